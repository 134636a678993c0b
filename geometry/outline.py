"""The closed line around a section on which the winding lies, by its arc length.

s = 0 at the top (x = 0), first toward +x: arc, side, bottom to (0, −h) at s = S/2, and back by the
mirror image to s = S.
"""

from __future__ import annotations

import numpy as np

from geometry.dimensions import Actuator
from geometry.mesh import Floats


def position(actuator: Actuator, s: Floats) -> Floats:
    """Points of the outline.

    Args:
        actuator: dimensions.
        s: arc length in mm, (n,), any real number (taken modulo S).

    Returns:
        Array (n, 2) of x, y in mm.
    """
    return _frame(actuator, s)[0]


def tangent(actuator: Actuator, s: Floats) -> Floats:
    """Unit tangents (n, 2) of the outline toward growing s; see `position`."""
    return _frame(actuator, s)[1]


def _frame(actuator: Actuator, s: Floats) -> tuple[Floats, Floats]:
    perimeter, r = actuator.winding_perimeter, actuator.outline_radius
    around = np.mod(np.asarray(s, dtype=float), perimeter)
    back = around > perimeter / 2
    half = np.where(back, perimeter - around, around)
    arc = np.pi * r / 2
    side = arc + actuator.floor - actuator.outline_bottom
    angle = half / r
    pieces = [half <= arc, half <= side]
    x = np.select(pieces, [r * np.sin(angle), r], perimeter / 2 - half)
    y = np.select(
        pieces,
        [actuator.floor + r * np.cos(angle), actuator.floor - (half - arc)],
        actuator.outline_bottom,
    )
    dx = np.select(pieces, [np.cos(angle), 0.0], -1.0)
    dy = np.select(pieces, [-np.sin(angle), -1.0], 0.0)
    mirror = np.where(back, -1.0, 1.0)
    return np.stack([mirror * x, y], axis=-1), np.stack([dx, mirror * dy], axis=-1)


def arc_length(actuator: Actuator, points: Floats, negative: np.ndarray) -> Floats:
    """Arc length of points on the outline.

    Args:
        actuator: dimensions.
        points: x, y in mm on the outline, (..., 2).
        negative: True for points that belong to the side x < 0, (...); it decides where x = 0.

    Returns:
        s in mm, (...): in [0, S/2], or in [S/2, S] on the negative side.
    """
    r = actuator.outline_radius
    x, y = np.abs(points[..., 0]), points[..., 1]
    arc = np.pi * r / 2
    side = arc + actuator.floor - actuator.outline_bottom
    on_side = r - x <= y - actuator.outline_bottom
    half = np.select(
        [y >= actuator.floor, on_side],
        [r * np.arctan2(x, y - actuator.floor), arc + actuator.floor - y],
        side + r - x,
    )
    return np.where(negative, actuator.winding_perimeter - half, half)
