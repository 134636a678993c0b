"""Curves of uniform bending for what needs them beside a run: control, cross-check, warm start."""

from __future__ import annotations

import numpy as np

from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section, load
from fiberbend.effects.table import PressureEffect, StraightEffect
from fiberbend.models.result import Curve
from fiberbend.running.runner import run_case


def section_curve(case: Case, pressure: PressureEffect | None = None) -> Curve:
    """P, θ and V of a case's actuator by the section model, winding smeared; collective.

    Args:
        case: any case that lists a pressure.
        pressure: the load; the case's own unless given.

    Raises:
        ValueError: a case without pressure.
    """
    pressure = pressure or case.find(PressureEffect)
    if pressure is None:
        raise ValueError("a case without pressure has no curve of pressure against angle")
    result = run_case(as_section(case, pressure), None)
    columns = ("pressure_kPa", "angle_deg", "chamber_mm3")
    kpa, degrees, volume = (np.array([row[name] for row in result.rows]) for name in columns)
    return Curve(1e-3 * kpa, np.deg2rad(degrees), volume, result.reason)


def blocked_moment(case: Case, pressure: float) -> float:
    """Moment in N mm that holds the case's actuator straight at a pressure in MPa, section model.

    Collective over all ranks.

    Raises:
        RuntimeError: the section does not converge.
    """
    straight = as_section(case, load(to=pressure))
    straight = straight.model_copy(update={"effects": (*straight.effects, StraightEffect())})
    result = run_case(straight, None)
    if result.status != "converged":
        raise RuntimeError(f"the section held straight: {result.reason}")
    return result.last("blocked_moment_Nmm")
