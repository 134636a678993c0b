"""Read the current gmsh model into `MeshData`."""

from __future__ import annotations

import gmsh
import numpy as np

from geometry.mesh.data import (
    FACET_VERTICES,
    Floats,
    Ints,
    MeshData,
    reference_nodes,
    vertex_positions,
)
from geometry.mesh.errors import MeshError


def _node_order(kind: int, cell_type: str) -> Ints:
    """Position in gmsh's node list of every node of `MeshData`, by matching coordinates."""
    _, dim, _, count, local, _ = gmsh.model.mesh.getElementProperties(kind)
    theirs: Floats = np.array(local).reshape(count, dim)
    if cell_type == "hexahedron":
        theirs = (theirs + 1) / 2
    ours = reference_nodes(cell_type)
    distance = np.abs(ours[:, None] - theirs[None]).max(axis=2)
    order = distance.argmin(axis=1)
    if len(set(order.tolist())) != len(ours) or distance.min(axis=1).max() > 1e-9:
        raise MeshError(f"gmsh's nodes of an order-2 {cell_type} do not match ours")
    return order


def _cells(cell_type: str, volumes: list[int]) -> tuple[Ints, Ints]:
    """Cells in gmsh node tags, and the position of each one's volume in the list."""
    kind = gmsh.model.mesh.getElementType(cell_type, 2)
    order = _node_order(kind, cell_type)
    cells, owner = [], []
    for i, volume in enumerate(volumes):
        kinds, _, tags = gmsh.model.mesh.getElements(3, volume)
        if list(kinds) != [kind]:
            raise MeshError(f"gmsh filled volume {volume} with other elements than {cell_type}")
        rows = np.array(tags[0], dtype=np.int64).reshape(-1, len(order))
        cells.append(rows[:, order])
        owner.append(np.full(len(rows), i))
    return np.concatenate(cells), np.concatenate(owner)


def _surface_vertices(cell_type: str, surfaces: list[int]) -> Ints:
    corners = 4 if cell_type == "hexahedron" else 3
    rows = []
    for surface in surfaces:
        kinds, _, tags = gmsh.model.mesh.getElements(2, surface)
        for kind, flat in zip(kinds, tags, strict=True):
            count = gmsh.model.mesh.getElementProperties(kind)[3]
            rows.append(np.array(flat, dtype=np.int64).reshape(-1, count)[:, :corners])
    return np.sort(np.concatenate(rows), axis=1)


def find_facets(cell_type: str, cells: Ints, vertices: Ints) -> Ints:
    """Find the facets with given vertices, each in the cell with the lowest number.

    Args:
        cell_type: of the cells.
        cells: nodes of the cells, (m, nodes).
        vertices: sorted vertex nodes of the facets, (k, 3 or 4).

    Returns:
        Pairs (cell, local facet), (k, 2), sorted by cell.

    Raises:
        MeshError: a facet that no cell has.
    """
    local = np.array(FACET_VERTICES[cell_type])
    all_vertices = np.sort(cells[:, vertex_positions(cell_type)][:, local], axis=2)
    everything = np.concatenate([all_vertices.reshape(-1, local.shape[1]), vertices])
    _, first, key = np.unique(everything, axis=0, return_index=True, return_inverse=True)
    number = first[key[cells.shape[0] * len(local) :]]
    if (number >= cells.shape[0] * len(local)).any():
        raise MeshError("gmsh meshed a surface that no cell touches")
    number = np.unique(number)
    return np.column_stack([number // len(local), number % len(local)])


def read_mesh(
    cell_type: str,
    regions: dict[str, list[int]],
    surfaces: dict[str, list[int]],
    points: dict[str, int],
    half: bool,
) -> MeshData:
    """Read the order-2 mesh of the current gmsh model.

    Args:
        cell_type: "hexahedron" or "tetrahedron".
        regions: gmsh volumes of each region.
        surfaces: gmsh surfaces of each named surface.
        points: gmsh point of each named point.
        half: only x ≥ 0 is meshed.

    Returns:
        The mesh, its cells sorted along z.

    Raises:
        MeshError: elements of another type, or surfaces apart from the cells.
    """
    tags, flat, _ = gmsh.model.mesh.getNodes()
    index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    index[tags.astype(np.int64)] = np.arange(len(tags))
    nodes = flat.reshape(-1, 3)

    volumes = [volume for tags in regions.values() for volume in tags]
    region_of = np.repeat(np.arange(len(regions)), [len(tags) for tags in regions.values()])
    cells, owner = _cells(cell_type, volumes)
    height = nodes[index[cells], 2].mean(axis=1)
    along_z = np.lexsort((owner, height.round(6)))
    cells, cell_region = cells[along_z], region_of[owner[along_z]]
    facets = {
        name: find_facets(cell_type, cells, _surface_vertices(cell_type, entities))
        for name, entities in surfaces.items()
    }
    used, numbering = np.unique(index[cells], return_inverse=True)
    named = {name: index[gmsh.model.mesh.getNodes(0, tag)[0][0]] for name, tag in points.items()}
    return MeshData(
        cell_type=cell_type,
        nodes=nodes[used],
        cells=numbering.reshape(cells.shape),
        regions={name: i for i, name in enumerate(regions)},
        cell_region=cell_region,
        facets=facets,
        half=half,
        points={name: int(np.searchsorted(used, node)) for name, node in named.items()},
    )
