"""Whether obstacles leave room for an actuator at rest."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

from fiberbend.effects.obstacles import CylinderSpec, PlaneSpec

if TYPE_CHECKING:
    from geometry.actuator import Actuator


def _box(actuator: Actuator) -> tuple[tuple[float, float], ...]:
    """Ends of the body at rest along x, y and z, mm."""
    width = actuator.outer_half_width
    return (
        (-width, width),
        (actuator.outer_bottom, actuator.outer_top),
        (-actuator.cap, actuator.length + actuator.cap),
    )


def over_plane(actuator: Actuator, plane: PlaneSpec) -> float:
    """Least distance of the corners of the body's box from a plane, mm; negative behind it."""
    length = math.hypot(*plane.normal)
    return min(
        sum(n * (x - p) for n, x, p in zip(plane.normal, corner, plane.point, strict=True)) / length
        for corner in itertools.product(*_box(actuator))
    )


def from_bar(actuator: Actuator, bar: CylinderSpec) -> float:
    """Distance of the body, seen from the side, from a bar, mm; negative inside it."""
    beside = [
        max(low - center, 0.0, center - high)
        for center, (low, high) in zip(bar.center, _box(actuator)[1:], strict=True)
    ]
    return math.hypot(*beside) - bar.radius
