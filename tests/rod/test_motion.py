"""Motion: energy, order, damping, and what is known of small vibrations."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest

from rod.functions import Floats
from rod.layout import STRAINS
from rod.loads import TipMoment, Weight
from rod.modes import modes
from rod.motion import Motion, Moving
from rod.rod import Level, Rod
from rod.shape import Shape
from rod.statics import NoEquilibriumError, Path, march, solve
from tests.rod.bars import DOWN, PLANE, SPACE, Bar, both

BAR = Bar()
WEIGHT = Level(amounts=(1.0,))


def kinetic(rod: Rod, moving: Moving) -> float:
    return float(np.sum(moving.velocity @ rod.inertia * moving.velocity)) / 2


def bent_rod(rod: Rod, angle: float = -0.6) -> Floats:
    strains = rod.layout.at_rest()
    strains[:, rod.layout.strains.index("curvature")] = angle / BAR.length
    if "twist" in rod.layout.strains:
        strains[:, rod.layout.strains.index("side_curvature")] = 0.5 / BAR.length
        strains[:, rod.layout.strains.index("twist")] = 0.6 / BAR.length
    return strains


@pytest.mark.parametrize(
    ("strains", "step", "count"),
    [
        (PLANE, 1e-3, 1000),
        (SPACE, 1e-3, 400),
        (STRAINS, 5e-4, 200),
        pytest.param(PLANE, 1e-3, 10_000, marks=pytest.mark.verify),
    ],
)
def test_energy_is_kept(strains: tuple[str, ...], step: float, count: int) -> None:
    """Released from 0.6 rad upward under its weight, it swings through more than 3 rad."""
    rod = BAR.rod(6, strains)
    motion = Motion(rod, lambda time: WEIGHT)
    start = motion.at(bent_rod(rod))
    first = motion.energy(start)
    worst, most, angles = 0.0, 0.0, []
    for moving in motion.run(start, step, count):
        worst = max(worst, abs(motion.energy(moving) - first))
        most = max(most, kinetic(rod, moving))
        angles.append(float(np.sum(rod.layout.weights("curvature") * moving.strains)))
    assert worst < 1e-9 * most
    assert np.ptp(angles) > 0.5
    assert moving.time == pytest.approx(step * count)
    turns = moving.frames[..., :3]
    np.testing.assert_allclose(
        np.swapaxes(turns, 1, 2) @ turns, np.tile(np.eye(3), (7, 1, 1)), atol=1e-12
    )


@dataclasses.dataclass(frozen=True)
class Cushion:
    """Π = a k d⁴/4 of the depths d of frames below a floor: a potential that begins smoothly."""

    height: float = -20.0
    stiffness: float = 1e-3
    conservative: bool = True

    def _depths(self, shape: Shape) -> Floats:
        return np.maximum(self.height - shape.places[:, 1], 0.0)

    def potential(self, shape: Shape, amount: float) -> float:
        """See `Term`."""
        return amount * self.stiffness / 4 * float(np.sum(self._depths(shape) ** 4))

    def _loads(self, shape: Shape, amount: float) -> Floats:
        loads = np.zeros_like(shape.frames)
        loads[:, 1, 3] = amount * self.stiffness * self._depths(shape) ** 3
        return loads

    def residual(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return -shape.pulled(self._loads(shape, amount))

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        out = -shape.curved(self._loads(shape, amount))
        for frame, depth in enumerate(self._depths(shape)):
            moves = shape.jacobian(frame)[0][1]
            out += 3 * amount * self.stiffness * depth**2 * np.outer(moves, moves)
        return out

    def growth(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return self.residual(shape, 1.0)


@pytest.mark.parametrize("strains", [PLANE, SPACE])
def test_energy_is_kept_by_any_term_with_a_potential(strains: tuple[str, ...]) -> None:
    """It falls onto a floor that is soft, touches it and lifts off."""
    plain = BAR.rod(6, strains)
    rod = Rod(plain.layout, plain.law, plain.inertia, (Weight(plain.inertia, DOWN), Cushion()))
    motion = Motion(rod, lambda time: Level(amounts=(1.0, 1.0)))
    start = motion.at(bent_rod(rod))
    first = motion.energy(start)
    worst, most, held = 0.0, 0.0, []
    for moving in motion.run(start, 1e-3, 300):
        worst = max(worst, abs(motion.energy(moving) - first))
        most = max(most, kinetic(rod, moving))
        held.append(Cushion().potential(rod.shape(moving.strains), 1.0))
    assert worst < 1e-9 * most
    assert max(held) > 0.1 * most
    assert held[-1] < max(held) / 2


def test_a_large_step_is_halved_and_keeps_the_energy() -> None:
    rod = BAR.rod(12, SPACE)
    motion = Motion(rod, lambda time: WEIGHT)
    start = motion.at(bent_rod(rod))
    first = motion.energy(start)
    *_, moving = motion.run(start, 2e-3, 60)
    assert moving.time == pytest.approx(0.12)
    assert motion.energy(moving) == pytest.approx(first, rel=1e-9)


def rising(time: float) -> Level:
    """A pressure and a weight that begin and end smoothly."""
    share = math.sin(math.pi * min(time / 0.2, 1.0) / 2) ** 2
    return Level(amounts=(share, share, share))


@pytest.mark.parametrize("strains", [PLANE, SPACE])
def test_the_scheme_is_of_second_order(strains: tuple[str, ...]) -> None:
    tip = both((0.0, -0.01, 0.0), (1.0, 2.0, 1.0) if strains is SPACE else (2.0, 0.0, 0.0))
    rod = BAR.rod(4, strains, tip)
    viscosity = 0.003 * np.diag(rod.law.hessian(rod.layout.at_rest(), 0.0)[0])
    ends = []
    for step in (4e-3, 2e-3, 1e-3, 5e-4):
        motion = Motion(rod, rising, viscosity, drag=0.5)
        *_, last = motion.run(motion.at(rod.layout.at_rest()), step, round(0.2 / step))
        ends.append(last.frames[-1, :, 3])
    changes = [np.linalg.norm(b - a) for a, b in itertools.pairwise(ends)]
    orders = [math.log2(a / b) for a, b in itertools.pairwise(changes)]
    assert orders[-1] == pytest.approx(2.0, abs=0.1), orders


def test_a_small_vibration_has_its_frequency_and_decay() -> None:
    """η = b K and a drag a: ζ = (b ω + a/ω)/2, ω_d = ω √(1 − ζ²).

    The midpoint rule's own frequency is off by (ω Δt)²/12 of it.
    """
    rod = BAR.rod(8, PLANE, gravity=(0.0, 0.0, 0.0))
    rest = rod.layout.at_rest()
    found = modes(rod, rod.shape(rest), Level(), 1)
    omega, shape = 2 * math.pi * found.frequencies[0], found.strains[0]
    viscous, drag = 0.004, 0.8
    stiffness = np.diag(rod.law.hessian(rest, 0.0)[0])
    motion = Motion(rod, lambda time: Level(), viscous * stiffness, drag)
    ratio = (viscous * omega + drag / omega) / 2
    size = 1e-6 / np.abs(shape).max()
    step, periods = 2 * math.pi / omega / 400, 2
    start = motion.at(rest + size * shape)
    mass = rod.shape(rest).mass(rod.inertia)
    for moving in motion.run(start, step, 400 * periods):
        amplitude = float(shape.ravel() @ mass @ (moving.strains - rest).ravel()) / size
        damped = omega * math.sqrt(1 - ratio**2)
        phase = damped * moving.time
        decay = math.exp(-ratio * omega * moving.time)
        exact = decay * (math.cos(phase) + ratio * omega / damped * math.sin(phase))
        assert amplitude == pytest.approx(exact, abs=1e-3)


def test_damping_takes_energy_until_it_rests() -> None:
    rod = BAR.rod(8, SPACE)
    viscosity = 0.001 * np.diag(rod.law.hessian(rod.layout.at_rest(), 0.0)[0])
    motion = Motion(rod, lambda time: WEIGHT, viscosity, drag=20.0)
    start = motion.at(bent_rod(rod))
    energies = [motion.energy(start)]
    for moving in motion.run(start, 5e-3, 400):
        energies.append(motion.energy(moving))
    assert np.diff(energies).max() < 1e-10 * np.ptp(energies)
    still = march(rod, rod.layout.at_rest(), Path(Level(), WEIGHT), [0.5, 1.0])[-1]
    np.testing.assert_allclose(moving.frames[..., 3], still.shape.places, atol=1e-5)
    assert kinetic(rod, moving) < 1e-9 * np.ptp(energies)


def test_a_moment_does_the_work_that_energy_gains() -> None:
    moment = 2.0
    rod = BAR.rod(6, PLANE, [TipMoment((moment, 0.0, 0.0))])
    motion = Motion(rod, lambda time: Level(amounts=(0.0, 1.0)))
    start = motion.at(rod.layout.at_rest())
    first = motion.energy(start)
    for moving in motion.run(start, 1e-3, 200):
        angle = float(np.sum(rod.layout.weights("curvature") * moving.strains))
        gained = motion.energy(moving) - first
        assert gained == pytest.approx(moment * angle, abs=1e-9)


def test_rates_are_those_it_began_with() -> None:
    rod = BAR.rod(5, STRAINS)
    motion = Motion(rod, lambda time: Level())
    rates = np.random.default_rng(1).normal(size=rod.layout.shape)
    start = motion.at(bent_rod(rod), rates, time=2.0)
    np.testing.assert_allclose(motion.rates(start), rates, rtol=1e-8, atol=1e-9)
    assert start.time == 2.0


def test_what_cannot_move_is_refused() -> None:
    bare = Rod(BAR.layout(3), BAR.law(PLANE))
    with pytest.raises(ValueError, match="without inertia"):
        Motion(bare, lambda time: Level())
    for viscosity, drag in ((-1.0, 0.0), (0.0, -1.0)):
        with pytest.raises(ValueError, match="zero or more"):
            Motion(BAR.rod(3), lambda time: Level(), viscosity, drag)
    motion = Motion(BAR.rod(3), lambda time: Level(amounts=(math.nan,)))
    with pytest.raises(NoEquilibriumError, match="does not converge"):
        motion.step(motion.at(BAR.layout(3).at_rest()), 1e-3)


def test_a_rod_at_rest_in_equilibrium_stays() -> None:
    rod = BAR.rod(8, PLANE)
    state = solve(rod, rod.layout.at_rest(), Path(Level(), WEIGHT), 0.4)
    motion = Motion(rod, lambda time: state.level)
    for moving in motion.run(motion.at(state.strains), 5e-3, 20):
        np.testing.assert_allclose(moving.strains, state.strains, atol=1e-12)
