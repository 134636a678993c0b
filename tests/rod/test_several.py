"""Several rods solved together, and contact between them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rod.contact.hull import Hull
from rod.contact.obstacles import Plane
from rod.contact.skin import ring, side
from rod.contact.touch import Touch
from rod.contact.tube import Pressing, Tube
from rod.functions import Floats
from rod.inertia import spread
from rod.layout import Layout
from rod.loads import TipForce, Weight
from rod.rod import Level, Rod
from rod.several.meeting import Meeting
from rod.several.system import Levels, Shapes, System
from rod.shape import Shape
from rod.statics import Equilibrium, Loading, Path, march
from tests.rod.bars import PLANE, SPACE, Bar, bent

BAR = Bar()
PIECES = 24
THRUST = 4e3
"""Moment of a pressure of one, mm³."""
UPSIDE = np.diag([-1.0, -1.0, 1.0])
STIFFNESS = 20.0


def box(bar: Bar = BAR, spacing: float = 2.0) -> Hull:
    x, y = bar.width / 2, bar.height / 2
    corners = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    parts = []
    for a, b in sides:
        count = max(1, round(float(np.linalg.norm(b - a)) / spacing))
        parts.append(a + np.arange(count)[:, None] / count * (b - a))
    return Hull(np.concatenate(parts))


def circle(radius: float, count: int = 32) -> Hull:
    t = 2 * np.pi * np.arange(count) / count
    return Hull(radius * np.column_stack([np.cos(t), np.sin(t)]))


def finger(
    place: Floats, rotation: Floats, strains: tuple[str, ...] = PLANE, pieces: int = PIECES
) -> Rod:
    """A bar that bends under pressure toward its −y."""
    layout = Layout(np.full(pieces, BAR.length / pieces), strains, rotation, place)
    law = BAR.law(strains)
    thrust = np.array([THRUST if name == "curvature" else 0.0 for name in strains])
    return Rod(layout, dataclasses.replace(law, thrust=thrust))


def tube(rod: Rod, hull: Hull) -> Tube:
    return Tube(hull, rod.layout.lengths)


def pressed(
    system: System, pressure: float, targets: tuple[float, ...] = (0.25, 0.5, 0.75, 1.0)
) -> list[Equilibrium[Shapes, Levels]]:
    count, ones = len(system.rods), (1.0,) * len(system.couplings)
    path = Loading(Levels((Level(),) * count, ones), Levels((Level(pressure),) * count, ones))
    return march(system, system.at_rest(), path, targets)


def pinch(stiffness: float, distance: float = 30.0) -> System:
    """Two fingers beside each other that bend toward each other, mirrored in y = 0."""
    low = finger(np.array([0.0, -distance, 0.0]), UPSIDE)
    high = finger(np.array([0.0, distance, 0.0]), np.eye(3))
    meeting = Meeting((0, 1), (tube(low, box()), tube(high, box())), stiffness)
    return System([low, high], [meeting])


@pytest.mark.parametrize(("one", "two"), [(circle(5.0), box()), (box(), circle(5.0))])
def test_pressing_has_exact_derivatives(one: Hull, two: Hull) -> None:
    first = Layout(np.full(6, 10.0), SPACE)
    turned = Rotation.from_rotvec([0.3, 0.2, 2.9]).as_matrix()
    second = Layout(np.full(5, 12.0), SPACE, turned, np.array([1.0, 7.0, 50.0]))
    a, b = bent(first, 1, 0.05), bent(second, 2, 0.05)
    tubes = Tube(one, first.lengths), Tube(two, second.lengths)

    def at(x: Floats) -> Pressing:
        shapes = (
            Shape(first, x[: a.size].reshape(a.shape)),
            Shape(second, x[a.size :].reshape(b.shape)),
        )
        return Pressing(tubes, shapes, 2.0)

    def flat(pressing: Pressing) -> Floats:
        return np.concatenate([part.ravel() for part in pressing.residual()])

    x = np.concatenate([a.ravel(), b.ravel()])
    here = at(x)
    assert len(here.points) > 2
    one_, both, two_ = here.tangent()
    tangent = np.block([[one_, both], [both.T, two_]])
    steps = 1e-7 * np.eye(len(x))
    force = np.array([(at(x + d).potential - at(x - d).potential) / 2e-7 for d in steps])
    slope = np.array([(flat(at(x + d)) - flat(at(x - d))) / 2e-7 for d in steps])
    np.testing.assert_allclose(flat(here), force, atol=1e-6 * np.abs(force).max())
    np.testing.assert_allclose(tangent, slope, atol=2e-6 * np.abs(slope).max())
    np.testing.assert_allclose(tangent, tangent.T, atol=1e-12 * np.abs(tangent).max())


def spread_out(meeting: bool) -> System:
    """Three fingers around an axis that never touch, each with loads of its own."""
    rods = []
    for number, angle in enumerate((0.0, 120.0, 240.0)):
        turn = Rotation.from_euler("z", angle, degrees=True).as_matrix()
        bare = finger(turn @ np.array([0.0, 30.0, 0.0]), turn @ UPSIDE)
        masses = spread(bare.layout, [BAR.mass()])
        force = TipForce((0.0, 0.0, -0.01 * number))
        rods.append(Rod(bare.layout, bare.law, masses, (Weight(masses, (0.0, 0.0, 9.8e3)), force)))
    tubes = [tube(rod, box()) for rod in rods]
    pairs = [(0, 1), (0, 2), (1, 2)] if meeting else []
    return System(rods, [Meeting(pair, (tubes[pair[0]], tubes[pair[1]]), 2.0) for pair in pairs])


def test_fingers_that_do_not_touch_are_those_alone() -> None:
    system = spread_out(meeting=True)
    ones = (1.0,) * 3
    begin, end = Level(), Level(0.002, (1.0, 1.0))
    path = Loading(Levels((begin,) * 3, ones), Levels((end,) * 3, ones))
    targets = [0.25, 0.5, 0.75, 1.0]
    together = march(system, system.at_rest(), path, targets)
    for number, rod in enumerate(system.rods):
        alone = march(rod, rod.layout.at_rest(), Path(begin, end), targets)
        for state, own in zip(together, alone, strict=True):
            near = state.shape.each[number].places
            np.testing.assert_allclose(near, own.shape.places, rtol=0.0, atol=1e-10 * BAR.length)
            assert len(system.blocks(state.shape, state.level)) == 3
    path = Loading(Levels((begin,) * 3), Levels((end,) * 3))
    bare = march(spread_out(meeting=False), system.at_rest(), path, targets)
    assert np.array_equal(bare[-1].strains, together[-1].strains)


def test_one_rod_is_itself() -> None:
    rod = finger(np.zeros(3), UPSIDE)
    state = pressed(System([rod]), 0.003)[-1]
    path = Path(Level(), Level(0.003))
    alone = march(rod, rod.layout.at_rest(), path, [0.25, 0.5, 0.75, 1.0])[-1]
    assert np.array_equal(state.strains, alone.strains.ravel())
    assert state.unstable == alone.unstable == 0


@pytest.mark.parametrize("distance", [18.0, 30.0])
def test_mirrored_fingers_stop_at_the_mirror_plane(distance: float) -> None:
    """Each as before a rigid plane; two surfaces that yield as one yield by half each."""
    system = pinch(20.0, distance)
    (meeting,) = system.couplings
    assert isinstance(meeting, Meeting)
    states = pressed(system, 0.004)
    low = system.rods[0]
    skin = side(low.layout, ring(box().corners.tolist(), 2.0), BAR.length / PIECES)
    wall = Touch(skin, Plane((0.0, 0.0, 0.0), (0.0, -1.0, 0.0)), 2 * 20.0)
    alone = Rod(low.layout, low.law, None, [wall])
    path = Path(Level(0.0, (1.0,)), Level(0.004, (1.0,)))
    beside = march(alone, low.layout.at_rest(), path, [0.25, 0.5, 0.75, 1.0])
    for state, one in zip(states, beside, strict=True):
        first, second = state.shape.each
        mirrored = second.places * [1.0, -1.0, 1.0]
        np.testing.assert_allclose(first.places, mirrored, rtol=0.0, atol=1e-8)
        np.testing.assert_allclose(first.places, one.shape.places, rtol=0.0, atol=0.01)
        force, _ = meeting.force(state.shape.each, np.zeros(3))
        wanted = wall.touched(one.shape, 1.0).force
        np.testing.assert_allclose(force, wanted, rtol=0.01, atol=1e-3 * BAR.young)
        assert state.unstable == 0
    assert (meeting.gap(states[0].shape.each) > 1.0) == (distance == 30.0)
    assert meeting.gap(states[-1].shape.each) == pytest.approx(0.0, abs=0.002)
    assert force[1] < -0.05


def skew() -> System:
    """A finger that presses on another one that lies across."""
    first = finger(np.zeros(3), UPSIDE, SPACE)
    across = Rotation.from_euler("yx", [90.0, 10.0], degrees=True).as_matrix()
    second = finger(np.array([-60.0, 45.0, 70.0]), across, SPACE)
    tubes = tube(first, box()), tube(second, circle(6.0))
    return System([first, second], [Meeting((0, 1), tubes, 20.0)])


def test_action_is_reaction_and_turns_with_the_whole() -> None:
    system = skew()
    (meeting,) = system.couplings
    assert isinstance(meeting, Meeting)
    state = pressed(system, 0.003)[-1]
    shapes, origin = state.shape.each, np.zeros(3)
    force, moment = meeting.force(shapes, origin)
    assert np.linalg.norm(force) > 0.01
    swapped = Meeting((1, 0), meeting.tubes[::-1], 20.0)
    back, back_moment = swapped.force(shapes[::-1], origin)
    np.testing.assert_allclose(back, -force, atol=1e-12)
    np.testing.assert_allclose(back_moment, -moment, atol=1e-10)
    # the clamps hold what the contact does to each rod: the potential hears of nothing else
    turn = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
    shift = np.array([11.0, -3.0, 5.0])
    rods = [
        Rod(
            dataclasses.replace(
                rod.layout,
                rotation=turn @ rod.layout.rotation,
                place=turn @ rod.layout.place + shift,
            ),
            rod.law,
        )
        for rod in system.rods
    ]
    moved = pressed(System(rods, [meeting]), 0.003)[-1]
    np.testing.assert_allclose(moved.strains, state.strains, atol=1e-9)
    there, about = meeting.force(moved.shape.each, shift)
    np.testing.assert_allclose(there, turn @ force, atol=1e-9)
    np.testing.assert_allclose(about, turn @ moment, atol=1e-7)


def test_the_tangent_of_a_system_is_exact_and_symmetric() -> None:
    system = skew()
    state = pressed(system, 0.003)[-1]
    ones = Levels((Level(0.003),) * 2, (1.0,))
    tangent = system.tangent(state.shape, ones)
    np.testing.assert_allclose(tangent, tangent.T, atol=1e-10 * np.abs(tangent).max())
    rng = np.random.default_rng(3)
    for _ in range(3):
        way = rng.normal(size=len(tangent)) * system.sizes
        step = 1e-6
        ends = [system.shape(state.strains + sign * step * way) for sign in (-1.0, 1.0)]
        before, after = (system.residual(shapes, ones) for shapes in ends)
        scale = np.abs(tangent @ way).max()
        np.testing.assert_allclose((after - before) / (2 * step), tangent @ way, atol=1e-5 * scale)
        work = [system.potential(shapes, ones) for shapes in ends]
        slope = (work[1] - work[0]) / (2 * step)
        assert slope == pytest.approx(system.residual(state.shape, ones) @ way, abs=1e-5)


def test_fingers_do_not_pass_through_each_other() -> None:
    """In one step from rest they would: the step is cut."""
    system = pinch(20.0)
    state = pressed(system, 0.004, (1.0,))[-1]
    slow = pressed(system, 0.004, tuple(np.linspace(0.05, 1.0, 20).tolist()))[-1]
    np.testing.assert_allclose(state.strains, slow.strains, atol=1e-8)
    assert state.shape.each[0].places[-1, 1] < 0.0


@pytest.mark.parametrize("wrong", [((0, 0), 1.0), ((0, 1), 0.0)])
def test_refused(wrong: tuple[tuple[int, int], float]) -> None:
    rod = finger(np.zeros(3), UPSIDE)
    tubes = tube(rod, box()), tube(rod, box())
    with pytest.raises(ValueError, match="expected"):
        Meeting(wrong[0], tubes, wrong[1])
    with pytest.raises(ValueError, match=r"expected|among"):
        System([rod], [Meeting((0, 1), tubes, 1.0)])
    with pytest.raises(ValueError, match="at least one"):
        System([])
    with pytest.raises(ValueError, match="hull"):
        Hull(np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]))
