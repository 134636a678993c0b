"""Block layout of the hemicircular section."""

from __future__ import annotations

from geometry.actuator import Actuator
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
from geometry.sections.grid import add_grid, base_rows, chamber_columns
from geometry.sections.size import MeshSize, Strips, elements_through


def hemicircle(actuator: Actuator, size: MeshSize, strips: Strips | None) -> Layout:
    """Lay out the side x ≥ 0: an arch of rings on a base of columns and rows."""
    layout = Layout(half=True)
    a, n = actuator.profile.half_width, size.section
    arcs = Arcs(actuator.profile.bottom, *quarter(size, roof_edge(actuator, strips), None))
    under = [*core_columns(a, size, arcs.divisions), (a, n)]
    columns, rows = chamber_columns(under, actuator, size), base_rows(actuator, size)

    def outer(piece: int) -> tuple[str, ...]:
        is_roof = strips and piece == len(arcs.divisions) - 1
        return ("outer", "roof") if is_roof else ("outer",)

    def outline(piece: int) -> tuple[str, ...]:
        return ("winding", *outer(piece)) if actuator.sheath is None else ("winding",)

    r = actuator.outline_half_width
    radii = levels(a, r, elements_through("wall", size))
    add_rings(layout, arcs, radii, lambda *_: "wall", ("chamber",), outline)
    add_grid(layout, columns, rows, strips, {"floor", "layer"}, above="chamber")
    if actuator.sheath is not None:
        radii = levels(r, actuator.outer_half_width, elements_through("sheath", size))
        add_rings(layout, arcs, radii, lambda *_: "sheath", (), outer)
        add_grid(layout, columns, rows, strips, {"sheath"}, above="chamber")
    add_fill(layout, arcs, a, size, down=False)
    return layout
