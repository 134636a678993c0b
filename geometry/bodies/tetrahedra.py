"""About how many tetrahedra, edges and vertices gmsh makes of a body; nothing is meshed for it.

gmsh divides every curve of the blocks into edges not longer than the size that is asked for, then
meshes faces, then blocks. A block that is long along z and has hardly a vertex inside is a stack of
prisms: with c lines of vertices around it each of N layers has c − 2 triangles, three tetrahedra
over each. Faces have rows of vertices inside, and so c hangs on the widths of walls as much as on
the size: long tetrahedra in a thin wall are more than the hexahedra there would split into.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections import Counter, defaultdict
from typing import NamedTuple

from geometry.bodies.stations import Segment, Stations
from geometry.sections.blocks import SIDES, Block, Layout, Point
from geometry.sections.size import divisions

NARROW = 0.4
"""Width of a face of one edge across, over its edges along, below which no vertex lies inside."""
_ROW = math.sqrt(3) / 2
"""Distance of rows of vertices over the length of edges, of triangles with equal sides."""
_AROUND = 4
"""Lines of vertices along the corners of a block."""
_TO_PRISM = 3
_TO_END, _TO_INNER = 2, 6
"""Tetrahedra for a vertex of an end face beside its corners, and for one inside the block."""
_LINES = 0.5
"""Lines of vertices inside, over the product of the widths, in edges, less one each: measured."""


class Line(NamedTuple):
    """A curve: its length in mm and the number of its edges."""

    length: float
    edges: float


class Face(NamedTuple):
    """A face of a block by its mean curves along both directions.

    Attributes:
        u: of two opposite curves.
        v: of the two others.
    """

    u: Line
    v: Line

    def inside(self) -> float:
        """Vertices beside those of its curves."""
        across, along = sorted((self.u, self.v))
        step = along.length / along.edges
        if across.edges == 1:
            return along.edges if across.length >= NARROW * step else 0.0
        return along.edges * max(across.edges - 1, across.length / (_ROW * step) - 1)

    def triangles(self) -> float:
        """By Euler's formula, of a disk."""
        return 2 * self.inside() + 2 * (self.u.edges + self.v.edges) - 2


@dataclasses.dataclass
class _Parts:
    """Corners, curves and faces of blocks, each once, and vertices inside the blocks."""

    points: set[tuple[int, int]] = dataclasses.field(default_factory=set)
    curves: dict[tuple[int, ...], Line] = dataclasses.field(default_factory=dict)
    faces: dict[tuple[int, ...], Face] = dataclasses.field(default_factory=dict)
    inner: float = 0.0

    def add(self, other: _Parts) -> None:
        """Take another's too."""
        self.points |= other.points
        self.curves |= other.curves
        self.faces |= other.faces
        self.inner += other.inner

    def vertices(self) -> float:
        """All of them."""
        on_curves = len(self.points) + sum(line.edges - 1 for line in self.curves.values())
        return on_curves + sum(face.inside() for face in self.faces.values()) + self.inner


class Tetrahedra:
    """Numbers of a mesh of order 1.

    Args:
        layout: of the section, its blocks as coarse as they may be.
        stations: segments along z.
        size: length of edges in mm.

    Attributes:
        vertices: corners of tetrahedra.
        edges: their edges.
        cells: tetrahedra.
        pressures: vertices by region: one on a face between two regions counts twice.
    """

    def __init__(self, layout: Layout, stations: Stations, size: float) -> None:
        self._layout, self._size = layout, size
        faces: Counter[tuple[int, ...]] = Counter()
        whole = _Parts()
        regions: defaultdict[str, _Parts] = defaultdict(_Parts)
        cells = 0.0
        for (i, segment), (number, block) in itertools.product(
            enumerate(stations.segments), enumerate(layout.blocks)
        ):
            if block.fill and not segment.filled:
                continue
            sides, axial = self._sides(block), self._axial(segment)
            end, lateral = _end(sides), [Face(side, axial) for side in sides]
            lines = self._lines(end)
            around = _AROUND + sum(face.inside() for face in lateral) / axial.edges
            ends = 2 * (end.inside() + sum(side.edges - 1 for side in sides))
            cells += _TO_PRISM * axial.edges * (around - 2) + _TO_END * ends
            cells += _TO_INNER * lines * axial.edges
            pairs = [tuple(sorted(block.corners[j] for j in pair)) for pair in SIDES]
            part = _Parts(inner=lines * axial.edges)
            part.faces |= {(number, i + j): end for j in range(2)}
            part.faces |= {(*pair, i): face for pair, face in zip(pairs, lateral, strict=True)}
            faces.update(part.faces.keys())
            for j in range(2):
                part.points |= {(corner, i + j) for corner in block.corners}
                part.curves |= {
                    (*pair, i + j): side for pair, side in zip(pairs, sides, strict=True)
                }
            part.curves |= {(corner, i): axial for corner in block.corners}
            whole.add(part)
            regions[block.region].add(part)
        vertices = whole.vertices()
        # V − E + F − T is 1 or so, and 2 F − 4 T the number of triangles on the boundary
        outer = sum(whole.faces[key].triangles() for key, uses in faces.items() if uses == 1)
        self.vertices, self.cells = round(vertices), round(cells)
        self.edges = round(vertices + cells + outer / 2)
        self.pressures = round(sum(part.vertices() for part in regions.values()))

    def _lines(self, end: Face) -> float:
        """Lines of vertices inside a block."""
        wide = (max(0.0, line.length / self._size - 1) for line in end)
        return _LINES * math.prod(wide)

    def _axial(self, segment: Segment) -> Line:
        return self._line(segment.end - segment.start)

    def _sides(self, block: Block) -> list[Line]:
        """Its curves in the section, as `SIDES` has them."""
        place = [self._layout.points[corner] for corner in block.corners]
        return [
            self._line(_length(place[i], place[j], center))
            for (i, j), center in zip(SIDES, block.centers, strict=True)
        ]

    def _line(self, length: float) -> Line:
        return Line(length, divisions(length, self._size))


def _end(sides: list[Line]) -> Face:
    """The face in the section: sides v = 0 and v = 1, then u = 0 and u = 1."""
    (a, b, c, d) = sides
    return Face(_mean(a, d), _mean(b, c))


def _mean(one: Line, other: Line) -> Line:
    return Line((one.length + other.length) / 2, (one.edges + other.edges) / 2)


def _length(start: Point, end: Point, center: Point | None) -> float:
    """Of a straight line, or of an arc of less than half a turn."""
    chord = math.dist(start, end)
    if center is None:
        return chord
    radius = math.dist(start, center)
    return 2 * radius * math.asin(min(1.0, chord / (2 * radius)))
