"""Contact in one step of a motion: its discrete gradients, a particle that falls, and rods."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rod.contact.impact import depth_of, pressed
from rod.contact.obstacles import Cylinder, Obstacle, Plane
from rod.contact.touch import Touch
from rod.functions import Floats
from rod.inertia import lump, spread
from rod.law import Linear
from rod.layout import Layout
from rod.loads import Weight
from rod.motion import Motion, Moving
from rod.motion.course import Course, Event, Watch
from rod.motion.equations import Equations
from rod.motion.motion import retarded
from rod.rod import Level, Rod
from tests.rod.bars import DOWN, PLANE, SPACE, Bar
from tests.rod.contact.test_touch import skin

BAR = Bar()
ON = Level(amounts=(1.0, 1.0))
HEIGHT, G = 20.0, 9810.0


@pytest.mark.parametrize("delay", [0.0, 0.1, 0.5, 2.0])
def test_a_pressure_is_that_of_one_depth(delay: float) -> None:
    """`depth_of` turns `pressed` round, whose slope is that of differences."""
    rng = np.random.default_rng(1)
    d0, d1 = rng.normal(size=(2, 2000))
    press, slope = pressed(d0, d1, delay)
    acts = (press > 0) & (np.abs(d1) > 1e-3)
    np.testing.assert_allclose(depth_of(d0, press, delay)[acts], d1[acts], atol=1e-13)
    up, down = (pressed(d0, d1 + sign * 1e-6, delay)[0] for sign in (1, -1))
    np.testing.assert_allclose(((up - down) / 2e-6)[acts], slope[acts], atol=1e-8)
    # its work is the change of the potential, and no less where it is damped
    work = press * (d1 - d0)
    stored = (np.maximum(d1, 0) ** 2 - np.maximum(d0, 0) ** 2) / 2
    assert (work - stored).min() > -1e-14
    if not delay:
        np.testing.assert_allclose(work, stored, atol=1e-14)


@pytest.mark.parametrize("strains", [PLANE, SPACE])
@pytest.mark.parametrize(
    "obstacle",
    [Plane((0.0, -14.0, 60.0), (0.2, 1.0, -0.3)), Cylinder((0.0, -40.0, 70.0), (1, 0, 0), 31.0)],
)
@pytest.mark.parametrize("keeps", [False, True])
def test_the_tangent_of_a_step_is_that_of_differences(
    strains: tuple[str, ...], obstacle: Obstacle, keeps: bool
) -> None:
    layout = BAR.layout(5, strains)
    inertia = spread(layout, [BAR.mass()])
    touch = Touch(skin(layout), obstacle, 1e-3, keeps=keeps)
    rod = Rod(layout, BAR.law(strains), inertia, [Weight(inertia, DOWN), touch])
    motion = Motion(rod, lambda time: ON, touching=0.003)
    strained = layout.at_rest()
    strained[:, strains.index("curvature")] = 0.25 / BAR.length
    rates = np.zeros_like(strained)
    rates[:, strains.index("curvature")] = 20 / BAR.length
    now = Equations(motion, motion.at(strained, rates), 1e-3)
    # pressures that are found by a step of no length: those of the depths
    change = 1e-3 * rates
    now.residual(change)
    now.stepped(0 * change)
    now.residual(change)
    tangent, columns = now.tangent(), []
    for place in np.ndindex(change.shape):
        part = np.zeros_like(change)
        part[place] = 1e-5 * motion.sizes[place]
        up, down = (now.residual(change + sign * part) for sign in (1, -1))
        columns.append((up - down).ravel() / (2 * part[place]))
    exact = np.stack(columns, axis=1)
    scale = np.outer(1 / motion.sizes.ravel(), 1 / motion.sizes.ravel())
    wrong = np.abs(tangent - exact) / scale
    # of a bar the direction turns with the step, of which the tangent has the greater part
    assert (
        wrong.max() < (1e-6 if isinstance(obstacle, Plane) else 1e-2) * np.abs(exact / scale).max()
    )


def particle(touching: float) -> tuple[Motion, Touch]:
    """One piece that shears without resistance: its end falls freely, HEIGHT over a table."""
    layout = Layout(np.array([100.0]), ("shear_y",))
    inertia = spread(layout, [BAR.mass()])
    inertia[-1] += lump(1e-5, (0.0, 0.0, 0.0))
    table = Touch(skin(layout), Plane((0.0, -5.0 - HEIGHT, 0.0), (0.0, 1.0, 0.0)), 0.5)
    law = Linear(np.zeros((1, 1)), np.zeros(1))
    rod = Rod(layout, law, inertia, [Weight(inertia, DOWN), table])
    return Motion(rod, lambda time: ON, touching=touching), table


def weight_of(motion: Motion) -> float:
    return G * float(motion.inertia[-1, 3, 3])


def momentum(motion: Motion, moving: Moving) -> float:
    return float(motion.inertia[-1, 3, 3] * moving.velocity[-1, 1, 3])


def fallen(
    motion: Motion, table: Touch, step: float, count: int
) -> tuple[list[Moving], list[Event]]:
    free = Motion(motion.rod, lambda time: Level(amounts=(1.0, 0.0)), touching=motion.touching)
    gap = Watch("table", lambda state: table.gap(state.shape, 1.0), free)
    course = Course(motion, motion.at(motion.rod.layout.at_rest()), [gap])
    states: list[Moving] = []
    events: list[Event] = []
    for passed in course.through([step * (n + 1) for n in range(count)]):
        states.append(passed.moving)
        events += passed.events
    return states, events


def test_a_particle_falls_and_bounces_to_where_it_was() -> None:
    """It touches at √(2 h/g), keeps its energy, and every impulse is a change of momentum."""
    motion, table = particle(0.0)
    states, events = fallen(motion, table, 1e-3, 300)
    fall = math.sqrt(2 * HEIGHT / G)
    assert events[0].time == pytest.approx(fall, abs=1e-8)
    assert [event.below for event in events] == [True, False] * (len(events) // 2) + [True] * (
        len(events) % 2
    )
    # a bounce takes as long as to fall and to rise, and a contact that is short against it
    touches = np.array([event.time for event in events if event.below])
    assert len(touches) >= 2
    np.testing.assert_allclose(np.diff(touches), 2 * fall, rtol=0.05)
    energy = [state.energy.total for state in states]
    most = max(state.energy.kinetic for state in states)
    assert np.ptp(energy) < 1e-10 * most
    assert max(float(state.places[-1, 1]) for state in (s.shape for s in states[40:])) > -0.05
    time, impulse = 0.0, 0.0
    for state in states:
        impulse += (state.pushes[0].force[1] - weight_of(motion)) * (state.time - time)
        time = state.time
    assert impulse == pytest.approx(momentum(motion, states[-1]), rel=1e-9)


@pytest.mark.parametrize("step", [1e-3, 5e-3])
def test_a_particle_that_is_damped_comes_to_rest_on_the_table(step: float) -> None:
    """There it is pushed by its weight; what its fall had is what damping took."""
    motion, table = particle(5e-3)
    states, events = fallen(motion, table, step, round(0.3 / step))
    last = states[-1]
    assert [event.below for event in events] == [True]
    assert last.pushes[0].force[1] == pytest.approx(weight_of(motion), rel=1e-6)
    assert abs(last.velocity).max() < 1e-3
    taken = [state.work.touch for state in states]
    assert np.diff(taken).min() > -1e-15
    lost = last.work.lost
    assert lost == pytest.approx(weight_of(motion) * HEIGHT, rel=1e-2)
    assert last.energy.total + lost == pytest.approx(states[0].energy.total, rel=1e-9)


def dropped(step: float, damping: float) -> tuple[Floats, float, Moving]:
    """A cantilever that falls on a table: its strains after 0.4 s, and the mean last force, N."""
    layout = BAR.layout(8)
    inertia = spread(layout, [BAR.mass()])
    table = Touch(skin(layout), Plane((0.0, -25.0, 0.0), (0.0, 1.0, 0.0)), 0.05)
    rod = Rod(layout, BAR.law(PLANE), inertia, [Weight(inertia, DOWN), table])
    motion = Motion(rod, lambda time: ON, retarded(rod, damping), touching=damping)
    start = motion.at(layout.at_rest())
    *states, last = motion.run(start, step, round(0.8 / step))
    open_ = [each.energy.total - start.energy.total - each.work.gained for each in [*states, last]]
    print(f"damped contact: {np.abs(open_).max():.1e} mJ of {last.work.lost:.2g} mJ taken")
    assert np.abs(open_).max() < 1e-8 < last.work.touch
    force = np.mean([state.pushes[0].force[1] for state in [*states[-9:], last]])
    held = float(table.touched(last.shape, 1.0).force[1])
    assert force == pytest.approx(held, rel=2e-2)
    return last.strains, float(force), last


def test_a_rod_comes_to_rest_in_its_equilibrium_on_a_table() -> None:
    from rod.statics import Path, solve

    strains, force, last = dropped(4e-3, 0.01)
    rod = last.shape
    layout = rod.layout
    inertia = spread(layout, [BAR.mass()])
    table = Touch(skin(layout), Plane((0.0, -25.0, 0.0), (0.0, 1.0, 0.0)), 0.05)
    still = Rod(layout, BAR.law(PLANE), inertia, [Weight(inertia, DOWN), table])
    state = solve(still, strains, Path(ON, ON), 1.0)
    apart = np.linalg.norm(state.shape.places - last.shape.places, axis=1).max()
    assert apart < 2e-3
    assert force == pytest.approx(float(table.touched(state.shape, 1.0).force[1]), rel=2e-2)


def test_no_step_passes_through_a_thin_bar() -> None:
    """A step of the tip by far more than a bar is halved until the bar is met."""
    layout = BAR.layout(6)
    inertia = spread(layout, [BAR.mass()])
    bar = Touch(skin(layout), Cylinder((0.0, -16.0, 100.0), (1.0, 0.0, 0.0), 2.0), 0.05)
    rod = Rod(layout, BAR.law(PLANE), inertia, [Weight(inertia, DOWN), bar])
    motion = Motion(rod, lambda time: ON, retarded(rod, 0.004), touching=0.004)
    rates = np.zeros(layout.shape)
    rates[:, 1] = 25 / BAR.length
    *_, last = motion.run(motion.at(layout.at_rest(), rates), 0.03, 5)
    # over the bar at last, not below it
    place = last.shape.along(np.array([100.0]))[0, :, 3]
    assert place[1] > -16.0
