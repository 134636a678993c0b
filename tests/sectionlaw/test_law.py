"""Laws by a table in a chart: derivatives, and places that are remembered."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from fiberbend.sectionlaw.chart import Chart
from fiberbend.sectionlaw.law import SectionLaw
from fiberbend.sectionlaw.polynomial import Polynomial
from rod.functions import Floats
from rod.spline import Axis, Samples
from rod.table import Table


@pytest.fixture
def law() -> SectionLaw:
    """Any smooth one."""
    rng = np.random.default_rng(4)
    axes = tuple(Axis(np.linspace(0.0, end, 3), 5) for end in (1.0, 1.0, 0.1))
    coefficients = rng.random([axis.count for axis in axes])
    none = Samples(np.empty((0, 3)), np.empty(0), np.empty((0, 3)))
    powers = tuple(itertools.product(range(3), repeat=2))
    unpulled = Polynomial((0.5, 0.2), powers, tuple((0.1 * rng.random(len(powers))).tolist()))
    chart = Chart(unpulled, (-0.2, -0.3), (0.1, 0.2), (0.9, 0.8), (0.4, 0.3))
    return SectionLaw(Table(axes, coefficients, none, np.empty(0)), chart)


def places(count: int) -> Floats:
    return np.random.default_rng(count).uniform(0.05, 0.4, (count, 2))


def test_derivatives_are_those_of_differences(law: SectionLaw) -> None:
    strains, pressure, h = places(6), 0.03, 1e-6
    points = [(strains + h * e[:2], pressure + h * e[2]) for e in np.eye(3)]
    back = [(strains - h * e[:2], pressure - h * e[2]) for e in np.eye(3)]
    for number, (ahead, behind) in enumerate(zip(points, back, strict=True)):
        slope = (law.value(*ahead) - law.value(*behind)) / (2 * h)
        np.testing.assert_allclose(law.first(strains, pressure)[:, number], slope, atol=1e-7)
        bend = (law.first(*ahead) - law.first(*behind)) / (2 * h)
        found = law.second(strains, pressure)[:, number]
        np.testing.assert_allclose(found, bend, rtol=1e-6, atol=1e-6)


def test_what_it_remembers_is_of_the_place_that_is_asked_for(law: SectionLaw) -> None:
    """Also where what it was asked with, or has answered, is written over."""
    strains = places(5)
    first = law.gradient(strains, 0.03)
    kept = first.copy()
    first[:] = 7.0
    np.testing.assert_array_equal(law.gradient(strains, 0.03), kept)
    assert not np.array_equal(law.gradient(strains, 0.04), kept)
    strains += 0.01
    assert not np.array_equal(law.gradient(strains, 0.03), kept)
    for count in range(6, 12):
        law.hessian(places(count), 0.03)
    np.testing.assert_array_equal(law.gradient(places(5), 0.03), kept)
