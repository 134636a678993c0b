"""Rubber that bulges between the fibers, which no smeared winding sees: measured, and scaled.

docs/crosscheck.md has the numbers behind the rules.
"""

from __future__ import annotations

import numpy as np

from fiberbend.case.case import Case
from fiberbend.effects.table import WindingEffect

BULGING_PITCH = 3.0
"""Pitch in mm for which the bulging between the fibers was measured."""
_BULGING = ((90.0, 3.5), (180.0, 4.1), (270.0, 4.7), (360.0, 5.1))
"""Angle in degrees, and percent of pressure that every fiber by itself takes beyond a smeared
winding: the cell against the section model, baseline."""
_BULGING_EXPONENT = 1.3
_RESOLVED = ((0.5, 1.0), (2 / 3, 0.85), (4 / 3, 0.2))
"""Length of a body's elements over the pitch, and the part of the bulging that they give."""


def bulging(pitch: float, angle_deg: float) -> float:
    """Percent of pressure that rubber bulging between the fibers takes, scaled by the pitch.

    Args:
        pitch: pitch of the double helix, mm.
        angle_deg: bending angle, degrees.
    """
    angles, percent = zip(*_BULGING, strict=True)
    scale = (pitch / BULGING_PITCH) ** _BULGING_EXPONENT
    return scale * float(np.interp(abs(angle_deg), angles, percent))


def resolved(case: Case, model: str) -> float:
    """Part of the bulging between the fibers that a model gives: 1 resolved, 0 smeared."""
    winding = case.find(WindingEffect)
    if winding is None or winding.representation == "smeared" or model not in ("cell", "body"):
        return 0.0
    if model == "cell":
        return 1.0
    sizes, parts = zip(*_RESOLVED, strict=True)
    return float(np.interp(case.mesh.axial / winding.pitch, sizes, parts, right=0.0))
