"""A uniform bend that is held: exact tangent, exact solutions, energy, hand."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.incompressible import Incompressible
from fem.effects.sums.hold import BEND, HOLD, LENGTHENED, SIDE_BEND, TWISTED, Hold
from fem.effects.supports import StraightAxis, Symmetry, TwofoldAxis
from fem.kinematics.cell import Cell
from fem.kinematics.domain import Domain
from fem.kinematics.section import Section
from fem.march.equilibrium import Equilibrium
from fem.march.predictor import Predictor
from fem.march.records import Ramp
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from geometry.bodies.extrude import hexahedral_slice, section_quadrilaterals
from geometry.sections.size import MeshSize
from tests.exact.solutions import Torsion
from tests.fem.parts import PITCH, SHORT, law, smeared
from tests.fem.test_tip_load import STENCIL, Bordered
from tests.verify import uniform_limits as limits
from tests.verify.uniform import domain, march, rubber, section

REGIONS = ("wall", "floor", "sheath")
ALL = {LENGTHENED: 1.04, BEND: 0.6, TWISTED: -0.5}


def _scene(model: str, targets: dict[str, float], twisted: bool = True) -> Scene:
    """The short actuator, wound, under pressure."""
    size = MeshSize(section=1, half=model == "section")
    effects: list[Effect] = [law("yeoh", REGIONS), Incompressible(), ChamberPressure()]
    if targets:
        effects.append(Hold(targets))
    if model == "section":
        where = Domain(section_quadrilaterals(SHORT, size))
        effects += [TwofoldAxis() if twisted else Symmetry(), smeared(where, SHORT)]
        kind = functools.partial(Section, length=SHORT.length, twisted=twisted)
        return Scene(where, effects, kind)
    where = Domain(hexahedral_slice(SHORT, size, PITCH, 2))
    return Scene(where, effects, functools.partial(Cell, length=SHORT.length, twisted=twisted))


def _whole(targets: dict[str, float]) -> Scene:
    """The whole section of the short actuator, which bends to the side and twists."""
    where = Domain(section_quadrilaterals(SHORT, MeshSize(section=1, half=False)))
    effects = [law("yeoh", REGIONS), Incompressible(), ChamberPressure(), smeared(where, SHORT)]
    kind = functools.partial(Section, length=SHORT.length, twisted=True, sideways=True)
    return Scene(where, [*effects, Hold(targets)], kind)


@pytest.mark.parametrize(
    "model", ["section", "cell", pytest.param("whole section", marks=pytest.mark.long)]
)
def test_bordered_tangent_is_the_derivative_of_the_equations(model: str) -> None:
    whole = Bordered(_whole(ALL | {SIDE_BEND: 0.2}) if "whole" in model else _scene(model, ALL))
    scene, owned = whole.scene, whole.scene.body.owned
    scene.set_scalar(HOLD, 0.7)
    scene.set_scalar("pressure", 0.02)
    rng = np.random.default_rng(3)
    x = np.concatenate([0.02 * rng.uniform(-1, 1, owned), np.zeros(len(whole.names))])
    x[owned:] = [scene.scalar(name) + 0.03 * rng.uniform(-1, 1) for name in whole.names]
    scene.set(x[:owned])
    x[:owned] = scene.w
    v = rng.uniform(-1, 1, len(x))
    v[:owned][~scene.free[:owned]] = 0.0
    v[owned:] *= 0.05
    follow, lead = scene.body.ties
    v[follow] = v[lead]
    slope = np.asarray(
        sum(
            c * (whole.residual(x + k * 1e-4 * v) - whole.residual(x - k * 1e-4 * v)) / 1e-4
            for k, c in STENCIL
        )
    )
    product = whole.tangent(x, v)
    # what follows is no equation of its own
    product[follow] = slope[follow] = 0.0
    assert np.abs(product - slope).max() <= 2e-7 * np.abs(slope).max()
    tail = slice(owned, None)
    assert product[tail] == pytest.approx(slope[tail], abs=1e-6 * np.abs(slope[tail]).max())


def _held_tube(twist: float, n: int = 2) -> tuple[Scene, float, Torsion, Torsion]:
    """The tube at constant length and radii, twisted by so much a mm, which takes a pressure."""
    radius, length = limits.OUTER, limits.TUBE.length
    whole, core = (Torsion(limits.LAW, r, abs(twist)) for r in (radius, limits.INNER))
    pressure = -float(whole.radial_stress(np.array(limits.INNER)))
    targets = {LENGTHENED: 1.0, BEND: 0.0, TWISTED: twist * length}
    effects = [*rubber({"wall": limits.YEOH}), ChamberPressure(), Hold(targets)]
    scene = section(domain(limits.TUBE, n), limits.TUBE, effects, twisted=True)
    scene.set(scene.w.copy())
    # without the pressure the tube would buckle
    for part in np.linspace(0, 1, 11)[1:]:
        _solved(scene, part, pressure * part**2, steps=1)
    return scene, pressure, whole, core


def test_tube_held_in_length_and_twist_is_exact() -> None:
    # the centroids' line is the tube's axis: no screw about a pin has to be put in by hand
    scene, pressure, whole, core = _held_tube(0.05)
    inner, outer = limits.INNER, limits.OUTER
    points, weights = np.polynomial.legendre.leggauss(20)
    R = (outer + inner) / 2 + (outer - inner) / 2 * points
    force = math.pi * (outer - inner) * float(weights @ (whole.radial_stress(R) * R))
    force -= math.pi * inner**2 * pressure
    assert scene.scalar(TWISTED) == pytest.approx(whole.moment - core.moment, rel=1e-5)
    assert scene.scalar(LENGTHENED) == pytest.approx(force, rel=1e-5)
    assert scene.scalar(BEND) == pytest.approx(0.0, abs=1e-6)


def test_the_other_hand_turns_the_torque_round() -> None:
    right, left = (_held_tube(twist, 1)[0] for twist in (0.05, -0.05))
    assert right.scalar(TWISTED) == pytest.approx(-left.scalar(TWISTED), rel=1e-10)
    assert right.scalar(LENGTHENED) == pytest.approx(left.scalar(LENGTHENED), rel=1e-10)


def _solved(scene: Scene, share: float, pressure: float, steps: int = 5) -> None:
    """Put a scene at an equilibrium, from where it is."""
    newton = Newton(scene, scene.domain.comm, Settings(tolerance=1e-12))
    at = Equilibrium(scene, newton, Predictor(scene, None), None)
    first = scene.scalar(HOLD), scene.scalar("pressure")
    for part in np.linspace(0, 1, steps + 1)[1:]:
        for name, begin, end in zip((HOLD, "pressure"), first, (share, pressure), strict=True):
            scene.set_scalar(name, begin + part * (end - begin))
        outcome = newton.solve(scene.w.copy(), scene.natural, at.natural_conditions())
        assert outcome.converged, outcome.reason


@pytest.mark.parametrize("model", ["section", pytest.param("cell", marks=pytest.mark.long)])
def test_energy_is_the_work_of_what_holds_and_of_the_pressure(model: str) -> None:
    # dΠ_stored = N dl + M dθ + T dφ + P dV along a path on which all of them change
    scene = _scene(model, ALL)
    scene.set(scene.w.copy())
    factor = scene.body.symmetry_factor

    def at(t: float) -> tuple[float, float]:
        _solved(scene, 0.5 + t, 0.01 + 0.02 * t)
        energies = scene.energies()
        stored = factor * sum(e for key, e in energies.items() if key != "ChamberPressure")
        return stored, factor * scene.conjugate("pressure")

    at(0.0)
    h = 0.01
    change, swell = (
        sum(c * (a - b) / h for c, a, b in parts)
        for parts in zip(
            *(
                [(c, ahead, behind) for ahead, behind in zip(at(k * h), at(-k * h), strict=True)]
                for k, c in STENCIL
            ),
            strict=True,
        )
    )
    at(0.0)
    power = scene.scalar("pressure") * swell
    length = SHORT.length
    rates = {LENGTHENED: 0.04 * length, BEND: 0.6, TWISTED: -0.5}
    power += sum(scene.scalar(name) * rate for name, rate in rates.items())
    assert all(abs(scene.scalar(name)) > 1e-3 for name in rates)
    assert power == pytest.approx(change, rel=1e-7)


def test_straight_by_either_way_is_the_same_state() -> None:
    found = []
    for hold in (Hold({BEND: 0.0, LENGTHENED: 1.0}), StraightAxis(stretch=True)):
        where = domain(limits.BASELINE, 1)
        effects = [*rubber(limits.LAWS), ChamberPressure(), hold]
        scene = section(where, limits.BASELINE, effects)
        march(scene, Ramp("pressure", 0.02))
        found.append((scene.conjugate("pressure"), scene.scalar("stretch"), scene.w.copy()))
    (v, stretch, w), (other_v, other_stretch, other_w) = found
    assert v == pytest.approx(other_v, rel=1e-10)
    assert stretch == pytest.approx(other_stretch, abs=1e-12)
    assert w == pytest.approx(other_w, abs=1e-8)


def test_a_turn_that_the_symmetry_keeps_is_held_already() -> None:
    scene = _scene("section", {TWISTED: 0.0, BEND: 0.1}, twisted=False)
    assert TWISTED not in scene.natural
    with pytest.raises(ValueError, match="no such turn"):
        _scene("section", {TWISTED: 0.1}, twisted=False)


def test_what_is_not_held_costs_nothing() -> None:
    free, held = _scene("section", {}), _scene("section", ALL)
    assert free.added == {}
    assert free.natural == free.body.natural
    assert free.multipliers == 0
    assert (free.kernels, free.body.size) == (held.kernels, held.body.size)


@pytest.mark.long
def test_a_section_that_is_held_to_the_side_bends_as_far_either_way() -> None:
    names = (LENGTHENED, BEND, SIDE_BEND, TWISTED)
    found = []
    for side in (0.4, -0.4):
        # a mirror flips what turns about y and z
        targets = {BEND: 0.3, SIDE_BEND: side, LENGTHENED: 1.02, TWISTED: side / 2}
        scene = _whole(targets)
        scene.set(scene.w.copy())
        _solved(scene, 1.0, 0.01)
        line = scene.body.centre_line()  # type: ignore[attr-defined]
        assert line.rates * SHORT.length == pytest.approx([0.3, side, side / 2], rel=1e-10)
        assert line.stretch == pytest.approx(1.02, rel=1e-10)
        # no pin bears any of it
        pins = scene.fixed("pin")
        assert scene.residual()[0][pins] == pytest.approx(0.0, abs=1e-8)
        found.append([scene.scalar(name) for name in names])
    signs = np.array([1.0, 1.0, -1.0, -1.0])
    assert np.abs(found[0]).min() > 0.1
    assert found[0] == pytest.approx(signs * found[1], rel=1e-10)
