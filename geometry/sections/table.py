"""The section shapes as blocks; a new shape is a line in `LAYOUTS`."""

from __future__ import annotations

from collections.abc import Callable

from geometry.actuator import Actuator
from geometry.sections.blocks import Layout
from geometry.sections.circle import circle
from geometry.sections.hemicircle import hemicircle
from geometry.sections.rectangle import rectangle
from geometry.sections.size import MeshSize, Strips, check_size

LAYOUTS: dict[str, Callable[[Actuator, MeshSize, Strips | None], Layout]] = {
    "hemicircle": hemicircle,
    "rectangle": rectangle,
    "circle": circle,
}
"""The side x ≥ 0 of each section shape."""


def section_layout(actuator: Actuator, size: MeshSize, strips: Strips | None = None) -> Layout:
    """Lay out a section, with the blocks that fill the chamber in the caps.

    The point "pin" is (0, 0), on the lowest line of wall and floor, "crown" the highest point of
    the winding. Regions are "wall", "floor",
    "layer", "sheath"; named sides "chamber", "winding", "outer", "symmetry" (half only), and with
    `strips` "roof" and "post". Every surface inside the body is listed once, from the region that
    comes first.

    Raises:
        ValueError: dimensions that this mesh cannot hold.
    """
    check_size(actuator, size, strips)
    layout = LAYOUTS[actuator.section](actuator, size, strips)
    layout.name_point("pin", (0.0, 0.0))
    layout.name_point("crown", (0.0, actuator.outline_top))
    return layout if size.half else layout.mirrored()
