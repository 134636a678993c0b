"""How far the elements of a section move the pressure for an angle, as measured.

On the baseline with its hemicircle, and on the shipped cases of the other sections, at angles from
2 to 360° and against elements eight times as fine (docs/evidence/uniform.md). Sharp corners cost
most, and most where the angle is small or a flat wall bulges; the moment of an actuator that is
kept straight is off by no more.
"""

from __future__ import annotations

from collections.abc import Mapping

from fiberbend.case.case import Case

_SECTION = {
    "hemicircle": (0.8, 0.25, 0.1, 0.05),
    "rectangle": (3.1, 0.6, 0.3, 0.17),
    "circle": (0.09, 0.03, 0.01, 0.01),
}
"""Percent of P with 1, 2, 3, 4 and more elements through each thickness."""
_CELL = {"hemicircle": (0.3, 0.2), "rectangle": (2.6, 0.6), "circle": (0.1, 0.1)}
"""The same of a cell with four layers a half pitch and more, 1, 2 and more elements."""


def section_error(case: Case) -> float:
    """Percent of P by which the elements of a section are off; of an unknown shape the worst."""
    return _of(_SECTION, case)


def cell_section_error(case: Case) -> float:
    """The same of the elements across a cell."""
    return _of(_CELL, case)


def _of(measured: Mapping[str, tuple[float, ...]], case: Case) -> float:
    rows = measured.get(case.actuator.section)
    number = min(case.mesh.section, len(next(iter(measured.values())))) - 1
    return max(row[number] for row in ([rows] if rows is not None else measured.values()))
