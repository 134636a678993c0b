"""A curve through points that costs a control loop less than a microsecond to read."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from analytic.stress import Floats


class CubicTable:
    """Piecewise cubic y(x) in plain Python floats; beyond its ends it stays at the end values.

    Arrays cost numpy some microseconds a call, whatever their size; a bisection in a list and a
    Horner scheme in floats cost a tenth of that.

    Attributes:
        low: least knot.
        high: greatest knot.
    """

    def __init__(self, curve: CubicSpline | PchipInterpolator) -> None:
        """Take over the pieces of a scipy interpolant."""
        self._curve = curve
        self._knots: list[float] = curve.x.tolist()
        self._pieces = list(zip(self._knots[:-1], *curve.c.tolist(), strict=True))
        self._last = len(self._knots) - 1
        self.low, self.high = self._knots[0], self._knots[-1]

    @classmethod
    def smooth(cls, x: Floats, y: Floats) -> CubicTable:
        """Through points of a smooth curve, both (n,), x rising: a spline, error of order h⁴."""
        return cls(CubicSpline(x, y))

    @classmethod
    def monotone(cls, x: Floats, y: Floats) -> CubicTable:
        """Through any points, both (n,), x rising: between two of them it never leaves them."""
        return cls(PchipInterpolator(x, y))

    def __call__(self, x: float) -> float:
        """The value at x."""
        if x < self.low:
            x = self.low
        elif x > self.high:
            x = self.high
        start, c3, c2, c1, c0 = self._pieces[bisect_right(self._knots, x, 1, self._last) - 1]
        x -= start
        return ((c3 * x + c2) * x + c1) * x + c0

    def slope(self, x: float) -> float:
        """The derivative at x, and at its ends beyond them."""
        x = min(max(x, self.low), self.high)
        start, c3, c2, c1, _ = self._pieces[bisect_right(self._knots, x, 1, self._last) - 1]
        x -= start
        return (3 * c3 * x + 2 * c2) * x + c1

    def values(self, x: Floats) -> Floats:
        """The values at many x of any shape."""
        return np.asarray(self._curve(np.clip(x, self.low, self.high)), dtype=float)
