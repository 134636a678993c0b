"""Rods at rest that touch something, beside closed forms."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rod.contact.obstacles import Cylinder, Obstacle, Plane, Sphere
from rod.contact.skin import Outline, Skin, face, ring, side
from rod.contact.touch import Touch
from rod.inertia import SectionMass, spread
from rod.law import Linear
from rod.layout import Layout
from rod.loads import TipForce, Weight
from rod.rod import Level, Rod
from rod.statics import Path, State, march, solve, steps
from tests.rod.bars import PLANE, SPACE, Bar

BAR = Bar()
LINE = Outline(np.zeros((1, 2)), np.ones(1))
"""The rod's own line: what touches is its axis."""
STIFF = 1000.0
"""MPa/mm."""
CORNERS = ((-8.0, -5.0), (8.0, -5.0), (8.0, 5.0), (-8.0, 5.0))


def tip(layout: Layout) -> Skin:
    """One point of 1 mm² in the middle of the last section."""
    last, first = np.array([len(layout.lengths) - 1]), np.zeros(1, dtype=np.intp)
    return Skin(last, np.ones(1), np.ones(1), first, np.zeros((1, 2)), np.ones(1))


def ending(states: list[State]) -> State:
    """The last one, of a stable rod."""
    assert [state.unstable for state in states] == [0] * len(states)
    return states[-1]


def bending(bar: Bar) -> float:
    """EI."""
    return bar.young * bar.second


def test_a_cantilever_with_a_stop_at_its_tip() -> None:
    """The stop takes what bends the tip beyond its gap: F_stop = 3 EI/L³ (δ_free − gap)."""
    bar, gap = BAR, 0.01
    layout = bar.layout(60)
    load, at = 1e-3, 30
    stop = Touch(tip(layout), Plane((0.0, -gap, 0.0), (0.0, 1.0, 0.0)), STIFF)
    # a dead force at half the length, as a weight of one frame
    masses = np.zeros((61, 4, 4))
    masses[at, 3, 3] = 1.0
    rod = Rod(layout, bar.law(PLANE), terms=[Weight(masses, (0.0, -load, 0.0)), stop])
    path = Path(Level(amounts=(0.0, 1.0)), Level(amounts=(1.0, 1.0)))
    walked = list(steps(rod, layout.at_rest(), path, [0.25, 0.5, 0.75, 1.0]))
    free = 5 / 48 * load * bar.length**3 / bending(bar)
    exact = 3 * bending(bar) / bar.length**3 * (free - gap)
    state = ending([step.state for step in walked])
    found = stop.touched(state.shape, 1.0)
    assert found.force[1] == pytest.approx(exact, rel=1e-3)
    assert found.force[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert found.gap == pytest.approx(-exact / STIFF, rel=0.01)
    touch = [step.state.share for step in walked if step.touches == (1,)]
    # a fourth of the load from target to target, a thousandth of which is the touch known to
    assert touch == [pytest.approx(gap / free, abs=1e-3 / 4 + 1e-3 * gap / free)]


def lying(pieces: int, height: float) -> tuple[Touch, State, Bar, float]:
    """A bar that is clamped above a table and lies on it with its end."""
    bar = BAR
    layout = bar.layout(pieces, ("curvature",))
    weight = bar.density * bar.area * 9810
    skin = side(layout, LINE, 1.0)
    table = Touch(skin, Plane((0.0, -height, 0.0), (0.0, 1.0, 0.0)), STIFF)
    masses = spread(layout, [SectionMass(bar.density * bar.area)])
    law = Linear(np.array([[bending(bar)]]), np.zeros(1))
    rod = Rod(layout, law, masses, [Weight(masses, (0.0, -9810.0, 0.0)), table])
    path = Path(Level(amounts=(0.0, 1.0)), Level(amounts=(1.0, 1.0)))
    states = march(rod, layout.at_rest(), path, np.linspace(0.02, 1.0, 50).tolist())
    return table, ending(states), bar, weight


def test_a_strip_lies_on_a_table() -> None:
    """Clamped at a height h over it, it is free over a = (72 EI h/q)^¼ (beams, small slopes).

    At the end of a slope and moment vanish: there a force F = q a/3 presses, and beyond it the
    table carries the weight alone.
    """
    height = 0.5
    table, state, bar, weight = lying(100, height)
    reach = (72 * bending(bar) * height / weight) ** 0.25
    force = weight * (bar.length - reach) + weight * reach / 3
    found = table.touched(state.shape, 1.0)
    assert found.force[1] == pytest.approx(force, rel=1e-3)
    # stations are 1 mm apart
    assert found.length == pytest.approx(bar.length - reach, abs=1.5)
    assert -1e-4 < found.gap < 0


def test_root_and_obstacle_balance_the_load() -> None:
    """Newton's third law: the root's force is that of the load and the obstacle together."""
    layout = BAR.layout(30)
    outline = ring(CORNERS, 4.0)
    skin = side(layout, outline, 1.5).joined(face(layout, outline))
    bar = Touch(skin, Cylinder((0.0, -17.0, 70.0), (1.0, 0.0, 0.0), 10.0), 50.0)
    load = np.array([0.0, -0.3, 0.05])
    rod = Rod(layout, BAR.law(PLANE), terms=[TipForce(load), bar])
    path = Path(Level(amounts=(0.0, 1.0)), Level(amounts=(1.0, 1.0)))
    state = ending(march(rod, layout.at_rest(), path, np.linspace(0.1, 1.0, 10).tolist()))
    found = bar.touched(state.shape, 1.0)
    assert found.force[1] > 0.3
    # forces of the first piece, as its own half beyond the root sees them, are those at the root
    stretch, curvature = state.strains[0]
    tension = BAR.young * BAR.area * (stretch - 1)
    moment = bending(BAR) * curvature
    total, about = load + found.force, np.cross(state.shape.places[-1], load) + found.moment
    # a piece's strain is the mean of the forces along it: at the middle of the arc
    middle = state.shape.between(np.array([0]), np.array([0.5]))[0]
    arm = np.cross(middle[:, 3], total)
    assert middle[:, 2] @ total == pytest.approx(tension, rel=1e-3)
    assert (about - arm)[0] == pytest.approx(moment, rel=1e-3)


def around(turn: Rotation, shift: np.ndarray) -> tuple[State, Touch, Obstacle]:
    """A bar bent in space around a cylinder, the whole scene turned and moved."""
    plain = BAR.layout(16, SPACE)
    layout = dataclasses.replace(plain, rotation=turn.as_matrix(), place=shift)
    outline = ring(CORNERS, 4.0)
    center = turn.apply([4.0, -22.0, 80.0]) + shift
    bar = Cylinder(center, turn.apply([1.0, 0.3, 0.2]), 15.0)
    touch = Touch(side(layout, outline, 3.0).joined(face(layout, outline)), bar, 20.0)
    load = turn.apply([0.02, -0.25, 0.0])
    rod = Rod(layout, BAR.law(SPACE), terms=[TipForce(load), touch])
    path = Path(Level(amounts=(0.0, 1.0)), Level(amounts=(1.0, 1.0)))
    return ending(march(rod, layout.at_rest(), path, [0.25, 0.5, 0.75, 1.0])), touch, bar


def test_a_scene_that_is_turned_is_the_same() -> None:
    state, touch, _ = around(Rotation.identity(), np.zeros(3))
    turn, shift = Rotation.from_rotvec([0.7, -1.1, 0.4]), np.array([10.0, -20.0, 30.0])
    other, turned, _ = around(turn, shift)
    force = touch.touched(state.shape, 1.0).force
    assert np.linalg.norm(force) > 0.1
    np.testing.assert_allclose(other.strains, state.strains, rtol=0, atol=1e-10)
    np.testing.assert_allclose(turned.touched(other.shape, 1.0).force, turn.apply(force), rtol=1e-7)


def test_what_touches_nothing_changes_no_bit() -> None:
    layout = BAR.layout(12, SPACE)
    load = TipForce((0.01, -0.05, 0.0))
    outline = ring(CORNERS, 4.0)
    far = Touch(side(layout, outline, 3.0), Plane((0.0, -200.0, 0.0), (0.0, 1.0, 0.0)), 20.0)
    path = Path(Level(amounts=(0.0, 1.0)), Level(amounts=(1.0, 1.0)))
    without = march(
        Rod(layout, BAR.law(SPACE), terms=[load]), layout.at_rest(), path_of(1), [0.5, 1]
    )
    beside = march(Rod(layout, BAR.law(SPACE), terms=[load, far]), layout.at_rest(), path, [0.5, 1])
    for one, other in zip(without, beside, strict=True):
        np.testing.assert_array_equal(one.strains, other.strains)


def path_of(terms: int) -> Path:
    """The first term grows from nothing to all; the others act."""
    rest = (1.0,) * (terms - 1)
    return Path(Level(amounts=(0.0, *rest)), Level(amounts=(1.0, *rest)))


@pytest.mark.parametrize("stiffness", [1.0, 100.0, 1e4])
def test_a_stiff_obstacle_costs_no_iteration(stiffness: float) -> None:
    """And forces do not depend on it: overlap falls as 1/k."""
    layout = BAR.layout(30)
    outline = ring(CORNERS, 4.0)
    skin = side(layout, outline, 1.5).joined(face(layout, outline))
    table = Touch(skin, Plane((0.0, -25.0, 0.0), (0.0, 1.0, 0.0)), stiffness)
    law = dataclasses.replace(BAR.law(PLANE), thrust=np.array([0.0, 1400.0]))
    rod = Rod(layout, law, terms=[table])
    path = Path(Level(amounts=(1.0,)), Level(1.0 / 40, (1.0,)))
    walked = list(steps(rod, layout.at_rest(), path, np.linspace(0.05, 1.0, 20).tolist()))
    assert sum(step.state.iterations for step in walked) < 5 * len(walked)
    found = table.touched(ending([step.state for step in walked]).shape, 1.0)
    assert found.force[1] == pytest.approx(0.47394, abs=2e-5)
    assert found.gap == pytest.approx(-found.force[1] / (stiffness * found.area), rel=0.5)


def test_a_column_that_leans_on_a_wall_is_stable() -> None:
    """Beyond Euler's load a column falls; a stop beside its tip carries it up to 2.046 π² EI/L²."""
    layout = BAR.layout(48, ("curvature",))
    law = Linear(np.array([[bending(BAR)]]), np.zeros(1))
    euler = math.pi**2 * bending(BAR) / BAR.length**2

    def unstable(load: float, *terms: Touch) -> int:
        rod = Rod(layout, law, terms=[TipForce((0.0, 0.0, -load)), *terms])
        whole = Path(Level(), Level(amounts=(1.0,) * (1 + len(terms))))
        return solve(rod, layout.at_rest(), whole, 1.0).unstable

    stop = Touch(tip(layout), Plane(np.zeros(3), (0.0, 1.0, 0.0)), STIFF)
    assert [unstable(part * euler) for part in (0.249, 0.251, 2.3)] == [0, 1, 2]
    assert [unstable(part * euler, stop) for part in (0.251, 2.0, 2.1)] == [0, 0, 1]


PUSHED: dict[str, Obstacle] = {
    "plane": Plane((0.0, 0.0, 0.0), (0.0, -2.0, 0.0)),
    "sphere": Sphere((0.0, 5.0, BAR.length), 5.0),
    "bar": Cylinder((0.0, 5.0, BAR.length), (1.0, 0.0, 0.0), 5.0),
    "face of a cylinder": Cylinder((0.0, 6.0, BAR.length), (0.0, 1.0, 0.0), 3.0, 12.0),
}


@pytest.mark.parametrize("name", PUSHED)
def test_an_obstacle_that_is_pushed(name: str) -> None:
    """A stop that is moved by u against the tip of a cantilever: 3 EI u/L³; the amount is a way."""
    layout = BAR.layout(48)
    stop = Touch(tip(layout), PUSHED[name], STIFF, travel=(0.0, -3.0, 0.0))
    rod = Rod(layout, BAR.law(PLANE), terms=[stop])
    state = solve(rod, layout.at_rest(), Path(Level(), Level(amounts=(0.02,))), 1.0)
    force = stop.touched(state.shape, 0.02).force
    assert force[1] == pytest.approx(-3 * bending(BAR) / BAR.length**3 * 0.02, rel=1e-3)
