"""A rod against itself."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rod.contact.itself import Itself
from rod.contact.region import Region
from rod.contact.skin import face, ring, side
from rod.layout import STRAINS, Layout
from rod.shape import Shape
from tests.rod.bars import PLANE, SPACE
from tests.rod.contact.differences import errors

CORNERS = ((-8.0, -5.0), (8.0, -5.0), (8.0, 3.0), (4.0, 5.0), (-4.0, 5.0), (-8.0, 3.0))


def curled(strains: tuple[str, ...], turn: float = 1.15, seed: int = 2) -> tuple[Itself, Shape]:
    """A rod that is bent over a whole turn, sections not alike."""
    lengths = np.array([14.0, 10.0, 16.0, 12.0, 15.0, 13.0, 17.0, 11.0, 12.0, 14.0, 16.0, 10.0])
    layout = Layout(lengths, strains)
    outline = ring(CORNERS, 4.0)
    skin = side(layout, outline, 6.0).joined(face(layout, outline))
    rng = np.random.default_rng(seed)
    strained = layout.at_rest()
    for number, name in enumerate(strains):
        scale = 0.02 if "shear" in name or name == "stretch" else 2e-3
        strained[:, number] += scale * rng.uniform(-1, 1, len(lengths))
        if name == "curvature":
            strained[:, number] += turn * 2 * math.pi / lengths.sum()
    return Itself(layout, skin, Region(CORNERS, 0.6), 0.3), Shape(layout, strained)


@pytest.mark.parametrize("strains", [PLANE, SPACE, STRAINS])
def test_derivatives_are_those_of_differences(strains: tuple[str, ...]) -> None:
    term, shape = curled(strains)
    assert term.gap(shape, 1.0) < -0.1
    assert term.potential(shape, 0.8) > 1.0
    found = errors(term, shape.layout, shape.strains, 0.8)
    assert max(found[:3]) < 3e-7, found
    assert found[3] < 1e-12


def test_a_rod_that_is_not_curled_meets_nothing() -> None:
    term, shape = curled(SPACE, turn=0.6)
    assert term.gap(shape, 1.0) == math.inf
    assert term.potential(shape, 1.0) == 0.0
    assert not term.residual(shape, 1.0).any()
    assert not term.tangent(shape, 1.0).any()
