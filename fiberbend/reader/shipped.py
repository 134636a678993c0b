"""The cases that come with the program, wherever it is installed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import yaml

from fiberbend.reader.new_case import SCHEMA_FILE
from fiberbend.schema.problems import CaseError, Problem, found, meant

FOLDER = Path(__file__).resolve().parent.parent / "cases"
_ENDING = ".yaml"


def names() -> list[str]:
    """Names of cases and sweeps, "section" and "sweeps/table1", those of folders last."""
    paths = [path.relative_to(FOLDER) for path in FOLDER.glob(f"**/*{_ENDING}")]
    ordered = sorted(paths, key=lambda path: (len(path.parts), path))
    return [path.as_posix().removesuffix(_ENDING) for path in ordered]


def title(name: str) -> str:
    """What a case says of itself.

    Args:
        name: one of `names`.
    """
    for line in _text(name).splitlines():
        if line.startswith("title:"):
            return str(yaml.safe_load(line)["title"])
    return ""


def files(wanted: Iterable[str]) -> dict[str, str]:
    """Content of cases, of those that they are made from, and of the schema for editors.

    Args:
        wanted: names.

    Returns:
        By path within the folder of cases.

    Raises:
        CaseError: names that there are not.
    """
    left, known = list(wanted), names()
    problems = [
        Problem("case", f"{found(name)}, expected one of {', '.join(known)}{meant(name, known)}")
        for name in left
        if name not in known
    ]
    if problems:
        raise CaseError(problems)
    content: dict[str, str] = {}
    while left:
        name = left.pop(0)
        if f"{name}{_ENDING}" not in content:
            content[f"{name}{_ENDING}"] = text = _text(name)
            left += _base(name, text)
    content[SCHEMA_FILE] = (FOLDER / SCHEMA_FILE).read_text(encoding="utf-8")
    return content


def _text(name: str) -> str:
    return (FOLDER / f"{name}{_ENDING}").read_text(encoding="utf-8")


def _base(name: str, text: str) -> list[str]:
    """The case that a sweep changes, where it is another file."""
    base = yaml.safe_load(text).get("case")
    if not isinstance(base, str):
        return []
    path = (FOLDER / name).parent / base
    return [path.resolve().relative_to(FOLDER.resolve()).as_posix().removesuffix(_ENDING)]
