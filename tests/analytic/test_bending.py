"""Free bending and force: reference numbers, limits, the inverse, and the errata as numbers."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from analytic.bending import Hemicircle
from analytic.stress import effective, wound
from materials.material import Material
from materials.named.table import named_material

BASE = Hemicircle(8, 2, 2, 160)
QUARTERS = np.radians([90, 180, 270, 360])
RUBBER = named_material("elastosil-m4601")
ELASTOSIL = wound(RUBBER.principal)


def test_numbers_of_the_paper_without_its_factor_length() -> None:
    # worked out independently of this project
    assert BASE.kappa == pytest.approx(542.395, abs=5e-4)
    assert Hemicircle(6, 2, 2, 160).kappa == pytest.approx(257.097, abs=5e-4)
    kilopascal = 1e3 * BASE.pressure(QUARTERS)
    assert kilopascal == pytest.approx([78.197, 140.691, 192.815, 237.828], abs=5e-4)
    narrow = 1e3 * Hemicircle(6, 2, 2, 160).pressure(np.radians([90, 180, 360]))
    assert narrow == pytest.approx([91.1, 166.4, 286.8], abs=0.05)
    assert BASE.force(0.2, 15) == pytest.approx(7.23, abs=0.005)


def test_small_angle_slope_is_beam_theory_of_four_times_the_shear_modulus() -> None:
    a, b, r = 8.0, 2.0, 10.0
    disk = math.pi / 8 * (r**4 - a**4) + 2 * b * 2 / 3 * (r**3 - a**3)
    inertia = disk + b**2 * math.pi / 2 * (r**2 - a**2) + 2 * r * b**3 / 3
    slope = (BASE.moment(1e-5) - BASE.moment(-1e-5)) / 2e-5
    assert slope == pytest.approx(4 * 0.314 * inertia / 160, rel=1e-8)
    assert slope == pytest.approx(30.61, abs=0.005)
    assert BASE.moment(0.0) == 0


@pytest.mark.parametrize("stress", [effective(0.2), ELASTOSIL])
def test_quadrature_of_the_printed_integrals(stress: Any) -> None:
    model = Hemicircle(6, 1.5, 2.5, 90, stress=stress)
    theta, a, b, t, length = 5.0, 6.0, 1.5, 2.5, 90.0

    def top(phi: float, tau: float) -> float:
        stretch = 1 + (b + math.sin(phi) * (a + tau)) * theta / length
        return float(stress(stretch) * ((a + tau) ** 2 * math.sin(phi) + b * (a + tau)))

    def bottom(beta: float) -> float:
        return float(stress(1 + beta * theta / length) * 2 * (a + t) * beta)

    moment = 2 * dblquad(top, 0, t, 0, math.pi / 2)[0] + quad(bottom, 0, b)[0]
    assert model.moment(theta) == pytest.approx(moment, rel=1e-9)


def test_thin_wall_is_a_membrane() -> None:
    stress, a, b, theta, length = effective(), 8.0, 2.0, 3.0, 160.0

    def rim(phi: float) -> float:
        y = b + a * math.sin(phi)
        return float(2 * stress(np.asarray(1 + y * theta / length)) * y * a)

    # the floor is 2 t wider than the chamber
    bare = Hemicircle(a, b, 1e-12, length).moment(theta)
    overhang = quad(lambda y: 2 * stress(1 + y * theta / length) * y, 0, b)[0]
    for t in (1e-4, 1e-5):
        membrane = (Hemicircle(a, b, t, length).moment(theta) - bare) / t - overhang
        assert membrane == pytest.approx(quad(rim, 0, math.pi / 2)[0], rel=t)


def test_inverse_is_the_inverse_and_continuous_through_zero() -> None:
    angles = np.linspace(-1.5, 12.5, 333).reshape(9, 37)
    for model in (BASE, Hemicircle(8, 2, 2, 160, stress=ELASTOSIL, acts="winding")):
        assert model.angle(model.pressure(angles)) == pytest.approx(angles, abs=1e-11)
    assert BASE.angle(0.0) == pytest.approx(0, abs=1e-13)
    assert BASE.angle(-1e-4) == pytest.approx(-1e-4 * BASE.kappa / 30.61, rel=0.01)


def test_pressure_rises_with_angle_and_follows_the_trends() -> None:
    angles = np.linspace(-1.5, 12.5, 200)
    assert np.all(np.diff(BASE.pressure(angles)) > 0)
    full = 2 * math.pi
    assert Hemicircle(10, 2, 2, 160).pressure(full) < BASE.pressure(full)
    assert Hemicircle(8, 2, 2, 180).pressure(full) < BASE.pressure(full)
    assert Hemicircle(8, 2, 3, 160).pressure(full) > BASE.pressure(full)


def test_angle_refuses_what_it_cannot_answer() -> None:
    for pressure in (1.0, -1.0, math.nan, [0.1, math.inf]):
        with pytest.raises(ValueError, match=r"kPa is outside -103\.\d+ to 379\.\d+ kPa"):
            BASE.angle(pressure)  # type: ignore[arg-type]
    limp = Hemicircle(8, 2, 2, 160, stress=lambda stretch: 1 / stretch - stretch)
    with pytest.raises(ValueError, match="does not rise with the angle"):
        limp.angle(0.1)
    with pytest.raises(ValueError, match=r"angle: between -13\.33"):
        BASE.moment(-14.0)


def test_acting_area_up_to_the_winding() -> None:
    reaching = dataclasses.replace(BASE, acts="winding")

    def width(y: float) -> float:
        return 20.0 if y < 2 else 2 * math.sqrt(100 - (y - 2) ** 2)

    area = quad(lambda y: y * width(y), 0, 12, points=[2])[0]
    assert reaching.kappa == pytest.approx(area, rel=1e-8)
    assert reaching.pressure_moment(0.1) == pytest.approx(102.08, abs=0.005)
    assert BASE.pressure_moment(0.1) == pytest.approx(54.24, abs=0.005)
    assert reaching.moment(QUARTERS) == pytest.approx(BASE.moment(QUARTERS), rel=1e-14)
    # without wall and floor nothing is confined
    thin = Hemicircle(8, 1e-9, 1e-9, 160)
    assert dataclasses.replace(thin, acts="winding").kappa == pytest.approx(thin.kappa)


def test_floor_and_sheath_add_their_own_moment() -> None:
    wall, floor, sheath = effective(0.2), effective(3.0), effective(0.05)
    whole = Hemicircle(8, 2, 2, 160, wall, floor, 1.0, sheath)
    # a sheath is the difference of two hemicircles, and what runs on below y = 0
    both = Hemicircle(8, 2, 3, 160, sheath).moment(2.0) - Hemicircle(8, 2, 2, 160, sheath).moment(2)
    below = quad(lambda y: 22 * sheath(1 + y * 2 / 160) * y, -1, 0)[0]
    base = quad(lambda y: 20 * (floor(1 + y * 2 / 160) - wall(1 + y * 2 / 160)) * y, 0, 2)[0]
    alone = Hemicircle(8, 2, 2, 160, wall).moment(2.0)
    assert whole.moment(2.0) == pytest.approx(alone + base + both + below, rel=1e-9)


def test_stress_of_a_law_inside_the_winding() -> None:
    stretch = np.linspace(0.7, 1.6, 10)
    assert wound(Material("yeoh", {"c1": 0.157}).principal)(stretch) == pytest.approx(
        effective(0.314)(stretch)
    )
    energy = np.polynomial.Polynomial([0, 0.11, 0.02])

    def stored(s: Any) -> Any:
        return energy(s**2 + s**-2.0 - 2)

    slope = (stored(stretch + 1e-6) - stored(stretch - 1e-6)) / 2e-6
    assert ELASTOSIL(stretch) == pytest.approx(slope, rel=1e-7, abs=1e-9)


def test_errata_as_numbers() -> None:
    printed = dataclasses.replace(BASE, paper=True)
    assert printed.pressure(2 * math.pi) == pytest.approx(38.05, abs=0.005)
    assert printed.pressure(2.0) == pytest.approx(160 * BASE.pressure(2.0), rel=1e-14)
    # the factor L also turns the trend round: section V-A's 'longer needs more pressure'
    longer = Hemicircle(8, 2, 2, 180)
    assert longer.pressure(6.0) < BASE.pressure(6.0)
    assert dataclasses.replace(longer, paper=True).pressure(6.0) > printed.pressure(6.0)
    # s2/s1 = λ/(λ² + 1) of any law W(I1): 'significantly smaller, s2 < s1/2', says the paper
    stretch = np.array([1.0001, 1.5])
    along, around, across = RUBBER.principal(stretch, np.ones(2), 1 / stretch)
    ratio = (around - across) / ((along - across) / stretch)
    assert ratio == pytest.approx([0.5, 0.4615], abs=5e-5)
    # 200 kPa at 360° asks for a smaller modulus than the calibrated one
    assert 0.314 * 0.2 / BASE.pressure(2 * math.pi) == pytest.approx(0.264, abs=5e-4)
    # '1 ≤ λ < 1.5': the roof at 360°, over the cases of Table I
    cases = [(6, 100, 2), (6, 130, 2), (6, 160, 2), (8, 100, 2), (8, 130, 2)]
    cases += [(8, 160, 1), (8, 160, 2), (8, 160, 3), (10, 160, 2), (12, 160, 2)]
    roof = [1 + (2 + a + t) * 2 * math.pi / length for a, length, t in cases]
    assert sum(stretch > 1.5 for stretch in roof) == 6


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wall": 0.0}, "wall: positive mm"),
        ({"length": math.inf}, "length: positive mm"),
        ({"radius": math.nan}, "radius: positive mm"),
        ({"sheath": -1.0}, "sheath: zero or positive"),
        ({"sheath": 1.0}, "thickness and its stress"),
        ({"sheath_stress": ELASTOSIL}, "thickness and its stress"),
        ({"acts": "cap"}, "chamber or winding"),
        ({"paper": True, "acts": "winding"}, "no other acting area"),
    ],
)
def test_meaningless_models_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        dataclasses.replace(BASE, **change)
    with pytest.raises(ValueError, match="cap_length"):
        BASE.force(0.1, 0)
    with pytest.raises(ValueError, match="modulus"):
        effective(0.0)
