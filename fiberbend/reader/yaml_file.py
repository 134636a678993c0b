"""YAML files, and changes to what is in them before it is checked."""

from __future__ import annotations

import codecs
import contextlib
import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from fiberbend.schema.paths import dotted, put
from fiberbend.schema.problems import CaseError, Problem

MOST_BYTES = 1_000_000
_MOST_VALUES = 100_000
_DEEPEST = 50
"""What no case and no sweep needs: bytes of a file, values in it once its aliases are written out,
and values within values."""
_LONGEST_NUMBER = 400
_ROUND = ("int", "float", "bool", "timestamp")


class _Loader(yaml.SafeLoader):
    """Refuses what YAML would take in silence, or without an end.

    A key that a mapping has twice, of which YAML keeps the last; keys that are no text; values
    within themselves, too deep, or too many where aliases stand for them.
    """

    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self._depth = 0
        self._sizes: dict[int, tuple[int, int]] = {}

    def compose_node(self, parent: Any, index: Any) -> Any:
        """A node, with the number of its values and how deep they stand known."""
        self._depth += 1
        event = self.peek_event()
        if self._depth > _DEEPEST:
            raise _refused(f"more than {_DEEPEST} values within values", event)
        node: Any = super().compose_node(parent, index)
        self._depth -= 1
        if isinstance(event, yaml.AliasEvent):
            if id(node) not in self._sizes:
                raise _refused("a value within itself, expected an end", event)
            return node
        inner = [] if isinstance(node, yaml.ScalarNode) else node.value
        parts = [part for item in inner for part in (item if isinstance(item, tuple) else (item,))]
        sizes = [self._sizes[id(part)] for part in parts]
        count, depth = 1 + sum(size for size, _ in sizes), 1 + max((d for _, d in sizes), default=0)
        if count > _MOST_VALUES:
            raise _refused(f"more than {_MOST_VALUES} values", event)
        if depth > _DEEPEST:
            raise _refused(f"more than {_DEEPEST} values within values", event)
        self._sizes[id(node)] = count, depth
        return node

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """A value; what looks like a number, a date or a truth value and is none is refused."""
        kind = node.tag.rpartition(":")[2]
        scalar = isinstance(node, yaml.ScalarNode)
        wrong = scalar and kind in _ROUND and len(node.value) > _LONGEST_NUMBER
        # half of a surrogate pair is no character, and no file takes it
        wrong = wrong or (scalar and any("\ud800" <= c <= "\udfff" for c in node.value))
        if not wrong:
            try:
                return super().construct_object(node, deep)
            except (ValueError, KeyError, AttributeError, OverflowError):
                wrong = True
        raise _refused(f"{str(node.value)[:40]!r} is no {kind}", node)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        """A mapping of names."""
        lines: dict[str, int] = {}
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise _refused("a key that is no text, expected a name", key_node)
            key, line = key_node.value, key_node.start_mark.line + 1
            if not key_node.tag.endswith((":str", ":merge")):
                raise _refused(f"the key {key[:40]!r} is no text, expected a name", key_node)
            if key in lines:
                raise _refused(
                    f"key {key[:40]!r} a second time, expected once (line {lines[key]} has it)",
                    key_node,
                )
            lines[key] = line
        return super().construct_mapping(node, deep)


def _refused(problem: str, place: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=place.start_mark)


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
        data, lines = _parse(_text(path))
    except FileNotFoundError:
        raise CaseError([Problem(str(path), "no such file, expected a case file")]) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f"{path}, line {mark.line + 1}" if mark else str(path)
        what = getattr(error, "problem", None) or str(error).splitlines()[0]
        raise CaseError([Problem(where, f"malformed YAML, {what}")]) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise CaseError([Problem(str(path), f"{reason}, expected a case file")]) from None
    if not isinstance(data, dict):
        raise CaseError([Problem(str(path), "contains no mapping, expected a case")])
    return YamlContent(data, lines)


def _text(path: Path) -> str:
    """The text of a file.

    Raises:
        OSError: it cannot be read.
        ValueError: too long, or not UTF-8 (UTF-16 where it begins with its mark, as YAML has it).
    """
    with path.open("rb") as file:
        content = file.read(MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise ValueError(f"longer than {MOST_BYTES / 1e6:g} MB")
    is_utf16 = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        return content.decode("utf-16" if is_utf16 else "utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError("not text in UTF-8") from None


def _parse(text: str) -> tuple[Any, dict[str, int]]:
    """The value of a YAML text, and the line of every value within it."""
    loader = _Loader(text)
    node = loader.get_single_node()
    lines = {place: mark.line + 1 for place, mark in _marks(node, ())}
    return None if node is None else loader.construct_document(node), lines


def _marks(node: Any, keys: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    """The path and the mark of every value within a node."""
    if isinstance(node, yaml.MappingNode):
        parts = [(str(key.value), key.start_mark, value) for key, value in node.value]
    elif isinstance(node, yaml.SequenceNode):
        parts = [(str(index), value.start_mark, value) for index, value in enumerate(node.value)]
    else:
        return
    for key, mark, value in parts:
        yield dotted((*keys, key)), mark
        yield from _marks(value, (*keys, key))


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
        raise CaseError([Problem(path, f"{text[:60]!r} is not a YAML value")]) from None
    put(data, path, value)
