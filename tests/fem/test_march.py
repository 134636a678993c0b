"""The march: roll-back, requests hit exactly, volume control, and the work of the pressure."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fem.march.hooks import Hook, Marching
from fem.march.march import Ramp, Rules, State
from fem.march.position import Position
from fem.solver.newton import Newton, Outcome, SideCondition
from tests.fem.parts import Bender, Floats, bender

TARGET = 0.03
ANGLES = (np.deg2rad(2.0), np.deg2rad(5.0))
STOPS = (0.007, 0.02)


@pytest.fixture(scope="module")
def inflated() -> Bender:
    """Pressure control with requested angles and pressures."""
    body = bender(Rules(turn=np.deg2rad(3.0)))
    report = body.run([Ramp("pressure", TARGET, at=ANGLES, stops=STOPS, largest=TARGET / 10)])
    assert report.status == "converged", report.reason
    return body


def _measures(body: Bender, name: str) -> Floats:
    return np.array([state.measures[name] for state in body.states])


def test_requests_are_hit(inflated: Bender) -> None:
    # at_angles and output pressures of a case are promises
    angles = _measures(inflated, "control")
    pressures = _measures(inflated, "value pressure")
    assert all(np.abs(angles - angle).min() < 1e-8 for angle in ANGLES)
    assert all(np.abs(pressures - stop).min() < 1e-8 * TARGET for stop in (*STOPS, TARGET))
    assert pressures[-1] == pytest.approx(TARGET, abs=1e-15)
    assert np.all(np.diff(angles) > 0)


def test_report_counts_what_happened(inflated: Bender) -> None:
    report = inflated.march.report
    assert report.steps == len(inflated.states) - 1 == len(report.per_step)
    assert report.cutbacks == len(inflated.warnings)
    assert report.iterations >= sum(report.per_step)


def test_work_of_the_pressure_is_stored(inflated: Bender) -> None:
    # nothing dissipates; the spline through some 10 steps integrates P dV to 1e-5
    volume, pressure = (_measures(inflated, f"{n} pressure") for n in ("conjugate", "value"))
    work = float(CubicSpline(volume, pressure).integrate(volume[0], volume[-1]))
    assert len(volume) >= 10
    # the half body's chamber is half the chamber, its energy half the energy
    assert inflated.energies[-1] - inflated.energies[0] == pytest.approx(work, rel=1e-4)


def test_volume_control_reaches_the_state_of_pressure_control(inflated: Bender) -> None:
    # P is found; at the volume of the other run it must be the other run's
    other = bender()
    end = inflated.states[-1]
    report = other.run([Ramp("pressure", end.measures["conjugate pressure"], drive="conjugate")])
    assert report.status == "converged", report.reason
    assert other.scene.scalar("pressure") == pytest.approx(TARGET, rel=1e-6)
    assert other.angle.value() == pytest.approx(end.measures["control"], rel=1e-6)
    found = other.states[-1].measures["conjugate pressure"]
    assert found == pytest.approx(end.measures["conjugate pressure"], rel=1e-8)


def test_until_ends_the_ramp_at_an_angle() -> None:
    # 'up to 360°' of a case; the pressure there is an answer
    body = bender()
    report = body.run([Ramp("pressure", 1.0, until=ANGLES[0])])
    assert report.status == "converged", report.reason
    assert body.angle.value() == pytest.approx(ANGLES[0], abs=1e-8)


class _Kept(Hook):
    """The position after every step, as a checkpoint would have it."""

    def __init__(self) -> None:
        self.positions: list[Position] = []

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        self.positions.append(copy.deepcopy(march.position))


@pytest.mark.parametrize("drive", ["value", "conjugate", "control", "until"])
def test_a_ramp_that_had_ended_is_not_gone_on_with(drive: str) -> None:
    # killed after its last step: its end is hit within round-off, and nothing is left to do
    body, kept = bender(Rules(turn=np.deg2rad(2.0), first_turn=np.deg2rad(1.0))), _Kept()
    volume = body.march.rest.measures["conjugate pressure"]
    ramp = {
        "value": Ramp("pressure", TARGET, largest=TARGET / 2),
        "conjugate": Ramp("pressure", 1.05 * volume, drive="conjugate", largest=0.02 * volume),
        "control": Ramp("pressure", 0.2, drive="control"),
        "until": Ramp("pressure", 1.0, until=ANGLES[1]),
    }[drive]
    assert body.march.run([ramp], [kept]).status == "converged"
    end = kept.positions[-1]
    assert end.report.steps > 1
    body.march.resume(copy.deepcopy(end))
    report = body.march.run([ramp])
    assert (report.status, report.steps) == ("converged", end.report.steps)
    # killed one step before, it takes that step
    body.march.resume(copy.deepcopy(kept.positions[-2]))
    report = body.march.run([ramp])
    assert (report.status, report.steps) == ("converged", end.report.steps)
    assert body.march.states[-1].w == pytest.approx(end.states[-1].w, rel=1e-6, abs=1e-9)


class _Counter(Hook):
    """Remembers how many steps it has seen."""

    count = 0

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """One more."""
        self.count += 1

    def memory(self) -> dict[str, Any]:
        """So many."""
        return {"count": self.count}

    def recall(self, memory: dict[str, Any]) -> None:
        """So many before."""
        self.count = memory["count"]


def test_what_hooks_and_solver_remember_is_saved() -> None:
    """Unloaded, forces count no less than a thousandth of the greatest before the restart."""
    first, again = bender(hooks=[_Counter()]), bender(hooks=[_Counter()])
    first.march.run([Ramp("pressure", TARGET)])
    saved, floor = first.march.saved(), first.march.equilibrium.scene.force_floor
    assert (saved.memory[-1], saved.force_floor) == ({"count": saved.report.steps}, floor)
    assert floor > 1e-6
    again.march.resume(copy.deepcopy(saved))
    assert again.march.equilibrium.scene.force_floor == floor
    assert again.march.saved().memory == saved.memory


class _Flaky:
    """A Newton that fails its third call after it has moved everything."""

    def __init__(self, newton: Newton) -> None:
        self._newton = newton
        self.calls = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._newton, name)

    def solve(
        self, w: Floats, unknown: Sequence[str] = (), conditions: Sequence[SideCondition] = ()
    ) -> Outcome:
        """Solve, then pretend."""
        self.calls += 1
        outcome = self._newton.solve(w, unknown, conditions)
        if self.calls != 3:
            return outcome
        scene: Any = self._newton.problem
        scene.set(scene.w + 0.3)
        scene.set_scalar("pressure", 77.0)
        return dataclasses.replace(outcome, converged=False, reason="so says the test")


def test_a_failed_increment_is_rolled_back_exactly() -> None:
    seen: list[tuple[Floats, float, State]] = []

    class Look(Hook):
        def after_cutback(self, march: Marching, reason: str) -> None:
            scene = body.scene
            seen.append((scene.w.copy(), scene.scalar("pressure"), march.position.states[-1]))

    body = bender(wrap=_Flaky, hooks=[Look()])  # type: ignore[arg-type]
    report = body.run([Ramp("pressure", 0.01, largest=0.002)])
    assert report.status == "converged", report.reason
    assert report.cutbacks == len(seen) == 1
    w, pressure, state = seen[0]
    assert np.array_equal(w, state.w)
    assert pressure == state.scalars["pressure"]
    # the fibers' strain is that of the state as well
    body.march.equilibrium.restore(state)
    for key, discrete in body.scene.discrete.items():
        for name, values in discrete.state().items():
            assert np.array_equal(values, state.discrete[key][name])


def test_the_way_does_not_matter() -> None:
    # an elastic body forgets its path: a failure on the way changes the end by the tolerance only
    smooth, flaky = bender(), bender(wrap=_Flaky)  # type: ignore[arg-type]
    for body in (smooth, flaky):
        body.run([Ramp("pressure", 0.01, largest=0.002)])
    assert flaky.march.report.cutbacks == 1
    assert flaky.angle.value() == pytest.approx(smooth.angle.value(), rel=1e-7)


class _Hopeless(_Flaky):
    """A Newton that never converges again after its second call."""

    def solve(
        self, w: Floats, unknown: Sequence[str] = (), conditions: Sequence[SideCondition] = ()
    ) -> Outcome:
        """Give up."""
        outcome = super().solve(w, unknown, conditions)
        if self.calls < 3:
            return outcome
        return dataclasses.replace(outcome, converged=False, reason="hopeless")


def test_giving_up_keeps_the_last_converged_state() -> None:
    rules = Rules(cutbacks=2)
    body = bender(rules, wrap=_Hopeless)  # type: ignore[arg-type]
    report = body.run([Ramp("pressure", 0.02, largest=0.002)])
    assert (report.status, report.reason) == ("failed", "numerical: hopeless")
    assert report.cutbacks == rules.cutbacks + 1
    assert report.steps == 2
    assert np.array_equal(body.scene.w, body.states[-1].w)


def test_first_increment_turns_by_what_the_rules_say() -> None:
    # from the linear response: a guess in MPa would be wrong for every other body
    turn = np.deg2rad(1.0)
    body = bender(Rules(first_turn=turn))
    body.run([Ramp("pressure", 0.02)])
    first = body.states[1].measures["control"]
    assert first == pytest.approx(turn, rel=0.1)


def test_an_unknown_drive_is_refused() -> None:
    # as a key of the measures it would fail in the middle of a march only
    with pytest.raises(
        ValueError, match="drive 'angle', expected one of value, conjugate, control"
    ):
        Ramp("pressure", 1.0, drive="angle")
