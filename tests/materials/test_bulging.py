"""Stiffness against bulges: refused where it vanishes at some stretch."""

from __future__ import annotations

import math

import numpy as np
import pytest

from materials.bulging import Bulging

GOOD = [(0.0, 0.0), (0.86, 2.92), (2.43, 4.41), (-1.9, 1.0), (1.99, 1.0), (0.9, 0.0), (5.0, 6.3)]
BAD = [(0.0, -1e-9), (-1e-9, 0.0), (1.01, 0.0), (-2.1, 1.0), (2.01, 1.0), (0.5, -0.1), (4.0, 3.0)]


@pytest.mark.parametrize(("linear", "quadratic"), GOOD)
def test_what_is_taken_is_positive_at_every_stretch(linear: float, quadratic: float) -> None:
    stretch = np.concatenate([np.geomspace(1e-9, 1e9, 2001), np.linspace(0.0, 4.0, 40001)[1:]])
    assert Bulging(0.7, linear, quadratic).factor(stretch)[0].min() > 0


@pytest.mark.parametrize(("linear", "quadratic"), BAD)
def test_what_vanishes_at_some_stretch_is_refused(linear: float, quadratic: float) -> None:
    # it does: the parabola is not positive at one of these
    part = np.concatenate([np.geomspace(1e-9, 1e10, 4001), np.linspace(0.0, 4.0, 40001)[1:]]) - 1
    assert (1 + linear * part + quadratic * part**2).min() <= 0
    with pytest.raises(ValueError, match="at every stretch"):
        Bulging(0.7, linear, quadratic)


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_no_stiffness_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match="bulging stiffness"):
        Bulging(value)
    if not value <= 0:
        with pytest.raises(ValueError, match="bulging stiffness"):
            Bulging(0.7, 0.0, value)


def test_derivatives_of_the_factor() -> None:
    law, stretch, h = Bulging(0.7, 1.1, 3.0), np.linspace(0.5, 2.0, 7), 1e-4
    above, here, below = (law.factor(stretch + k * h) for k in (1, 0, -1))
    for i in (0, 1):
        assert (above[i] - below[i]) / (2 * h) == pytest.approx(here[i + 1], rel=1e-8)
    assert law.factor(np.ones(1))[0] == 1
