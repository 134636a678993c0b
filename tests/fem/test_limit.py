"""Limit points and lost stability: found, passed, told apart, held against exact solutions."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Symmetry
from fem.kinematics.domain import Domain
from fem.march.equilibrium import Equilibrium
from fem.march.hooks import AfterStep, Hook, Marching
from fem.march.limit_points import crossing, extreme, limit_ahead
from fem.march.march import March
from fem.march.records import (
    Ramp,
    Report,
    Rules,
    State,
)
from fem.results.checkpoint import Archive
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome, Settings
from materials.material import Material
from tests.exact.solids import sphere_octant
from tests.exact.solutions import sphere_limit, sphere_pressure

INNER, OUTER = 10.0, 11.0
C1 = 0.11
SNAPS = 0.0042
"""C2 of a sphere whose pressure falls beyond a limit point and rises above it again."""


@functools.cache
def octant() -> Domain:
    """12 hexahedra; the limit point is then 6e-6 off in pressure and 2e-5 in radius."""
    return Domain(sphere_octant(INNER, OUTER, (1, 2)))


@dataclasses.dataclass
class Sphere:
    """An eighth of a thick sphere under pressure, and its states."""

    march: March
    states: list[State]
    warnings: list[str]

    def radii(self) -> list[float]:
        """a/A of all states."""
        volume = [state.measures["conjugate pressure"] for state in self.states]
        return [float(np.cbrt(v / volume[0])) for v in volume]


def sphere(c2: float = 0.0, rules: Rules | None = None, hooks: Sequence[Hook] = ()) -> Sphere:
    """The sphere at rest."""
    effects: list[Effect] = [
        Elastic("yeoh", {"solid": {"c1": C1, "c2": c2}}),
        Incompressible(),
        ChamberPressure("inner"),
        *(Symmetry(name, axis) for axis, name in enumerate(("left", "front", "bottom"))),
    ]
    scene = Scene(octant(), effects)
    newton = Newton(scene, scene.domain.comm, Settings())
    states: list[State] = []
    warnings: list[str] = []

    class Keep(Hook):
        def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
            states.append(state)

        def after_cutback(self, march: Marching, reason: str) -> None:
            warnings.append(reason)

    march = March(scene, newton, rules or Rules(), hooks=[Keep(), *hooks])
    states.append(march.rest)
    return Sphere(march, states, warnings)


def exact_pressure(c2: float, ratio: float) -> float:
    """Pressure of the sphere at a/A, MPa."""
    return sphere_pressure(
        Material("yeoh", {"c1": C1, "c2": c2}).principal, INNER, OUTER, ratio * INNER
    )


@pytest.fixture(scope="module")
def balloon() -> tuple[Sphere, Report]:
    """The neo-Hookean sphere under a pressure that it never bears."""
    body = sphere()
    return body, body.march.run([Ramp("pressure", 0.03)])


def test_limit_point_of_the_exact_sphere(balloon: tuple[Sphere, Report]) -> None:
    # a/A = 1.426385, p = 0.02596276: the mesh is 6e-6 off, the step to the limit point less
    body, report = balloon
    (point,) = report.critical
    ratio, pressure = sphere_limit(Material("yeoh", {"c1": C1}).principal, INNER, OUTER)
    rest = body.states[0].measures["conjugate pressure"]
    assert (point.kind, point.before, point.after) == ("limit", 0, 1)
    assert point.value == pytest.approx(pressure, rel=2e-5)
    assert (point.conjugate / rest) ** (1 / 3) == pytest.approx(ratio, rel=1e-4)


def test_the_falling_branch_is_the_exact_one(balloon: tuple[Sphere, Report]) -> None:
    # 3e-5: the mesh
    body, _ = balloon
    for state, ratio in zip(body.states[1:], body.radii()[1:], strict=True):
        assert state.scalars["pressure"] == pytest.approx(exact_pressure(0.0, ratio), rel=3e-5)


def test_a_balloon_is_not_followed_for_ever(balloon: tuple[Sphere, Report]) -> None:
    # before, the pressure crept toward its limit in ever smaller steps and never ended
    body, report = balloon
    volumes = [state.measures["conjugate pressure"] for state in body.states]
    assert report.status == "stopped"
    assert volumes[-1] == pytest.approx(Rules().beyond * report.critical[0].conjugate, rel=1e-9)
    assert report.steps < 25


def test_no_step_is_wasted_on_the_way_to_a_limit_point(balloon: tuple[Sphere, Report]) -> None:
    # the parabola through the last three states sees it before Newton fails at it
    body, report = balloon
    assert (report.cutbacks, body.warnings) == (0, [])


def test_the_unstable_mode_is_counted_with_the_pressure_held(
    balloon: tuple[Sphere, Report],
) -> None:
    # the states were found at given volume, where they are stable
    body, report = balloon
    limit = report.critical[0].conjugate
    for state in body.states[1:]:
        beyond = state.measures["conjugate pressure"] > 1.02 * limit
        assert beyond <= state.measures["modes"] <= 1
        assert (state.measures["rate pressure"] < 0) == state.measures["modes"]


def test_given_volume_finds_the_same_limit_point(balloon: tuple[Sphere, Report]) -> None:
    # a case may ask for the volume at once; the greatest pressure is of interest all the same
    _, report = balloon
    body = sphere()
    volume = 2 * report.critical[0].conjugate
    other = body.march.run([Ramp("pressure", volume, drive="conjugate")])
    assert other.status == "converged"
    # a state lies within a twentieth of an increment from it, which is longer here
    assert other.critical[0].value == pytest.approx(report.critical[0].value, rel=1e-4)


@pytest.fixture(scope="module")
def snapping() -> tuple[Sphere, Report]:
    """A sphere that bears 29.5 kPa only on the far side of its limit point of 28.92 kPa."""
    body = sphere(SNAPS)
    return body, body.march.run([Ramp("pressure", 0.0295, stops=(0.01, 0.0292))])


def test_the_pressure_is_reached_again_on_another_branch(
    snapping: tuple[Sphere, Report],
) -> None:
    body, report = snapping
    assert report.status == "converged"
    assert [(p.kind, p.before, p.after) for p in report.critical] == [
        ("limit", 0, 1),
        ("limit", 1, 0),
    ]
    assert body.states[-1].scalars["pressure"] == pytest.approx(0.0295, abs=1e-15)
    ratio = body.radii()[-1]
    assert ratio > 2.5
    assert exact_pressure(SNAPS, ratio) == pytest.approx(0.0295, rel=1e-4)


def test_requested_pressures_are_hit_once_on_both_branches(
    snapping: tuple[Sphere, Report],
) -> None:
    body, _ = snapping
    pressures = np.array([state.scalars["pressure"] for state in body.states])
    for goal in (0.01, 0.0292):
        assert np.sum(np.abs(pressures - goal) < 1e-12) == 1


def test_least_pressure_between_the_branches(snapping: tuple[Sphere, Report]) -> None:
    # by the closed form on a fine grid of radii; the mesh is 1e-4 off there
    _, report = snapping
    grid = [exact_pressure(SNAPS, ratio) for ratio in np.linspace(1.8, 2.6, 801)]
    assert report.critical[1].value == pytest.approx(min(grid), rel=2e-4)


def test_newton_may_not_leave_for_another_branch() -> None:
    # the second load in one increment converges, at a chamber turned inside out: volume −4.5 V0
    body = sphere(0.0035)
    report = body.march.run([Ramp("pressure", 0.028), Ramp("pressure", 0.03, first=0.002)])
    assert report.status == "stopped"
    assert [point.after for point in report.critical] == [1]
    assert np.all(np.diff(body.radii()) > 0)


def test_a_march_always_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    # near a limit point that nobody sees, half of all tiny increments converge: 2000 and more
    monkeypatch.setattr("fem.march.march.limit_ahead", lambda *_: False)
    monkeypatch.setattr("fem.march.march.softens", lambda *_: False)
    body = sphere(rules=Rules(jump=np.inf))
    report = body.march.run([Ramp("pressure", 0.0262)])
    assert report.status == "failed"
    assert report.steps < 100


def test_following_a_path_goes_on_after_a_restart(snapping: tuple[Sphere, Report]) -> None:
    # a checkpoint holds the march's position; that must do
    _, report = snapping
    assert Report(**json.loads(json.dumps(dataclasses.asdict(report)))) == report
    ramp = Ramp("pressure", 0.0295)

    class KilledError(Exception):
        pass

    def kill(state: State, _outcome: Outcome) -> None:
        if state.measures["modes"]:
            raise KilledError

    body = sphere(SNAPS, hooks=[AfterStep(kill)])
    with pytest.raises(KilledError):
        body.march.run([ramp])
    again = sphere(SNAPS)
    archive = Archive(again.march.equilibrium.scene, None)
    again.march.resume(archive.unpack(archive.pack(body.march.position)))
    assert again.march.position.path_following
    assert again.march.run([ramp]).status == "converged"
    end = again.march.states[-1].measures["conjugate pressure"]
    other = snapping[0].states[-1].measures["conjugate pressure"]
    assert end == pytest.approx(other, rel=1e-8)


# --- curves through states ----------------------------------------------------------------------


def _states(points: list[tuple[float, float]], rate: float = 1.0) -> list[State]:
    def measures(v: float, p: float) -> dict[str, float]:
        return {"conjugate pressure": v, "value pressure": p, "rate pressure": rate}

    empty: Any = np.zeros(0)
    return [State(empty, {}, measures(v, p), None, {}) for v, p in points]


def test_extreme_of_a_cubic_is_exact() -> None:
    # three points and a slope make a cubic
    def p(v: float) -> float:
        return v - v**3 / 3

    states = _states([(v, p(v)) for v in (0.2, 0.7, 1.4)])
    at, top = extreme(states, "pressure", 1 - 1.4**2)
    assert (at, top) == (pytest.approx(1.0), pytest.approx(2 / 3))


def test_a_limit_ahead_needs_a_curve_that_turns_below_the_target() -> None:
    falling = _states([(v, v - v**2 / 4) for v in (0.0, 0.5, 1.0)])
    assert limit_ahead(falling, "pressure", 1.1)
    assert not limit_ahead(falling, "pressure", 0.9)
    stiffening = _states([(v, v + v**2 / 4) for v in (0.0, 0.5, 1.0)])
    assert not limit_ahead(stiffening, "pressure", 100.0)
    vacuum = _states([(2 - v, v**2 / 4 - v) for v in (0.0, 0.5, 1.0)])
    assert limit_ahead(vacuum, "pressure", -1.1)


def test_a_seed_next_to_the_state_at_rest_gives_no_curvature() -> None:
    # round-off would decide
    states = _states([(1e-9, 1e-9 + 1e-17), (0.0, 0.0), (1.0, 0.5)])
    assert not limit_ahead(states, "pressure", 10.0)


def test_crossing_lies_between_the_last_states() -> None:
    states = _states([(v, (v - 1) ** 2) for v in (0.5, 1.5, 3.0)])
    assert crossing(states, "pressure", 1.0) == pytest.approx(2.0)
    assert math.isclose(crossing(states[1:], "pressure", 0.25), 1.5)


class _Told(Equilibrium):
    """Counts one unstable mode everywhere; the conjugate grows with the value at a known rate."""

    def __init__(self, rate: float | None) -> None:
        self._rate = rate

    @property
    def tells_stability(self) -> bool:
        return True

    def modes(self) -> int:
        return 1

    def perturbed(self, base: State, scalar: str, sign: float = 1.0) -> State:
        assert self._rate is not None, "nothing asks for another factor"
        change = {"value pressure": 1.0, "conjugate pressure": self._rate}
        near = {name: base.measures[name] + by for name, by in change.items()}
        return State(base.w, {}, near, None, {})


@pytest.mark.parametrize(("conjugate", "rate"), [(2.0, 3.0), (2.0, -3.0), (0.0, None)])
def test_a_load_that_turns_while_another_mode_is_lost_is_seen(
    conjugate: float, rate: float | None
) -> None:
    # the count stays one: of the load that falls before, of a mode that has nothing to do with it
    def at(value: float, conjugate: float, **more: float) -> State:
        measures = {"value pressure": value, "conjugate pressure": conjugate, **more}
        return State(np.zeros(0), {}, measures, None, {})

    before = at(0.5, 1.0, **{"rate pressure": -1.0, "modes": 1})
    new = at(0.6, conjugate)
    _Told(rate).assess_stability(new, before, "pressure")
    assert new.measures["rate pressure"] == (-1.0 if rate is None else rate)
