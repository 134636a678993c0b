"""Closed forms of the section shapes. A new shape adds a function here, a layout and an outline.

y = 0 is the lowest line of wall and floor together; a separate layer and the sheath lie below it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from geometry.actuator import Actuator

NEEDED: dict[str, tuple[str, ...]] = {
    "hemicircle": ("radius", "floor"),
    "rectangle": ("width", "height", "floor"),
    "circle": ("radius",),
}
"""Dimensions that a section must have, beside those that all have."""
OPTIONAL: dict[str, tuple[str, ...]] = {
    "hemicircle": ("layer",),
    "rectangle": ("layer",),
    "circle": ("floor",),
}
"""Dimensions that a section may have."""

_ROUNDING = 1e-9

FLOOR_HALF_ANGLE = math.pi / 4
"""The floor of a circle reaches this far to each side of its lowest line, in rad."""


@dataclasses.dataclass(frozen=True)
class Profile:
    """Lengths in mm and areas in mm² of a section.

    Attributes:
        half_width: half of the chamber's greatest width.
        bottom: y of the chamber's lowest line.
        top: y of its highest line.
        chamber_area: area of the chamber.
        chamber_centroid: y of the chamber's centroid.
        outer_centroid: y of the centroid of the area inside the outer surface.
        floor_area: area of the region "floor".
        layer_area: area of the region "layer".
        outline_area: area inside the winding's outline.
        outer_area: area inside the outer surface.
        perimeter: perimeter of the winding's outline.
        outer_perimeter: perimeter of the outer surface.
        widest_roof: half widths of a roof on the top of the section lie below this.
    """

    half_width: float
    bottom: float
    top: float
    chamber_area: float
    chamber_centroid: float
    outer_centroid: float
    floor_area: float
    layer_area: float
    outline_area: float
    outer_area: float
    perimeter: float
    outer_perimeter: float
    widest_roof: float


def _hemicircle(actuator: Actuator) -> Profile:
    a, floor, layer, sheath = _lengths(actuator, "radius", "floor", "layer", "sheath")
    r = a + actuator.wall
    outer, base = r + sheath, floor + layer
    arch, block = math.pi * outer**2 / 2, 2 * outer * (base + sheath)
    arch_moment = arch * (floor + 4 * outer / (3 * math.pi))
    block_moment = block * (floor - layer - sheath) / 2
    return Profile(
        half_width=a,
        bottom=floor,
        top=floor + a,
        chamber_area=math.pi * a**2 / 2,
        chamber_centroid=floor + 4 * a / (3 * math.pi),
        outer_centroid=(arch_moment + block_moment) / (arch + block),
        floor_area=2 * r * floor,
        layer_area=2 * r * layer,
        outline_area=math.pi * r**2 / 2 + 2 * r * base,
        outer_area=arch + block,
        perimeter=math.pi * r + 2 * base + 2 * r,
        outer_perimeter=math.pi * outer + 2 * (base + sheath) + 2 * outer,
        widest_roof=outer * math.sin(math.pi / 4),
    )


def _rectangle(actuator: Actuator) -> Profile:
    width, height, floor = _lengths(actuator, "width", "height", "floor")
    layer, sheath = _lengths(actuator, "layer", "sheath")
    wide, high = width + 2 * actuator.wall, layer + floor + height + actuator.wall
    return Profile(
        half_width=width / 2,
        bottom=floor,
        top=floor + height,
        chamber_area=width * height,
        chamber_centroid=floor + height / 2,
        outer_centroid=high / 2 - layer,
        floor_area=wide * floor,
        layer_area=wide * layer,
        outline_area=wide * high,
        outer_area=(wide + 2 * sheath) * (high + 2 * sheath),
        perimeter=2 * (wide + high),
        outer_perimeter=2 * (wide + high + 4 * sheath),
        widest_roof=width / 2,
    )


def _circle(actuator: Actuator) -> Profile:
    a, floor, sheath = _lengths(actuator, "radius", "floor", "sheath")
    r = a + actuator.wall
    outer = r + sheath
    return Profile(
        half_width=a,
        bottom=actuator.wall,
        top=actuator.wall + 2 * a,
        chamber_area=math.pi * a**2,
        chamber_centroid=r,
        outer_centroid=r,
        floor_area=FLOOR_HALF_ANGLE * (r**2 - (r - floor) ** 2),
        layer_area=0.0,
        outline_area=math.pi * r**2,
        outer_area=math.pi * outer**2,
        perimeter=2 * math.pi * r,
        outer_perimeter=2 * math.pi * outer,
        widest_roof=outer * math.sin(math.pi / 4),
    )


def _lengths(actuator: Actuator, *names: str) -> tuple[float, ...]:
    return tuple(getattr(actuator, name) or 0.0 for name in names)


PROFILES: dict[str, Callable[[Actuator], Profile]] = {
    "hemicircle": _hemicircle,
    "rectangle": _rectangle,
    "circle": _circle,
}


def misfits(given: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """What does not go together in dimensions that are valid one by one.

    Args:
        given: the dimensions of an actuator by name; None where one is absent.

    Yields:
        Name of a dimension and what is wrong with it.
    """
    section = str(given["section"])
    needed, optional = NEEDED[section], OPTIONAL[section]
    for name in dict.fromkeys(n for names in (*NEEDED.values(), *OPTIONAL.values()) for n in names):
        value = given[name]
        if value is None and name in needed:
            yield name, f"missing, expected the {name} of a {section}"
        if value is not None and name not in (*needed, *optional):
            yield name, f"no effect on a {section}, expected no value"
    wall, floor = given["wall"], given["floor"]
    if section == "circle" and floor is not None and floor > wall * (1 + _ROUNDING):
        yield "floor", f"{floor:g} mm, expected at most the wall, {wall:g} mm"
