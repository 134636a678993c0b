"""Whole turns in the bending angle, where the end section turns far against the body beside it."""

from __future__ import annotations

import numpy as np
import pytest

from fem.kinematics.body import Body
from fem.march.frames import Frames
from fem.results.measures import BendingAngle
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
    angle = BendingAngle(body, Frames(body)).value()
    assert np.rad2deg(angle) == pytest.approx(degrees + end, abs=1e-9)
