"""Hexahedra split into tetrahedra."""

from __future__ import annotations

import numpy as np

from geometry.mesh.data import (
    FACET_VERTICES,
    Ints,
    MeshData,
    reference_nodes,
    vertex_positions,
)

_LATTICE = np.rint(2 * reference_nodes("hexahedron")).astype(int)
_CORNERS = _LATTICE[vertex_positions("hexahedron")]
_TET_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))


def _position(lattice: np.ndarray) -> int:
    return int(lattice @ (1, 3, 9))


def _split(apex: int, diagonals: tuple[int, ...]) -> tuple[np.ndarray, list[list[tuple[int, int]]]]:
    """Split a hexahedron into six tetrahedra with a common vertex.

    Args:
        apex: vertex of the hexahedron that all tetrahedra share.
        diagonals: for each facet without the apex, in order, one end of its diagonal.

    Returns:
        The node positions of the tetrahedra, (6, 10), and for each facet of the hexahedron the
        two pairs (tetrahedron, local facet) that cover it.
    """
    tets = []
    opposite = [facet for facet in FACET_VERTICES["hexahedron"] if apex not in facet]
    for facet, start in zip(opposite, diagonals, strict=True):
        end = facet[3 - facet.index(start)]
        for other in (v for v in facet if v not in (start, end)):
            vertices = [apex, start, end, other]
            edges = _CORNERS[vertices[1:]] - _CORNERS[apex]
            if np.linalg.det(edges) < 0:
                vertices = [apex, end, start, other]
            tets.append(vertices)
    positions = []
    for vertices in tets:
        lattice = _CORNERS[vertices]
        middles = [(lattice[a] + lattice[b]) // 2 for a, b in _TET_EDGES]
        positions.append([_position(p) for p in [*lattice, *middles]])
    covers = [
        [
            (t, local)
            for t, vertices in enumerate(tets)
            for local, three in enumerate(FACET_VERTICES["tetrahedron"])
            if {vertices[i] for i in three} <= set(facet)
        ]
        for facet in FACET_VERTICES["hexahedron"]
    ]
    return np.array(positions), covers


def to_tetrahedra(mesh: MeshData) -> MeshData:
    """Split every hexahedron into six order-2 tetrahedra with the same nodes.

    All tetrahedra of a hexahedron share its vertex with the lowest number, and every facet is cut
    from its lowest vertex, so neighbours conform (Dompierre et al. 1999). Cell 6 c + i comes from
    hexahedron c; the named surfaces follow.

    Args:
        mesh: mesh of 27-node hexahedra.

    Returns:
        Mesh of 10-node tetrahedra; nodes that no tetrahedron uses are left out.

    Raises:
        ValueError: not a mesh of hexahedra.
    """
    if mesh.cell_type != "hexahedron":
        raise ValueError(f"cannot split {mesh.cell_type!r}: expected 'hexahedron'")
    vertices = mesh.cells[:, vertex_positions("hexahedron")]
    facet_vertices = np.array(FACET_VERTICES["hexahedron"])
    lowest = facet_vertices[np.arange(6), np.argmin(vertices[:, facet_vertices], axis=2)]
    apex = np.argmin(vertices, axis=1)
    without = ~(facet_vertices[None] == np.arange(8)[:, None, None]).any(axis=2)
    keys = np.column_stack([apex, lowest[without[apex]].reshape(-1, 3)])
    kinds, kind = np.unique(keys, axis=0, return_inverse=True)
    cells = np.empty((len(mesh.cells), 6, 10), dtype=np.int64)
    covers = np.empty((len(mesh.cells), 6, 2, 2), dtype=np.int64)
    for i, (first, *diagonals) in enumerate(kinds.tolist()):
        positions, cover = _split(first, tuple(diagonals))
        cells[kind == i] = mesh.cells[kind == i][:, positions]
        covers[kind == i] = np.array(cover)
    facets: dict[str, Ints] = {}
    for name, pairs in mesh.facets.items():
        covered = covers[pairs[:, 0], pairs[:, 1]]
        numbers = 6 * pairs[:, :1] + covered[..., 0]
        facets[name] = np.stack([numbers, covered[..., 1]], axis=2).reshape(-1, 2)
    used, numbering = np.unique(cells, return_inverse=True)
    return MeshData(
        cell_type="tetrahedron",
        nodes=mesh.nodes[used],
        cells=numbering.reshape(-1, 10),
        regions=dict(mesh.regions),
        cell_region=np.repeat(mesh.cell_region, 6),
        facets=facets,
        half=mesh.half,
        points={name: int(np.searchsorted(used, i)) for name, i in mesh.points.items()},
    )
