"""YAML files, and changes to what is in them before it is checked."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import yaml

from fiberbend.schema.paths import dotted, put
from fiberbend.schema.problems import CaseError, Problem


class _Loader(yaml.SafeLoader):
    """Refuses a key that a mapping has twice, where YAML would keep the last in silence."""

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        lines: dict[str, int] = {}
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                continue
            key, line = key_node.value, key_node.start_mark.line + 1
            if key in lines:
                raise yaml.MarkedYAMLError(
                    problem=f"key {key!r} a second time, expected once (line {lines[key]} has it)",
                    problem_mark=key_node.start_mark,
                )
            lines[key] = line
        return super().construct_mapping(node, deep)


@dataclasses.dataclass(frozen=True)
class YamlContent:
    """The mapping of a YAML file, and the lines of its values.

    Attributes:
        data: its mapping.
        lines: the line of each value, by its dotted path.
    """

    data: dict[str, Any]
    lines: dict[str, int]


def load_yaml(path: Path) -> dict[str, Any]:
    """Read a YAML file of one mapping.

    Raises:
        CaseError: no such file, malformed, a key twice, or no mapping.
    """
    return read_yaml(path).data


def read_yaml(path: Path) -> YamlContent:
    """Read a YAML file of one mapping, with the lines of its values.

    Raises:
        CaseError: no such file, malformed, a key twice, or no mapping.
    """
    try:
        with path.open(encoding="utf-8") as file:
            data, lines = _parse(file)
    except FileNotFoundError:
        raise CaseError([Problem(str(path), "no such file, expected a case file")]) from None
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text"
        raise CaseError([Problem(str(path), f"{reason}, expected a case file")]) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f"{path}, line {mark.line + 1}" if mark else str(path)
        what = getattr(error, "problem", None) or str(error).splitlines()[0]
        raise CaseError([Problem(where, f"malformed YAML, {what}")]) from None
    if not isinstance(data, dict):
        raise CaseError([Problem(str(path), "contains no mapping, expected a case")])
    return YamlContent(data, lines)


def _parse(stream: str | IO[str]) -> tuple[Any, dict[str, int]]:
    """The value of a YAML text, and the line of every value within it."""
    loader = _Loader(stream)
    node = loader.get_single_node()
    lines = {place: mark.line + 1 for place, mark in _marks(node, (), ())}
    return None if node is None else loader.construct_document(node), lines


def _marks(node: Any, keys: tuple[str, ...], around: tuple[Any, ...]) -> Iterator[tuple[str, Any]]:
    """The path and the mark of every value within a node.

    Raises:
        MarkedYAMLError: an alias puts a value into itself.
    """
    if node in around:
        raise yaml.MarkedYAMLError(
            problem="a value within itself, expected an end", problem_mark=node.start_mark
        )
    if isinstance(node, yaml.MappingNode):
        parts = [(str(key.value), key.start_mark, value) for key, value in node.value]
    elif isinstance(node, yaml.SequenceNode):
        parts = [(str(index), value.start_mark, value) for index, value in enumerate(node.value)]
    else:
        return
    for key, mark, value in parts:
        yield dotted((*keys, key)), mark
        yield from _marks(value, (*keys, key), (*around, node))


@contextlib.contextmanager
def line_numbers(lines: Mapping[str, int], changed: Sequence[str] = ()) -> Iterator[None]:
    """Add to the problems raised within the lines of a file at which they stand.

    Args:
        lines: the line of each value of the file, by its dotted path.
        changed: paths whose values come from elsewhere.
    """
    try:
        yield
    except CaseError as error:
        raise CaseError(located(problem, lines, changed) for problem in error.problems) from None


def located(problem: Problem, lines: Mapping[str, int], changed: Sequence[str] = ()) -> Problem:
    """A problem with the line of its value, or of the part that should have it.

    Args:
        problem: the problem.
        lines: the line of each value of a file, by its dotted path.
        changed: paths whose values come from elsewhere.
    """
    path = f"{problem.path}."
    if any(path.startswith(f"{other}.") or f"{other}.".startswith(path) for other in changed):
        return problem
    keys = problem.path.split(".")
    places = (dotted(keys[:count]) for count in range(len(keys), 0, -1))
    line = next((lines[place] for place in places if place in lines), problem.line)
    return dataclasses.replace(problem, line=line)


def root_paths(data: dict[str, Any], folder: Path) -> None:
    """Make the files that a case names independent of where it lies.

    Args:
        data: the case, not yet checked; changed in place.
        folder: that of the case file.
    """
    output = data.get("output")
    if isinstance(output, dict) and isinstance(output.get("measured"), str):
        output["measured"] = str(folder.resolve() / output["measured"])


def setting_path(setting: str) -> str:
    """The path of a change, `effects.0.pressure.to=150 kPa`."""
    return setting.partition("=")[0].strip()


def apply_setting(data: dict[str, Any], setting: str) -> None:
    """Change one value of a case that is not yet checked.

    Args:
        data: the case; changed in place.
        setting: a path and a YAML value, `effects.0.pressure.to=150 kPa`. It can name a key that
            the file leaves out, and the effect after the last; the schema checks what came out.

    Raises:
        CaseError: there is no such path, or the value is not YAML.
    """
    path, (_, equals, text) = setting_path(setting), setting.partition("=")
    if not equals or not path:
        raise CaseError([Problem(f"--set {setting}", 'expected a path and a value, "path=value"')])
    try:
        value, _ = _parse(text)
    except yaml.YAMLError:
        raise CaseError([Problem(path, f"{text!r} is not a YAML value")]) from None
    put(data, path, value)
