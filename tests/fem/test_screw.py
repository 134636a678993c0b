"""Uniform bending and twist is a screw: moved along it, a section or slice is what it was."""

from __future__ import annotations

import types

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from fem import compat
from fem.kinematics.cell import Cell
from fem.kinematics.domain import Domain
from fem.kinematics.uniform import CURVATURE, STRETCH, TWIST
from fem.scene import Scene
from geometry.bodies.extrude import hexahedral_slice
from geometry.mesh.data import reference_nodes
from geometry.sections.size import MeshSize
from tests.fem.parts import SHORT, Floats
from tests.fem.test_uniform import _scene

K, LAMBDA, TAU = 0.03, 1.1, 0.02


def _put(scene: Scene, x: Floats) -> None:
    """Positions in the turning frame, (n, 3), also of what is held."""
    body, nodes = scene.body, scene.domain.data.nodes
    rest = np.zeros_like(x)
    rest[:, :2] = nodes[:, :2]
    body.set_displacement((x - rest)[body.owned_nodes, : body.components])
    for discrete in scene.discrete.values():
        discrete.update(body.w.x.array)


@pytest.mark.parametrize(
    ("name", "model", "twisted"),
    [
        ("solid", "section", True),
        ("smeared", "section", True),
        ("solid", "cell", False),
        ("discrete", "cell", False),
        ("solid", "cell", True),
        ("discrete", "cell", True),
    ],
)
def test_a_screw_along_itself_changes_nothing(name: str, model: str, twisted: bool) -> None:
    # differences of the potential do not tell whether F is that of a screw; this does
    scene = _scene(name, model, twisted)
    body, mesh = scene.body, scene.domain.mesh
    for key, value in {CURVATURE: K, STRETCH: LAMBDA, TWIST: TAU}.items():
        if key in body.scalars:
            scene.set_scalar(key, value)
    nodes = scene.domain.data.nodes
    x = np.random.default_rng(5).uniform(-0.05, 0.05, (len(nodes), 3))
    x[:, :2] += nodes[:, :2]
    corners = reference_nodes(scene.domain.data.cell_type)
    position, gradient = (compat.PointValues(mesh, field, corners) for field in (body.x, body.F))
    # on the axis λ0 e_z + ω × a is parallel to ω
    omega = np.array([K, 0.0, TAU if twisted else 0.0])
    axis = np.cross(omega, [0.0, 0.0, LAMBDA]) / (omega @ omega)
    unit = omega / np.linalg.norm(omega)
    turn = Rotation.from_rotvec(0.4 * unit).as_matrix()

    def read() -> tuple[Floats, dict[str, float]]:
        return gradient().reshape(*gradient().shape[:2], 3, 3), scene.energies()

    _put(scene, x)
    order = scene.domain.data.cells[scene.domain.cells]
    assert position() == pytest.approx(x[order], abs=1e-12)
    f, energies = read()
    _put(scene, axis + (x - axis) @ turn.T + 3.0 * unit)
    moved, after = read()
    assert moved == pytest.approx(turn @ f, abs=1e-11)
    assert after == pytest.approx(energies, rel=1e-9)


def test_tied_ends_are_refused_on_several_ranks(monkeypatch: pytest.MonkeyPatch) -> None:
    # the two ends of a pair may lie on two ranks, of which neither knows the other's dofs
    mesh = hexahedral_slice(SHORT, MeshSize(section=1, half=False), 3.0, 1)
    domain = Domain(mesh, MPI.COMM_SELF)
    assert len(Cell(domain, ["u"], SHORT.length).ties[0])
    monkeypatch.setattr(domain, "comm", types.SimpleNamespace(size=2))
    with pytest.raises(ValueError, match="one rank"):
        Cell(domain, ["u"], SHORT.length)
