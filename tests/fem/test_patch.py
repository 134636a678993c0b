"""Patch test: an affine boundary displacement gives the affine field, on distorted meshes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fem import compat
from fem.effects.elastic import Elastic
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Symmetry
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from geometry.mesh.data import MeshData, reference_nodes
from geometry.mesh.tets import to_tetrahedra
from tests.exact.solids import box
from tests.fem.parts import CELLS, law
from tests.fem.spread import measure


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


STIFF, SOFT = 7.9, 0.0127
"""The baseline's floor and its sheath, moduli in MPa."""


@pytest.mark.parametrize("cell", CELLS)
def test_two_bars_side_by_side(cell: str) -> None:
    # stretched alike, they have no stress across: p is σ_zz / 3 in each, and jumps between them
    mesh = box((4.0, 4.0, 4.0), (4, 2, 2))
    mesh = to_tetrahedra(mesh) if cell == "tetrahedron" else mesh
    middle = mesh.nodes[mesh.cells].mean(axis=1)
    inside = np.all((mesh.nodes > 0) & (mesh.nodes < 4) & (mesh.nodes != 2), axis=1)
    moved = np.random.default_rng(2).uniform(-0.06, 0.06, mesh.nodes.shape) * inside[:, None]
    mesh = dataclasses.replace(
        mesh,
        nodes=mesh.nodes + moved,
        regions={"stiff": 0, "soft": 1},
        cell_region=(middle[:, 0] > 2).astype(np.int64),
    )
    domain, stretch = Domain(mesh, MPI.COMM_SELF), 1.2
    rubber = Elastic("neo-hooke", {"stiff": {"mu": STIFF}, "soft": {"mu": SOFT}})
    planes = [Symmetry("left", 0), Symmetry("front", 1), Symmetry("bottom", 2)]
    scene = Scene(domain, [rubber, Incompressible(), *planes])
    body = scene.body
    top = domain.surface_nodes("top")
    scene.fix(body.node_dofs[top, 2], (stretch - 1) * mesh.nodes[top, 2])
    outcome = Newton(scene, MPI.COMM_SELF, Settings(tolerance=1e-12)).solve(scene.w.copy())
    assert outcome.converged, outcome.reason
    u = mesh.nodes * ([stretch**-0.5, stretch**-0.5, stretch] - np.ones(3))
    assert np.abs(scene.w[body.node_dofs] - u).max() < 1e-9
    points = reference_nodes(cell)
    p = compat.PointValues(domain.mesh, body.p, points)()[..., 0]
    exact = np.array([STIFF, SOFT]) * (stretch**2 - 1 / stretch) / 3
    assert np.abs(p - exact[mesh.cell_region[domain.cells], None]).max() < 1e-9


def test_an_actuator_of_three_rubbers_bends_alike_in_both_elements() -> None:
    # one element through each thickness: a pressure that cannot jump makes 7 % of it
    at = [measure(MPI.COMM_SELF, cell)["pressure at the angle"] for cell in CELLS]
    assert at[1] == pytest.approx(at[0], rel=0.01)
