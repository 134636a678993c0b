"""A part of a sweep's points, named by values of varied fields: `--only wall=2mm`."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from typing import Any

from fiberbend.reader.yaml_file import apply_setting
from fiberbend.schema.paths import value_at
from fiberbend.schema.problems import CaseError, Problem, found, meant
from fiberbend.schema.units import KINDS, parse
from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.points import Point, Sweep

_SAME = 1e-9
_MOST_VALUES = 12
"""Values of a field that a message lists."""


def choose(sweep: Sweep, only: Sequence[str]) -> tuple[Point, ...]:
    """The points of a sweep that have given values.

    Args:
        sweep: the sweep.
        only: `FIELD=VALUE` each; of several values of one field a point has one, of several fields
            it has all. None: every point.

    Raises:
        CaseError: a field that does not vary, a value or a combination that no point has; says
            which there are.
    """
    wanted: dict[VariedField, list[Any]] = {}
    problems: list[Problem] = []
    resolved = [point.case.resolved() for point in sweep.points] if only else []
    for text in only:
        name, _, value = text.partition("=")
        try:
            field = _field(sweep.columns, name.strip(), text)
            given = _given(value, text)
            known = [value_at(case, field.path) for case in resolved]
            if not any(_alike(given, each) for each in known):
                raise CaseError([Problem(f"--only {text}", _no_value(field, known))])
            wanted.setdefault(field, []).append(given)
        except CaseError as error:
            problems += error.problems
    if problems:
        raise CaseError(problems)
    if not only:
        return sweep.points
    chosen = tuple(
        point
        for point, case in zip(sweep.points, resolved, strict=True)
        if all(
            any(_alike(given, value_at(case, field.path)) for given in values)
            for field, values in wanted.items()
        )
    )
    if not chosen:
        together = " and ".join(only)
        raise CaseError([Problem("--only", f"no point has {together} together")])
    return chosen


def _field(columns: Iterable[VariedField], name: str, text: str) -> VariedField:
    """The varied field of a name: its label, or the end of its path."""
    columns = tuple(columns)
    ends = {column: f".{column.path}" for column in columns}
    matching = [column for column in columns if column.label == name] or [
        column for column, path in ends.items() if name and path.endswith(f".{name}")
    ]
    if len(matching) == 1:
        return matching[0]
    if matching:
        several = " and ".join(column.path for column in matching)
        raise CaseError([Problem(f"--only {text}", f"{name} is {several}, expected one of them")])
    names = [column.label for column in columns]
    wanted = f"expected a field that varies, {', '.join(names)}{meant(name, names)}"
    raise CaseError([Problem(f"--only {text}", f"{found(name)}, {wanted}")])


def _given(value: str, text: str) -> Any:
    if not value.strip():
        raise CaseError([Problem(f"--only {text}", "expected FIELD=VALUE, such as wall=2mm")])
    read: dict[str, Any] = {}
    try:
        apply_setting(read, f"value={value}")
    except CaseError as error:
        raise CaseError(Problem(f"--only {text}", p.text) for p in error.problems) from None
    return read["value"]


def _no_value(field: VariedField, known: Sequence[Any]) -> str:
    shown = list(dict.fromkeys(_shown(value) for value in known))
    more = f" … ({len(shown)} in all)" if len(shown) > _MOST_VALUES else ""
    return f"no point has that {field.label}, there are {', '.join(shown[:_MOST_VALUES])}{more}"


def _shown(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _alike(one: Any, other: Any) -> bool:
    """The same value: quantities by their size, "2mm" and "0.2 cm", all else as it stands."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_alike(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(_alike, one, other))
    numbers = [
        isinstance(each, int | float) and not isinstance(each, bool) for each in (one, other)
    ]
    if all(numbers):
        return math.isclose(one, other, rel_tol=_SAME)
    if isinstance(one, str) and isinstance(other, str):
        return one == other or any(_same_size(one, other, kind) for kind in KINDS)
    return type(one) is type(other) and bool(one == other)


def _same_size(one: str, other: str, kind: str) -> bool:
    try:
        return math.isclose(parse(one, kind), parse(other, kind), rel_tol=_SAME)
    except ValueError:
        return False
