"""Torsion of a solid section of several materials, by Saint-Venant's warping function."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from geometry.mesh.data import MeshData
from geometry.mesh.reference import cell_rule, shape_functions
from rod.functions import Floats


def torsion(mesh: MeshData, moduli: Mapping[str, float]) -> float:
    """GJ, N mm²: least of ∫ G |∇φ + (−y, x)|² dA over all warpings φ.

    It is the same about every axis along z: φ takes up what moves the axis. Elements of second
    order give it from above, with an error of the fourth power of their size but for corners.

    Args:
        mesh: quadrilaterals of the whole section, all of them solid.
        moduli: G of each region, MPa.
    """
    points, weights = cell_rule("quadrilateral")
    values, slopes = shape_functions("quadrilateral", points)
    nodes = mesh.nodes[mesh.cells]
    places = np.einsum("qa,cai->cqi", values, nodes)
    jacobian = np.einsum("qaj,cai->cqij", slopes, nodes)
    by = np.array([moduli[name] for name in mesh.regions])
    numbers = list(mesh.regions.values())
    shear = by[[numbers.index(number) for number in mesh.cell_region.tolist()]]
    area = shear[:, None] * np.linalg.det(jacobian) * weights
    gradients = np.einsum("qaj,cqji->cqai", slopes, np.linalg.inv(jacobian))
    turned: Floats = np.stack([-places[..., 1], places[..., 0]], axis=-1)
    each = np.einsum("cq,cqai,cqbi->cab", area, gradients, gradients)
    load = np.einsum("cq,cqai,cqi->ca", area, gradients, turned)
    count, corners = len(mesh.nodes), mesh.cells.shape[1]
    rows = np.repeat(mesh.cells, corners, axis=1).ravel()
    columns = np.tile(mesh.cells, (1, corners)).ravel()
    matrix = coo_matrix((each.ravel(), (rows, columns)), shape=(count, count)).tocsc()
    right = np.bincount(mesh.cells.ravel(), load.ravel(), minlength=count)
    used = np.unique(mesh.cells)
    # a warping is known but for a constant
    inner = used[1:]
    warping = np.zeros(count)
    warping[inner] = splu(matrix[inner][:, inner]).solve(-right[inner])
    stiff = float(np.einsum("cq,cqi,cqi->", area, turned, turned))
    return stiff + float(right @ warping)
