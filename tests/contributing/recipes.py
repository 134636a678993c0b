"""The recipes of CONTRIBUTING.md, applied to a copy of the source."""

from __future__ import annotations

import copy
import dataclasses
import difflib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import yaml

from tests.conftest import ROOT

PAGE = ROOT / "CONTRIBUTING.md"
PACKAGES = ("machine", "materials", "geometry", "analytic", "rod", "fem", "fiberbend")
TESTS = ("tests/__init__.py", "tests/conftest.py", "tests/materials", "pyproject.toml")
"""What comes with the source, so that recipes can add to the tests."""
_BLOCK = re.compile(r"(?:^`([^`\n]+)`\n\n)?^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)

USE = '''
import json, sys
from pathlib import Path

import fiberbend
from fiberbend.plan.plan import make_plan
from fiberbend.reader.json_schema import json_schema
from fiberbend.reader.reader import read_case
from fiberbend.results.reading import read_history
from fiberbend.schema.problems import CaseError

assert Path(fiberbend.__file__).parents[1] == Path.cwd()

def told(path, *settings):
    """What is wrong with a case."""
    try:
        read_case(path, settings)
    except CaseError as error:
        return str(error)
    return ""

def answer(path):
    """What plan and run say of a case."""
    case = read_case(path)
    assert read_case(path).resolved() == case.resolved()
    plan = " ".join("\\n".join(make_plan(case).lines()).split())
    result = fiberbend.run(case, path.with_suffix(""))
    rows = read_history(path.with_suffix("") / "history.csv")
    return {"plan": plan, "status": result.status, "rows": rows, "resolved": case.resolved(),
            "model": result.run["model"]}

if __name__ == "__main__":
    paths = sorted(Path.cwd().glob("*.yaml"))
    found = {path.stem: answer(path) for path in paths}
    found["schema"] = json.dumps(json_schema(), ensure_ascii=False)
    Path("found.json").write_text(json.dumps(found), encoding="utf-8")
'''


@dataclasses.dataclass(frozen=True)
class Recipe:
    """What a section of the page has.

    Attributes:
        files: new files by their paths.
        diffs: hunks (before, after) of files that are there, by their paths.
        case: what a case then says.
    """

    files: dict[str, str]
    diffs: dict[str, list[tuple[str, str]]]
    case: dict[str, Any]


def recipe(title: str) -> Recipe:
    """The recipe under a heading; every block of it is read, and nothing else is."""
    text = PAGE.read_text(encoding="utf-8")
    (section,) = re.findall(rf"^### {title}\n(.*?)(?=^### |\Z)", text, re.MULTILINE | re.DOTALL)
    files: dict[str, str] = {}
    diffs: dict[str, list[tuple[str, str]]] = {}
    case: dict[str, Any] = {}
    for path, kind, content in _BLOCK.findall(section):
        if kind == "python":
            assert path, "a new file has its path above it"
            files[path] = content
        elif kind == "diff":
            name, hunks = _hunks(content)
            assert name not in diffs
            diffs[name] = hunks
        elif kind == "yaml":
            case |= yaml.safe_load(content)
        else:
            raise ValueError(f"block of {kind!r}, expected python, diff or yaml")
    return Recipe(files, diffs, case)


def _hunks(diff: str) -> tuple[str, list[tuple[str, str]]]:
    """File of a diff without line numbers, and what stands in it before and after."""
    head, *hunks = diff.split("@@\n")
    (name,) = {line[4:] for line in head.splitlines()}
    pairs = []
    for hunk in hunks:
        lines = hunk.splitlines(keepends=True)
        assert all(line[0] in " +-" for line in lines)
        pairs.append(
            tuple("".join(line[1:] for line in lines if line[0] in kept) for kept in (" -", " +"))
        )
    return name, pairs  # type: ignore[return-value]


class House:
    """A copy of the source with one recipe applied.

    Args:
        folder: where the copy goes.
        title: heading of the recipe.

    Attributes:
        recipe: what the page says.
    """

    def __init__(self, folder: Path, title: str) -> None:
        self._folder, self.recipe = folder, recipe(title)
        ignore = shutil.ignore_patterns("__pycache__")
        (folder / "tests").mkdir()
        for part in (*PACKAGES, *TESTS):
            if (ROOT / part).is_dir():
                shutil.copytree(ROOT / part, folder / part, ignore=ignore)
            else:
                shutil.copy(ROOT / part, folder / part)
        for path, text in self.recipe.files.items():
            assert not (folder / path).exists()
            (folder / path).write_text(text, encoding="utf-8")
        for path, hunks in self.recipe.diffs.items():
            text = (folder / path).read_text(encoding="utf-8")
            for before, after in hunks:
                assert text.count(before) == 1, f"{path} has no such place, or several:\n{before}"
                text = text.replace(before, after)
            (folder / path).write_text(text, encoding="utf-8")

    def touched(self) -> dict[str, int]:
        """Lines added to the source, by file; nothing is taken away."""
        found = {}
        for package in PACKAGES:
            for path in sorted((self._folder / package).rglob("*.py")):
                name = str(path.relative_to(self._folder))
                old = ROOT / name
                before = old.read_text(encoding="utf-8").splitlines() if old.exists() else []
                after = path.read_text(encoding="utf-8").splitlines()
                changes = [line[0] for line in difflib.ndiff(before, after) if line[0] in "+-"]
                assert "-" not in changes
                if changes:
                    found[name] = len(changes)
        return found

    def lint(self) -> str:
        """What ruff has against the files of the recipe; nothing where it is content."""
        said = ""
        for command in (["check", "--no-cache"], ["format", "--no-cache", "--diff"]):
            done = self._python("-m", "ruff", *command, *self.recipe.files, *self.recipe.diffs)
            if done.returncode:
                said += done.stdout + done.stderr
        return said

    def case(self, base: dict[str, Any]) -> dict[str, Any]:
        """A case with what the page says: parts by their keys, effects by their names."""
        said = copy.deepcopy(base)
        for key, value in copy.deepcopy(self.recipe.case).items():
            if key == "effects":
                names = {name for effect in value for name in effect}
                kept = [effect for effect in said["effects"] if names.isdisjoint(effect)]
                said["effects"] = [*kept, *value]
            elif isinstance(value, dict):
                said[key] = said.get(key, {}) | value
            else:
                said[key] = value
        return said

    def use(self, cases: dict[str, dict[str, Any]], more: str = "") -> dict[str, Any]:
        """Plan and run cases in a fresh process.

        Args:
            cases: by name.
            more: code that follows, with `told`, `answer` and `Path` known.

        Returns:
            The answers by name, and the JSON schema as text under "schema".
        """
        for name, case in cases.items():
            path = self._folder / f"{name}.yaml"
            path.write_text(yaml.safe_dump(case), encoding="utf-8")
        done = self._python("-c", USE + more)
        assert done.returncode == 0, done.stderr
        found: dict[str, Any] = json.loads((self._folder / "found.json").read_text("utf-8"))
        return found

    def tests(self, *arguments: str) -> str:
        """What pytest says last of tests in the copy."""
        done = self._python("-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments)
        return done.stdout.rstrip().splitlines()[-1]

    def _python(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run Python in the copy, which is where all is imported from."""
        search = os.pathsep.join([str(self._folder), os.environ.get("PYTHONPATH", "")])
        return subprocess.run(
            [sys.executable, *arguments],
            cwd=self._folder,
            env=os.environ | {"PYTHONPATH": search},
            capture_output=True,
            text=True,
            timeout=600,
        )
