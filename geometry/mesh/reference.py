"""Shape functions and quadrature on the order-2 reference cells of `MeshData`."""

from __future__ import annotations

import numpy as np

from geometry.mesh.data import (
    FACET_VERTICES,
    Floats,
    MeshData,
    facet_positions,
    reference_nodes,
    vertex_positions,
)

_CHUNK = 20_000
"""Elements whose Jacobians are held at once."""


def _line(x: Floats) -> tuple[Floats, Floats]:
    values = np.stack([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)], axis=-1)
    slopes = np.stack([4 * x - 3, 4 - 8 * x, 4 * x - 1], axis=-1)
    return values, slopes


def shape_functions(cell_type: str, points: Floats) -> tuple[Floats, Floats]:
    """Shape functions and their reference gradients.

    Args:
        cell_type: "quadrilateral", "hexahedron" or "tetrahedron".
        points: reference coordinates, (..., d).

    Returns:
        Values (..., nodes) and gradients (..., nodes, d) in the node order of `MeshData`.
    """
    if cell_type == "tetrahedron":
        return _tetrahedron(points)
    d = points.shape[-1]
    lines = [_line(points[..., i]) for i in range(d)]

    def product(derived: int) -> Floats:
        out = np.ones((*points.shape[:-1], 1))
        for i in reversed(range(d)):
            factor = lines[i][1] if i == derived else lines[i][0]
            out = (out[..., :, None] * factor[..., None, :]).reshape(
                *points.shape[:-1], 3 * out.shape[-1]
            )
        return out

    return product(-1), np.stack([product(i) for i in range(d)], axis=-1)


def _tetrahedron(points: Floats) -> tuple[Floats, Floats]:
    slopes = np.vstack([-np.ones(3), np.eye(3)])
    share = points @ slopes.T + np.array([1.0, 0.0, 0.0, 0.0])
    values = [share[..., i] * (2 * share[..., i] - 1) for i in range(4)]
    gradients = [(4 * share[..., i, None] - 1) * slopes[i] for i in range(4)]
    for i, j in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)):
        values.append(4 * share[..., i] * share[..., j])
        gradients.append(4 * (share[..., i, None] * slopes[j] + share[..., j, None] * slopes[i]))
    return np.stack(values, axis=-1), np.stack(gradients, axis=-2)


def gauss(number: int) -> tuple[Floats, Floats]:
    """Gauss points and weights on [0, 1]."""
    points, weights = np.polynomial.legendre.leggauss(number)
    return (points + 1) / 2, weights / 2


def _simplex(d: int) -> tuple[Floats, Floats]:
    """Conical product rule of degree 5 on the unit triangle or tetrahedron."""
    # slow to load, and most meshes have no triangles
    from scipy.special import roots_jacobi

    points, weights = np.zeros((1, 0)), np.ones(1)
    for i in range(d):
        x, w = roots_jacobi(3, i, 0)
        x, w = (x + 1) / 2, w / 2 ** (i + 1)
        inner = (1 - x)[:, None, None] * points[None]
        first = np.broadcast_to(x[:, None, None], (*inner.shape[:2], 1))
        points = np.concatenate([first, inner], axis=2).reshape(-1, i + 1)
        weights = (w[:, None] * weights[None]).ravel()
    return points, weights


def cell_rule(cell_type: str) -> tuple[Floats, Floats]:
    """Quadrature points (q, d) and weights (q,) of degree 5 on a reference cell."""
    if cell_type == "tetrahedron":
        return _simplex(3)
    x, w = gauss(3)
    d = 2 if cell_type == "quadrilateral" else 3
    grids = np.meshgrid(*[x] * d, indexing="ij")
    weights = w
    for _ in range(d - 1):
        weights = (weights[:, None] * w[None]).ravel()
    return np.stack([g.ravel() for g in grids], axis=1), weights


def facet_rule(cell_type: str) -> tuple[Floats, Floats]:
    """Quadrature points (q, d - 1) and weights (q,) of degree 5 on the facets of a cell."""
    if cell_type == "quadrilateral":
        points, weights = gauss(3)
        return points[:, None], weights
    return _simplex(2) if cell_type == "tetrahedron" else cell_rule("quadrilateral")


def facet_rules(cell_type: str) -> tuple[Floats, Floats, Floats]:
    """Quadrature of degree 5 on every facet (edge of a quadrilateral) of a reference cell.

    Returns:
        Points (facets, q, d) in the cell, weights (q,) that sum to the area of the reference
        facet, and outward normals (facets, d) scaled so that weight × normal is the area vector.
    """
    flat, weights = facet_rule(cell_type)
    vertices = reference_nodes(cell_type)[vertex_positions(cell_type)]
    points, normals = [], []
    for corners in FACET_VERTICES[cell_type]:
        base = vertices[corners[0]]
        spans = vertices[list(corners[1 : len(base)])] - base
        points.append(base + flat @ spans)
        normal = np.cross(*spans) if len(base) == 3 else spans[0, ::-1] * [1, -1]
        inside = vertices.mean(axis=0) - base
        normals.append(-normal * np.sign(normal @ inside))
    return np.array(points), weights, np.array(normals)


def jacobians(mesh: MeshData, cells: np.ndarray, points: Floats) -> tuple[Floats, Floats]:
    """Positions and Jacobians of the geometry.

    Args:
        mesh: the mesh.
        cells: cell numbers, (n,).
        points: reference coordinates, (n, q, d) or the same for all cells, (q, d).

    Returns:
        Positions (n, q, D) in mm and Jacobians (n, q, D, d) in mm.
    """
    values, gradients = shape_functions(mesh.cell_type, points)
    nodes = mesh.nodes[mesh.cells[cells]]
    if points.ndim == 2:
        return (
            np.einsum("qa,nai->nqi", values, nodes),
            np.einsum("qad,nai->nqid", gradients, nodes),
        )
    return (
        np.einsum("nqa,nai->nqi", values, nodes),
        np.einsum("nqad,nai->nqid", gradients, nodes),
    )


def area_vectors(mesh: MeshData, name: str) -> tuple[Floats, Floats]:
    """Positions and weighted outward normals on a named surface (named edges of a section).

    Returns:
        Positions (k, q, d) in mm and vectors n dA (k, q, d) in mm² (mm of a section), out of the
        listed cell.
    """
    points, weights, normals = facet_rules(mesh.cell_type)
    pairs = mesh.facets[name]
    x, jacobian = jacobians(mesh, pairs[:, 0], points[pairs[:, 1]])
    normal = normals[pairs[:, 1]]
    cofactor = np.linalg.det(jacobian)[..., None, None] * np.linalg.inv(jacobian).swapaxes(2, 3)
    return x, np.einsum("nqij,nj,q->nqi", cofactor, normal, weights)


def surface_weights(mesh: MeshData, name: str) -> Floats:
    """Area weight of every node, ∫ φ_a dA over a named surface.

    Returns:
        Weights (n,) in mm² (mm of a section's edges), zero away from the surface.
    """
    points, _, _ = facet_rules(mesh.cell_type)
    cell, facet = mesh.facets[name].T
    positions = facet_positions(mesh.cell_type)[facet]
    values = shape_functions(mesh.cell_type, points)[0][facet]
    values = np.take_along_axis(values, positions[:, None], axis=2)
    areas = np.linalg.norm(area_vectors(mesh, name)[1], axis=2)
    weights = np.zeros(len(mesh.nodes))
    parts = np.einsum("kq,kqa->ka", areas, values)
    np.add.at(weights, mesh.cells[cell[:, None], positions], parts)
    return weights


def determinants(mesh: MeshData) -> Floats:
    """Jacobian determinants at quadrature points and vertices, (cells, points), in mm^d."""
    points = np.vstack([cell_rule(mesh.cell_type)[0], _vertices(mesh.cell_type)])
    starts = range(0, len(mesh.cells), _CHUNK)
    cells = np.arange(len(mesh.cells))
    parts = [jacobians(mesh, cells[i : i + _CHUNK], points)[1] for i in starts]
    return np.concatenate([np.linalg.det(part) for part in parts])


def _vertices(cell_type: str) -> Floats:
    return reference_nodes(cell_type)[vertex_positions(cell_type)]
