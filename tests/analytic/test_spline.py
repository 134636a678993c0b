"""The spline through points beside that of scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from analytic.spline import through


@pytest.mark.parametrize("count", [2, 3, 4, 5, 40])
def test_it_is_that_of_scipy(count: int) -> None:
    random = np.random.default_rng(count)
    x = np.cumsum(random.uniform(0.1, 2.0, count))
    y = random.standard_normal(count)
    part = np.linspace(0.0, 1.0, 7)
    places = x[:-1, None] + np.diff(x)[:, None] * part
    spline = make_interp_spline(x, y, min(3, count - 1))
    value, rate = through(x, y, part)
    assert value == pytest.approx(spline(places), abs=1e-12)
    assert rate == pytest.approx(spline(places, 1), abs=1e-11)
