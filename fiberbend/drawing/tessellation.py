"""Facets of a mesh as fine flat pieces that follow their quadratic shape, for drawing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geometry.mesh.data import (
    FACET_VERTICES,
    Floats,
    Ints,
    MeshData,
    facet_positions,
    reference_nodes,
    vertex_positions,
)
from geometry.mesh.reference import shape_functions

_SHOWN = 0.995
"""Part of the drawn points whose values lie within the colour bar."""
_EDGE_ON = 0.2
"""A surface is hardly seen whose normal has less than this along the view."""


def boundary_facets(mesh: MeshData, cells: NDArray[np.bool_]) -> Ints:
    """Facets that belong to exactly one of some cells.

    Args:
        mesh: hexahedra or tetrahedra.
        cells: True for the cells to look at, (m,).

    Returns:
        Pairs (cell, local facet), (k, 2).
    """
    chosen = np.flatnonzero(cells)
    vertices = vertex_positions(mesh.cell_type)[np.array(FACET_VERTICES[mesh.cell_type])]
    corners = np.sort(mesh.cells[chosen[:, None, None], vertices], axis=2)
    # three corners identify a facet of a conforming mesh
    first, second, third = corners.reshape(-1, corners.shape[2]).T[:3]
    order = np.lexsort((third, second, first))
    ordered = np.column_stack([first, second, third])[order]
    same = (ordered[1:] == ordered[:-1]).all(axis=1)
    shared = np.zeros(len(order), dtype=bool)
    shared[1:] |= same
    shared[:-1] |= same
    single = order[~shared]
    facets = len(vertices)
    return np.column_stack([chosen[single // facets], single % facets])


def on_mirror(mesh: MeshData, pairs: Ints) -> NDArray[np.bool_]:
    """True for the facets that lie in the plane x = 0, (k,)."""
    nodes = mesh.cells[pairs[:, :1], facet_positions(mesh.cell_type)[pairs[:, 1]]]
    width = np.ptp(mesh.nodes[:, 0])
    flat: NDArray[np.bool_] = (np.abs(mesh.nodes[nodes, 0]) < 1e-9 * width).all(axis=1)
    return flat


class Tessellation:
    """Facets cut into small triangles or quadrilaterals.

    Args:
        mesh: hexahedra or tetrahedra.
        pairs: (cell, local facet), (k, 2).
        level: pieces along an edge.

    Attributes:
        pieces: point numbers of the pieces, counterclockwise seen from outside, (pieces, 3 or 4).
    """

    def __init__(self, mesh: MeshData, pairs: Ints, level: int = 3) -> None:
        flat, pieces = _square(level) if mesh.cell_type == "hexahedron" else _triangle(level)
        vertices = reference_nodes(mesh.cell_type)[vertex_positions(mesh.cell_type)]
        self._cells: list[Ints] = []
        self._values: list[Floats] = []
        self._slopes: list[Floats] = []
        blocks: list[Ints] = []
        count = 0
        for facet, corners in enumerate(FACET_VERTICES[mesh.cell_type]):
            cells = pairs[pairs[:, 1] == facet, 0]
            base, edges = vertices[corners[0]], vertices[list(corners[1:3])] - vertices[corners[0]]
            inside = vertices.mean(axis=0) - base
            turned = float(np.cross(edges[0], edges[1]) @ inside) > 0
            if turned:
                edges = edges[::-1]
            values, gradients = shape_functions(mesh.cell_type, base + flat @ edges)
            self._cells.append(cells)
            self._values.append(values)
            self._slopes.append(np.einsum("gad,ed->ega", gradients, edges))
            first = count + len(flat) * np.arange(len(cells))
            blocks.append((first[:, None, None] + pieces).reshape(-1, pieces.shape[1]))
            count += len(flat) * len(cells)
        self.pieces = np.concatenate(blocks)

    def interpolate(self, values: Floats) -> Floats:
        """A field at the drawn points.

        Args:
            values: at the nodes of every cell, (m, k) or (m, k, 3).

        Returns:
            At the points, (n,) or (n, 3).
        """
        flat = values.reshape(*values.shape[:2], -1)
        parts = [
            (weights @ flat[cells]).reshape(-1, flat.shape[2])
            for cells, weights in zip(self._cells, self._values, strict=True)
        ]
        return np.concatenate(parts).reshape(-1, *values.shape[2:])

    def normals(self, nodes: Floats) -> Floats:
        """Outward unit normals at the drawn points.

        Args:
            nodes: positions of the nodes of every cell, (m, k, 3).

        Returns:
            Array (n, 3).
        """
        parts = []
        for cells, (along, across) in zip(self._cells, self._slopes, strict=True):
            parts.append(np.cross(along @ nodes[cells], across @ nodes[cells]).reshape(-1, 3))
        normals = np.concatenate(parts)
        size = np.linalg.norm(normals, axis=1, keepdims=True)
        return normals / np.where(size > 0, size, 1.0)


def greatest_seen(
    skin: Tessellation, nodes: Floats, values: Floats, toward: tuple[float, float, float]
) -> float:
    """Greatest of the values that a viewer sees, single peaks left out.

    Args:
        skin: the drawn surface.
        nodes: positions at rest of the nodes of every cell, (m, k, 3), mm.
        values: at the drawn points, (n,).
        toward: direction to the viewer, or from him: of a half, its mirror image is seen.
    """
    seen = np.abs(skin.normals(nodes) @ toward) > _EDGE_ON * np.linalg.norm(toward)
    return float(np.quantile(values[seen] if seen.any() else values, _SHOWN))


def _square(level: int) -> tuple[Floats, Ints]:
    line = np.linspace(0, 1, level + 1)
    v, u = np.meshgrid(line, line, indexing="ij")
    corner = (np.arange(level)[:, None] * (level + 1) + np.arange(level)).reshape(-1, 1)
    pieces = corner + np.array([0, 1, level + 2, level + 1])
    return np.column_stack([u.ravel(), v.ravel()]), pieces


def _triangle(level: int) -> tuple[Floats, Ints]:
    grid = [(i, j) for j in range(level + 1) for i in range(level + 1 - j)]
    number = {point: n for n, point in enumerate(grid)}
    pieces = []
    for i, j in grid:
        if i + j < level:
            pieces.append([number[i, j], number[i + 1, j], number[i, j + 1]])
        if i + j < level - 1:
            pieces.append([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]])
    return np.array(grid) / level, np.array(pieces)
