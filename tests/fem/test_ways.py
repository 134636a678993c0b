"""Angles that are asked for: hit up and down, on loading and unloading, or told to be missed."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from fem.march.hooks import Hook, Marching
from fem.march.march import Ramp, Rules, State
from fem.march.position import Position
from fem.march.ways import MISSED, Requests, Way
from fem.solver.newton import Outcome
from tests.fem.parts import Bender, bender

LOW, HIGH = np.deg2rad(2.0), np.deg2rad(5.0)
TARGET = 0.03
WAY = Way("value", "value pressure", 1.0, 1.0, 1.0, (), np.inf)


def _requests(*at: float, until: float | None = None) -> Requests:
    return Requests(Ramp("pressure", 1.0, at=at, until=until), 1e-8)


def _at(angle: float, load: float = 0.0) -> State:
    measures = {"control": angle, "value pressure": load}
    return State(np.zeros(0), {}, measures, None, {})


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_nearest_angle_in_the_way_of_the_increment_is_due(side: float) -> None:
    asked = _requests(*(side * a for a in (0.3, 0.1, -0.2)), until=side * 0.5)
    assert asked.due(0.0, side * 0.4) == side * 0.1
    assert asked.due(side * 0.1, side * 0.4) == side * 0.3
    # on the way back the same ones, and beyond zero
    assert asked.due(side * 0.4, 0.0) == side * 0.3
    assert asked.due(side * 0.05, side * -0.3) == side * -0.2
    # one that would be missed by a fifth of the step is hit, none where the angle stands still
    assert asked.due(0.0, side * 0.09) == asked.due(0.0, side * 0.084) == side * 0.1
    assert asked.due(0.0, side * 0.083) is None
    assert asked.due(side * 0.0999, side * 0.0999) is None
    assert asked.due(0.0, side * 0.05) is None


def test_an_angle_that_a_step_has_passed_is_gone_back_for() -> None:
    asked = _requests(0.1, 0.3)
    assert asked.judge(_at(0.0), _at(0.4, 0.5), "value", 0.5, WAY) == "again"
    assert asked.due(0.0, 0.05) == 0.1
    assert asked.judge(_at(0.0), _at(0.1, 0.2), "control", 0.1, WAY) == "keep"
    assert asked.hits(_at(0.1)) == [0.1]
    # falling
    assert asked.judge(_at(0.4), _at(0.05, 0.5), "value", 0.5, WAY) == "again"
    assert asked.due(0.4, 0.4) == 0.3


def test_an_angle_beyond_the_end_of_the_load_or_behind_it_is_not_taken() -> None:
    asked = _requests(0.1)
    assert asked.due(0.0, 0.2) == 0.1
    assert asked.judge(_at(0.0), _at(0.1, 1.1), "control", 0.1, WAY) == "again"
    assert asked.due(0.0, 0.2) is None
    asked = _requests(0.1)
    assert asked.due(0.0, 0.2) == 0.1
    assert asked.judge(_at(0.0, 0.4), _at(0.1, 0.3), "control", 0.1, WAY) == "cut"
    assert "ahead" in MISSED


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_angle_beyond_the_next_stop_of_the_load_waits_until_the_stop_is_hit(
    side: float,
) -> None:
    way = Way("value", "value pressure", side, side, 1.0, (side * 0.5, side * 0.8), np.inf)
    asked = _requests(side * 0.1)
    assert asked.due(0.0, side * 0.095) == side * 0.1
    passed = _at(side * 0.1, side * 0.52)
    assert asked.judge(_at(0.0), passed, "control", side * 0.1, way) == "again"
    assert asked.due(0.0, side * 0.095) is None
    # from the stop on the load runs past it, and is sent back
    stop = _at(side * 0.095, side * 0.5)
    assert asked.judge(stop, _at(side * 0.15, side * 0.8), "value", side * 0.8, way) == "again"
    assert asked.due(stop.measures["control"], side * 0.15) == side * 0.1
    assert asked.judge(stop, passed, "control", side * 0.1, way) == "keep"


def test_pressures_and_angles_close_together_are_all_hit() -> None:
    stops = (TARGET / 3, TARGET / 2)
    body = bender(Rules(turn=np.deg2rad(10.0)))
    body.run([Ramp("pressure", stop) for stop in stops])
    # the load passes a stop on the way to an angle just beyond
    angle = 1.005 * body.states[-1].measures["control"]
    body = bender(Rules(turn=np.deg2rad(10.0)))
    report = body.run([Ramp("pressure", TARGET, stops=stops, at=(angle,))])
    assert report.status == "converged", report.reason
    assert [value for _, value in report.hits] == [angle]
    reached = [state.measures["value pressure"] for state in body.states]
    assert all(stop in reached for stop in stops)


def _angles(body: Bender) -> np.ndarray:
    return np.array([state.measures["control"] for state in body.states])


def test_angles_are_hit_on_loading_and_on_unloading() -> None:
    body = bender(Rules(turn=np.deg2rad(4.0)))
    ramps = [
        Ramp("pressure", TARGET, at=(LOW, HIGH)),
        Ramp("pressure", 0.0, at=(LOW, HIGH)),
        Ramp("pressure", -TARGET / 2, at=(-LOW / 4, LOW)),
    ]
    report = body.run(ramps)
    assert report.status == "converged", report.reason
    assert [value for _, value in report.hits] == [LOW, HIGH, HIGH, LOW, -LOW / 4]
    angles, pressures = _angles(body), np.array([s.scalars["pressure"] for s in body.states])
    assert [angles[step] for step, _ in report.hits] == pytest.approx(
        [value for _, value in report.hits], abs=1e-8
    )
    up, top, down, end, vacuum = (pressures[step] for step, _ in report.hits)
    # nothing dissipates: the way back passes the same states
    assert (top, up) == pytest.approx((down, end), rel=1e-6)
    assert vacuum < 0 < up < top < TARGET


@pytest.mark.parametrize(("end", "stop"), [(TARGET, HIGH), (-TARGET, -LOW / 4)])
def test_a_stop_ends_the_run_in_either_direction(end: float, stop: float) -> None:
    body = bender()
    report = body.run([Ramp("pressure", end, until=stop), Ramp("pressure", 3 * end)])
    assert (report.status, report.ended_at) == ("converged", stop)
    assert body.angle.value() == pytest.approx(stop, abs=1e-8)


class _Kept(Hook):
    def __init__(self) -> None:
        self.positions: list[Position] = []

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        self.positions.append(copy.deepcopy(march.position))


def test_a_stop_on_unloading_is_not_gone_beyond_when_resumed() -> None:
    body, kept = bender(), _Kept()
    ramps = [Ramp("pressure", TARGET, at=(HIGH,)), Ramp("pressure", 0.0, until=HIGH)]
    report = body.march.run(ramps, [kept])
    assert (report.ended_at, len(report.hits)) == (HIGH, 2)
    body.march.resume(copy.deepcopy(kept.positions[-1]))
    again = body.march.run(ramps)
    assert (again.status, again.steps, again.ended_at) == ("converged", report.steps, HIGH)


def test_an_angle_is_driven_up_and_back() -> None:
    body = bender(Rules(turn=np.deg2rad(4.0)))
    there = Ramp("pressure", HIGH, drive="control", at=(LOW,))
    back = Ramp("pressure", LOW / 2, drive="control", at=(LOW,))
    report = body.run([there, back])
    assert report.status == "converged", report.reason
    assert [value for _, value in report.hits] == [LOW, HIGH, LOW, LOW / 2]
