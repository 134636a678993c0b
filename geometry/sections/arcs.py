"""Blocks between concentric arcs, and inside one: what hemicircle and circle share."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Sequence

from geometry.actuator import Actuator
from geometry.sections.blocks import Layout, Point
from geometry.sections.size import MeshSize, Strips

_CORE = 2 / 3
_CORE_CORNER = 0.72


@dataclasses.dataclass(frozen=True)
class Arcs:
    """Pieces of an arc about a point of x = 0, counterclockwise on the side x ≥ 0.

    Attributes:
        center: y of the centre in mm.
        angles: polar angles between the pieces, increasing, within ±π/2.
        divisions: number of quads along each piece.
    """

    center: float
    angles: tuple[float, ...]
    divisions: tuple[int, ...]

    def point(self, radius: float, angle: float) -> Point:
        """Point at a radius in mm and a polar angle, exactly on x = 0 at ±π/2."""
        if abs(angle) == math.pi / 2:
            return (0.0, self.center + math.copysign(radius, angle))
        return (radius * math.cos(angle), self.center + radius * math.sin(angle))


def quarter(
    size: MeshSize, roof_edge: float | None, middle: float | None
) -> tuple[tuple[float, ...], tuple[int, ...]]:
    """Angles and divisions of the pieces of an upper quarter arc, from the side to the top.

    Args:
        size: fineness.
        roof_edge: polar angle where a roof begins, in rad, or None.
        middle: angle of the fill's corner in rad; None spaces the elements evenly.
    """
    n = size.section
    if roof_edge is None:
        return (0.0, math.pi / 4, math.pi / 2), (2 * n, 2 * n)
    roof = min(max(1, round(4 * n * (1 - roof_edge / (math.pi / 2)))), 2 * n - 1)
    between = 2 * n - roof
    corner = roof_edge * 2 * n / (2 * n + between) if middle is None else middle
    return (0.0, corner, roof_edge, math.pi / 2), (2 * n, between, roof)


def roof_edge(actuator: Actuator, strips: Strips | None) -> float | None:
    """Polar angle in rad where the roof begins on a round top; None without strips."""
    return math.acos(strips.roof_half_width / actuator.outer_half_width) if strips else None


def levels(start: float, end: float, number: int) -> list[float]:
    """Evenly spaced values, both ends exact.

    Args:
        start: first value.
        end: last value.
        number: number of intervals.
    """
    return [start + (end - start) * i / number for i in range(number)] + [end]


def add_rings(
    layout: Layout,
    arcs: Arcs,
    radii: Sequence[float],
    region: Callable[[int, int], str | None],
    inside: tuple[str, ...],
    outside: Callable[[int], tuple[str, ...]],
) -> None:
    """Add rings of blocks, one quad each across, so that every mesh line around is an exact arc.

    Args:
        layout: the blocks are appended to it.
        arcs: pieces around.
        radii: radii between the rings in mm, increasing.
        region: region of the block of a ring and a piece; None leaves it out.
        inside: names of the innermost sides.
        outside: names of the outermost side of a piece.
    """
    center = (0.0, arcs.center)
    for i, (inner, outer) in enumerate(itertools.pairwise(radii)):
        for j, number in enumerate(arcs.divisions):
            name = region(i, j)
            if name is None:
                continue
            low, high = arcs.angles[j], arcs.angles[j + 1]
            names = {
                0: ("symmetry",) if low == -math.pi / 2 else (),
                1: inside if i == 0 else (),
                2: outside(j) if i == len(radii) - 2 else (),
                3: ("symmetry",) if high == math.pi / 2 else (),
            }
            layout.add(
                name,
                (
                    arcs.point(inner, low),
                    arcs.point(outer, low),
                    arcs.point(inner, high),
                    arcs.point(outer, high),
                ),
                (1, number),
                {1: center, 2: center},
                names,
            )


def core_columns(
    radius: float, size: MeshSize, divisions: Sequence[int]
) -> list[tuple[float, int]]:
    """Right ends in mm and divisions of the columns of a disk's core, from x = 0.

    Args:
        radius: of the disk, mm.
        size: fineness.
        divisions: number of quads along each piece of the upper quarter arc.
    """
    columns, done = [], 0
    for number in reversed(divisions[1:]):
        done += number
        columns.append((_CORE * radius * done / (2 * size.section), number))
    return columns


def add_fill(layout: Layout, arcs: Arcs, radius: float, size: MeshSize, down: bool) -> None:
    """Add the O-grid of a quarter disk: a core, one block right of it, the rest above.

    Args:
        layout: the blocks are appended to it; they belong to the caps' wall.
        arcs: pieces of the upper quarter.
        radius: of the disk in mm.
        size: fineness.
        down: add the image in the horizontal line through the centre instead.
    """
    b, angles, pieces = arcs.center, arcs.angles, arcs.divisions
    corner = arcs.point(_CORE_CORNER * radius, angles[1])
    width, crown = _CORE * radius, b + _CORE * radius

    def add(
        corners: tuple[Point, Point, Point, Point],
        divisions: tuple[int, int],
        arc: int | None,
        at_mirror: bool,
    ) -> None:
        centers = {} if arc is None else {arc: (0.0, b)}
        if down:
            left, right, above_left, above_right = ((x, 2 * b - y) for x, y in corners)
            corners = (above_left, above_right, left, right)
            centers = {3 - side if side in (0, 3) else side: c for side, c in centers.items()}
        layout.add(
            "wall", corners, divisions, centers, {1: ("symmetry",)} if at_mirror else {}, True
        )

    floor: Point = (0.0, b)
    lid: Point = (0.0, crown)
    for column, (x, number) in enumerate(core_columns(radius, size, pieces)):
        part = x / width
        next_floor = (x, b)
        next_lid = (part * corner[0], (1 - part) * crown + part * corner[1])
        high, low = angles[len(angles) - 1 - column], angles[len(angles) - 2 - column]
        add((floor, next_floor, lid, next_lid), (number, pieces[0]), None, column == 0)
        ends = arcs.point(radius, high), arcs.point(radius, low)
        add((lid, next_lid, *ends), (number, size.section), 3, column == 0)
        floor, lid = next_floor, next_lid
    ends = (radius, b), arcs.point(radius, angles[1])
    add(((width, b), ends[0], corner, ends[1]), (size.section, pieces[0]), 2, False)
