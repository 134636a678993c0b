"""Block layout of the rectangular section."""

from __future__ import annotations

import dataclasses

from geometry.actuator import Actuator
from geometry.sections.blocks import Layout
from geometry.sections.grid import (
    Band,
    add_grid,
    base_rows,
    chamber_columns,
)
from geometry.sections.size import MeshSize, Strips, elements_through

_SHORTER = 3
_LONGER = 12


def rectangle(actuator: Actuator, size: MeshSize, strips: Strips | None) -> Layout:
    """Lay out the side x ≥ 0 as one grid of columns and rows.

    Quads are about square in the chamber, up to 12 n along its longer side.
    """
    layout = Layout(half=True)
    profile = actuator.profile
    across, up = _divisions(profile.half_width, profile.top - profile.bottom, size)
    ends = [(profile.half_width, across)]
    if strips is not None:
        x = strips.roof_half_width
        roof = min(max(1, round(across * x / profile.half_width)), across - 1)
        ends = [(x, roof), (profile.half_width, across - roof)]
    columns = chamber_columns(ends, actuator, size)
    if strips is not None:
        columns[0] = dataclasses.replace(columns[0], top=("roof",))
    rows = [
        Band("wall", actuator.outline_top, profile.top, elements_through("wall", size)),
        Band("chamber", profile.top, profile.bottom, up),
        *base_rows(actuator, size),
    ]
    if actuator.sheath is not None:
        start, end = actuator.outer_top, actuator.outline_top
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
