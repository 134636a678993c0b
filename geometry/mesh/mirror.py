"""A mesh of x ≥ 0 with its mirror image in the plane x = 0."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from numpy.typing import NDArray

from geometry.mesh.data import Floats, Ints, MeshData, facet_positions, reference_nodes


@dataclasses.dataclass(frozen=True)
class BothHalves:
    """A whole mesh, and which part of the half each of its parts is an image of.

    The half itself comes first in nodes and cells; the nodes of the mirror plane are in both.

    Attributes:
        mesh: the whole, n nodes and m cells with k nodes each.
        node: node of the half that each node is an image of, (n,).
        image: True for the nodes of x < 0, (n,).
        plane: True for the nodes of the mirror plane, (n,).
        cell: cell of the half that each cell is an image of, (m,).
        order: places of its nodes in the node list of that cell, (m, k).
    """

    mesh: MeshData
    node: Ints
    image: NDArray[np.bool_]
    plane: NDArray[np.bool_]
    cell: Ints
    order: Ints


def reflect(cell_type: str, points: Floats) -> Floats:
    """The reflection that maps a reference cell onto itself, so that images are not inside out.

    (a, …) becomes (1 − a, …) in a quadrilateral or hexahedron, (a, b, c) becomes (b, a, c) in a
    tetrahedron.

    Args:
        cell_type: of the cells.
        points: reference coordinates, (..., d).
    """
    image = np.array(points, dtype=float)
    if cell_type == "tetrahedron":
        image[..., [0, 1]] = image[..., [1, 0]]
    else:
        image[..., 0] = 1 - image[..., 0]
    return image


def reflected_vectors(cell_type: str, vectors: Floats) -> Floats:
    """Derivatives of reference coordinates under `reflect`, (..., d)."""
    return reflect(cell_type, vectors) - reflect(cell_type, np.zeros_like(vectors))


@functools.cache
def backward(cell_type: str) -> Ints:
    """Places in a cell's node list of the nodes of its mirror image, (k,)."""
    nodes = reference_nodes(cell_type)
    gap = np.linalg.norm(reflect(cell_type, nodes)[:, None] - nodes, axis=2)
    return np.asarray(gap.argmin(axis=1))


@functools.cache
def facet_images(cell_type: str) -> Ints:
    """Local facet of the mirror image for each local facet, (facets,)."""
    sets = [frozenset(row.tolist()) for row in facet_positions(cell_type)]
    order = backward(cell_type)
    return np.array([sets.index(frozenset(order[list(nodes)].tolist())) for nodes in sets])


def both_halves(half: MeshData) -> BothHalves:
    """A half mesh and its mirror image as one mesh; its facets in the mirror plane are gone.

    Args:
        half: a mesh of x ≥ 0 with its surface "symmetry" in x = 0.

    Raises:
        ValueError: the mesh is whole.
    """
    if not half.half:
        raise ValueError("the mesh is whole: expected a half")
    nodes, cells = len(half.nodes), len(half.cells)
    plane = np.zeros(nodes, dtype=bool)
    plane[half.facet_nodes("symmetry").ravel()] = True
    added = np.flatnonzero(~plane)
    number = np.arange(nodes)
    number[added] = nodes + np.arange(len(added))
    order, facet = backward(half.cell_type), facet_images(half.cell_type)
    across = np.ones(half.nodes.shape[1])
    across[0] = -1.0
    mesh = dataclasses.replace(
        half,
        nodes=np.concatenate([half.nodes, half.nodes[added] * across]),
        cells=np.concatenate([half.cells, number[half.cells][:, order]]),
        cell_region=np.tile(half.cell_region, 2),
        facets={
            name: np.concatenate(
                [pairs, np.column_stack([pairs[:, 0] + cells, facet[pairs[:, 1]]])]
            )
            for name, pairs in half.facets.items()
            if name != "symmetry"
        },
        half=False,
    )
    image = np.arange(len(mesh.nodes)) >= nodes
    return BothHalves(
        mesh=mesh,
        node=np.r_[np.arange(nodes), added],
        image=image,
        plane=np.r_[plane, np.zeros(len(added), dtype=bool)],
        cell=np.tile(np.arange(cells), 2),
        order=np.repeat([np.arange(len(order)), order], cells, axis=0),
    )
