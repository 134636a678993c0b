"""Three shapes of equal chamber area: reference numbers, exact geometry, errata as numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import dblquad

from analytic.equal_area import SHAPES, EqualArea, Shape, text_torques

EXACT = EqualArea(10, 160)
ROUNDED = EqualArea(10, 160, rounded=True)
PAPER = EqualArea(10, 160, paper=True)
ENDS = np.radians([90, 360])


@pytest.mark.parametrize(
    ("shape", "quarter", "full"),
    [("rectangle", 126.72, 381.12), ("hemicircle", 107.25, 322.66), ("circle", 126.36, 364.58)],
)
def test_resistance_of_the_exact_geometry(shape: Shape, quarter: float, full: float) -> None:
    # worked out independently of this project
    assert 1e3 * EXACT.resistance(shape, ENDS) == pytest.approx([quarter, full], abs=0.005)
    assert EXACT.aspect == pytest.approx(1.4765, abs=5e-5)


@pytest.mark.parametrize(
    ("shape", "quarter", "full"),
    # the hemicircle was given to us as 322.0; the integral below has 322.067 like the module
    [("rectangle", 127.0, 381.5), ("hemicircle", 107.1, 322.1), ("circle", 126.9, 366.4)],
)
def test_resistance_with_the_printed_radii(shape: Shape, quarter: float, full: float) -> None:
    assert 1e3 * ROUNDED.resistance(shape, ENDS) == pytest.approx([quarter, full], abs=0.05)


def test_printed_hemicircle_by_another_quadrature() -> None:
    r, t, mu = 8.0, 2.5, 0.314

    def bent(y: float) -> float:
        stretch = 1 + y * 2 * math.pi / 160
        return mu * (stretch - stretch**-3) * y

    arch = dblquad(lambda c, p: (r + c) * bent(t + (r + c) * math.sin(p)), 0, math.pi / 2, 0, t)[0]
    base = dblquad(lambda y, x: bent(y), 0, r + t, 0, t)[0]
    torque = 2 / 3 * r**3 + math.pi / 8 * r**2 * 10
    pressure = 2 * (arch + base) / torque
    assert ROUNDED.resistance("hemicircle", 2 * math.pi) == pytest.approx(pressure, rel=1e-9)
    assert 1e3 * pressure == pytest.approx(322.067, abs=5e-4)


def test_walls_fill_what_the_outline_leaves_around_the_chamber() -> None:
    half, full = EXACT.radii
    t, v = 2.5, EXACT.aspect
    outline = {
        "rectangle": (10 * v + 2 * t) * (10 / v + 2 * t),
        "hemicircle": math.pi / 2 * (half + t) ** 2 + 2 * (half + t) * t,
        "circle": math.pi * (full + t) ** 2,
    }
    for shape in SHAPES:
        area = EXACT._layers[shape].area.sum()
        assert area == pytest.approx(outline[shape] - 100, rel=1e-12)


def test_small_angle_slope_of_the_circle_is_beam_theory() -> None:
    full, t = EXACT.radii[1], 2.5
    inertia = math.pi / 4 * ((full + t) ** 4 - full**4)
    inertia += math.pi * ((full + t) ** 2 - full**2) * (full + t) ** 2
    slope = EXACT.moment("circle", 1e-7) / 1e-7
    assert slope == pytest.approx(4 * 0.314 * inertia / 160, rel=1e-6)
    assert EXACT.moment("circle", 0.0) == 0


def test_conclusion_of_the_paper() -> None:
    angles = np.radians(np.linspace(5, 360, 20))
    box, half, full = (EXACT.resistance(shape, angles) for shape in SHAPES)
    assert np.all(half < 0.9 * np.minimum(box, full))
    assert full == pytest.approx(box, rel=0.05)
    assert EXACT.torque("rectangle") == pytest.approx(EXACT.torque("hemicircle"), rel=1e-14)


def test_errata_as_numbers() -> None:
    # v is 1.46 from r = 0.80 a, 1.47 from the torque rounded to 0.59 a³
    assert 0.5 / (ROUNDED.torque("hemicircle") / 1e3 - 0.25) == pytest.approx(1.46, abs=0.005)
    assert 0.5 / (PAPER.torque("hemicircle") / 1e3 - 0.25) == pytest.approx(1.47, abs=0.005)
    # the main text has the torques about the chamber's own floor, and a third one for the circle
    half, full = ROUNDED.radii
    text = text_torques(1.46)
    assert 2 / 3 * half**3 / 1e3 == pytest.approx(text["hemicircle"], abs=0.005)
    assert (math.pi * full**3 / 1e3, ROUNDED.torque("circle") / 1e3) == pytest.approx(
        (0.55, 0.80), abs=0.005
    )
    assert text["circle"] == 0.72
    # the factor L makes it 61 MPa, and (A15) with dφ and dc exchanged is another body altogether
    assert PAPER.resistance("rectangle", 2 * math.pi) == pytest.approx(61.05, abs=0.005)
    assert PAPER.moment("hemicircle", 2.0) == pytest.approx(160 * ROUNDED.moment("hemicircle", 2.0))
    full, t = PAPER.radii[1], 2.5

    def literally(c: float, phi: float) -> float:
        height = t + full - (full + c) * math.cos(phi)
        stretch = 1 + height * 2 / 160
        return 0.314 * (stretch - stretch**-3) * (full + c) * height * 160

    # outer dc from 0 to π, inner dφ from 0 to t
    printed = 2 * dblquad(lambda phi, c: literally(c, phi), 0, math.pi, 0, t)[0]
    assert PAPER.moment("circle", 2.0) == pytest.approx(printed, rel=1e-9)
    share = PAPER.moment("circle", ENDS) / (160 * ROUNDED.moment("circle", ENDS))
    assert share == pytest.approx([0.704, 0.725], abs=5e-4)


def test_meaningless_comparisons_are_refused() -> None:
    with pytest.raises(ValueError, match="side: positive mm"):
        EqualArea(0, 160)
    with pytest.raises(ValueError, match="length: positive mm"):
        EqualArea(10, math.nan)
    with pytest.raises(ValueError, match="one of rectangle, hemicircle, circle"):
        EXACT.moment("oval", 1.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="one of rectangle, hemicircle, circle"):
        EXACT.torque("oval")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="angle: zero or positive rad"):
        EXACT.resistance("circle", -0.1)
