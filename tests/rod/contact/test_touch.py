"""A rod's surface against rigid obstacles."""

from __future__ import annotations

import numpy as np
import pytest

from rod.contact.obstacles import Cylinder, Obstacle, Plane, Sphere
from rod.contact.skin import Skin, face, ring, side
from rod.contact.touch import Touch
from rod.layout import STRAINS, Layout
from rod.shape import Shape
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
