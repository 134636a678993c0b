"""Inverse of a smooth rising function, fast enough for a control loop."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from analytic.stress import Floats

_INTERVALS = 400


class MonotoneInverse:
    """θ(P) from P(θ): a spline of the inverse, and a Newton step with the spline's slope.

    Attributes:
        angles: least and greatest θ that it returns, rad.
        pressures: P at these, MPa.
    """

    def __init__(self, pressure: Callable[[Floats], Floats], low: float, high: float) -> None:
        """Tabulate.

        Args:
            pressure: P(θ) in MPa, elementwise.
            low: least θ, rad.
            high: greatest θ, rad.

        Raises:
            ValueError: P does not rise with θ all the way.
        """
        # a fifth of a second to import, and many a curve is never inverted
        from scipy.interpolate import CubicSpline

        angles = np.linspace(low, high, _INTERVALS + 1)
        values = pressure(angles)
        rising = np.diff(values) > 0
        if not np.all(rising):
            where = np.degrees(angles[int(np.argmin(rising))])
            raise ValueError(
                f"pressure does not rise with the angle beyond {where:.4g}°: no inverse"
            )
        self.angles = (low, high)
        self.pressures = (float(values[0]), float(values[-1]))
        self._pressure = pressure
        slopes = CubicSpline(values, angles).derivative()(values)
        self._spline = CubicSpline(values, np.column_stack([angles, slopes]))

    def __call__(self, pressure: Floats) -> Floats:
        """Angles in rad of pressures of any shape in MPa.

        Raises:
            ValueError: a pressure that is not finite, or outside `pressures`.
        """
        low, high = self.pressures
        outside = ~((pressure >= low) & (pressure <= high))
        if outside.any():
            wrong = float(pressure[outside].flat[0])
            first, last = np.degrees(self.angles)
            raise ValueError(
                f"pressure {1e3 * wrong:.6g} kPa is outside {1e3 * low:.6g} to {1e3 * high:.6g} kPa"
                f", which bend by {first:.4g} to {last:.4g}°"
            )
        guess = self._spline(pressure)
        angle, slope = guess[..., 0], guess[..., 1]
        # the spline is good to about 1e-9, and the step squares that
        result: Floats = np.asarray(angle - (self._pressure(angle) - pressure) * slope)
        return result
