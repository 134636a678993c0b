"""The command `fiberbend cases`: the cases that come with the program."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fiberbend.running.launch import say
from fiberbend.schema.problems import CaseError, Problem


def cases(
    names: tuple[str, ...] = (),
    /,
    *,
    every: Annotated[bool, Parameter(name="--all")] = False,
    out: Path = Path("cases"),
    overwrite: bool = False,
) -> None:
    """List the cases that come with the program, or copy some of them into a folder.

    With a sweep comes the case that it changes.

    Args:
        names: Cases to copy; without any they are listed.
        every: Copy all of them.
        out: Folder to copy to; cases by default.
        overwrite: Replace files that are there.
    """
    from fiberbend.reader import shipped

    known = shipped.names()
    if not names and not every:
        width = max(map(len, known))
        for name in known:
            say(f"{name:<{width}}  {shipped.title(name)}".rstrip())
        return
    content = {out / path: text for path, text in shipped.files(names or known).items()}
    there = {path for path, text in content.items() if _holds(path, text)}
    taken = [path for path in content if path not in there and path.exists()]
    if taken and not overwrite:
        text = "exists with other content, expected a new file, or --overwrite"
        raise CaseError([Problem(str(path), text) for path in taken])
    for path, text in content.items():
        if path not in there:
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            except OSError as error:
                raise CaseError(
                    [Problem(str(path), f"{error.strerror}, expected a file")]
                ) from None
        say(f"{path}: {'there already' if path in there else 'written'}")


def _holds(path: Path, text: str) -> bool:
    """Whether a file has this content."""
    try:
        return path.read_bytes() == text.encode()
    except OSError:
        return False
