"""Where a bent body meets itself: exact arcs with straight caps, and a body."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import brentq

from fem.effects.elastic import Elastic
from fem.kinematics.domain import Domain
from fem.kinematics.section import Section
from fem.march.frames import Frames
from fem.march.records import State
from fem.march.selfcontact import (
    BodyRod,
    Pose,
    UniformRod,
    clearance,
    directions,
    first_contact,
)
from fem.scene import Scene
from geometry.bodies.extrude import hexahedral_body, section_quadrilaterals
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize
from tests.fem.parts import set_positions

Floats = npt.NDArray[np.float64]

ACTUATOR = HemicircleActuator(radius=8, length=160, wall=2, floor=2, sheath=1, cap=15)


def meeting(length: float, cap: float, bottom: float) -> float:
    """The angle at which the caps of an arc meet.

    The gap of 2π − θ is mirror-symmetric about a line through the centre; a cap runs along the
    tangent, and its inner edge, at the radius L/θ + bottom, is the first to reach that line.
    """

    def gap(angle: float) -> float:
        return float(np.tan(np.pi - angle / 2) * (length / angle + bottom) - cap)

    return float(brentq(gap, np.pi + 1e-9, 2 * np.pi))


def _arc(angle: float, length: float, cap: float, height: float) -> Pose:
    """An arc of stations with a rectangular section 0 ≤ y ≤ height, and its caps."""
    z = np.concatenate([np.linspace(-cap, 0, 6), np.linspace(0, length, 41)[1:-1]])
    z = np.concatenate([z, np.linspace(length, length + cap, 6)])
    along = np.clip(z, 0, length)
    turn, radius = angle * along / length, length / angle
    c, s, one, none = np.cos(turn), np.sin(turn), np.ones_like(z), np.zeros_like(z)
    rotation = np.moveaxis(np.array([[one, none, none], [none, c, -s], [none, s, c]]), 2, 0)
    centre = np.column_stack([none, radius * (c - 1), radius * s])
    centre += (z - along)[:, None] * rotation[:, :, 2]
    corners = np.array([[6.0, 0.0], [-6.0, 0.0], [6.0, height], [-6.0, height]])
    reach = (corners @ directions().T).max(axis=0)
    return Pose(z, centre, rotation, np.tile(reach, (len(z), 1)))


@pytest.mark.parametrize(("length", "cap"), [(160.0, 15.0), (100.0, 5.0)])
def test_caps_of_an_arc_meet_where_geometry_says(length: float, cap: float) -> None:
    found = brentq(lambda a: clearance(_arc(a, length, cap, 12.0)), 4.5, 2 * np.pi, xtol=1e-10)
    assert found == pytest.approx(meeting(length, cap, 0.0), abs=1e-6)


def test_an_arc_without_caps_closes_at_360_degrees() -> None:
    for turns, inside in ((0.9, False), (0.99, False), (1.01, True), (2.0, True)):
        pose = _arc(2 * np.pi * turns, 160.0, 1e-9, 12.0)
        assert (clearance(pose) < 0) == inside


def test_a_straight_body_is_clear() -> None:
    # and reports no distance beyond the size of a section, 12 mm
    assert clearance(_arc(1e-9, 160.0, 15.0, 12.0)) > 11


def _uniform_states(turns: float) -> tuple[UniformRod, State, State]:
    mesh = section_quadrilaterals(ACTUATOR, MeshSize(axial=4, section=1, half=True))
    scene = Scene(
        Domain(mesh),
        [Elastic("neo-hooke", {name: {"mu": 1.0} for name in mesh.regions})],
        lambda domain, fields: Section(domain, fields, ACTUATOR.length),
    )
    angles = (0.0, 2 * np.pi * turns)
    old, new = (
        State(
            scene.w.copy(),
            {"curvature": angle / ACTUATOR.length, "stretch": 1.0},
            {"control": angle},
            None,
            {},
        )
        for angle in angles
    )
    return UniformRod(scene.body, ACTUATOR.cap), old, new  # type: ignore[arg-type]


@pytest.mark.parametrize("turns", [1.0, 2.0])
def test_first_contact_of_a_section(turns: float) -> None:
    # sheath, 1 mm below y = 0, meets first; the polygon of 24 sides touches the flat floor exactly
    rod, old, new = _uniform_states(turns)
    share = first_contact(rod, old, new)
    assert share is not None
    exact = meeting(ACTUATOR.length, ACTUATOR.cap, ACTUATOR.outer_bottom)
    assert 2 * np.pi * turns * share == pytest.approx(exact, abs=1e-3)


def test_a_short_increment_before_the_contact_is_clear() -> None:
    rod, old, new = _uniform_states(0.8)
    assert first_contact(rod, old, new) is None


@pytest.mark.parametrize("half", [True, False])
def test_first_contact_of_a_body(half: bool) -> None:
    # the same arc as a body that is bent in one go: stations turn by more than half a turn
    domain = Domain(hexahedral_body(ACTUATOR, MeshSize(axial=8, section=1, half=half)))
    scene = Scene(
        domain, [Elastic("neo-hooke", {name: {"mu": 1.0} for name in domain.data.regions})]
    )
    frames = Frames(scene.body)
    states = []
    for angle in (1e-6, 2 * np.pi):
        set_positions(scene, _bent(domain.data.nodes, angle))
        shape = frames.fit(scene.body.displacement())
        states.append(State(scene.w.copy(), {}, {"control": angle}, shape, {}))
    share = first_contact(BodyRod(scene.body, frames), *states)
    assert share is not None
    # 2°: elements of 8 mm give no station at the ends of the caps
    exact = meeting(ACTUATOR.length, ACTUATOR.cap, ACTUATOR.outer_bottom)
    assert np.rad2deg(2 * np.pi * share) == pytest.approx(np.rad2deg(exact), abs=2.0)


def _bent(nodes: Floats, angle: float) -> Floats:
    along = np.clip(nodes[:, 2], 0, ACTUATOR.length)
    turn, radius = angle * along / ACTUATOR.length, ACTUATOR.length / angle
    c, s, past = np.cos(turn), np.sin(turn), nodes[:, 2] - along
    y = radius * (c - 1) + nodes[:, 1] * c - past * s
    return np.column_stack([nodes[:, 0], y, radius * s + nodes[:, 1] * s + past * c])
