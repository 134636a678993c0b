"""The first angle that holds a pressure, and where the search for it ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.inverse import FORWARD, angle_range, first_angle
from analytic.stress import Floats


def _hill(angle: Floats) -> Floats:
    """Rises to 1 at θ = 2 and falls again; odd."""
    return np.asarray(angle * (4 - np.abs(angle)) / 4)


@pytest.mark.parametrize("target", [0.3, 0.75, -0.3, -0.75])
def test_the_first_of_two_angles_is_found(target: float) -> None:
    found = first_angle(_hill, target, math.copysign(4.0, target))
    assert found.end == ""
    assert found.angle == pytest.approx(math.copysign(2 - 2 * math.sqrt(1 - abs(target)), target))


def test_a_pressure_beyond_the_peak_ends_there() -> None:
    found = first_angle(_hill, 1.5, 4.0)
    assert found.end == "peak"
    assert (found.angle, found.pressure) == pytest.approx((2, 1), abs=0.03)


def test_a_pressure_beyond_the_bound_ends_there() -> None:
    assert first_angle(_hill, 0.9, 1.0) == (1.0, 0.75, "bound")
    assert first_angle(_hill, -0.9, -1.0) == (-1.0, 0.75, "bound")


def test_backward_bending_ends_before_the_roof_is_squeezed_to_nothing() -> None:
    assert angle_range(160.0, 12.0) == (-math.pi / 2, FORWARD)
    assert angle_range(20.0, 12.0) == (-20 / 24, FORWARD)
