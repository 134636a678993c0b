"""How stiff a solid section of several materials is against twist: St. Venant's torsion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from geometry.mesh.data import MeshData
from geometry.mesh.reference import cell_rule, shape_functions


def twisting_stiffness(mesh: MeshData, shear: Mapping[str, float]) -> float:
    """GJ = min over ψ of ∫ G ((∂ψ/∂x − y)² + (∂ψ/∂y + x)²) dA, N mm².

    ψ is the warping for a twist of one; whatever the axis of the twist, ψ makes up for it
    (Timoshenko and Goodier 1970, section 109). Quads of second order meet it from above.

    Args:
        mesh: quadrilaterals of the whole section.
        shear: modulus of each region, MPa.
    """
    points, weights = cell_rule("quadrilateral")
    values, slopes = shape_functions("quadrilateral", points)
    nodes = mesh.nodes[mesh.cells][..., :2]
    place = np.einsum("qa,cai->cqi", values, nodes)
    jacobian = np.einsum("qaj,cai->cqij", slopes, nodes)
    by_region = np.zeros(max(mesh.regions.values()) + 1)
    for name, number in mesh.regions.items():
        by_region[number] = shear[name]
    measure = np.linalg.det(jacobian) * weights * by_region[mesh.cell_region][:, None]
    gradient = np.einsum("qaj,cqji->cqai", slopes, np.linalg.inv(jacobian))
    turned = np.stack([place[..., 1], -place[..., 0]], axis=-1)
    blocks = np.einsum("cq,cqai,cqbi->cab", measure, gradient, gradient)
    loads = np.einsum("cq,cqai,cqi->ca", measure, gradient, turned)
    count, per_cell = len(mesh.nodes), mesh.cells.shape[1]
    rows = np.repeat(mesh.cells, per_cell, axis=1).ravel()
    columns = np.tile(mesh.cells, (1, per_cell)).ravel()
    matrix = coo_matrix((blocks.ravel(), (rows, columns)), shape=(count, count)).tocsc()
    load = np.zeros(count)
    np.add.at(load, mesh.cells, loads)
    warping = np.zeros(count)
    # ψ is known but for a constant
    warping[1:] = splu(matrix[1:, 1:]).solve(load[1:])
    rigid = float(np.einsum("cq,cqi,cqi->", measure, turned, turned))
    return rigid - float(load @ warping)
