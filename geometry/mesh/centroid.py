"""Where a section is and how it stands, by the line of its winding: centroid and axes."""

from __future__ import annotations

import numpy as np

from geometry.mesh.data import Floats, MeshData, facet_positions
from geometry.mesh.reference import area_vectors, facet_rules, shape_functions

OUTSIDE = "sheath"
"""The region outside the winding."""


def winding_weights(mesh: MeshData) -> tuple[Floats, Floats]:
    """Weights of the nodes on the winding's surface that make up the centroid inside it.

    The centroid of wall, floor and chamber together moves with the line of the winding,

        c = 1/(2A) ∮ x (X − X̄)·N ds,      A = ½ ∮ (X − X̄)·N ds:

    every piece of the line weighs as much as the triangle that it spans at rest with the centroid
    X̄ = 1/(3A) ∮ X (X·N) ds. Each triangle keeps its weight, of rubber and of
    chamber alike, so that no point within the hollow chamber has to be followed; at rest c = X̄,
    and any homogeneous deformation takes c where it takes X̄. X and N are the parts across z.

    Args:
        mesh: with the surface "winding": a section, a slice or a body, half or whole.

    Returns:
        w_a = ½ ∫ φ_a (X − X̄)·N dA over the surface, (n,), mm² (mm³ of a slice or a body), and X̄,
        (2,), mm; x of it is zero where half is meshed.
    """
    points, _, _ = facet_rules(mesh.cell_type)
    cell, facet = mesh.facets["winding"].T
    positions = facet_positions(mesh.cell_type)[facet]
    values = shape_functions(mesh.cell_type, points)[0][facet]
    values = np.take_along_axis(values, positions[:, None], axis=2)
    place, normal = (part[..., :2] for part in area_vectors(mesh, "winding"))
    # a facet is listed from one of its cells: out of the sheath is into the winding
    sheath = mesh.regions.get(OUTSIDE, -1)
    normal = normal * np.where(mesh.cell_region[cell] == sheath, -1.0, 1.0)[:, None, None]
    flux = np.einsum("kqi,kqi->kq", place, normal)
    rest = np.einsum("kqi,kq->i", place, flux) / (1.5 * flux.sum())
    if mesh.half:
        rest[0] = 0.0
    parts = np.einsum("kqi,kqi,kqa->ka", place - rest, normal, values) / 2
    weights = np.zeros(len(mesh.nodes))
    np.add.at(weights, mesh.cells[cell[:, None], positions], parts)
    return weights, rest


def section_fit(mesh: MeshData) -> tuple[Floats, Floats, Floats]:
    """Centroid and axes of a section, or of a slice in the mean along z, linear in positions.

    Least squares x' ≈ c + (X − X̄) a_x + (Y − Ȳ) a_y on the winding's line, by its weights.

    Args:
        mesh: a section or a slice; half is completed by half a turn about y or by a mirror.

    Returns:
        Rows that multiply the nodes' positions to c, a_x and a_y, (3, n); the components that the
        other half leaves of them, ones and zeros, (3, 3); X̄, (2,), mm.
    """
    weights, rest = winding_weights(mesh)
    levers = mesh.nodes[:, :2] - rest
    weighted = weights[:, None] * levers
    gram = weighted.T @ levers
    kept = np.ones((3, 3))
    if mesh.half:
        gram[0, 1] = gram[1, 0] = 0.0
        # a half slice has mirrored neighbours; a half section that warps is turned about y
        warp = 1.0 if mesh.cell_type == "quadrilateral" else 0.0
        kept = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, warp], [0.0, 1.0, 0.0]])
    axes = np.linalg.solve(gram, weighted.T)
    return np.vstack([weights / weights.sum(), axes]), kept, rest
