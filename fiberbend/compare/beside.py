"""What a run is compared with is computed here: the section model, and the user's file."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.case.measured import read_measured
from fiberbend.case.section_beside import MODEL, as_section
from fiberbend.compare.check import Check, crosscheck
from fiberbend.compare.others import StraightSection
from fiberbend.effects.pressure import inflate
from fiberbend.effects.straight import straight_of
from fiberbend.models.model import ModelKind
from fiberbend.models.result import Curve, RunResult

LEAST_ANGLE = 1.0
"""Degrees that a run has to bend for a curve of the section model beside it."""
_PARTS = (0.25, 0.5, 0.75)


def check_run(
    case: Case,
    model: ModelKind,
    rows: Sequence[dict[str, Any]],
    solve: Callable[[Case], RunResult] | None = None,
    known: Curve | None = None,
) -> Check:
    """Put a run beside the section model, the closed forms and the measured points; no collective.

    Args:
        case: the case of the run.
        model: its model.
        rows: its history.
        solve: solves a section on this rank alone; without it there is none beside the run.
        known: the section's curve where it was solved already; it is solved again where the run
            goes beyond.
    """
    measured = read_measured(case)
    alike = case.zones is None
    if case.inflation is None or solve is None or model.name == MODEL or not alike:
        return crosscheck(case, model, rows, measured=measured)
    keys = (col.ANGLE, col.UNIFORM_ANGLE)
    furthest = max((row[key] for row in rows for key in keys if row.get(key) is not None), key=abs)
    if case.straight:
        reached = 1e-3 * max((row[col.PRESSURE] for row in rows), key=abs)
        if reached == 0:
            return crosscheck(case, model, rows, measured=measured)
        straight, reason = _straight(case, reached, solve)
        return crosscheck(
            case, model, rows, measured=measured, straight=straight, no_section=reason
        )
    if abs(furthest) < LEAST_ANGLE:
        return crosscheck(case, model, rows, measured=measured)
    curve = known
    if curve is None or not curve.reaches(math.radians(furthest)):
        curve = section_curve(case, math.radians(furthest), solve)
    if len(curve.angle) < 2:
        return crosscheck(case, model, rows, measured=measured, no_section=curve.reason)
    return crosscheck(case, model, rows, curve, measured, no_section=curve.reason)


def section_curve(case: Case, angle: float, solve: Callable[[Case], RunResult]) -> Curve:
    """P, θ and V of a case's actuator by the section model, winding smeared.

    Args:
        case: any case.
        angle: bending angle at the end, rad.
        solve: solves a section.
    """
    result = solve(as_section(case, inflate(angle=angle)))
    columns = (col.PRESSURE, col.ANGLE, col.VOLUME)
    kpa, degrees, volume = (np.array([row[name] for row in result.rows]) for name in columns)
    return Curve(1e-3 * kpa, np.deg2rad(degrees), volume, result.reason)


def _straight(
    case: Case, pressure: float, solve: Callable[[Case], RunResult]
) -> tuple[StraightSection | None, str]:
    """The section kept straight up to a pressure in MPa, and why it ends early."""
    section = as_section(case, inflate(to=pressure))
    output = section.output.model_copy(
        update={"at_pressures": tuple(part * pressure for part in _PARTS)}
    )
    effects = (*section.effects, straight_of(case.effects))
    result = solve(section.model_copy(update={"effects": effects, "output": output}))
    states = [(row[col.PRESSURE], row.get(col.MOMENT)) for row in result.rows]
    known = [(0.0, 0.0), *((1e-3 * p, m) for p, m in states if m is not None and p != 0)]
    if len(known) < 2:
        return None, result.reason
    pressures, moments = np.array(known).T
    order = np.argsort(pressures)
    return StraightSection(pressures[order], moments[order]), result.reason
