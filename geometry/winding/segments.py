"""Fibers as segments in host cells, and the winding's surface that they are found on."""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import (
    FACET_VERTICES,
    Floats,
    Ints,
    MeshData,
    reference_nodes,
    vertex_positions,
)
from geometry.mesh.reference import jacobians
from geometry.winding.outline import arc_length


@dataclasses.dataclass(frozen=True)
class Lines:
    """Pieces of material lines, each in a facet of one cell; n pieces with q points each.

    Attributes:
        cell: host cell, (n,).
        facet: local facet of the host cell, (n,).
        points: reference coordinates in the host cell, (n, q, d).
        tangents: derivative of the reference coordinates along the piece, parameter in [0, 1],
            (n, q, d).
        axial: derivative of z along the piece in mm where the mesh has no z, else 0, (n, q).
        weights: weights of the points, (n, q); they sum to 1.
    """

    cell: Ints
    facet: Ints
    points: Floats
    tangents: Floats
    axial: Floats
    weights: Floats

    def lines(self, index: Ints) -> Lines:
        """Some of them by their numbers, (m,), as lines alone."""
        names = (field.name for field in dataclasses.fields(Lines))
        return Lines(**{name: getattr(self, name)[index] for name in names})


@dataclasses.dataclass(frozen=True)
class EmbeddedFibers(Lines):
    """Fiber segments, n segments with q points each.

    With J the Jacobian of the cell's geometry, length = Σ_q weights |J tangents|. A section has no
    z of its own: there d = 2 and length = Σ_q weights √(|J tangents|² + axial²), in mm per mm of z.

    Attributes:
        length: length in mm in the mesh's own geometry, (n,); see above for a section.
        share: fraction of the fiber's stiffness, (n,).
        curve: number of the curve (of the helix, when smeared), (n,).
        z: z in mm of the segment's middle, (n,); 0 on a section.
        s: arc length in mm on the outline of the segment's middle, (n,).
        family: number of the family of threads, (n,).
    """

    length: Floats
    share: Floats
    curve: Ints
    z: Floats
    s: Floats
    family: Ints


@dataclasses.dataclass(frozen=True)
class SmearedFibers(EmbeddedFibers):
    """Fibers smeared over their surface: segments of one point each.

    Attributes:
        curvature: curvature of the fiber's path normal to the surface, in 1/mm, (n,): with it a
            fiber under the tension T presses on the surface by T curvature per length.
        density: length of all helices together per area, in 1/mm, (n,).
    """

    curvature: Floats
    density: Floats


@dataclasses.dataclass(frozen=True)
class Facets:
    """The winding's facets as affine images of their reference interval, square or triangle.

    Attributes:
        cell: host cells, (k,).
        facet: their local facets, (k,).
        origin: developed coordinates (s, z), of a section (s), of the facet's first vertex,
            (k, d - 1).
        axes: developed edge vectors as columns, (k, d - 1, d - 1).
        base: first vertex in the cell's reference coordinates, (k, d).
        edges: reference edge vectors, (k, d - 1, d).
        triangle: True for triangles.
    """

    cell: Ints
    facet: Ints
    origin: Floats
    axes: Floats
    base: Floats
    edges: Floats
    triangle: bool


def develop(mesh: MeshData, actuator: Actuator) -> Facets:
    """Unroll the winding's surface: each facet as an affine image of its reference facet.

    A point of the outline at arc length s and height z has the developed coordinates X = (s, z);
    on them a helix is a straight line. A facet with vertices X0, X1, X2 is

        X(ξ) = X0 + A ξ,   A = [X1 − X0, X2 − X0],

    with ξ in the unit square or triangle: exact on a body extruded along z, where facets are
    rectangles of (s, z) or halves of these. The edge of a section has X = s alone. X, A in mm.
    """
    pairs = mesh.facets["winding"]
    d = mesh.nodes.shape[1]
    corners = np.array(FACET_VERTICES[mesh.cell_type])[pairs[:, 1]][:, :d]
    vertices = vertex_positions(mesh.cell_type)
    nodes = mesh.nodes[mesh.cells[pairs[:, :1], vertices[corners]]]
    negative = nodes[..., 0].sum(axis=1) < 0
    s = arc_length(actuator, nodes[..., :2], np.repeat(negative[:, None], d, axis=1))
    developed = np.concatenate([s[..., None], nodes[..., 2:]], axis=-1)
    reference = reference_nodes(mesh.cell_type)[vertices][corners]
    return Facets(
        cell=pairs[:, 0],
        facet=pairs[:, 1],
        origin=developed[:, 0],
        axes=(developed[:, 1:] - developed[:, :1]).swapaxes(1, 2),
        base=reference[:, 0],
        edges=reference[:, 1:] - reference[:, :1],
        triangle=mesh.cell_type == "tetrahedron",
    )


def push(mesh: MeshData, cell: Ints, points: Floats, tangents: Floats) -> Floats:
    """Tangents in space, J t, of tangents t in the reference cells.

    Args:
        mesh: the mesh.
        cell: host cells, (n,).
        points: reference coordinates, (n, q, d).
        tangents: t there, (n, q, d).

    Returns:
        Array (n, q, d), mm per unit of the segment's parameter.
    """
    return np.einsum("nqij,nqj->nqi", jacobians(mesh, cell, points)[1], tangents)
