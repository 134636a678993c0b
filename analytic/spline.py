"""A cubic spline through points, whose third derivative is continuous at the last but one.

As `scipy.interpolate` makes it, whose import takes as long as a third of a section's load steps.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def through(x: Floats, y: Floats, part: Floats) -> tuple[Floats, Floats]:
    """The spline and its derivative within each interval; through three points a parabola.

    Args:
        x: growing, (n,), two at least.
        y: values there, (n,).
        part: places in an interval, from 0 to 1, (m,).

    Returns:
        Values and derivatives, (n - 1, m) both.
    """
    width = np.diff(x)
    chord, h = np.diff(y) / width, width[:, None]
    slopes = _slopes(x, width, chord)
    low, high = slopes[:-1, None], slopes[1:, None]
    # Hermite's cubic y0 + s (h y0' + s (c2 + s c3)) with s the part of the interval
    c2 = h * (3 * chord[:, None] - 2 * low - high)
    c3 = h * (low + high - 2 * chord[:, None])
    value = y[:-1, None] + part * (h * low + part * (c2 + part * c3))
    return value, low + part * (2 * c2 + 3 * part * c3) / h


def _slopes(x: Floats, width: Floats, chord: Floats) -> Floats:
    """Derivatives at the points, (n,)."""
    if len(x) == 2:
        return np.repeat(chord, 2)
    if len(x) == 3:
        bend = (chord[1] - chord[0]) / (x[2] - x[0])
        steps = (-width[0], width[0], width[0] + 2 * width[1])
        return np.array([chord[0] + step * bend for step in steps])
    from scipy.linalg import solve_banded

    bands, right = np.zeros((3, len(x))), np.empty(len(x))
    bands[0, 2:], bands[2, :-2] = width[:-1], width[1:]
    bands[1, 1:-1] = 2 * (width[:-1] + width[1:])
    right[1:-1] = 3 * (width[1:] * chord[:-1] + width[:-1] * chord[1:])
    for end, (a, b), (p, q) in (
        (0, width[:2], chord[:2]),
        (-1, width[:-3:-1], chord[:-3:-1]),
    ):
        bands[1, end], bands[2 * (end != 0), 1 if end == 0 else -2] = b, a + b
        right[end] = ((a + 2 * (a + b)) * b * p + a**2 * q) / (a + b)
    found: Floats = solve_banded((1, 1), bands, right)
    return found
