"""Loads on the tip's face: work, tangent, reference point, mirror and half."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.path import section_axes
from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.incompressible import Incompressible
from fem.effects.sums.tip_load import FollowingTipLoad, TipForce, TipMoment
from fem.effects.supports import Clamp, Symmetry
from fem.march.equilibrium import Equilibrium
from fem.march.predictor import Predictor
from fem.results.measures import Tip, balance
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from tests.fem.parts import Floats, law, stub

REGIONS = ("wall", "floor")
STENCIL = ((1, 2 / 3), (2, -1 / 12))
LOADS = {
    "force": (TipForce((0.1, -0.2, 0.3)), TipForce((0.0, -0.2, 0.3))),
    "moment": (TipMoment(3.0), TipMoment(3.0)),
    "follower": (
        FollowingTipLoad((0.1, -0.2, 0.3), (1.0, 2.0, -3.0), True),
        FollowingTipLoad((0.0, -0.2, 0.3), (1.0, 0.0, 0.0), True),
    ),
    "dead moment": (
        FollowingTipLoad((0.1, -0.2, 0.3), (1.0, 2.0, -3.0), False),
        FollowingTipLoad((0.0, -0.2, 0.3), (1.0, 0.0, 0.0), False),
    ),
}


def _scene(load: str, half: bool) -> Scene:
    supports = [Clamp(), *([Symmetry(halves=True)] if half else [])]
    effects = [law("yeoh", REGIONS), Incompressible(), LOADS[load][int(half)], *supports]
    return Scene(stub("hexahedron", half), effects)


class Bordered:
    """Fields and natural scalars as one vector."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.names = scene, list(scene.natural)

    def set(self, x: Floats) -> None:
        """Take fields and scalars as the state."""
        for name, value in zip(self.names, x[self.scene.body.owned :], strict=True):
            self.scene.set_scalar(name, float(value))
        self.scene.set(x[: self.scene.body.owned])

    def residual(self, x: Floats) -> Floats:
        """All equations."""
        self.set(x)
        r = self.scene.residual()[0]
        r[~self.scene.free[: len(r)]] = 0.0
        return np.concatenate([r, [-self.scene.conjugate(name) for name in self.names]])

    def tangent(self, x: Floats, v: Floats) -> Floats:
        """Bordered tangent times a direction."""
        self.set(x)
        scene, owned = self.scene, self.scene.body.owned
        matrix = scene.assemble_tangent()
        a, b = matrix.createVecs()
        a.array_w[:] = v[:owned]
        matrix.mult(a, b)
        columns = np.array([scene.load(name) for name in self.names]).reshape(-1, owned)
        seconds = [[scene.second_derivative(i, j) for j in self.names] for i in self.names]
        field = b.array_r + v[owned:] @ columns
        field[~scene.free[:owned]] = 0.0
        corner = np.array(seconds).reshape(len(self.names), len(self.names))
        return np.concatenate([field, columns @ v[:owned] + corner @ v[owned:]])


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("load", LOADS)
def test_bordered_tangent_is_the_derivative_of_the_equations(load: str, half: bool) -> None:
    whole = Bordered(_scene(load, half))
    scene, owned = whole.scene, whole.scene.body.owned
    scene.set_scalar("tip-load", 0.7)
    rng = np.random.default_rng(3)
    x = np.concatenate([0.05 * rng.uniform(-1, 1, owned), np.zeros(len(whole.names))])
    x[owned:] = [scene.scalar(name) + rng.uniform(-0.2, 0.2) for name in whole.names]
    v = rng.uniform(-1, 1, len(x))
    v[:owned][~scene.free[:owned]] = 0.0
    h = 1e-4
    slope = sum(
        c * (whole.residual(x + k * h * v) - whole.residual(x - k * h * v)) for k, c in STENCIL
    )
    product = whole.tangent(x, v)
    assert np.abs(product - slope / h).max() <= 1e-7 * np.abs(slope / h).max()
    tail = slice(owned, None)
    assert product[tail] == pytest.approx(np.asarray(slope)[tail] / h, abs=1e-7)


def _solve(scene: Scene, **loads: float) -> Equilibrium:
    """Put a scene at an equilibrium under loads, in steps."""
    newton = Newton(scene, scene.domain.comm, Settings(tolerance=1e-12))
    at = Equilibrium(scene, newton, Predictor(scene, None), None)
    scene.set(scene.w.copy())
    for part in (0.25, 0.5, 0.75, 1.0):
        for name, value in loads.items():
            scene.set_scalar(name.replace("_", "-"), part * value)
        outcome = newton.solve(scene.w.copy(), scene.natural, at.natural_conditions())
        assert outcome.converged, outcome.reason
    return at


def _loaded(*loads: Effect, half: bool = False) -> Scene:
    supports = [Clamp(), *([Symmetry(halves=True)] if half else [])]
    effects = [law("yeoh", REGIONS), Incompressible(), ChamberPressure(), *loads, *supports]
    return Scene(stub("hexahedron", half), effects)


def test_clamp_holds_force_and_moment_at_the_centroid() -> None:
    force, moment = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, -3.0])
    scene = _loaded(FollowingTipLoad(tuple(force), tuple(moment), False))
    _solve(scene, tip_load=1.0, pressure=0.02)
    found = balance(scene)
    clamp = found.supports["clamp"]
    assert clamp.force == pytest.approx(-force, rel=1e-8, abs=1e-10)
    about = np.cross(Tip(scene.body).position(), force) + moment
    assert clamp.moment == pytest.approx(-about, rel=1e-8)
    assert found.force < 1e-8
    assert found.moment < 1e-8


def test_a_load_that_follows_keeps_its_place_in_the_face() -> None:
    load = FollowingTipLoad((0.3, -0.6, 0.2), (10.0, 20.0, -30.0), True)
    scene = _loaded(load)
    _solve(scene, tip_load=1.0)
    b = np.array([scene.scalar(f"tip place {j}") for j in range(9)])
    f = np.array([scene.scalar(f"tip force {j}") for j in range(9)])
    a_x, a_y = b[3:6], b[6:]
    turned = section_axes(a_x, a_y, np.cross(a_x, a_y))
    assert np.abs(turned - np.eye(3)).max() > 0.03
    assert f[:3] == pytest.approx(turned @ np.array(load.force), rel=1e-9)
    couple = np.cross(a_x, f[3:6]) + np.cross(a_y, f[6:])
    assert couple == pytest.approx(turned @ np.array(load.moment), rel=1e-9)


def test_in_the_plane_both_ways_of_a_moment_are_one() -> None:
    found = []
    for load in (TipMoment(20.0), FollowingTipLoad((0.0, 0.0, 0.0), (20.0, 0.0, 0.0), False)):
        for half in (True, False):
            scene = _loaded(load, half=half)
            _solve(scene, tip_load=1.0, pressure=0.02)
            found.append(
                [
                    *Tip(scene.body).position()[1:],
                    scene.body.symmetry_factor * scene.conjugate("pressure"),
                ]
            )
    for other in found[1:]:
        assert other == pytest.approx(found[0], rel=1e-9)


def test_mirrored_loads_give_mirrored_answers() -> None:
    mirror = np.array([-1.0, 1.0, 1.0])
    force, moment = np.array([0.3, -0.2, 0.1]), np.array([5.0, 10.0, -20.0])
    tips = []
    for sign in (np.ones(3), mirror):
        # a moment is an axial vector
        load = FollowingTipLoad(tuple(sign * force), tuple(np.prod(sign) * sign * moment), True)
        scene = _loaded(load)
        _solve(scene, tip_load=1.0)
        tips.append(Tip(scene.body).position())
    assert abs(tips[0][0]) > 0.1
    assert tips[0] == pytest.approx(mirror * tips[1], rel=1e-10, abs=1e-10)


def test_reciprocity_of_pressure_and_force() -> None:
    # Maxwell and Betti about a state far from rest: the volume that a force makes is the way of the
    # tip that a pressure makes
    scene = _loaded(TipForce((0.1, -0.2, 0.3)), TipMoment(8.0))
    at = _solve(scene, tip_load=1.0, pressure=0.03)
    here = at.capture()
    step = 1e-3

    def along(name: str, of: str) -> float:
        ends = []
        for sign in (1.0, -1.0):
            at.restore(here)
            scene.set_scalar(name, here.scalars[name] * (1 + sign * step))
            assert at.newton.solve(scene.w.copy(), scene.natural, at.natural_conditions()).converged
            ends.append(scene.conjugate(of))
        return (ends[0] - ends[1]) / (2 * step * here.scalars[name])

    assert along("pressure", "tip-load") == pytest.approx(along("tip-load", "pressure"), rel=1e-5)


def test_a_face_that_turns_beyond_half_a_turn_goes_on() -> None:
    scene = _loaded(TipMoment(1.0))
    discrete = scene.discrete["TipMoment"]
    scene.set_scalar("tip turn", 5.0)
    scene.set_scalar("tip axis place 0", np.cos(5.0))
    scene.set_scalar("tip axis place 1", np.sin(5.0))
    assert discrete.conjugate("tip turn moment") == pytest.approx(0.0, abs=1e-14)
    assert discrete.conjugate("tip-load") == pytest.approx(5.0)


def test_loads_cost_no_kernel_and_no_unknown_of_the_fields() -> None:
    bare, loaded = _loaded(), _loaded(*LOADS["follower"][:1])
    assert bare.natural == ()
    assert bare.conservative
    assert not loaded.conservative
    assert (bare.kernels, bare.body.size) == (loaded.kernels, loaded.body.size)
