"""The rectangle on a flat floor."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from geometry.actuator import Profile, Side
from geometry.sections.blocks import Layout
from geometry.sections.grid import Band, add_grid, base_rows, chamber_columns, flat_inlays
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips, elements_through

_SHORTER = 3
_LONGER = 12
_ROUNDING = 1e-9


@dataclasses.dataclass(frozen=True, kw_only=True)
class RectangleActuator(ShapedActuator):
    """`width` × `height` on the line y = `floor`; all corners are sharp.

    Walls at both sides and on top; the floor reaches from y = 0 to `floor` over the width of
    chamber and walls.

    Attributes:
        width: width of the chamber.
        height: height of the chamber.
        floor: thickness of the floor, b.
        layer: thickness of a separate strain-limiting layer below the floor, h, or None.
    """

    section: ClassVar[str] = "rectangle"

    width: float
    height: float
    floor: float
    layer: float | None = None

    def closed_forms(self) -> Profile:
        """Lengths and areas of the section."""
        width, height, floor = self.width, self.height, self.floor
        layer, sheath = self.layer or 0.0, self.sheath or 0.0
        wide, high = width + 2 * self.wall, layer + floor + height + self.wall
        return Profile(
            half_width=width / 2,
            bottom=floor,
            top=floor + height,
            outline_bottom=-layer,
            chamber_area=width * height,
            chamber_centroid=floor + height / 2,
            outer_centroid=high / 2 - layer,
            inlays=flat_inlays(wide, floor, self.layer),
            outline_area=wide * high,
            outer_area=(wide + 2 * sheath) * (high + 2 * sheath),
            perimeter=2 * (wide + high),
            widest_roof=width / 2,
        )

    def one_material(self) -> frozenset[str]:
        """Wall, floor and layer, where below the chamber they are as thick as above it."""
        below = self.floor + (self.layer or 0.0)
        if abs(below - self.wall) > _ROUNDING * self.wall:
            return frozenset()
        return frozenset({"wall", "floor", *([] if self.layer is None else ["layer"])})

    def outline(self) -> tuple[Side, ...]:
        """Three sides of the half box."""
        w, top, low = self.outline_half_width, self.outline_top, self.outline_bottom
        return (
            Side("top", (0.0, top), (w, top)),
            Side("side", (w, top), (w, low)),
            Side("floor", (w, low), (0.0, low)),
        )

    def layout(self, size: MeshSize, strips: Strips | None) -> Layout:
        """Lay out the side x ≥ 0 as one grid of columns and rows.

        Quads are about square in the chamber, up to 12 n along its longer side.
        """
        layout = Layout(half=True)
        profile = self.profile
        across, up = _divisions(profile.half_width, self.height, size)
        ends = [(profile.half_width, across)]
        if strips is not None:
            x = strips.roof_half_width
            roof = min(max(1, round(across * x / profile.half_width)), across - 1)
            ends = [(x, roof), (profile.half_width, across - roof)]
        columns = chamber_columns(ends, self, size)
        if strips is not None:
            columns[0] = dataclasses.replace(columns[0], top=("roof",))
        rows = [
            Band("wall", self.outline_top, profile.top, elements_through("wall", size)),
            Band("chamber", profile.top, profile.bottom, up),
            *base_rows(self, size),
        ]
        if self.sheath is not None:
            start, end = self.outer_top, self.outline_top
            rows.insert(0, Band("sheath", start, end, elements_through("sheath", size)))
        for parts in ({"wall", "floor", "layer"}, {"sheath"}, {"chamber"}):
            add_grid(layout, columns, rows, strips, parts)
        return layout


def _divisions(half_width: float, height: float, size: MeshSize) -> tuple[int, int]:
    """Numbers of quads across the half chamber and up."""
    shorter = min(half_width, height)
    across, up = (
        size.section * min(round(_SHORTER * side / shorter), _LONGER)
        for side in (half_width, height)
    )
    return across, up
