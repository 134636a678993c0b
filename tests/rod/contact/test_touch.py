"""A rod's surface against rigid obstacles."""

from __future__ import annotations

import numpy as np
import pytest

from rod.contact.obstacles import Cylinder, Obstacle, Plane, Sphere
from rod.contact.skin import Skin, face, ring, side
from rod.contact.touch import Touch
from rod.layout import STRAINS, Layout
from rod.loads import TipForce
from rod.rod import Level, Rod
from rod.shape import Shape
from rod.statics import Path, solve
from rod.term import Term
from tests.rod.bars import PLANE, SPACE, Bar, bent
from tests.rod.contact.differences import errors

BAR = Bar()
CORNERS = ((-8.0, -5.0), (8.0, -5.0), (8.0, 5.0), (-8.0, 5.0))
OBSTACLES: dict[str, Obstacle] = {
    "plane": Plane((0.0, -4.0, 60.0), (0.2, 1.0, -0.3)),
    "bar": Cylinder((0.0, -20.0, 70.0), (1.0, 0.0, 0.0), 22.0),
    "cylinder": Cylinder((2.0, -15.0, 70.0), (0.3, 1.0, 0.2), 12.0, 30.0),
    "sphere": Sphere((3.0, -20.0, 70.0), 25.0),
}


def skin(layout: Layout, spacing: float = 6.0) -> Skin:
    """Sides and tip of the bar."""
    outline = ring(CORNERS, 4.0)
    return side(layout, outline, spacing).joined(face(layout, outline))


@pytest.mark.parametrize("strains", [PLANE, SPACE, STRAINS])
@pytest.mark.parametrize("name", OBSTACLES)
def test_derivatives_are_those_of_differences(strains: tuple[str, ...], name: str) -> None:
    layout = Layout(np.array([20.0, 30.0, 25.0, 25.0, 20.0]), strains)
    strained = bent(layout, seed=3, most=0.15)
    for travel in (None, (0.1, 1.0, 0.3)):
        term = Touch(skin(layout), OBSTACLES[name], 0.3, travel)
        assert term.touched(Shape(layout, strained), 0.8).area > 0
        found = errors(term, layout, strained, 0.8)
        assert max(found[:3]) < 3e-8, found
        assert found[3] < 1e-13


@pytest.mark.parametrize("amounts", [(0.0, 1.0), (), (0.0,)])
def test_an_obstacle_that_is_not_moved_yet_stands_where_it_is(amounts: tuple[float, ...]) -> None:
    """Its amount is a way: zero of it is not nothing of the obstacle."""
    layout = BAR.layout(5)
    obstacle = Plane((0.0, -4.0, 60.0), (0.2, 1.0, -0.3))
    terms: list[Term] = [
        Touch(skin(layout), obstacle, 0.3, (0.1, 1.0, 0.3)),
        TipForce((0.0, 0.001, 0.0)),
    ]
    rod, still = Rod(layout, BAR.law(PLANE), terms=terms), Touch(skin(layout), obstacle, 0.3)
    shape, level = rod.shape(bent(layout, seed=3, most=0.15)), Level(amounts=amounts)
    whole = Rod(layout, BAR.law(PLANE), terms=[still, terms[1]])
    as_much = Level(amounts=(1.0, *amounts[1:]))
    assert still.potential(shape, 1.0) > 0
    assert rod.potential(shape, level) == whole.potential(shape, as_much)
    assert np.array_equal(rod.residual(shape, level), whole.residual(shape, as_much))
    assert np.array_equal(rod.tangent(shape, level), whole.tangent(shape, as_much))


def test_a_bar_rests_on_an_obstacle_that_is_not_moved_yet() -> None:
    layout = BAR.layout(8)
    floor = Touch(skin(layout), Plane((0.0, -5.5, 0.0), (0.0, 1.0, 0.0)), 0.3, (0.0, 1.0, 0.0))
    rod = Rod(layout, BAR.law(PLANE), terms=[TipForce((0.0, -0.004, 0.0)), floor])
    state = solve(rod, layout.at_rest(), Path(Level(), Level(amounts=(1.0,))), 1.0)
    assert floor.touched(state.shape, 0.0).force[1] > 1e-3
