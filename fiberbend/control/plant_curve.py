"""Curves of uniform bending for what needs them beside a run: control, cross-check, warm start."""

from __future__ import annotations

import numpy as np

from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.effects.pressure import inflate
from fiberbend.models.result import Curve
from fiberbend.running.runner import run_case


def section_curve(case: Case, angle: float) -> Curve:
    """P, θ and V of a case's actuator by the section model, winding smeared; collective.

    Args:
        case: any case.
        angle: bending angle at the end, rad.
    """
    result = run_case(as_section(case, inflate(angle=angle)), None)
    columns = ("pressure_kPa", "angle_deg", "chamber_mm3")
    kpa, degrees, volume = (np.array([row[name] for row in result.rows]) for name in columns)
    return Curve(1e-3 * kpa, np.deg2rad(degrees), volume, result.reason)
