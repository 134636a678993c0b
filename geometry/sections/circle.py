"""Block layout of the circular section."""

from __future__ import annotations

from geometry.actuator import Actuator
from geometry.sections.arcs import (
    Arcs,
    add_fill,
    add_rings,
    levels,
    quarter,
    roof_edge,
)
from geometry.sections.blocks import Layout
from geometry.sections.profiles import FLOOR_HALF_ANGLE
from geometry.sections.size import (
    MeshSize,
    Strips,
    elements_through,
    wall_above_floor,
)


def circle(actuator: Actuator, size: MeshSize, strips: Strips | None) -> Layout:
    """Lay out the side x ≥ 0: rings, a part of them floor.

    With `strips` the post is as wide as the roof: a round body rests on a line.
    """
    layout = Layout(half=True)
    a, r = actuator.profile.half_width, actuator.outline_half_width
    angles, divisions = quarter(size, roof_edge(actuator, strips), FLOOR_HALF_ANGLE)
    upper = Arcs(r, angles, divisions)
    down = tuple(-angle for angle in reversed(angles[1:]))
    arcs = Arcs(r, down + angles, (*reversed(divisions), *divisions))

    def outer(piece: int) -> tuple[str, ...]:
        ends = {0: ("outer", "post"), len(arcs.divisions) - 1: ("outer", "roof")}
        return ends.get(piece, ("outer",)) if strips else ("outer",)

    def outline(piece: int) -> tuple[str, ...]:
        return ("winding", *outer(piece)) if actuator.sheath is None else ("winding",)

    through = elements_through("wall", size)
    above = wall_above_floor(actuator)
    radii = levels(a, r, through)
    if above > 0:
        radii = levels(a, a + above, through)[:-1]
        radii += levels(a + above, r, elements_through("floor", size))

    def region(ring: int, piece: int) -> str:
        is_low = arcs.angles[piece + 1] <= -FLOOR_HALF_ANGLE
        is_deep = above == 0 or ring >= through
        return "floor" if actuator.floor is not None and is_low and is_deep else "wall"

    add_rings(layout, arcs, radii, region, ("chamber",), outline)
    if actuator.sheath is not None:
        radii = levels(r, actuator.outer_half_width, elements_through("sheath", size))
        add_rings(layout, arcs, radii, lambda *_: "sheath", (), outer)
    for mirrored in (False, True):
        add_fill(layout, upper, a, size, mirrored)
    return layout
