"""Rod frames, bending angle and tip: exact on states that are known."""

from __future__ import annotations

import numpy as np
import pytest

from fem.kinematics.body import Body
from fem.kinematics.domain import Domain
from fem.march.frames import Frames
from fem.results.centre_line import BendingAngle, CentreLine
from fem.results.measures import Tip
from geometry.bodies.extrude import hexahedral_body
from geometry.mesh.reference import area_vectors
from geometry.sections.size import MeshSize
from tests.fem.parts import SHORT, Floats, short_domain

LENGTH = SHORT.length


@pytest.fixture(scope="module")
def body() -> Body:
    """Kinematics without any effect."""
    return Body(short_domain(), ["u"])


def _arc(body: Body, angle: float, stretch: float = 1.0) -> Floats:
    """Displacement of the owned nodes: sections turned evenly, `angle` over the chamber."""
    X = body.domain.data.nodes[body.owned_nodes]
    k = angle / LENGTH
    turn = k * X[:, 2]
    radius = stretch / k
    y = X[:, 1] * np.cos(turn) - radius * (1 - np.cos(turn))
    z = X[:, 1] * np.sin(turn) + radius * np.sin(turn)
    return np.column_stack([1.02 * X[:, 0], y, z]) - X


def test_rebuild_inverts_fit(body: Body) -> None:
    # the predictor must start from the state itself, whatever it is
    frames = Frames(body)
    u = np.random.default_rng(1).uniform(-1, 1, (len(body.owned_nodes), 3))
    assert frames.rebuild(frames.fit(u)) == pytest.approx(u, abs=1e-12)


def test_weights_of_one_return_the_state(body: Body) -> None:
    # three times the same state, extrapolated, is that state
    frames = Frames(body)
    shape = frames.fit(_arc(body, np.deg2rad(140)))
    same = frames.extrapolate([shape, shape, shape], np.array([1.0, -3.0, 3.0]))
    assert frames.rebuild(same) == pytest.approx(frames.rebuild(shape), abs=1e-10)


def test_long_elements_leave_no_station_empty() -> None:
    # planes of nodes 12 mm apart: stations in between had no nodes to fit, and the run crashed
    size = MeshSize(axial=24, section=1, half=True)
    body = Body(Domain(hexahedral_body(SHORT, size)), ["u"])
    frames = Frames(body)
    u = _arc(body, np.deg2rad(20))
    assert frames.rebuild(frames.fit(u)) == pytest.approx(u, abs=1e-12)


@pytest.mark.parametrize("degrees", [-200.0, 30.0, 179.0, 181.0, 400.0])
def test_angle_counts_full_turns(body: Body, degrees: float) -> None:
    # an arctangent alone wraps at 180°
    angle = np.deg2rad(degrees)
    body.set_displacement(_arc(body, angle))
    # a section keeps its plane, so its own angle is exact
    assert BendingAngle(CentreLine(body)).value() == pytest.approx(angle, abs=1e-12)


def test_extrapolation_of_an_arc_stays_an_arc(body: Body) -> None:
    # angle linear in the load, over a step of 40°: the curve through the centres leaves 0.014 mm,
    # extrapolating displacements 8 mm
    frames = Frames(body)
    shapes = [frames.fit(_arc(body, np.deg2rad(d))) for d in (20, 60, 100)]
    found = frames.rebuild(frames.extrapolate(shapes, np.array([1.0, -3.0, 3.0])))
    exact = _arc(body, np.deg2rad(140))
    fields = [_arc(body, np.deg2rad(d)) for d in (20, 60, 100)]
    plain = fields[0] - 3 * fields[1] + 3 * fields[2]
    error = np.abs(found - exact).max()
    assert error < 0.005 * np.abs(plain - exact).max()


def test_row_is_the_gradient_of_the_angle(body: Body) -> None:
    # the border of Newton under a prescribed angle
    angle = BendingAngle(CentreLine(body))
    body.set_displacement(_arc(body, np.deg2rad(250)))
    w = body.w.x.array
    w += np.random.default_rng(3).uniform(-0.1, 0.1, len(w))
    base, row = w.copy(), angle.row()
    v = row / np.abs(row).max() + np.random.default_rng(4).uniform(-1, 1, len(w))
    values = []
    for k in (-2, -1, 1, 2):
        w[:] = base + k * 1e-3 * v
        values.append(angle.value())
    slope = (8 * (values[2] - values[1]) - (values[3] - values[0])) / 12e-3
    assert float(row @ v) == pytest.approx(slope, rel=1e-9)
    w[:] = 0.0


def test_tip_is_the_centroid_of_the_end_face(body: Body) -> None:
    # of the whole face in a half model, by area: a half ellipse of corners would shift it
    x, vectors = area_vectors(body.domain.data, "tip")
    areas = np.linalg.norm(vectors, axis=2)
    centroid = np.einsum("kq,kqi->i", areas, x) / areas.sum()
    A = np.eye(3) + np.random.default_rng(5).uniform(-0.3, 0.3, (3, 3))
    nodes = body.domain.data.nodes[body.owned_nodes]
    tip = Tip(body)
    body.set_displacement(np.zeros_like(nodes))
    assert tip.position() == pytest.approx(centroid, abs=1e-7)
    body.set_displacement(nodes @ A.T - nodes)
    assert tip.position() == pytest.approx(A @ centroid, abs=1e-6)
    body.w.x.array[:] = 0.0


@pytest.mark.parametrize("degrees", [-30.0, 179.0, 400.0])
def test_the_greatest_turn_counts_full_turns(body: Body, degrees: float) -> None:
    frames = Frames(body, against=True)
    found = frames.turned(frames.fit(_arc(body, np.deg2rad(degrees))))
    whole = np.deg2rad(abs(degrees)) * np.ptp(frames.z) / LENGTH
    # stations at the ends stand for what is next to them
    assert found == pytest.approx(whole, rel=0.08)
    assert Frames(body).turned(frames.fit(_arc(body, np.deg2rad(degrees)))) is None


def test_the_greatest_turn_of_an_s_is_that_of_its_middle(body: Body) -> None:
    """Its ends are parallel: the bending angle knows nothing of it."""
    frames = Frames(body, against=True)
    X = body.domain.data.nodes[body.owned_nodes]
    half, angle = np.ptp(X[:, 2]) / 2, np.deg2rad(50.0)
    z = X[:, 2] - X[:, 2].min()
    turn = angle * (1 - np.abs(z / half - 1))
    # ∫ of sin and cos of the turn, there and back
    k = angle / half
    out = (np.sin(k * np.minimum(z, half)), 1 - np.cos(k * np.minimum(z, half)))
    back = (np.sin(angle) - np.sin(turn), np.cos(turn) - np.cos(angle))
    along, down = (a / k + np.where(z > half, b / k, 0.0) for a, b in zip(out, back, strict=True))
    x = np.column_stack([X[:, 0], X[:, 1] * np.cos(turn) - down, X[:, 1] * np.sin(turn) + along])
    x[:, 2] += X[:, 2].min()
    assert frames.turned(frames.fit(x - X)) == pytest.approx(angle, rel=0.08)
    assert frames.turned(frames.fit(0 * X)) == pytest.approx(0.0, abs=1e-12)
