"""The first angle that holds a pressure, and where the search for it ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.bending import Hemicircle
from analytic.control.filter import TOLERANCE, AngleFilter
from analytic.inverse import FORWARD, angle_range, first_angle
from analytic.stress import Floats, effective, wound
from materials.material import Material


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


def test_forward_bending_ends_before_a_thick_sheath_is_squeezed_to_nothing() -> None:
    # the table of θ(P) stops where the closed form does, instead of being refused
    assert angle_range(160.0, 12.0, 1.0)[1] == FORWARD
    thick = Hemicircle(8, 2, 2, 160, sheath=20.0, sheath_stress=effective(0.05))
    assert thick.angles[1] == pytest.approx(0.99 * 8)
    angle = np.linspace(0, 7.9, 9)
    assert thick.angle(thick.pressure(angle)) == pytest.approx(angle)


def _gent(jm: float) -> Hemicircle:
    return Hemicircle(8, 2, 2, 100, stress=wound(Material("gent", {"mu": 0.3, "jm": jm}).principal))


def _limit(jm: float) -> float:
    """Angle at which the roof, 12 mm above y = 0, is stretched to λ − 1/λ = √Jm, rad.

    The form integrates by points, the highest of which lies 0.6 % below the roof.
    """
    root = math.sqrt(jm)
    return ((root + math.sqrt(jm + 4)) / 2 - 1) * 100 / 12


@pytest.mark.parametrize("jm", [0.3, 1.0, 3.0, 4.3])
def test_the_table_ends_before_rubber_meets_its_limit(jm: float) -> None:
    model, limit = _gent(jm), _limit(jm)
    low, high = model.tabulated
    assert (low, high) == pytest.approx((-math.pi / 2, 0.97 * limit), rel=6e-3)
    assert high < limit
    angle = np.linspace(low, high, 50)[1:-1]
    assert model.angle(model.pressure(angle)) == pytest.approx(angle, abs=1e-9)
    assert AngleFilter.from_model(model).error < TOLERANCE


def test_rubber_without_a_limit_below_720_degrees_is_tabulated_as_far() -> None:
    assert _limit(5.0) > FORWARD / 0.97
    assert _gent(5.0).tabulated == _gent(5.0).angles


def test_every_pressure_is_held_below_the_limit() -> None:
    # P grows without bound there: 5 MPa lie in the last of the search's 181 pieces
    model, limit = _gent(1.0), _limit(1.0)
    found = first_angle(model.pressure, 5.0, FORWARD)
    assert found.end == ""
    assert model.pressure(found.angle) == pytest.approx(5.0)
    assert found.angle == pytest.approx(limit, rel=6e-3)
    beyond = first_angle(model.pressure, math.inf, FORWARD)
    assert (beyond.end, beyond.angle) == ("limit", pytest.approx(limit, rel=6e-3))
