"""The line of a rod, its derivatives and its symmetries."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analytic.path import arc, screw
from rod.functions import Floats, cross_matrix
from rod.inertia import SectionMass, lump, spread
from rod.layout import STRAINS, Layout
from rod.shape import Shape
from tests.rod.bars import PLANE, SPACE, bent

STEP = 1e-5
EVERY = pytest.mark.parametrize("strains", [PLANE, SPACE, STRAINS])


def turned(strains: tuple[str, ...], pieces: int = 5) -> Layout:
    """Unequal pieces, a root of any pose."""
    rng = np.random.default_rng(3)
    rotation = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()
    return Layout(rng.uniform(4, 12, pieces), strains, rotation, np.array([1.0, -2.0, 3.0]))


def differences(layout: Layout, strains: Floats, read: Callable[[Shape], Floats]) -> Floats:
    """Derivatives of what is read off a shape, along a last axis of all strains."""
    columns = []
    for place in np.ndindex(strains.shape):
        step = np.zeros_like(strains)
        step[place] = STEP / (layout.lengths[place[0]] if "curv" in layout.strains[place[1]] else 1)
        up, down = (Shape(layout, strains + sign * step) for sign in (1, -1))
        columns.append((read(up) - read(down)) / (2 * step[place]))
    return np.stack(columns, axis=-1)


def loads(layout: Layout, seed: int = 5) -> Floats:
    frames = len(layout.lengths) + 1
    return np.random.default_rng(seed).normal(size=(frames, 3, 4))


def inertia(layout: Layout) -> Floats:
    sections = [
        SectionMass(1 + i, (0.3, -0.2), (2.0, 3.0, 0.4)) for i in range(len(layout.lengths))
    ]
    out = spread(layout, sections)
    out[-1] += lump(5.0, (0.1, 0.2, 0.9), np.diag([1.0, 2.0, 3.0]))
    return out


@EVERY
def test_sections_anywhere_are_on_the_line(strains: tuple[str, ...]) -> None:
    """At frames they are these; between, those of a rod of more pieces of the same strains."""
    layout = turned(strains)
    q = bent(layout)
    shape = Shape(layout, q)
    ends = np.concatenate([[0.0], np.cumsum(layout.lengths)])
    np.testing.assert_allclose(shape.along(ends), shape.frames, rtol=1e-13, atol=1e-12)
    finer = Layout(np.repeat(layout.lengths / 2, 2), strains, layout.rotation, layout.place)
    halves = Shape(finer, np.repeat(q, 2, axis=0))
    between = np.concatenate([[0.0], np.cumsum(finer.lengths)])
    np.testing.assert_allclose(shape.along(between), halves.frames, rtol=1e-13, atol=1e-12)


def test_constant_strains_make_a_screw() -> None:
    spin, stretch, n = np.array([0.011, -0.004, 0.02]), 1.13, 9
    layout = Layout(np.full(n, 12.0), SPACE)
    shape = Shape(layout, np.tile([stretch, *spin], (n, 1)))
    z = 12.0 * np.arange(n + 1)
    rotations, places = screw(z, spin, stretch)
    np.testing.assert_allclose(shape.rotations, rotations, atol=1e-13)
    np.testing.assert_allclose(shape.places, places, atol=1e-11)


def test_a_helix_has_its_radius_and_pitch() -> None:
    """κ across, τ along: radius λ κ/(κ² + τ²), pitch 2π λ τ/(κ² + τ²) a turn."""
    kappa, tau, stretch, n = 0.05, 0.02, 1.2, 40
    layout = Layout(np.full(n, 5.0), SPACE)
    shape = Shape(layout, np.tile([stretch, kappa, 0.0, tau], (n, 1)))
    rate = math.hypot(kappa, tau)
    axis = np.array([kappa, 0.0, tau]) / rate
    centre = shape.places[0] - stretch * kappa / rate**2 * np.array([0.0, 1.0, 0.0])
    away = shape.places - centre
    along = away @ axis
    radii = np.linalg.norm(away - along[:, None] * axis, axis=1)
    np.testing.assert_allclose(radii, stretch * kappa / rate**2, rtol=1e-12)
    turn = rate * 5.0 * np.arange(n + 1)
    np.testing.assert_allclose(along, stretch * tau / rate**2 * turn, atol=1e-10)


def test_curvature_bends_toward_minus_y() -> None:
    layout = Layout(np.full(4, 25.0))
    shape = Shape(layout, np.tile([1.0, 0.01], (4, 1)))
    z, down = arc(1.0, 100.0)
    np.testing.assert_allclose(shape.places[-1], [0.0, -down, z], atol=1e-11)
    assert np.sum(layout.weights("curvature") * shape.strains) == pytest.approx(1.0)


@EVERY
def test_frames_move_as_their_derivatives_say(strains: tuple[str, ...]) -> None:
    layout = turned(strains)
    q = bent(layout)
    shape = Shape(layout, q)
    rates = differences(layout, q, lambda s: s.frames)
    for frame in (0, 1, 3, -1):
        moved, spins = shape.jacobian(frame)
        np.testing.assert_allclose(moved, rates[frame, :, 3], atol=1e-7)
        for k in range(q.size):
            turn = cross_matrix(spins[:, k]) @ shape.rotations[frame]
            np.testing.assert_allclose(turn, rates[frame, :, :3, k], atol=1e-7)
    some = np.random.default_rng(2).normal(size=q.shape)
    np.testing.assert_allclose(shape.moved(some), rates @ some.ravel(), atol=1e-6)


@EVERY
def test_work_of_loads_has_two_derivatives(strains: tuple[str, ...]) -> None:
    layout = turned(strains)
    q, load = bent(layout), loads(layout)
    shape = Shape(layout, q)
    first = differences(layout, q, lambda s: np.sum(load * s.frames)).reshape(q.shape)
    np.testing.assert_allclose(shape.pulled(load), first, rtol=1e-7, atol=1e-6)
    second = differences(layout, q, lambda s: s.pulled(load).ravel())
    scale = np.abs(second).max()
    np.testing.assert_allclose(shape.curved(load), second, atol=1e-9 * scale)
    np.testing.assert_array_equal(shape.curved(load), shape.curved(load).T)


@EVERY
def test_a_moment_in_space_has_its_derivative(strains: tuple[str, ...]) -> None:
    layout = turned(strains)
    q, moment = bent(layout), np.array([1.0, -2.0, 0.5])
    exact = differences(layout, q, lambda s: moment @ s.jacobian()[1])
    np.testing.assert_allclose(
        Shape(layout, q).spun(moment), exact, atol=1e-9 * max(np.abs(exact).max(), 1.0)
    )


@EVERY
def test_the_mass_matrix_is_that_of_the_frames(strains: tuple[str, ...]) -> None:
    layout = turned(strains)
    q, masses = bent(layout), inertia(layout)
    other = q + 0.05 * (bent(layout, seed=2) - layout.at_rest())
    here, there = (differences(layout, each, lambda s: s.frames) for each in (q, other))
    one = np.einsum("fabi,fbc,faci->i", here, masses, here)
    shape = Shape(layout, q)
    found = shape.mass(masses)
    np.testing.assert_allclose(np.diag(found), one, rtol=1e-8)
    np.testing.assert_allclose(found, found.T, atol=1e-12 * one.max())
    np.testing.assert_allclose(
        found, np.einsum("fabi,fbc,facj->ij", here, masses, here), atol=1e-8 * one.max()
    )
    both = np.einsum("fabi,fbc,facj->ij", here, masses, there)
    np.testing.assert_allclose(
        shape.mass(masses, Shape(layout, other)), both, atol=1e-8 * one.max()
    )


def test_a_moved_root_moves_all_and_changes_nothing() -> None:
    """Loads that are moved along give the same work, second derivatives and masses."""
    layout = Layout(np.full(6, 8.0), STRAINS)
    q, load, masses = bent(layout), loads(layout), inertia(layout)
    rotation, place = (
        Rotation.from_rotvec([2.0, -0.4, 1.3]).as_matrix(),
        np.array([5.0, 6.0, -70.0]),
    )
    here, there = Shape(layout, q), Shape(Layout(layout.lengths, STRAINS, rotation, place), q)
    np.testing.assert_allclose(there.rotations, rotation @ here.rotations, atol=1e-13)
    np.testing.assert_allclose(there.places, here.places @ rotation.T + place, atol=1e-11)
    moved = rotation @ load
    np.testing.assert_allclose(there.pulled(moved), here.pulled(load), atol=1e-10)
    np.testing.assert_allclose(there.curved(moved), here.curved(load), atol=1e-8)
    np.testing.assert_allclose(there.mass(masses), here.mass(masses), rtol=1e-10, atol=1e-7)


def test_what_is_seen_in_a_mirror_is_its_mirror_image() -> None:
    """x → −x: k_y, τ and γ_x change their sign."""
    layout = Layout(np.full(6, 8.0), STRAINS)
    signs, mirror = np.array([-1.0, 1, 1, 1, -1, -1]), np.diag([-1.0, 1, 1])
    q, load = bent(layout), loads(layout)
    here, there = Shape(layout, q), Shape(layout, q * signs)
    np.testing.assert_allclose(there.places, here.places @ mirror, atol=1e-12)
    np.testing.assert_allclose(there.rotations, mirror @ here.rotations @ mirror, atol=1e-13)
    seen = mirror @ load @ np.diag([-1.0, 1, 1, 1])
    np.testing.assert_allclose(there.pulled(seen), here.pulled(load) * signs, atol=1e-11)
    both = np.outer(np.tile(signs, 6), np.tile(signs, 6))
    np.testing.assert_allclose(there.curved(seen), here.curved(load) * both, atol=1e-9)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"lengths": np.array([1.0, 0.0])}, "positive mm"),
        ({"strains": ("curvature", "stretch")}, "order"),
        ({"strains": ("curvature", "curvature")}, "each once"),
        ({"strains": ("bend",)}, "some of"),
        ({"strains": ()}, "some of"),
        ({"rotation": np.diag([1.0, 1.0, -1.0])}, "a rotation expected"),
        ({"place": np.array([0.0, np.nan, 0.0])}, "three mm"),
    ],
)
def test_what_is_no_rod_is_refused(values: dict[str, Floats], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Layout(**({"lengths": np.ones(3)} | values))  # type: ignore[arg-type]


def test_an_angle_of_a_strain_that_is_not_free_is_refused() -> None:
    with pytest.raises(ValueError, match="twist is no unknown"):
        Layout(np.ones(3)).weights("twist")
