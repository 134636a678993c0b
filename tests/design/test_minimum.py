"""The minimum under conditions, on functions whose minimum is known."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fiberbend.design.search.minimum import Slopes, Values, descend

Floats = Any


@dataclasses.dataclass
class Known:
    """Functions in closed form, with derivatives by central differences."""

    goal: Callable[[Floats], float]
    below: Callable[[Floats], list[float]] = lambda _x: []
    zero: Callable[[Floats], list[float]] = lambda _x: []
    none: Callable[[Floats], bool] = lambda _x: False
    asked: int = 0

    def values(self, x: Floats) -> Values | None:
        """As of `Functions`."""
        self.asked += 1
        if self.none(x):
            return None
        return Values(self.goal(x), np.array(self.below(x)), np.array(self.zero(x)))

    def slopes(self, x: Floats) -> Slopes | None:
        """As of `Functions`."""

        def by(function: Callable[[Floats], Any]) -> Floats:
            sides = [
                (np.array(function(x + d)) - np.array(function(x - d))) / 2e-6
                for d in 1e-6 * np.eye(len(x))
            ]
            return np.array(sides).T

        n = len(x)
        below, zero = (by(f).reshape(-1, n) for f in (self.below, self.zero))
        return Slopes(by(self.goal), below, zero)


def test_an_inner_minimum() -> None:
    found = descend(Known(lambda x: (1 - 2 * x[0]) ** 2 + 10 * (2 * x[1] - x[0]) ** 2), [0.1, 0.9])
    assert found is not None
    assert found.whole
    np.testing.assert_allclose(found.x, [0.5, 0.25], atol=2e-3)


def test_multipliers_are_the_slopes_of_the_minimum_by_its_conditions() -> None:
    functions = Known(lambda x: -x[0] - 2 * x[1], lambda x: [x[0] ** 2 + x[1] ** 2 - 0.9])
    found = descend(functions, [0.1, 0.1])
    assert found is not None
    assert found.multipliers is not None
    # the minimum is −√(5 R) where x² + y² ≤ R
    assert found.values.goal == pytest.approx(-np.sqrt(4.5), rel=1e-5)
    np.testing.assert_allclose(found.x, np.sqrt(0.9 / 5) * np.array([1, 2]), atol=3e-3)
    assert found.multipliers.below[0] == pytest.approx(np.sqrt(5 / 0.9) / 2, rel=1e-3)
    assert not found.multipliers.low.any()
    assert not found.multipliers.high.any()


def test_bounds_that_are_active_have_multipliers() -> None:
    found = descend(Known(lambda x: 3 * x[0] - 2 * x[1], zero=lambda x: [x[2] - 0.4]), [0.5] * 3)
    assert found is not None
    assert found.multipliers is not None
    np.testing.assert_allclose(found.x, [0, 1, 0.4], atol=1e-9)
    np.testing.assert_allclose(found.multipliers.low, [3, 0, 0], atol=1e-6)
    np.testing.assert_allclose(found.multipliers.high, [0, 2, 0], atol=1e-6)


def test_what_cannot_be_met_is_missed_least_and_says_what_stops_it() -> None:
    functions = Known(lambda x: x[0], zero=lambda x: [x[0] * x[1] * (2 - x[1]) - 2])
    found = descend(functions, [0.3, 0.1], goal=False)
    assert found is not None
    assert found.multipliers is not None
    # x1 (2 - x1) has its greatest value at the end of the range, where it is level
    assert found.x[0] == pytest.approx(1.0)
    assert found.values.miss == pytest.approx(1.0, abs=1e-3)
    assert found.multipliers.high[0] == pytest.approx(1.0, abs=0.05)
    assert functions.asked < 40


def test_points_without_values_are_walked_round() -> None:
    functions = Known(lambda x: -x[0] - x[1], none=lambda x: x[0] + x[1] > 1.2)
    found = descend(functions, [0.3, 0.1])
    assert found is not None
    assert -1.2 <= found.values.goal < -1.19
    assert descend(functions, [0.9, 0.9]) is None
