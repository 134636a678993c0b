"""What flat-bottomed sections share: base of a hemicircle and whole of a rectangle, as a grid."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence

from geometry.actuator import Actuator
from geometry.sections.arcs import levels
from geometry.sections.blocks import Layout
from geometry.sections.size import MeshSize, Strips, elements_through


@dataclasses.dataclass(frozen=True)
class Band:
    """A column or a row of a grid.

    Attributes:
        part: "chamber", "wall" or "sheath", of a row "floor" or "layer" too.
        start: x of its left side, or y of its upper side, in mm.
        end: x of its right side, or y of its lower side, in mm.
        divisions: number of quads across it.
        top: further names of the outermost side above a column.
    """

    part: str
    start: float
    end: float
    divisions: int
    top: tuple[str, ...] = ()


def flat_inlays(width: float, floor: float, layer: float | None) -> dict[str, float]:
    """Areas in mm² of the regions "floor" and "layer" under a flat-bottomed chamber.

    Args:
        width: width of both in mm, over chamber and walls.
        floor: thickness of the floor in mm.
        layer: thickness of the layer in mm, or None.
    """
    areas = {"floor": width * floor}
    if layer is not None:
        areas["layer"] = width * layer
    return areas


def chamber_columns(
    right_ends: Sequence[tuple[float, int]], actuator: Actuator, size: MeshSize
) -> list[Band]:
    """Columns from x = 0 to the outer side: those of the chamber, then wall and sheath.

    Args:
        right_ends: right ends in mm and divisions of the chamber's columns.
        actuator: dimensions.
        size: fineness.
    """
    columns, left = [], 0.0
    for right, number in right_ends:
        columns.append(Band("chamber", left, right, number))
        left = right
    ends = {"wall": actuator.outline_half_width, "sheath": actuator.outer_half_width}
    for part, end in ends.items():
        if end > left:
            through = levels(left, end, elements_through(part, size))
            columns += [Band(part, a, b, 1) for a, b in itertools.pairwise(through)]
        left = end
    return columns


def base_rows(actuator: Actuator, size: MeshSize) -> list[Band]:
    """Rows below a flat-bottomed chamber, from the top down."""
    rows = [Band("floor", actuator.profile.bottom, 0.0, elements_through("floor", size))]
    if actuator.outline_bottom < 0:
        rows.append(Band("layer", 0.0, actuator.outline_bottom, elements_through("layer", size)))
    if actuator.sheath is not None:
        start, end = actuator.outline_bottom, actuator.outer_bottom
        rows.append(Band("sheath", start, end, elements_through("sheath", size)))
    return rows


def _part(column: Band, row: Band) -> str:
    if "sheath" in (column.part, row.part):
        return "sheath"
    if row.part in ("floor", "layer"):
        return row.part
    return "chamber" if column.part == row.part == "chamber" else "wall"


def _side(part: str, neighbour: str | None) -> tuple[str, ...]:
    if neighbour is None:
        return ("outer",) if part == "sheath" else ("winding", "outer")
    if neighbour == "chamber" != part:
        return ("chamber",)
    return ("winding",) if neighbour == "sheath" != part else ()


def add_grid(
    layout: Layout,
    columns: Sequence[Band],
    rows: Sequence[Band],
    strips: Strips | None,
    parts: set[str],
    above: str | None = None,
) -> None:
    """Add the blocks of some parts of a grid on the side x ≥ 0.

    Args:
        layout: the blocks are appended to it.
        columns: from x = 0 to the outer side.
        rows: from the top down to the outer side.
        strips: the outer lower side is the post too.
        parts: which parts to add; "chamber" fills it with the caps' wall.
        above: part of a row above the first one that is not in the grid; None: nothing is there.
    """
    below = ("post",) if strips else ()
    high = rows[0].start
    outside = Band(above, high, high, 0) if above else None
    for j, row in enumerate(rows):
        upper = rows[j - 1] if j > 0 else outside
        lower = rows[j + 1] if j + 1 < len(rows) else None
        for i, column in enumerate(columns):
            part = _part(column, row)
            if part not in parts:
                continue
            right = columns[i + 1] if i + 1 < len(columns) else None
            names: dict[int, tuple[str, ...]] = {1: ("symmetry",)} if i == 0 else {}
            if part != "chamber":
                if i > 0:
                    names[1] = _side(part, _part(columns[i - 1], row))
                names[0] = _side(part, _part(column, lower) if lower else None)
                names[2] = _side(part, _part(right, row) if right else None)
                names[3] = _side(part, _part(column, upper) if upper else None)
                names[0] += below if lower is None else ()
                names[3] += column.top if upper is None else ()
            layout.add(
                "wall" if part == "chamber" else part,
                (
                    (column.start, row.end),
                    (column.end, row.end),
                    (column.start, row.start),
                    (column.end, row.start),
                ),
                (column.divisions, row.divisions),
                {},
                names,
                part == "chamber",
            )
