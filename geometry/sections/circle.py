"""The disk in a ring, with or without a floor."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from typing import ClassVar

from geometry.actuator import Profile, Side
from geometry.sections.arcs import (
    Arcs,
    add_fill,
    add_rings,
    levels,
    quarter,
    roof_edge,
)
from geometry.sections.blocks import Layout
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips, elements_through

FLOOR_HALF_ANGLE = math.pi / 4
"""The floor of a circle reaches this far to each side of its lowest line, in rad."""

_ROUNDING = 1e-9


@dataclasses.dataclass(frozen=True, kw_only=True)
class CircleActuator(ShapedActuator):
    """The disk of radius `radius` about (0, `radius` + `wall`) in a concentric wall.

    The wall touches y = 0. The floor is the outer `floor` of the wall's thickness over the lowest
    quarter of the ring, |angle from −y| ≤ 45°; without it the section is a plain tube.

    Attributes:
        radius: radius of the chamber, a.
        floor: thickness of the floor, b, at most the wall's; None for a plain tube.
    """

    section: ClassVar[str] = "circle"

    radius: float
    floor: float | None = None

    @classmethod
    def contradictions(cls, given: Mapping[str, float | None]) -> Iterator[tuple[str, str]]:
        """A floor thicker than the wall that it is part of."""
        wall, floor = given["wall"], given.get("floor")
        if wall is not None and floor is not None and floor > wall * (1 + _ROUNDING):
            yield "floor", f"{floor:g} mm, expected at most the wall, {wall:g} mm"

    @property
    def alike_around(self) -> bool:
        """A plain tube."""
        return self.floor is None

    @property
    def wall_above_floor(self) -> float:
        """Thickness in mm of the wall between chamber and floor; 0 where the floor is all of it."""
        above = self.wall - self.floor if self.floor is not None else 0.0
        return above if above > _ROUNDING * self.wall else 0.0

    def closed_forms(self) -> Profile:
        """Lengths and areas of the section."""
        a, floor = self.radius, self.floor
        r = a + self.wall
        outer = r + (self.sheath or 0.0)
        inlays = {}
        if floor is not None:
            inlays["floor"] = FLOOR_HALF_ANGLE * (r**2 - (r - floor) ** 2)
        return Profile(
            half_width=a,
            bottom=self.wall,
            top=self.wall + 2 * a,
            outline_bottom=0.0,
            chamber_area=math.pi * a**2,
            chamber_centroid=r,
            outer_centroid=r,
            inlays=inlays,
            outline_area=math.pi * r**2,
            outer_area=math.pi * outer**2,
            perimeter=2 * math.pi * r,
            widest_roof=outer * math.sin(math.pi / 4),
        )

    def one_material(self) -> frozenset[str]:
        """The ring is round: wall and floor."""
        return frozenset({"wall"} if self.floor is None else {"wall", "floor"})

    def outline(self) -> tuple[Side, ...]:
        """Two quarters of the circle."""
        r = self.outline_half_width
        center, side = (0.0, r), (r, r)
        return (
            Side("upper half", (0.0, 2 * r), side, center),
            Side("lower half", side, (0.0, 0.0), center),
        )

    def layout(self, size: MeshSize, strips: Strips | None) -> Layout:
        """Lay out the side x ≥ 0: rings, a part of them floor.

        With `strips` the post is as wide as the roof: a round body rests on a line.
        """
        layout = Layout(half=True)
        a, r = self.radius, self.outline_half_width
        angles, divisions = quarter(size, roof_edge(self, strips), FLOOR_HALF_ANGLE)
        upper = Arcs(r, angles, divisions)
        down = tuple(-angle for angle in reversed(angles[1:]))
        arcs = Arcs(r, down + angles, (*reversed(divisions), *divisions))

        def outer(piece: int) -> tuple[str, ...]:
            ends = {0: ("outer", "post"), len(arcs.divisions) - 1: ("outer", "roof")}
            return ends.get(piece, ("outer",)) if strips else ("outer",)

        def outline(piece: int) -> tuple[str, ...]:
            return ("winding", *outer(piece)) if self.sheath is None else ("winding",)

        through = elements_through("wall", size)
        above = self.wall_above_floor
        radii = levels(a, r, through)
        if above > 0:
            radii = levels(a, a + above, through)[:-1]
            radii += levels(a + above, r, elements_through("floor", size))

        def region(ring: int, piece: int) -> str:
            is_low = arcs.angles[piece + 1] <= -FLOOR_HALF_ANGLE
            is_deep = above == 0 or ring >= through
            return "floor" if self.floor is not None and is_low and is_deep else "wall"

        add_rings(layout, arcs, radii, region, ("chamber",), outline)
        if self.sheath is not None:
            radii = levels(r, self.outer_half_width, elements_through("sheath", size))
            add_rings(layout, arcs, radii, lambda *_: "sheath", (), outer)
        for mirrored in (False, True):
            add_fill(layout, upper, a, size, mirrored)
        return layout
