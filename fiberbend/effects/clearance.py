"""Whether the obstacles of a case leave room for its actuator at rest."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from fiberbend.case import convert
from fiberbend.case.case import Actuator
from fiberbend.effects.table import ContactEffect, Cylinder, Plane
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show

_ROUNDING = 1e-9


def wrong_obstacles(
    actuator: Actuator | None, path: str, contact: ContactEffect
) -> Iterator[Problem]:
    """What is wrong with the obstacles of a case.

    Args:
        actuator: its dimensions, where they are valid.
        path: of the effect in the case.
        contact: the effect.
    """
    if not contact.obstacles:
        yield Problem(path, "nothing to touch, expected roof, post, plane or cylinder")
    plane, bar = contact.plane, contact.cylinder
    if plane is not None and not any(plane.normal):
        yield Problem(f"{path}.plane.normal", "[0, 0, 0], expected a direction")
        plane = None
    if actuator is None:
        return
    rooms = {
        "plane": None if plane is None else _over_plane(actuator, plane),
        "cylinder": None if bar is None else _from_bar(actuator, bar),
    }
    for name, room in rooms.items():
        if room is not None and room < -_ROUNDING:
            yield Problem(
                f"{path}.{name}",
                f"reaches {show(-room, 'length')} into the actuator at rest, expected room for it",
            )


def _box(actuator: Actuator) -> tuple[tuple[float, float], ...]:
    """Ends of the body at rest along x, y and z, mm."""
    size = convert.dimensions(actuator)
    width = size.outer_half_width
    return (
        (-width, width),
        (size.outer_bottom, size.outer_top),
        (-size.cap, size.length + size.cap),
    )


def _over_plane(actuator: Actuator, plane: Plane) -> float:
    """Least distance of the corners of the body's box from a plane, mm; negative behind it."""
    length = math.hypot(*plane.normal)
    return min(
        sum(n * (x - p) for n, x, p in zip(plane.normal, corner, plane.point, strict=True)) / length
        for corner in itertools.product(*_box(actuator))
    )


def _from_bar(actuator: Actuator, bar: Cylinder) -> float:
    """Distance of the body, seen from the side, from a bar, mm; negative inside it."""
    beside = [
        max(low - center, 0.0, center - high)
        for center, (low, high) in zip(bar.center, _box(actuator)[1:], strict=True)
    ]
    return math.hypot(*beside) - bar.radius
