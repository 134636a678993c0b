"""A rod in its plane by complex numbers, and laws that are asked for everything at once."""

from __future__ import annotations

import numpy as np
import pytest

from rod.functions import Floats
from rod.law import Law, Linear, Zones, whole
from rod.layout import Layout
from rod.offset import Offset
from rod.plane import PlaneShape, placed
from rod.quartic import Quartic
from rod.shape import Shape
from rod.sheared import Sheared
from tests.rod.bars import PLANE, SPACE, bent
from tests.rod.test_shape import inertia, loads, turned

SHEARED = ("shear_y", "stretch", "curvature")


@pytest.mark.parametrize("strains", [PLANE, SHEARED, ("curvature",), ("stretch",)])
@pytest.mark.parametrize("straight", [False, True])
def test_in_the_plane_it_is_the_shape_in_space(strains: tuple[str, ...], straight: bool) -> None:
    layout = turned(strains, 7)
    if straight:
        layout = Layout(layout.lengths, strains, place=layout.place)
    pairs = [[kind(layout, bent(layout, seed)) for seed in (1, 4)] for kind in (Shape, PlaneShape)]
    (space, ahead), (plane, after) = pairs
    rates = np.random.default_rng(0).normal(size=plane.strains.shape)
    blocks = np.random.default_rng(1).normal(size=(8, 6, 6))

    def read(shape: Shape, other: Shape) -> list[Floats]:
        force = loads(layout)
        return [
            shape.frames,
            shape.pulled(force),
            shape.curved(force),
            shape.mass(inertia(layout)),
            shape.mass(inertia(layout), other),
            shape.moved(rates),
            shape.stiffened(blocks, other),
            *shape.jacobian(3),
            shape.along(np.array([3.0, 20.0])),
        ]

    for exact, found in zip(read(space, ahead), read(plane, after), strict=True):
        np.testing.assert_allclose(found, exact, rtol=1e-12, atol=1e-13 * np.abs(exact).max())


def test_only_a_rod_in_the_plane_is_one() -> None:
    for strains, kind in ((PLANE, PlaneShape), (SHEARED, PlaneShape), (SPACE, Shape)):
        layout = turned(strains)
        assert type(placed(layout, bent(layout))) is kind


def test_springs_of_two_shapes_have_the_symmetry_of_their_order() -> None:
    layout = turned(SPACE)
    one, two = (Shape(layout, bent(layout, seed)) for seed in (1, 4))
    blocks = np.random.default_rng(1).normal(size=(6, 6, 6))
    swapped = two.stiffened(np.swapaxes(blocks, 1, 2), one)
    np.testing.assert_allclose(one.stiffened(blocks, two), swapped.T, rtol=1e-12, atol=1e-12)
    symmetric = blocks + np.swapaxes(blocks, 1, 2)
    scale = np.abs(one.stiffened(symmetric)).max()
    np.testing.assert_allclose(
        one.stiffened(symmetric, one), one.stiffened(symmetric), atol=1e-13 * scale
    )


def test_a_law_tells_all_at_once_what_it_tells_one_by_one() -> None:
    rng = np.random.default_rng(2)
    rest = np.array([1.0, 0.0])
    cubic = np.zeros((2, 2, 2))
    for place in ((0, 1, 1), (1, 0, 1), (1, 1, 0)):
        cubic[place] = 7.0
    quartic = np.zeros((2, 2, 2, 2))
    quartic[1, 1, 1, 1] = 40.0
    stiffness = np.array([[60.0, 3.0], [3.0, 900.0]])
    beam = Quartic(stiffness, cubic, quartic, rest)
    tube = Linear(stiffness, rest, area=70.0, thrust=np.array([30.0, 400.0]))
    law = Offset(Zones([beam, tube], [0, 0, 1, 1, 1, 0]), rng.normal(size=(3, 6, 2)))
    told_at_once(law, rest + 0.1 * rng.normal(size=(3, 6, 2)))
    forms = rng.normal(size=(4, 3, 3))
    sheared = Sheared(law, (1, 2), forms + forms.transpose(0, 2, 1), np.array([0.0, *rest]))
    told_at_once(sheared, sheared.rest + 0.1 * rng.normal(size=(3, 6, 3)))


def told_at_once(law: Law, strains: Floats) -> None:
    pressures, count = np.array([0.02, 0.0, -0.01]), strains.shape[-1]
    value, first, second = whole(law, strains, pressures)
    for k, pressure in enumerate(pressures.tolist()):
        at = strains[k], pressure
        mixed = law.chamber_gradient(*at)
        pairs = (
            (value[k], law.value(*at)),
            (first[k, :, :count], law.gradient(*at)),
            (-first[k, :, count], law.chamber(*at)),
            (second[k, :, :count, :count], law.hessian(*at)),
            (-second[k, :, :count, count], mixed),
            (-second[k, :, count, :count], mixed),
            (-second[k, :, count, count], law.chamber_slope(*at)),
        )
        for found, known in pairs:
            np.testing.assert_allclose(found, known, rtol=1e-12, atol=1e-12)
