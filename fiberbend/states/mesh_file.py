"""A mesh with regions, surfaces and fibers as a file for other programs: gmsh, VTK, Abaqus.

pyvista and meshio are imported where they are used.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.inp_file import write_inp
from fiberbend.states.paraview import vtk_order, write_grid
from fiberbend.states.snapshot import ModelMesh
from geometry.mesh.data import (
    FACET_VERTICES,
    Floats,
    Ints,
    MeshData,
    facet_positions,
    reference_nodes,
    vertex_positions,
)
from geometry.mesh.reference import facet_rules

ENDINGS = (".msh", ".vtu", ".inp")
"""Files that can be written: gmsh 2.2, VTK, Abaqus."""

_CELLS = {
    "hexahedron": ("hexahedron27", "quad9"),
    "tetrahedron": ("tetra10", "triangle6"),
    "quadrilateral": ("quad9", "line3"),
}
"""Names of cells and facets in meshio."""
_VTK = {
    "hexahedron27": "TRIQUADRATIC_HEXAHEDRON",
    "tetra10": "QUADRATIC_TETRA",
    "quad9": "BIQUADRATIC_QUAD",
    "triangle6": "QUADRATIC_TRIANGLE",
    "line3": "QUADRATIC_EDGE",
}


@dataclasses.dataclass(frozen=True)
class Named:
    """A mesh in the words of meshio: blocks of elements with names; nodes in VTK's order.

    Attributes:
        points: of the mesh, then those of the fibers, (n, 3), mm.
        solid: name of the cells' type.
        facet: name of the facets' type.
        regions: cells of each region, (m, k).
        surfaces: facets of each surface, seen from outside the listed cell, (f, j).
        fibers: start, end and middle of every piece of fiber, (s, 3); none without lines.
        curve: number of the curve of each piece, (s,).
        nodes: number of each named node.
        dimension: 3 of a body, 2 of a section.
    """

    points: Floats
    solid: str
    facet: str
    regions: dict[str, Ints]
    surfaces: dict[str, Ints]
    fibers: Ints
    curve: Ints
    nodes: dict[str, int]
    dimension: int

    def blocks(self) -> Iterator[tuple[str, str, int, Ints]]:
        """Name, type, dimension and nodes of every block that is not empty."""
        for name, cells in self.regions.items():
            yield name, self.solid, self.dimension, cells
        for name, facets in self.surfaces.items():
            yield name, self.facet, self.dimension - 1, facets
        if len(self.fibers):
            yield "fibers", "line3", 1, self.fibers
        for name, node in self.nodes.items():
            yield name, "vertex", 0, np.array([[node]])


def named(model_mesh: ModelMesh) -> Named:
    """Regions, surfaces and fibers of a mesh as blocks of elements."""
    mesh = model_mesh.mesh
    solid, facet = _CELLS[mesh.cell_type]
    points = np.zeros((len(mesh.nodes), 3))
    points[:, : mesh.nodes.shape[1]] = mesh.nodes
    cells, facets = mesh.cells[:, vtk_order(mesh.cell_type)], facet_order(mesh.cell_type)
    regions = {name: cells[mesh.cell_region == n] for name, n in mesh.regions.items()}
    surfaces = {
        name: mesh.cells[pairs[:, :1], facets[pairs[:, 1]]] for name, pairs in mesh.facets.items()
    }
    fibers, curve = np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=np.int64)
    if model_mesh.lines is not None:
        lines = fiber_lines(mesh, model_mesh.lines)
        fibers, curve = _pieces(lines)
        fibers = fibers + len(points)
        points = np.concatenate([points, lines.points])
    return Named(
        points=points,
        solid=solid,
        facet=facet,
        regions={name: part for name, part in regions.items() if len(part)},
        surfaces={name: part for name, part in surfaces.items() if len(part)},
        fibers=fibers,
        curve=curve,
        nodes=dict(mesh.points),
        dimension=mesh.nodes.shape[1],
    )


@functools.cache
def facet_order(cell_type: str) -> Ints:
    """Places in a cell's node list of the nodes of each facet, in VTK's order.

    Corners go round counter-clockwise seen from outside (an edge has the cell at its left), then
    come the middles of the sides, then that of the facet.

    Args:
        cell_type: of the cells.

    Returns:
        Array (facets, nodes per facet).
    """
    nodes = reference_nodes(cell_type)
    vertices = vertex_positions(cell_type)
    normals = facet_rules(cell_type)[2]
    rows = []
    for local, on_facet in enumerate(facet_positions(cell_type)):
        corners = vertices[list(FACET_VERTICES[cell_type][local])]
        if len(corners) == 4:
            corners = corners[[0, 1, 3, 2]]
        if not _outward(nodes[corners], normals[local]):
            corners = corners[::-1]
        sides = [corners] if len(corners) == 2 else list(_sides(corners))
        wanted = [nodes[list(side)].mean(axis=0) for side in sides]
        if len(corners) == 4:
            wanted.append(nodes[corners].mean(axis=0))
        gaps = np.linalg.norm(np.array(wanted)[:, None] - nodes[on_facet], axis=2)
        rows.append(np.r_[corners, on_facet[gaps.argmin(axis=1)]])
    return np.array(rows)


def write_mesh(model_mesh: ModelMesh, path: Path) -> list[str]:
    """Write a mesh with what has a name in it; lengths in mm.

    Args:
        model_mesh: mesh and fibers.
        path: the file, with one of `ENDINGS`: .msh has physical groups, .vtu a cell array of zeros
            and ones for each name, .inp element sets, surfaces, node sets and trusses.

    Returns:
        What the file leaves out or has otherwise than the mesh, a sentence each.

    Raises:
        ValueError: another ending.
    """
    mesh, parts = model_mesh.mesh, named(model_mesh)
    if path.suffix == ".msh":
        _write_msh(parts, path)
        return []
    if path.suffix == ".vtu":
        write_grid(_grid(parts, mesh), path)
        return []
    if path.suffix == ".inp":
        return write_inp(parts, mesh, path, model_mesh.title)
    raise ValueError(f"{path.name}: expected an ending {', '.join(ENDINGS)}")


def _write_msh(parts: Named, path: Path) -> None:
    """Gmsh's version 2.2: a physical group for each name, the curve of a fiber as its entity."""
    import meshio

    cells, physical, entity, tags = [], [], [], {}
    for number, (name, kind, dimension, nodes) in enumerate(parts.blocks(), start=1):
        cells.append((kind, nodes))
        physical.append(np.full(len(nodes), number))
        own = number + parts.curve if name == "fibers" else physical[-1]
        entity.append(own)
        tags[name] = np.array([number, dimension])
    mesh = meshio.Mesh(
        parts.points,
        cells,
        cell_data={"gmsh:physical": physical, "gmsh:geometrical": entity},
        field_data=tags,
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=False)


def _grid(parts: Named, mesh: MeshData) -> Any:
    """Cells, all facets that have a name, and fibers, with an array of 0 and 1 for each name."""
    import pyvista as pv

    facets, owners = _facets_once(parts, mesh)
    groups = [
        (parts.solid, np.concatenate(list(parts.regions.values()))),
        (parts.facet, facets),
        ("line3", parts.fibers),
    ]
    groups = [(kind, nodes) for kind, nodes in groups if len(nodes)]
    rows = [np.insert(nodes, 0, nodes.shape[1], axis=1).ravel() for _, nodes in groups]
    kinds = [np.full(len(nodes), int(pv.CellType[_VTK[kind]])) for kind, nodes in groups]
    grid = pv.UnstructuredGrid(np.concatenate(rows), np.concatenate(kinds), parts.points)
    counts = [len(cells) for cells in parts.regions.values()]
    first = np.cumsum([0, *counts])
    for name, begin, count in zip(parts.regions, first, counts, strict=False):
        grid.cell_data[name] = _mask(grid.n_cells, np.arange(begin, begin + count))
    for name, there in owners.items():
        grid.cell_data[name] = _mask(grid.n_cells, first[-1] + there)
    if len(parts.fibers):
        pieces = np.arange(grid.n_cells - len(parts.fibers), grid.n_cells)
        grid.cell_data["fibers"] = _mask(grid.n_cells, pieces)
        curve = np.full(grid.n_cells, -1, dtype=np.int32)
        curve[pieces] = parts.curve
        grid.cell_data["curve"] = curve
    for name, node in parts.nodes.items():
        grid.point_data[name] = _mask(grid.n_points, [node])
    return grid


def _facets_once(parts: Named, mesh: MeshData) -> tuple[Ints, dict[str, Ints]]:
    """Every facet that has a name once, and for each surface the numbers of its facets."""
    counts = [len(nodes) for nodes in parts.surfaces.values()]
    pairs = np.concatenate([mesh.facets[name] for name in parts.surfaces])
    _, first, number = np.unique(pairs, axis=0, return_index=True, return_inverse=True)
    nodes = np.concatenate(list(parts.surfaces.values()))[first]
    pieces = np.split(number.ravel(), np.cumsum(counts)[:-1])
    return nodes, dict(zip(parts.surfaces, pieces, strict=True))


def _pieces(lines: Any) -> tuple[Ints, Ints]:
    """Start, end and middle of the pieces of polylines, and their curves."""
    flat, begin, pieces, curves = np.asarray(lines.lines), 0, [], []
    for curve in lines.cell_data["curve"]:
        row = flat[begin + 1 : begin + 1 + flat[begin]]
        begin += 1 + len(row)
        pieces.append(np.column_stack([row[:-2:2], row[2::2], row[1::2]]))
        curves.append(np.full(len(pieces[-1]), curve))
    return np.concatenate(pieces).astype(np.int64), np.concatenate(curves).astype(np.int64)


def _outward(corners: Floats, normal: Floats) -> bool:
    """Whether corners go round as seen from outside."""
    first = corners[1] - corners[0]
    if len(corners) == 2:
        return bool(first[1] * normal[0] - first[0] * normal[1] > 0)
    return bool(np.cross(first, corners[2] - corners[1]) @ normal > 0)


def _sides(corners: Sequence[int] | Ints) -> Iterator[tuple[int, int]]:
    return zip(corners, np.roll(corners, -1), strict=True)


def _mask(size: int, here: Sequence[int] | Ints) -> NDArray[np.uint8]:
    mask = np.zeros(size, dtype=np.uint8)
    mask[here] = 1
    return mask
