"""What a case asks for, as numbers that can be read off the history of any model."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.schema.units import show
from fiberbend.sweep.quantities import angle_column, kilopascals, pressure_column

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
    """

    name: str
    label: str
    unit: str
    column: str
    key: str = ""
    goal: float = 0.0

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
        return next((float(value) for value in values if value is not None), None)


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
        label = f"angle at {show(pressure, 'pressure')}"
        goal = 1e3 * pressure
        yield Asked(angle_column(pressure), label, "°", col.ANGLE, col.PRESSURE, goal)
    if angles or output.at_pressures:
        return
    yield Asked("end_angle_deg", "angle at the end", "°", col.ANGLE)
    if load is not None and load.to is None:
        yield Asked("end_pressure_kPa", "pressure at the end", "kPa", col.PRESSURE)
