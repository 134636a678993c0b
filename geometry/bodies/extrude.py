"""Sections extruded along z into order-2 hexahedra."""

from __future__ import annotations

import numpy as np

from geometry.bodies.quads import section_mesh
from geometry.bodies.stations import Stations, body_stations, slice_stations
from geometry.mesh.data import Ints, MeshData
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips
from geometry.sections.table import section_layout

_BOTTOM, _TOP = 0, 5


def extrude(section: MeshData, stations: Stations, fill: Ints | None = None) -> MeshData:
    """Extrude a section of quadrilaterals along z.

    Args:
        section: two-dimensional mesh.
        stations: segments along z and the names of surfaces.
        fill: numbers of the quadrilaterals that are present in filled segments only.

    Returns:
        Mesh of 27-node hexahedra, its cells sorted along z.
    """
    quads, nodes = len(section.cells), len(section.nodes)
    is_fill = np.zeros(quads, dtype=bool)
    if fill is not None:
        is_fill[fill] = True
    levels = [np.array([stations.segments[0].start])]
    layer_segment: list[int] = []
    for i, segment in enumerate(stations.segments):
        levels.append(np.linspace(segment.start, segment.end, 2 * segment.divisions + 1)[1:])
        layer_segment += [i] * segment.divisions
    z = np.concatenate(levels)
    filled = np.array([stations.segments[i].filled for i in layer_segment])
    present = filled[:, None] | ~is_fill[None, :]
    number = np.where(present, np.cumsum(present).reshape(present.shape) - 1, -1)

    planes = 2 * np.arange(len(layer_segment))[:, None, None, None] + np.arange(3)[:, None]
    cells = (planes * nodes + section.cells[None, :, None, :]).reshape(-1, quads, 27)[present]
    used, cells = np.unique(cells, return_inverse=True)
    points = np.column_stack([section.nodes[used % nodes], z[used // nodes]])

    facets: dict[str, list[Ints]] = {}
    _name_sides(section, stations, np.array(layer_segment), number, facets)
    _name_planes(stations, is_fill, number, facets)
    first = 2 * sum(segment.divisions for segment in stations.segments[: stations.origin]) * nodes
    return MeshData(
        cell_type="hexahedron",
        nodes=points,
        cells=cells.reshape(-1, 27),
        regions=dict(section.regions),
        cell_region=np.broadcast_to(section.cell_region, present.shape)[present],
        facets={name: np.concatenate(pairs) for name, pairs in facets.items()},
        half=section.half,
        points={n: int(np.searchsorted(used, first + i)) for n, i in section.points.items()},
    )


def _name_sides(
    section: MeshData,
    stations: Stations,
    layer_segment: Ints,
    number: Ints,
    facets: dict[str, list[Ints]],
) -> None:
    for name, pairs in section.facets.items():
        for i, segment in enumerate(stations.segments):
            if name not in segment.names:
                continue
            cells = number[layer_segment == i][:, pairs[:, 0]]
            local = np.broadcast_to(pairs[:, 1] + 1, cells.shape)
            there = cells >= 0
            facets.setdefault(name, []).append(np.column_stack([cells[there], local[there]]))


def _name_planes(
    stations: Stations, is_fill: np.ndarray, number: Ints, facets: dict[str, list[Ints]]
) -> None:
    layer = 0
    for i, names in enumerate(stations.planes):
        for name, quads in zip(names, (~is_fill, is_fill), strict=True):
            if name is None or not quads.any():
                continue
            below = number[layer - 1, quads] if i > 0 else np.full(quads.sum(), -1)
            above = number[layer, quads] if i < len(stations.segments) else np.full_like(below, -1)
            cells = np.where(below >= 0, below, above)
            local = np.where(below >= 0, _TOP, _BOTTOM)
            facets.setdefault(name, []).append(np.column_stack([cells, local]))
        if i < len(stations.segments):
            layer += stations.segments[i].divisions


def section_quadrilaterals(actuator: ShapedActuator, size: MeshSize) -> MeshData:
    """Two-dimensional mesh of an actuator's section between its caps.

    Raises:
        ValueError: dimensions that this mesh cannot resolve.
    """
    return section_mesh(section_layout(actuator, size).without_fill())


def hexahedral_slice(
    actuator: ShapedActuator, size: MeshSize, length: float, number: int
) -> MeshData:
    """Hexahedra of a slice between the caps, 0 ≤ z ≤ `length`.

    Args:
        actuator: dimensions.
        size: fineness of the section.
        length: length of the slice, mm.
        number: layers of elements.

    Raises:
        ValueError: dimensions that this mesh cannot resolve.
    """
    return extrude(section_quadrilaterals(actuator, size), slice_stations(length, number))


def hexahedral_body(
    actuator: ShapedActuator, size: MeshSize, strips: Strips | None = None
) -> MeshData:
    """Hexahedra of the whole body, from the block map alone.

    Args:
        actuator: dimensions.
        size: fineness.
        strips: strips of roof and post, which become named surfaces.

    Raises:
        ValueError: dimensions that this mesh cannot resolve.
    """
    layout = section_layout(actuator, size, strips)
    counts = [block.divisions[0] * block.divisions[1] for block in layout.blocks]
    is_fill = np.repeat([block.fill for block in layout.blocks], counts)
    stations = body_stations(actuator, size, strips)
    return extrude(section_mesh(layout), stations, np.flatnonzero(is_fill))
