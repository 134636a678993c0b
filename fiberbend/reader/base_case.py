"""The base case of a file that solves many, with what the file changes of it."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fiberbend.reader.own_files import root_paths, rooted_value
from fiberbend.reader.yaml_file import (
    YamlContent,
    apply_setting,
    located,
    read_yaml,
    setting_path,
)
from fiberbend.schema.paths import put
from fiberbend.schema.problems import CaseError, Problem

HAND = "fingers"
"""Key by which a file is a hand's."""


def refuse_hand(data: Mapping[str, Any], path: Path | str) -> None:
    """A line that says the command for a hand.

    Raises:
        CaseError: it is one.
    """
    if HAND in data:
        raise CaseError([Problem(str(path), f"this is a hand: fiberbend hand {path}")])


@dataclasses.dataclass(frozen=True)
class BaseCase:
    """A base case with all changes that its cases share.

    Attributes:
        source: the case, not yet checked, and its lines in its own file.
        where: that file, or `case` for one within the file.
        changed: paths whose values come from elsewhere.
    """

    source: YamlContent
    where: str
    changed: tuple[str, ...]

    def reported(self, problem: Problem) -> Problem:
        """A problem of the base case, as one of the file."""
        found = located(problem, self.source.lines, self.changed)
        return dataclasses.replace(found, path=f"{self.where}: {found.path}")


def read_base(
    case: str | Mapping[str, Any],
    changes: Mapping[str, Any],
    source: YamlContent,
    path: Path,
    settings: Sequence[str],
) -> BaseCase:
    """Read a base case.

    Args:
        case: its file, relative to `path`, or the case itself.
        changes: values by their dotted paths, as the key `set` has them.
        source: the file that names it.
        path: of that file; what a file says is seen from that file.
        settings: changes after those, `actuator.wall=3 mm` each, seen from the working folder.

    Raises:
        CaseError: its file cannot be read, or has no place for a change.
    """
    if isinstance(case, str):
        where, own = case, read_yaml(path.parent / case)
        root_paths(own.data, (path.parent / case).parent)
    else:
        begin = "case."
        lines = source.lines.items()
        inner = {place.removeprefix(begin): n for place, n in lines if place.startswith(begin)}
        where, own = "case", YamlContent(copy.deepcopy(dict(case)), inner)
        root_paths(own.data, path.parent)
    wrong: list[Problem] = []
    for field, value in changes.items():
        try:
            put(own.data, field, rooted_value(field, copy.deepcopy(value), path.parent))
        except CaseError as error:
            wrong += (Problem(f"set.{p.path}", p.text) for p in error.problems)
    for setting in settings:
        try:
            apply_setting(own.data, setting)
        except CaseError as error:
            wrong += error.problems
    if wrong:
        raise CaseError(wrong)
    root_paths(own.data, Path())
    return BaseCase(own, where, (*changes, *map(setting_path, settings)))
