"""When a body touches the obstacles of its case, read off the columns of contact."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence

from fiberbend import columns as col
from fiberbend.answer.numbers import quantity

_BEYOND = 1.2
"""Parts of a step after which gaps that close evenly may meet; the step then ends at the touch."""


@dataclasses.dataclass(frozen=True)
class Touch:
    """An obstacle and the body.

    Attributes:
        obstacle: its name in the case.
        value: pressure and angle of the first touch, ready to print; empty where there is none.
        note: how they are found, or how near the body comes.
        force: of the obstacle on the body at the end, N; None where they do not touch then.
    """

    obstacle: str
    value: str
    note: str
    force: float | None


def touches(rows: Sequence[col.Row]) -> Iterator[Touch]:
    """First touch of every obstacle that a history has columns of.

    Between two load steps the gap is extrapolated from the two steps before the touch, as it
    closes evenly until then and stays at zero afterwards. Where that does not meet zero within
    the step, the answer is the interval between the steps.

    Args:
        rows: of the history, the first at rest.
    """
    for name in col.obstacles(rows):
        yield _touch(name, rows)


def _touch(name: str, rows: Sequence[col.Row]) -> Touch:
    area, gap = col.contact(name, "area_mm2"), col.contact(name, "gap_mm")
    first = next((i for i, row in enumerate(rows) if row.get(area)), None)
    if first is None:
        least = [row[gap] for row in rows if row.get(gap) is not None]
        near = f"the body comes as near as {quantity(min(least), 'mm')}" if least else ""
        return Touch(name, "", near, None)
    force = None
    if rows[-1].get(area):
        parts = (rows[-1].get(col.contact(name, f"{axis}_N")) or 0.0 for axis in "yz")
        force = math.hypot(*parts)
    value, note = _where(gap, rows, first)
    if force is None:
        note += "; it has left it at the end"
    return Touch(name, value, note, force)


def _where(gap: str, rows: Sequence[col.Row], first: int) -> tuple[str, str]:
    """Pressure and angle of the touch in the step to a row, and how they are found."""
    now, before = rows[first], rows[first - 1]
    if first < 2 or before.get(gap) is None:
        return f"by {_state(now)}", "within the first load step"
    if rows[first - 2].get(gap) is not None:
        share = {key: _share(key, gap, rows, first) for key in (col.PRESSURE, col.ANGLE)}
        if all(0 < part <= _BEYOND for part in share.values()):
            at = {
                key: before[key] + min(part, 1.0) * (now[key] - before[key])
                for key, part in share.items()
            }
            steps = f"{first - 2} and {first - 1}"
            return (
                f"at {_state(at)}",
                f"its gaps in steps {steps} extrapolated, within step {first}",
            )
    return f"between {_state(before)} and {_state(now)}", f"within step {first}"


def _share(key: str, gap: str, rows: Sequence[col.Row], first: int) -> float:
    """Part of the step to a row in which a gap closes that goes on as before; nan where it opens.

    Args:
        key: the column along which it closes evenly.
        gap: its column.
        rows: of the history.
        first: the first row that touches.
    """
    earlier, before, now = rows[first - 2 : first + 1]
    closing, step = earlier[gap] - before[gap], now[key] - before[key]
    if closing <= 0 or step == 0:
        return math.nan
    return float(before[gap] * (before[key] - earlier[key]) / closing / step)


def _state(row: col.Row) -> str:
    """Pressure and angle with three digits: steps are no finer."""
    return f"{quantity(row[col.PRESSURE], 'kPa', 3)}, {quantity(row[col.ANGLE], '°', 3)}"
