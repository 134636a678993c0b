"""What a case asks for, as numbers that can be read off the history of any model."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import Any

from fiberbend import columns as col
from fiberbend.answer.asked import HELD
from fiberbend.answer.motion import SEEN, STRETCH, STRETCHED, Reading
from fiberbend.answer.moves import moves
from fiberbend.case.case import Case
from fiberbend.schema.units import show
from fiberbend.sweep.quantities import kilopascals, motion_column, pressure_column

_SAME = 1e-6
"""Part of an asked value by which a row may miss it."""


@dataclasses.dataclass(frozen=True)
class Asked:
    """A quantity that a case asks for.

    Attributes:
        name: its column in a table, with the unit.
        label: in words, such as "pressure at 90°".
        unit: of its value.
        column: of history.csv, that has the value.
        key: column in which the row is found; empty for the last row.
        goal: value of that column.
        rest: value at rest, from which it counts.
        factor: of its unit over that of the column.
        together: quantities with the same word are judged in parts of the greatest of them; of one
            that is empty in parts of itself.
        least: size of the greatest from which an error in parts of it means anything.
    """

    name: str
    label: str
    unit: str
    column: str
    key: str = ""
    goal: float = 0.0
    rest: float = 0.0
    factor: float = 1.0
    together: str = ""
    least: float = 0.0

    def value(self, rows: Sequence[col.Row], ended: bool) -> float | None:
        """Its value: the first that the run comes to; None where it does not.

        Args:
            rows: of history.csv, the first at rest.
            ended: the run came to its end.
        """
        if not self.key:
            found = rows[-1:] if ended and len(rows) > 1 else []
        else:
            slack = _SAME * max(1.0, abs(self.goal))
            found = [
                row
                for row in rows[1:]
                if row.get(self.key) is not None and abs(row[self.key] - self.goal) <= slack
            ]
        values = (row.get(self.column) for row in found)
        first = next((float(value) for value in values if value is not None), None)
        return None if first is None else self.factor * (first - self.rest)


def asked(case: Case) -> tuple[Asked, ...]:
    """The quantities of a case: what its output asks for, else what is not given at its end."""
    found = list(_forces(case) if case.straight else _bending(case))
    return tuple({each.name: each for each in found}.values())


def _forces(case: Case) -> Iterator[Asked]:
    """Tip forces at the asked pressures, or at the end."""
    for pressure in case.output.at_pressures:
        name = f"tip_force_{kilopascals(pressure)}_N"
        label = f"tip force at {show(pressure, 'pressure')}"
        yield Asked(name, label, "N", col.TIP_FORCE, col.PRESSURE, 1e3 * pressure)
    if not case.output.at_pressures:
        yield Asked("end_tip_force_N", "tip force at the end", "N", col.TIP_FORCE)


def _bending(case: Case) -> Iterator[Asked]:
    output, load = case.output, case.inflation
    angles = output.at_angles
    if load is not None and not angles and not output.at_pressures:
        # a run that ends at an angle is one that asks for it
        angles = tuple(angle for angle in (load.angle, output.stop_at_angle) if angle is not None)
    for angle in angles if load is not None else ():
        degrees = math.degrees(angle)
        label = f"pressure at {degrees:.6g}°"
        yield Asked(pressure_column(angle), label, "kPa", col.PRESSURE, col.ANGLE, degrees)
    for pressure in output.at_pressures:
        yield from _moved(case, pressure)
    if angles or output.at_pressures:
        return
    yield from _moved(case, None)
    if load is not None and load.to is None:
        yield Asked("end_pressure_kPa", "pressure at the end", "kPa", col.PRESSURE)


def _moved(case: Case, pressure: float | None) -> Iterator[Asked]:
    """How far it moves at a pressure, or at the end; and what it exerts on what holds a motion.

    Angles at one state are judged together, in parts of the greatest: of what bends by 90° and
    twists by 1° half a degree more is not half of its answer.
    """
    held = {key for effect in case.acting for key in effect.held()}
    for motion in moves(case):
        yield _read(motion, pressure)
    for key in HELD:
        if key in held:
            yield _read(HELD[key], pressure)


def _read(reading: Reading, pressure: float | None) -> Asked:
    """What is read off a row, at a pressure or at the end."""
    (column,), name, unit = reading.columns, reading.name, reading.unit
    at = "the end" if pressure is None else show(pressure, "pressure")
    kind: dict[str, Any] = {}
    if not unit:
        name, unit = name.replace(STRETCH.name, "lengthening"), "%"
        kind = {"rest": 1.0, "factor": 100.0, "least": 100 * STRETCHED}
    elif unit == "°":
        kind = {"together": f"turn at {at}", "least": SEEN}
    named = motion_column(dataclasses.replace(reading, name=name, unit=unit), pressure)
    if pressure is not None:
        kind |= {"key": col.PRESSURE, "goal": 1e3 * pressure}
    return Asked(named, f"{name} at {at}", unit, column, **kind)
