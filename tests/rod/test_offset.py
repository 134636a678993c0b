"""A law with strains beside those of the forces: exact derivatives, and what it does to a rod."""

from __future__ import annotations

import numpy as np
import pytest

from rod.functions import Floats
from rod.layout import Layout
from rod.offset import Offset
from rod.rod import Level, Rod
from rod.statics import Path, solve
from rod.table import tabulate

COEFFICIENTS = np.array([[0.05, 0.004], [0.2, -0.03], [-0.6, 0.05]])
"""By P, P² and P³; of a stretch and of a curvature in 1/mm."""
PRESSURE, TINY = 0.3, 1e-5
STRAINS = np.array([[1.02, 0.003], [1.07, 0.012]])


def section(points: Floats) -> tuple[Floats, Floats]:
    """A section whose stiffness grows, under a pressure that widens its chamber."""
    e, k, pressure = (points - [1.0, 0.0, 0.0]).T
    chamber = 20 + 30 * e + 150 * k + 5 * pressure
    value = 40 * e**2 + 900 * k**2 + 60 * e**4 + 80 * e * k - pressure * chamber
    slopes = [80 * e + 240 * e**3 + 80 * k - 30 * pressure, 1800 * k + 80 * e - 150 * pressure]
    return value, np.column_stack([*slopes, -chamber - 5 * pressure])


@pytest.fixture(scope="module")
def law() -> Offset:
    own = tabulate(section, ((0.8, 1.4), (-0.05, 0.1), (0.0, 0.6)), 1e-6)
    return Offset(own, COEFFICIENTS)


@pytest.fixture(params=[COEFFICIENTS, np.stack([COEFFICIENTS, 2 * COEFFICIENTS], axis=1)])
def each(request: pytest.FixtureRequest, law: Offset) -> Offset:
    """The same of all pieces, and one for each."""
    return Offset(law.law, request.param)


def test_derivatives_are_those_of_differences(each: Offset) -> None:
    for number in range(2):
        away = TINY * np.eye(2)[number] * (1.0, 0.01)[number]
        size = away[number]
        slope = (each.value(STRAINS + away, PRESSURE) - each.value(STRAINS - away, PRESSURE)) / 2
        assert slope / size == pytest.approx(each.gradient(STRAINS, PRESSURE)[:, number], rel=1e-6)
        bend = (
            each.gradient(STRAINS + away, PRESSURE) - each.gradient(STRAINS - away, PRESSURE)
        ) / 2
        assert bend / size == pytest.approx(each.hessian(STRAINS, PRESSURE)[:, number], rel=1e-6)
    more, less = PRESSURE + TINY, PRESSURE - TINY
    area = -(each.value(STRAINS, more) - each.value(STRAINS, less)) / (2 * TINY)
    assert area == pytest.approx(each.chamber(STRAINS, PRESSURE), rel=1e-7)
    mixed = -(each.gradient(STRAINS, more) - each.gradient(STRAINS, less)) / (2 * TINY)
    assert mixed == pytest.approx(each.chamber_gradient(STRAINS, PRESSURE), rel=1e-6)
    slope = (each.chamber(STRAINS, more) - each.chamber(STRAINS, less)) / (2 * TINY)
    assert slope == pytest.approx(each.chamber_slope(STRAINS, PRESSURE), rel=1e-5)


def test_without_pressure_it_is_the_law(law: Offset) -> None:
    assert np.array_equal(law.gradient(STRAINS, 0.0), law.law.gradient(STRAINS, 0.0))
    assert np.array_equal(law.hessian(STRAINS, 0.0), law.law.hessian(STRAINS, 0.0))
    # the area still has what the pressure begins to turn
    more = law.law.gradient(STRAINS, 0.0) @ COEFFICIENTS[0]
    assert law.chamber(STRAINS, 0.0) == pytest.approx(law.law.chamber(STRAINS, 0.0) + more)


def test_a_free_rod_has_so_much_more_strain(law: Offset) -> None:
    layout = Layout(np.full(4, 5.0))
    path = Path(Level(), Level(pressure=PRESSURE))
    plain = solve(Rod(layout, law.law), layout.at_rest(), path, 1.0).strains
    found = solve(Rod(layout, law), layout.at_rest(), path, 1.0).strains
    more = PRESSURE ** np.arange(1, 4) @ COEFFICIENTS
    assert np.abs(found - plain - more).max() < 1e-12


def test_outside_is_that_of_the_forces(law: Offset) -> None:
    more = PRESSURE ** np.arange(1, 4) @ COEFFICIENTS
    assert not law.outside(np.array([[1.39, 0.0]]) + more, PRESSURE)
    assert "1.41" in law.outside(np.array([[1.41, 0.0]]) + more, PRESSURE)
