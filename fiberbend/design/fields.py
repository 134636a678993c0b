"""Fields that a design may change: between two ends, in whole numbers, or among choices."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fiberbend.answer.numbers import number
from fiberbend.design.file import MOST_COMBINATIONS
from fiberbend.schema.problems import CaseError, Problem, found
from fiberbend.schema.units import KINDS, factor, parse
from fiberbend.sweep.fields import labels

_ENDS = ("from", "to")
_MOST_WHOLE = 32
Pairs = tuple[tuple[str, Any], ...]
"""Paths with the values that stand there in a file."""


@dataclasses.dataclass(frozen=True)
class Varied:
    """A number of a case that may have any value between two ends.

    Attributes:
        path: dotted path in the case.
        label: short name, unique in the design.
        low: the lower end in the internal unit of its kind.
        high: the upper end.
        unit: in which the file gives it; empty for a pure number.
        factor: one of that unit in the internal unit.
    """

    path: str
    label: str
    low: float
    high: float
    unit: str = ""
    factor: float = 1.0

    def rounded(self, value: float) -> float:
        """A value with eight digits in its unit, between the ends."""
        near = self.factor * float(f"{value / self.factor:.8g}")
        return min(max(near, self.low), self.high)

    def text(self, value: float) -> Any:
        """A value as a case file has it."""
        scaled = float(f"{value / self.factor:.12g}")
        return f"{scaled!r} {self.unit}".replace(".0 ", " ") if self.unit else scaled

    def shown(self, value: float) -> str:
        """A value as a person reads it."""
        return f"{number(value / self.factor)} {self.unit}".strip()

    @property
    def step(self) -> float:
        """A small change that a maker would notice: 0.1 mm, else 1 % of the range."""
        if self.unit and _is_length(self.unit):
            return 0.1
        return 0.01 * (self.high - self.low)


@dataclasses.dataclass(frozen=True)
class Choice:
    """A field of a case that has one of several values.

    Attributes:
        path: dotted path in the case.
        label: short name, unique in the design.
        values: as a file has them.
        between: they are all whole numbers between two ends.
    """

    path: str
    label: str
    values: tuple[Any, ...]
    between: bool = False

    def origins(self) -> dict[str, Any]:
        """By their keys under the field in the file, the values that stand there."""
        if self.between:
            return {"from": self.values[0], "to": self.values[-1]}
        return {str(index): value for index, value in enumerate(self.values)}


@dataclasses.dataclass(frozen=True)
class Fields:
    """All that may change.

    Attributes:
        varied: numbers between two ends.
        choices: all others.
    """

    varied: tuple[Varied, ...]
    choices: tuple[Choice, ...]

    def combinations(self) -> list[Pairs]:
        """Every combination of choices; a single empty one where there are none."""
        parts = [[(choice.path, value) for value in choice.values] for choice in self.choices]
        return [tuple(pairs) for pairs in itertools.product(*parts)]

    def words(self, chosen: Pairs) -> str:
        """A combination in words; empty where there are no choices."""
        names = {choice.path: choice.label for choice in self.choices}
        return ", ".join(f"{names[path]} {value_words(value)}" for path, value in chosen)


def value_words(value: Any) -> str:
    """A chosen value in words."""
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {value_words(part)}" for key, part in value.items())
    return str(value)


def read_fields(vary: Mapping[str, Any]) -> Fields:
    """Fields of a design file.

    Args:
        vary: as the file has them.

    Raises:
        CaseError: everything that is wrong with them, but for what the case says of their values.
    """
    problems: list[Problem] = []
    names = labels(list(vary))
    varied: list[Varied] = []
    choices: list[Choice] = []
    for path, given in vary.items():
        where = f"vary.{path}"
        try:
            if isinstance(given, list):
                choices.append(_choice(where, path, names[path], given))
            elif isinstance(given, dict):
                one = _between(where, path, names[path], given)
                (choices if isinstance(one, Choice) else varied).append(one)  # type: ignore[arg-type]
            else:
                text = "expected {from: …, to: …} or a list of choices"
                raise CaseError([Problem(where, f"{found(given)}, {text}")])
        except CaseError as error:
            problems += error.problems
    problems += _overlaps(list(vary))
    fields = Fields(tuple(varied), tuple(choices))
    count = math.prod(len(choice.values) for choice in choices)
    if count > MOST_COMBINATIONS:
        text = f"{count} combinations of choices, expected at most {MOST_COMBINATIONS}"
        problems.append(Problem("vary", text))
    if problems:
        raise CaseError(problems)
    return fields


def _overlaps(paths: Sequence[str]) -> Iterator[Problem]:
    for path in paths:
        for other in paths:
            if path.startswith(f"{other}."):
                yield Problem(f"vary.{path}", f"a part of {other}, which varies too")


def _choice(where: str, path: str, label: str, values: list[Any]) -> Choice:
    if not values:
        raise CaseError([Problem(where, "no value, expected at least one")])
    twice = [i for i, value in enumerate(values) if value in values[:i]]
    if twice:
        raise CaseError([Problem(f"{where}.{i}", "there already, expected once") for i in twice])
    return Choice(path, label, tuple(values))


def _between(where: str, path: str, label: str, given: dict[str, Any]) -> Varied | Choice:
    wrong = [
        Problem(f"{where}.{key}", "unknown key, expected one of from, to")
        for key in given
        if key not in _ENDS
    ]
    wrong += [
        Problem(f"{where}.{key}", "missing, expected the end of a range")
        for key in _ENDS
        if key not in given
    ]
    if wrong:
        raise CaseError(wrong)
    low, high = (given[key] for key in _ENDS)
    if _whole(low) and _whole(high):
        _rising(where, low, high)
        if high - low >= _MOST_WHOLE:
            text = (
                f"{high - low + 1} whole numbers, expected at most {_MOST_WHOLE} (a number that "
                "need not be whole has a point, 1.0)"
            )
            raise CaseError([Problem(where, text)])
        return Choice(path, label, tuple(range(low, high + 1)), between=True)
    if _number(low) and _number(high):
        _rising(where, low, high)
        return Varied(path, label, float(low), float(high))
    for key in _ENDS:
        if not isinstance(given[key], str):
            text = "expected a quantity with its unit, as the other end has"
            text = text if isinstance(given[_ENDS[key == "from"]], str) else "expected a number"
            raise CaseError([Problem(f"{where}.{key}", f"{found(given[key])}, {text}")])
    kind = next((name for name in KINDS if _fits(low, name) and _fits(high, name)), None)
    if kind is None:
        text = f"{found(low)} and {found(high)}, expected two quantities of one kind with units"
        raise CaseError([Problem(where, text)])
    ends = parse(low, kind), parse(high, kind)
    _rising(where, *ends)
    unit = low.strip().lstrip("+-0123456789.eE").strip()
    unit = unit if _is_unit(unit, kind) else KINDS[kind].shown
    return Varied(path, label, *ends, unit, factor(unit, kind))


def _rising(where: str, low: float, high: float) -> None:
    if not low < high:
        raise CaseError([Problem(f"{where}.to", "not above from, expected a greater value")])


def _whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _fits(text: str, kind: str) -> bool:
    try:
        parse(text, kind)
    except ValueError:
        return False
    return True


def _is_unit(unit: str, kind: str) -> bool:
    try:
        factor(unit, kind)
    except ValueError:
        return False
    return True


def _is_length(unit: str) -> bool:
    return _is_unit(unit, "length")
