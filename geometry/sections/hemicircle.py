"""The half disk on a flat floor."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from geometry.actuator import Profile, Side
from geometry.sections.arcs import (
    Arcs,
    add_fill,
    add_rings,
    core_columns,
    levels,
    quarter,
    roof_edge,
)
from geometry.sections.blocks import Layout
from geometry.sections.grid import add_grid, base_rows, chamber_columns, flat_inlays
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips, elements_through


@dataclasses.dataclass(frozen=True, kw_only=True)
class HemicircleActuator(ShapedActuator):
    """The half disk of radius `radius` on the line y = `floor`.

    The wall goes around the arc, the floor reaches from y = 0 to `floor` over the width of chamber
    and walls.

    Attributes:
        radius: radius of the chamber, a.
        floor: thickness of the floor, b.
        layer: thickness of a separate strain-limiting layer below the floor, h, or None.
    """

    section: ClassVar[str] = "hemicircle"

    radius: float
    floor: float
    layer: float | None = None

    def closed_forms(self) -> Profile:
        """Lengths and areas of the section."""
        a, floor, layer, sheath = self.radius, self.floor, self.layer or 0.0, self.sheath or 0.0
        r = a + self.wall
        outer, base = r + sheath, floor + layer
        arch, block = math.pi * outer**2 / 2, 2 * outer * (base + sheath)
        arch_moment = arch * (floor + 4 * outer / (3 * math.pi))
        block_moment = block * (floor - layer - sheath) / 2
        return Profile(
            half_width=a,
            bottom=floor,
            top=floor + a,
            outline_bottom=-layer,
            chamber_area=math.pi * a**2 / 2,
            chamber_centroid=floor + 4 * a / (3 * math.pi),
            outer_centroid=(arch_moment + block_moment) / (arch + block),
            inlays=flat_inlays(2 * r, floor, self.layer),
            outline_area=math.pi * r**2 / 2 + 2 * r * base,
            outer_area=arch + block,
            perimeter=math.pi * r + 2 * base + 2 * r,
            widest_roof=outer * math.sin(math.pi / 4),
        )

    def outline(self) -> tuple[Side, ...]:
        """An arch over a box."""
        r, floor, low = self.outline_half_width, self.floor, self.outline_bottom
        return (
            Side("wall", (0.0, self.outline_top), (r, floor), (0.0, floor)),
            Side("side", (r, floor), (r, low)),
            Side("floor", (r, low), (0.0, low)),
        )

    def layout(self, size: MeshSize, strips: Strips | None) -> Layout:
        """Lay out the side x ≥ 0: an arch of rings on a base of columns and rows."""
        layout = Layout(half=True)
        a, n = self.radius, size.section
        arcs = Arcs(self.floor, *quarter(size, roof_edge(self, strips), None))
        under = [*core_columns(a, size, arcs.divisions), (a, n)]
        columns, rows = chamber_columns(under, self, size), base_rows(self, size)

        def outer(piece: int) -> tuple[str, ...]:
            is_roof = strips and piece == len(arcs.divisions) - 1
            return ("outer", "roof") if is_roof else ("outer",)

        def outline(piece: int) -> tuple[str, ...]:
            return ("winding", *outer(piece)) if self.sheath is None else ("winding",)

        r = self.outline_half_width
        radii = levels(a, r, elements_through("wall", size))
        add_rings(layout, arcs, radii, lambda *_: "wall", ("chamber",), outline)
        add_grid(layout, columns, rows, strips, {"floor", "layer"}, above="chamber")
        if self.sheath is not None:
            radii = levels(r, self.outer_half_width, elements_through("sheath", size))
            add_rings(layout, arcs, radii, lambda *_: "sheath", (), outer)
            add_grid(layout, columns, rows, strips, {"sheath"}, above="chamber")
        add_fill(layout, arcs, a, size, down=False)
        return layout
