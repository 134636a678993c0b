"""How many elements and nodes a mesh will have, from its blocks: nothing is meshed for it.

The counts of hexahedra are those of `geometry.bodies.extrude`, whatever the size; those of gmsh's
tetrahedra are an estimate (`geometry.bodies.tetrahedra`). No numpy.
"""

from __future__ import annotations

import dataclasses
import itertools

from geometry.bodies.stations import Stations, body_stations, slice_stations
from geometry.bodies.tetrahedra import Tetrahedra
from geometry.sections.blocks import SIDES, Layout
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips
from geometry.sections.table import section_layout


@dataclasses.dataclass(frozen=True)
class Counts:
    """Numbers of an order-2 mesh.

    Attributes:
        cells: elements.
        nodes: of the displacement, all of the elements' own.
        vertices: corners of elements.
        pressures: of tetrahedra, their vertices by region: one on a face between two counts twice.
    """

    cells: int
    nodes: int
    vertices: int
    pressures: int = 0


def of_layout(layout: Layout) -> Counts:
    """Of a section's 9-node quadrilaterals: corners and sides of blocks are shared."""
    corners = {corner for block in layout.blocks for corner in block.corners}
    sides: dict[tuple[int, ...], int] = {}
    cells = nodes = vertices = 0
    for block in layout.blocks:
        across, up = block.divisions
        cells += across * up
        nodes += (2 * across - 1) * (2 * up - 1)
        vertices += (across - 1) * (up - 1)
        for pair, number in zip(SIDES, (across, up, up, across), strict=True):
            sides[tuple(sorted(block.corners[end] for end in pair))] = number
    return Counts(
        cells,
        nodes + len(corners) + sum(2 * number - 1 for number in sides.values()),
        vertices + len(corners) + sum(number - 1 for number in sides.values()),
    )


def of_extrusion(ring: Counts, full: Counts, stations: Stations) -> Counts:
    """Of the hexahedra of a section extruded along z.

    Args:
        ring: of the section with an open chamber.
        full: of the section with the chamber's blocks.
        stations: segments along z, each with the chamber filled or open.
    """
    segments = stations.segments
    parts = [full if segment.filled else ring for segment in segments]
    # a plane between a filled and an open segment has the nodes of the filled one
    planes = [parts[0], *_larger(parts), parts[-1]]
    inner = list(zip(segments, parts, strict=True))
    return Counts(
        sum(segment.divisions * part.cells for segment, part in inner),
        sum((2 * segment.divisions - 1) * part.nodes for segment, part in inner)
        + sum(plane.nodes for plane in planes),
        sum((segment.divisions - 1) * part.vertices for segment, part in inner)
        + sum(plane.vertices for plane in planes),
    )


def _larger(parts: list[Counts]) -> list[Counts]:
    return [max(pair, key=lambda part: part.nodes) for pair in itertools.pairwise(parts)]


def winding_sides(actuator: ShapedActuator, size: MeshSize) -> int:
    """Sides of the section's quadrilaterals on which the winding lies."""
    ends = ("bottom", "left", "right", "top")
    across = {"bottom": 0, "left": 1, "right": 1, "top": 0}
    return sum(
        block.divisions[across[end]]
        for block in section_layout(actuator, size).blocks
        for end, names in zip(ends, block.names, strict=True)
        if "winding" in names
    )


def body_counts(actuator: ShapedActuator, size: MeshSize, strips: Strips | None = None) -> Counts:
    """Of the whole body in hexahedra, or in about as many tetrahedra as gmsh makes of it."""
    if size.element == "tetrahedron":
        size = size.of_edges()
    layout, stations = section_layout(actuator, size, strips), body_stations(actuator, size, strips)
    if size.element == "tetrahedron":
        mesh = Tetrahedra(layout, stations, size.axial)
        nodes = mesh.vertices + mesh.edges
        return Counts(mesh.cells, nodes, mesh.vertices, mesh.pressures)
    return of_extrusion(of_layout(layout.without_fill()), of_layout(layout), stations)


def slice_counts(actuator: ShapedActuator, size: MeshSize, length: float, number: int) -> Counts:
    """Of a slice between the caps, `length` mm long, in so many layers of hexahedra."""
    ring = of_layout(section_layout(actuator, size).without_fill())
    return of_extrusion(ring, ring, slice_stations(length, number))


def section_counts(actuator: ShapedActuator, size: MeshSize) -> Counts:
    """Of the section's quadrilaterals between the caps."""
    return of_layout(section_layout(actuator, size).without_fill())
