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
from fem.kinematics.uniform import CURVATURE, SIDE, STRETCH, TWIST, Uniform
from fem.scene import Scene
from geometry.bodies.extrude import hexahedral_slice
from geometry.mesh.data import reference_nodes
from geometry.sections.size import MeshSize
from tests.fem.parts import SHORT, Floats
from tests.fem.test_uniform import _scene

K, LAMBDA, TAU, SIDEWAYS = 0.03, 1.1, 0.02, -0.024


def _put(scene: Scene, x: Floats) -> None:
    """Positions in the turning frame, (n, 3), also of what is held."""
    body, nodes = scene.body, scene.domain.data.nodes
    rest = np.zeros_like(x)
    rest[:, :2] = nodes[:, :2]
    body.set_displacement((x - rest)[body.owned_nodes, : body.components])
    for discrete in scene.discrete.values():
        discrete.update(body.w.x.array)


def _bend(scene: Scene) -> Floats:
    """Set the scalars that there are; ω."""
    for key, value in {CURVATURE: K, STRETCH: LAMBDA, SIDE: SIDEWAYS, TWIST: TAU}.items():
        if key in scene.body.scalars:
            scene.set_scalar(key, value)
    body = scene.body
    assert isinstance(body, Uniform)
    return body.carry().spin


@pytest.mark.parametrize(
    ("name", "model", "freedom"),
    [
        pytest.param("solid", "section", "twisted", marks=pytest.mark.long),
        pytest.param("smeared", "section", "twisted", marks=pytest.mark.long),
        ("solid", "cell", "in its plane"),
        ("discrete", "cell", "in its plane"),
        pytest.param("solid", "cell", "twisted", marks=pytest.mark.long),
        pytest.param("discrete", "cell", "twisted", marks=pytest.mark.long),
        ("smeared", "section", "free"),
        ("discrete", "cell", "free"),
    ],
)
def test_a_screw_along_itself_changes_nothing(name: str, model: str, freedom: str) -> None:
    # differences of the potential do not tell whether F is that of a screw; this does
    scene = _scene(name, model, freedom)
    body, mesh = scene.body, scene.domain.mesh
    omega = _bend(scene)
    nodes = scene.domain.data.nodes
    x = np.random.default_rng(5).uniform(-0.05, 0.05, (len(nodes), 3))
    x[:, :2] += nodes[:, :2]
    corners = reference_nodes(scene.domain.data.cell_type)
    position, gradient = (compat.PointValues(mesh, field, corners) for field in (body.x, body.F))
    # on the axis λ0 e_z + ω × a is parallel to ω
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


@pytest.mark.parametrize(("name", "model"), [("smeared", "section"), ("discrete", "cell")])
def test_another_frame_is_the_same_state(name: str, model: str) -> None:
    # its origin at x0, its axes turned so that e3 is where x0 goes: three shifts and a turn
    scene = _scene(name, model, "free")
    omega, nodes = _bend(scene), scene.domain.data.nodes
    x = np.random.default_rng(5).uniform(-0.05, 0.05, (len(nodes), 3))
    x[:, :2] += nodes[:, :2]
    _put(scene, x)
    before = scene.energies()
    origin = np.array([1.0, -2.0, 0.7])
    along = np.cross(omega, origin) + np.array([0.0, 0.0, LAMBDA])
    across = np.cross(along, [1.0, 0.0, 0.0])
    third = np.cross(across, along)
    tilt = np.array([v / np.linalg.norm(v) for v in (third, across, along)])
    turn = Rotation.from_rotvec([0.0, 0.0, 0.3]).as_matrix() @ tilt
    assert np.linalg.det(turn) == pytest.approx(1.0)
    spin = turn @ omega
    for key, value in zip((CURVATURE, SIDE, TWIST), spin, strict=True):
        scene.set_scalar(key, value)
    scene.set_scalar(STRETCH, float(np.linalg.norm(along)))
    _put(scene, (x - origin) @ turn.T)
    assert scene.energies() == pytest.approx(before, rel=1e-9)


def test_tied_ends_are_refused_on_several_ranks(monkeypatch: pytest.MonkeyPatch) -> None:
    # the two ends of a pair may lie on two ranks, of which neither knows the other's dofs
    mesh = hexahedral_slice(SHORT, MeshSize(section=1, half=False), 3.0, 1)
    domain = Domain(mesh, MPI.COMM_SELF)
    assert len(Cell(domain, ["u"], SHORT.length).ties[0])
    monkeypatch.setattr(domain, "comm", types.SimpleNamespace(size=2))
    with pytest.raises(ValueError, match="one rank"):
        Cell(domain, ["u"], SHORT.length)
