"""Values of a run at a pressure, at an angle or at a load step."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fiberbend import columns as col
from fiberbend.schema.problems import CaseError, Problem, found
from fiberbend.schema.units import KINDS, parse, show

SAME = 1e-6
"""Part of a pressure or an angle by which a load step may miss it and still be taken as it is."""
_MOST = 6
"""Steps and states that a message lists."""

ASKED = {"pressure": (col.PRESSURE, "pressure", 1e3), "angle": (col.ANGLE, "angle", 180 / math.pi)}
"""By keyword: the column, the kind of quantity, and what the column shows of an internal unit."""


class Reading(Mapping[str, float]):
    """The row of a run at a load step, or between two of them; values by column name.

    Args:
        values: by column, in its unit.
        steps: the load step, or the two between which the values are interpolated.
        at: what was asked for, in words.

    Attributes:
        steps: as given.
        at: as given.
    """

    def __init__(self, values: Mapping[str, float], steps: tuple[int, ...], at: str) -> None:
        self._values = dict(values)
        self.steps, self.at = steps, at

    @property
    def exact(self) -> bool:
        """Whether it is a load step that was solved, not a value between two."""
        return len(self.steps) == 1

    def __getitem__(self, column: str) -> float:
        if column not in self._values:
            where = "interpolated" if column in col.COUNTS and not self.exact else "known"
            raise KeyError(f"{column!r} is not {where} {self.where}")
        return self._values[column]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def _repr_html_(self) -> str:
        """The same as a notebook shows it."""
        from fiberbend.api import shown

        return shown.reading(self)

    def __repr__(self) -> str:
        """Where it is, and its values one a line."""
        width = max(map(len, self._values), default=0)
        lines = [f"  {name:{width}}  {value:.6g}" for name, value in self._values.items()]
        return "\n".join([f"<{self.at}, {self.where}", *lines]) + ">"

    @property
    def where(self) -> str:
        """At which step it is, or between which: "at step 3"."""
        steps = " and ".join(map(str, self.steps))
        return f"at step {steps}" if self.exact else f"between steps {steps}"


def asked(call: str, **given: Any) -> tuple[str, float]:
    """The one keyword that was given, and its value in the unit of its column.

    Args:
        call: the method, for messages.
        given: pressure and angle as text with a unit, step as a whole number; None: not given.

    Raises:
        CaseError: none or several, no quantity of the kind, or no whole number.
    """
    named = {key: value for key, value in given.items() if value is not None}
    if len(named) != 1:
        text = f"{' and '.join(named) or 'nothing'} given, expected one of {', '.join(given)}"
        raise CaseError([Problem(call, text)])
    ((key, value),) = named.items()
    if key == "step":
        if isinstance(value, bool) or not hasattr(value, "__index__"):
            raise CaseError([Problem("step", f"{found(value)}, expected a whole number")])
        return key, int(value)
    _, kind, shown = ASKED[key]
    try:
        return key, parse(value, kind) * shown
    except ValueError as error:
        raise CaseError([Problem(key, f"{found(value)}, {error}")]) from None


def words(key: str, value: float) -> str:
    """A pressure, an angle or a step as a message has it."""
    if key == "step":
        return f"step {value:g}"
    _, kind, shown = ASKED[key]
    name = KINDS[kind].shown
    return f"{value:.6g} {name}" if name in ("kPa", "deg") else show(value / shown, kind)


def close(value: float, goal: float, span: float) -> bool:
    """Whether a state is the one that is asked for; `span`: greatest magnitude of the run."""
    return abs(value - goal) <= SAME * max(abs(goal), 1e-3 * span)


def read_at(rows: Sequence[col.Row], key: str, goal: float) -> Reading:
    """The row of a run where its pressure or angle has a value, or that of a step.

    A load step that has the value is taken as it is. Between two steps every column is
    interpolated along the branch: by the cubic through two steps on either side, as far as the
    asked quantity grows or falls over them without a turn, and never beyond the values of the two
    steps. Counts are not interpolated.

    Args:
        rows: rows of history.csv, n of them.
        key: 'pressure', 'angle' or 'step'.
        goal: in kPa, in degrees, or the number of the step.

    Raises:
        CaseError: the run does not reach it, passes it more than once, or has no such step.
    """
    at = words(key, goal)
    if key == "step":
        for row in rows:
            if row[col.STEP] == goal:
                return _as_it_is(row, at)
        ends = f"from 0 to {rows[-1][col.STEP]}" if rows else "a run with steps"
        raise CaseError([Problem("step", f"{goal:g}, expected {ends}")])
    column = ASKED[key][0]
    x = [float(row[column]) for row in rows]
    span = max(map(abs, x), default=0.0)
    hits = [index for index, value in enumerate(x) if close(value, goal, span)]
    crossings = [
        index
        for index in range(len(x) - 1)
        if not {index, index + 1} & {*hits} and (x[index] - goal) * (x[index + 1] - goal) < 0
    ]
    if not hits and not crossings:
        unit = KINDS[ASKED[key][1]].shown
        reach = f"a value from {min(x):.6g} to {max(x):.6g} {unit}" if x else "a run with steps"
        raise CaseError([Problem(key, f"{at}, which the run does not reach, expected {reach}")])
    if len(hits) + len(crossings) > 1:
        raise CaseError([Problem(key, _ambiguous(rows, at, hits, crossings))])
    if hits:
        return _as_it_is(rows[hits[0]], at)
    return _between(rows, x, crossings[0], column, goal, at)


def _as_it_is(row: col.Row, at: str) -> Reading:
    known = {name: row[name] for name in row if _known(row, name)}
    return Reading(known, (int(row[col.STEP]),), at)


def _ambiguous(
    rows: Sequence[col.Row], at: str, hits: Sequence[int], crossings: Sequence[int]
) -> str:
    places = [(index, f"at step {rows[index][col.STEP]}") for index in hits]
    places += [
        (index, f"between steps {rows[index][col.STEP]} and {rows[index + 1][col.STEP]}")
        for index in crossings
    ]
    listed = [text for _, text in sorted(places)]
    more = f" and {len(listed) - _MOST} more" if len(listed) > _MOST else ""
    return f"{at} is passed {', '.join(listed[:_MOST])}{more}: expected a step"


def _between(
    rows: Sequence[col.Row], x: Sequence[float], index: int, column: str, goal: float, at: str
) -> Reading:
    """The row between a step and the next, by the steps around them that go the same way."""
    way = [(b > a) - (b < a) for a, b in itertools.pairwise(x)]
    first, last = index, index + 1
    while first > 0 and way[first - 1] == way[index]:
        first -= 1
    while last < len(x) - 1 and way[last] == way[index]:
        last += 1
    start = max(first, min(index - 1, last - 3))
    around = range(start, min(start + 4, last + 1))
    values: dict[str, float] = {}
    for name in rows[index]:
        if name in col.COUNTS or not (_known(rows[index], name) and _known(rows[index + 1], name)):
            continue
        points = [i for i in around if _known(rows[i], name)]
        y = [float(rows[i][name]) for i in points]
        low, high = sorted((float(rows[index][name]), float(rows[index + 1][name])))
        values[name] = min(max(_lagrange([x[i] for i in points], y, goal), low), high)
    values[column] = goal
    return Reading(values, (int(rows[index][col.STEP]), int(rows[index + 1][col.STEP])), at)


def _known(row: col.Row, name: str) -> bool:
    value = row.get(name)
    return value is not None and math.isfinite(value)


def _lagrange(x: Sequence[float], y: Sequence[float], goal: float) -> float:
    """The polynomial through points with different x, at the goal."""
    return sum(
        y[i] * math.prod((goal - x[j]) / (x[i] - x[j]) for j in range(len(x)) if j != i)
        for i in range(len(x))
    )
