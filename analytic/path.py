"""Where the tip of a uniformly bent actuator is. mm, rad."""

from __future__ import annotations

import math

import numpy as np

from analytic.stress import Floats


def tip(
    angle: Floats | float, length: Floats | float, cap: float = 0.0, height: float = 0.0
) -> Floats:
    """Tip of a constant-curvature arc that starts along z at the origin, with a straight cap.

    Args:
        angle: bending angles θ, rad, positive toward −y.
        length: arc lengths L, mm; broadcast with `angle`, so that `tip(θ s, L s)` with s from 0 to
            1 is the whole arc.
        cap: length of a straight end that goes on along the tangent, mm.
        height: height of the tracked point above the arc in the section's own frame, mm.

    Returns:
        Points (z, −y), (..., 2), mm.

    Raises:
        ValueError: a length or a cap that is negative or not finite.
    """
    angle, length = np.asarray(angle, dtype=float), np.asarray(length, dtype=float)
    if not np.all((length >= 0) & (length < math.inf)):
        raise ValueError(f"length: zero or positive mm expected, not {length}")
    if not 0 <= cap < math.inf:
        raise ValueError(f"cap: zero or positive mm expected, not {cap}")
    # the chord is L sin(θ/2)/(θ/2) long at half the angle; sinc needs no limit at θ = 0
    chord = length * np.sinc(angle / (2 * math.pi))
    cos, sin = np.cos(angle), np.sin(angle)
    along = chord * np.cos(angle / 2) + cap * cos + height * sin
    down = chord * np.sin(angle / 2) + cap * sin - height * cos
    return np.stack(np.broadcast_arrays(along, down), axis=-1)
