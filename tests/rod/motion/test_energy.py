"""Where the energy of a moving rod goes: contact, following loads, air, damping; back in time."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipk

from rod.contact.obstacles import Plane
from rod.contact.touch import Touch
from rod.functions import Floats
from rod.inertia import SectionMass, lump, spread
from rod.law import Linear, Zones
from rod.layout import Layout
from rod.loads import TipForce, TipMoment, Weight
from rod.motion import Motion, Moving
from rod.motion.air import Swelling
from rod.motion.motion import retarded
from rod.rod import Level, Rod
from tests.rod.bars import DOWN, PLANE, SPACE, Bar
from tests.rod.contact.test_touch import skin

BAR = Bar()
ON = Level(amounts=(1.0, 1.0))


def chambered(strains: tuple[str, ...], pieces: int = 8) -> Rod:
    """A bar with a chamber of a third of its section above its line, under its weight."""
    layout = BAR.layout(pieces, strains)
    area, arm = BAR.area / 3, 2.0
    thrust = np.array([{"stretch": area, "curvature": area * arm}.get(s, 0.0) for s in strains])
    law = dataclasses.replace(BAR.law(strains), area=area, thrust=thrust)
    inertia = spread(layout, [BAR.mass()])
    return Rod(layout, law, inertia, [Weight(inertia, DOWN)])


def drift(motion: Motion, start: Moving, step: float, count: int) -> tuple[float, Moving]:
    """Greatest part of the energy that the balance leaves open, and the last state."""
    worst, most = 0.0, 0.0
    for moving in motion.run(start, step, count):
        left = moving.energy.total - start.energy.total - moving.work.gained
        worst, most = max(worst, abs(left)), max(most, moving.energy.kinetic)
    return worst / most, moving


@pytest.mark.parametrize("strains", [PLANE, SPACE])
def test_every_part_of_the_energy_is_accounted_for(strains: tuple[str, ...]) -> None:
    """A pressure that comes and goes, weight, a following force, viscosity and drag at once."""
    rod = chambered(strains)
    load = TipForce((0.0, 0.004, 0.002), follows=True)
    moment = TipMoment((0.3, 0.2, 0.0))
    rod = Rod(rod.layout, rod.law, rod.inertia, [*rod.terms, load, moment])
    motion = Motion(
        rod,
        lambda time: Level(0.01 * math.sin(20 * time), (1.0, min(time / 0.1, 1.0), 1.0)),
        retarded(rod, 0.004),
        drag=0.7,
    )
    worst, moving = drift(motion, motion.at(rod.layout.at_rest()), 2e-3, 150)
    print(f"balance of everything at once: {worst:.1e} of the greatest kinetic energy")
    assert worst < 1e-9
    work = moving.work
    assert min(abs(work.air), abs(work.loads), work.viscous, work.drag) > 1e-4
    assert 0 < work.dropped < 1e-4 * work.lost


def test_contact_keeps_the_energy() -> None:
    """A bar that falls on a floor, again and again."""
    layout = BAR.layout(8)
    inertia = spread(layout, [BAR.mass()])
    floor = Touch(skin(layout), Plane((0.0, -25.0, 0.0), (0.0, 1.0, 0.0)), 0.05)
    rod = Rod(layout, BAR.law(PLANE), inertia, [Weight(inertia, DOWN), floor])
    motion = Motion(rod, lambda time: ON)
    start, touched = motion.at(layout.at_rest()), []
    worst = most = 0.0
    for moving in motion.run(start, 1e-3, 400):
        worst = max(worst, abs(moving.energy.total - start.energy.total))
        most = max(most, moving.energy.kinetic)
        touched.append(floor.touched(moving.shape, 1.0).area > 0)
    print(f"contact: {worst:.1e} mJ of {most:.2g} mJ of motion")
    assert worst < 1e-8
    assert 0.05 < np.mean(touched) < 0.9


def test_it_runs_back_in_time() -> None:
    rod = BAR.rod(6, SPACE)
    motion = Motion(rod, lambda time: Level(amounts=(1.0,)))
    strains = rod.layout.at_rest()
    strains[:, 1], strains[:, 3] = -0.6 / BAR.length, 0.4 / BAR.length
    start = motion.at(strains)
    *_, there = motion.run(start, 2e-3, 100)
    assert np.abs(there.frames - start.frames).max() > 10
    turned = dataclasses.replace(
        there, velocity=-there.velocity, rate=-there.rate, ahead=-there.rate
    )
    *_, back = motion.run(turned, 2e-3, 100)
    apart = np.linalg.norm(back.frames[:, :, 3] - start.frames[:, :, 3], axis=1).max()
    print(f"back in time: {apart:.1e} mm")
    np.testing.assert_allclose(back.frames, start.frames, atol=2e-7)
    np.testing.assert_allclose(back.velocity, -start.velocity, atol=1e-4)


def hinged(length: float = 100.0) -> Rod:
    """A stiff massless bar with a mass at its end on a hinge: a thousandth of a mm that bends."""
    layout = Layout(np.array([1e-3, length / 2, length / 2]), ("curvature",))
    inertia = spread(layout, [SectionMass(0.0)])
    inertia[-1] += lump(1e-5, (0.0, 0.0, 0.0), 1e-9 * np.eye(3))
    inertia[-2] += lump(1e-9, (0.0, 0.0, 0.0), 1e-9 * np.eye(3))
    loose, stiff = (Linear(np.full((1, 1), ei), np.zeros(1)) for ei in (0.0, 1e7))
    law = Zones([loose, stiff], [0, 1, 1])
    return Rod(layout, law, inertia, [Weight(inertia, DOWN)])


def test_a_pendulum_has_its_period_and_momentum() -> None:
    """T = 4 √(l/g) K(sin² θ₀/2) of a mass point at the length l, from 80° on.

    Its momentum at the lowest point is m √(2 g l (1 − cos θ₀)).
    """
    length, most = 100.0, math.radians(80)
    rod = hinged(length)
    motion = Motion(rod, lambda time: Level(amounts=(1.0,)))
    # straight along z, gravity along −y: the bend by which it hangs is 90°
    strains = np.zeros((3, 1))
    strains[0] = (math.pi / 2 - most) / 1e-3
    period = 4 * math.sqrt(length / 9810) * ellipk(math.sin(most / 2) ** 2)
    start = motion.at(strains)
    count = 400
    states = list(motion.run(start, period / count, count))
    angle = [float(state.strains[0, 0]) * 1e-3 - math.pi / 2 for state in states]
    assert angle[-1] == pytest.approx(-most, abs=2e-3)
    assert angle[count // 2 - 1] == pytest.approx(most, abs=1e-3)
    momentum = 1e-5 * np.linalg.norm(states[count // 4 - 1].velocity[-1, :, 3])
    exact = 1e-5 * math.sqrt(2 * 9810 * length * (1 - math.cos(most)))
    print(f"pendulum: {abs(angle[-1] + most):.1e} rad, momentum {abs(momentum / exact - 1):.1e}")
    assert momentum == pytest.approx(exact, rel=1e-4)


@dataclasses.dataclass(frozen=True)
class Closed:
    """A chamber without valves: (P + P₀) V^n stays."""

    exponent: float = 1.4
    outside: float = 0.1

    def passed(
        self, time: float, step: float, pressure: float, swelling: Swelling
    ) -> tuple[float, float]:
        """See `rod.motion.air.Air`."""
        before, after = swelling.volume, swelling.volume + swelling.growth

        def at(volume: float) -> float:
            return (pressure + self.outside) * (before / volume) ** self.exponent - self.outside

        mean = quad(lambda share: at(before + share * (after - before)), 0.0, 1.0)[0]
        return at(after), float(mean)


def test_air_in_a_closed_chamber_is_a_spring() -> None:
    """It keeps its amount, and the work it does is what its inner energy loses."""
    rod, air = chambered(PLANE), Closed()
    strains = rod.layout.at_rest()
    strains[:, 1] = -0.8 / BAR.length
    states, balance = [], []
    for step in (4e-3, 2e-3, 1e-3, 5e-4):
        motion = Motion(rod, lambda time: Level(amounts=(1.0,)), retarded(rod, 0.004), air=air)
        start = motion.at(strains, pressure=0.02)
        worst, moving = drift(motion, start, step, round(0.2 / step))
        assert worst < 1e-8
        inner = [
            (s.pressure + air.outside) * rod.volume(s.strains, s.pressure) / (air.exponent - 1)
            for s in (start, moving)
        ]
        outer = air.outside * np.diff([rod.volume(s.strains, s.pressure) for s in (start, moving)])
        balance.append(float(moving.work.air + outer[0] + inner[1] - inner[0]))
        states.append(moving.frames[-1, :, 3])
        amounts = [
            (s.pressure + air.outside) * rod.volume(s.strains, s.pressure) ** air.exponent
            for s in (start, moving)
        ]
        assert amounts[1] == pytest.approx(amounts[0], rel=1e-9)
    print(f"closed air: {max(map(abs, balance)) / abs(moving.work.air):.1e} of the air's work")
    assert abs(moving.pressure - 0.02) > 1e-4
    assert max(map(abs, balance)) < 1e-9 < abs(moving.work.air)
    changes = [np.linalg.norm(b - a) for a, b in itertools.pairwise(states)]
    assert math.log2(changes[-2] / changes[-1]) == pytest.approx(2.0, abs=0.2)


def test_an_order_by_steps_that_end_at_corners() -> None:
    """A pressure by a ramp: halved steps quarter the error, printed with pytest -s."""
    rod = chambered(PLANE)
    ends: list[Floats] = []
    for step in (4e-3, 2e-3, 1e-3, 5e-4):
        motion = Motion(
            rod, lambda time: Level(0.01 * min(time / 0.1, 1.0), (1.0,)), retarded(rod, 0.003)
        )
        *_, last = motion.run(motion.at(rod.layout.at_rest()), step, round(0.2 / step))
        ends.append(last.frames[-1, :, 3])
    changes = [float(np.linalg.norm(b - a)) for a, b in itertools.pairwise(ends)]
    orders = [math.log2(a / b) for a, b in itertools.pairwise(changes)]
    print("order of the scheme:", *(f"{order:.2f}" for order in orders))
    assert orders[-1] == pytest.approx(2.0, abs=0.1)


@pytest.mark.verify
def test_the_balance_drifts_less_than_a_millionth_in_ten_thousand_steps() -> None:
    rod = chambered(PLANE)
    motion = Motion(rod, lambda time: Level(0.01, (1.0,)))
    worst, _ = drift(motion, motion.at(rod.layout.at_rest()), 5e-3, 10_000)
    print(f"drift: {worst:.1e} of the greatest kinetic energy")
    assert worst < 1e-6
