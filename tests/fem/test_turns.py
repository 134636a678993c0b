"""Angles of bodies that do not bend evenly: turns of the end section, and of the middle alone."""

from __future__ import annotations

import numpy as np
import pytest

from fem.kinematics.body import Body
from fem.kinematics.domain import Domain
from fem.results.centre_line import BendingAngle, CentreLine
from geometry.bodies.extrude import hexahedral_body
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize
from tests.fem.parts import short_domain
from tests.fem.test_frames import _arc


@pytest.mark.parametrize(("degrees", "end"), [(300.0, 170.0), (-300.0, -170.0), (300.0, -120.0)])
def test_whole_turns_are_those_of_the_body_below_the_end(degrees: float, end: float) -> None:
    # an arctangent knows 470° as 110°; the stations beside the end, which hardly follow it, know
    # the turns as long as the end turns by less than half of one against them, and no less
    body = Body(short_domain(), ["u"])
    rest = body.domain.data.nodes[body.owned_nodes]
    x = rest + _arc(body, np.deg2rad(degrees))
    plane = np.isin(body.owned_nodes, body.domain.surface_nodes("section_tip"))
    c, s = np.cos(np.deg2rad(end)), np.sin(np.deg2rad(end))
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    middle = x[plane].mean(axis=0)
    x[plane] = middle + (x[plane] - middle) @ turn.T
    body.set_displacement(x - rest)
    angle = BendingAngle(CentreLine(body)).value()
    assert np.rad2deg(angle) == pytest.approx(degrees + end, abs=1e-9)


def test_the_middle_half_has_an_angle_of_its_own() -> None:
    # curvature k over the middle half and −k beyond: the whole turns by nothing, the middle by k L
    length, k = 80.0, np.deg2rad(60.0) / 80.0
    actuator = HemicircleActuator(radius=8, length=length, wall=2, floor=2, sheath=1, cap=5)
    body = Body(Domain(hexahedral_body(actuator, MeshSize(axial=4, section=1, half=True))), ["u"])
    rest = body.domain.data.nodes[body.owned_nodes]
    fine = np.linspace(-10.0, length + 10, 4001)
    turn = np.cumsum(np.where(np.abs(fine - length / 2) < length / 4, k, -k)) * (fine[1] - fine[0])
    steps = np.stack([-np.sin(turn), np.cos(turn)]) * (fine[1] - fine[0])
    y, z = (np.interp(rest[:, 2], fine, along) for along in np.cumsum(steps, axis=1))
    at = np.interp(rest[:, 2], fine, turn)
    height = rest[:, 1]
    x = np.column_stack([rest[:, 0], y + height * np.cos(at), z + height * np.sin(at)])
    body.set_displacement(x - rest)
    line = CentreLine(body)
    whole = BendingAngle(line).value()
    middle = line.middle()[0]
    assert whole == pytest.approx(0, abs=1e-2)
    # stations next to the change of curvature see both
    assert middle == pytest.approx(k * length, rel=0.2)
