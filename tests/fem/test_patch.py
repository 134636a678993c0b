"""Patch test: an affine boundary displacement gives the affine field, on distorted meshes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fem.effects.incompressible import Incompressible
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from geometry.mesh.data import MeshData
from geometry.mesh.tets import to_tetrahedra
from tests.exact.solids import box
from tests.fem.parts import CELLS, law


def _distorted(cell: str) -> MeshData:
    """A box of 2 × 2 × 2 bricks, or their tetrahedra, with every node moved."""
    mesh = box((4.0, 4.0, 4.0), (2, 2, 2))
    mesh = to_tetrahedra(mesh) if cell == "tetrahedron" else mesh
    moved = mesh.nodes + np.random.default_rng(2).uniform(-0.12, 0.12, mesh.nodes.shape)
    return dataclasses.replace(mesh, nodes=moved)


def _shear() -> np.ndarray:
    """A random map with det = 1."""
    A = np.eye(3) + np.random.default_rng(4).uniform(-0.25, 0.25, (3, 3))
    return A / np.cbrt(np.linalg.det(A))


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("bulk", [None, {"solid": 20.0}])
def test_patch(cell: str, bulk: dict[str, float] | None) -> None:
    domain = Domain(_distorted(cell), MPI.COMM_SELF)
    scene = Scene(domain, [law("yeoh", ["solid"]), Incompressible(bulk)])
    body, nodes = scene.body, domain.data.nodes
    u = nodes @ _shear().T - nodes
    surface = np.unique(np.concatenate([domain.surface_nodes(n) for n in domain.data.facets]))
    assert len(surface) < len(nodes), "there must be something to solve for"
    scene.fix(body.node_dofs[surface].ravel(), u[surface].ravel())
    if bulk is None:
        # with every boundary node held p is known up to a constant
        scene.fix(body.dofs("p")[0, :1, 0], np.zeros(1))
    start = scene.w.copy()
    start[body.node_dofs] = u + np.random.default_rng(6).uniform(-0.05, 0.05, u.shape)
    outcome = Newton(scene, MPI.COMM_SELF, Settings(tolerance=1e-12)).solve(start)
    assert outcome.converged, outcome.reason
    found = scene.w[body.node_dofs]
    assert np.abs(found - u).max() < 1e-11
    assert np.abs(scene.w[body.dofs("p")]).max() < 1e-11
    assert scene.det_f() == pytest.approx(1, abs=1e-11)
