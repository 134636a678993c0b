"""Bending angle from measured pressure in real time: the angle filter of a control loop. MPa, rad.

Section VI and Fig. 12 of Polygerinos et al. 2015 (doi 10.1109/TRO.2015.2428504): 'utilizing (19)
and the measured input air pressure information P_a, the angle filter of the feedback loop was able
to estimate the actuator bending angle θ_a'.
"""

from __future__ import annotations

import dataclasses
import math
import time

import numpy as np

from analytic.bending import Hemicircle
from analytic.control.cubic_table import CubicTable
from analytic.inverse import ROUND_OFF
from analytic.stress import Floats

_INTERVALS = 400
TOLERANCE = 1e-6
"""Greatest error of a filter against the model that it inverts, rad."""


@dataclasses.dataclass(frozen=True)
class LinearTable:
    """A filter as a short table for a microcontroller: equal steps of P, straight in between.

    Attributes:
        pressure: pressures, (n,), MPa.
        angle: angles, (n,), rad, in single precision.
        error: greatest difference from the filter between the ends, rad.
    """

    pressure: Floats
    angle: Floats
    error: float


class AngleFilter:
    """θ(P), the inverse of eq. (19) or of any tabulated curve, for one sample at a time.

    Beyond its table it stays at the table's end: a controller must get a number for every sample,
    and the end value drives the valves in the right direction.

    Attributes:
        low: least pressure of the table, MPa.
        high: greatest pressure of the table, MPa.
        error: greatest error found midway between the knots, rad. Of `from_model` against the
            model; of `from_curve` the difference between a monotone cubic and a spline through
            the same points, which is what the points leave open.
    """

    def __init__(self, table: CubicTable, back: CubicTable, error: float) -> None:
        """Take over a table θ(P); `from_model` and `from_curve` make one.

        Args:
            table: θ in rad over P in MPa, rising.
            back: P over θ.
            error: greatest error of `table`, rad.
        """
        self._table, self._back = table, back
        self.low, self.high = table.low, table.high
        self.error = error

    @classmethod
    def from_model(cls, actuator: Hemicircle) -> AngleFilter:
        """Invert eq. (19) from half the angle that closes the section backward to 720°.

        Rubber with a limiting stretch ends it before.

        Raises:
            ValueError: P does not rise with θ everywhere, or the table misses `TOLERANCE`.
        """
        angle = np.linspace(*actuator.tabulated, _INTERVALS + 1)
        pressure = actuator.pressure(angle)
        _check_rising(pressure, angle)
        table = CubicTable.smooth(pressure, angle)
        middle = (angle[1:] + angle[:-1]) / 2
        error = float(np.abs(table.values(actuator.pressure(middle)) - middle).max())
        if error > TOLERANCE:
            raise ValueError(f"filter: error of {error:.2g} rad, more than {TOLERANCE:g}")
        return cls(table, CubicTable.smooth(angle, pressure), error)

    @classmethod
    def from_curve(cls, pressure: Floats, angle: Floats) -> AngleFilter:
        """Invert a computed or measured curve.

        Args:
            pressure: pressures, (n,), MPa, rising.
            angle: angles, (n,), rad, rising.

        Raises:
            ValueError: fewer than two points, arrays of different shapes, or a curve that does not
                rise everywhere: there one pressure has several angles.
        """
        pressure, angle = np.asarray(pressure, dtype=float), np.asarray(angle, dtype=float)
        if pressure.ndim != 1 or pressure.shape != angle.shape or len(pressure) < 2:
            raise ValueError("filter: two lists of one length of at least 2 expected")
        _check_rising(pressure, angle)
        table = CubicTable.monotone(pressure, angle)
        middle = (pressure[1:] + pressure[:-1]) / 2
        other = CubicTable.smooth(pressure, angle).values(middle)
        error = float(np.abs(table.values(middle) - other).max())
        return cls(table, CubicTable.monotone(angle, pressure), error)

    def __call__(self, pressure: float) -> float:
        """Angle in rad at a pressure in MPa.

        Raises:
            ValueError: the pressure is not a number.
        """
        if pressure != pressure:
            raise ValueError("filter: the pressure is not a number")
        return self._table(pressure)

    def angles(self, pressure: Floats) -> Floats:
        """Angles in rad at many pressures in MPa, of any shape."""
        return self._table.values(np.asarray(pressure, dtype=float))

    def pressure(self, angle: float) -> float:
        """Pressure in MPa at which the filter gives an angle in rad.

        Raises:
            ValueError: the filter never gives this angle.
        """
        slack = ROUND_OFF * (self._back.high - self._back.low)
        if not self._back.low - slack <= angle <= self._back.high + slack:
            low, high = math.degrees(self._back.low), math.degrees(self._back.high)
            raise ValueError(
                f"filter: it gives angles from {low:.4g} to {high:.4g}°, "
                f"not {math.degrees(angle):.4g}°"
            )
        return self._back(angle)

    def slope(self, pressure: float) -> float:
        """dθ/dP in rad/MPa."""
        return self._table.slope(pressure)

    def linear_table(self, low: float, high: float, points: int) -> LinearTable:
        """A table in equal steps for linear interpolation.

        Args:
            low: first pressure, MPa.
            high: last pressure, MPa.
            points: number of points, at least 2.

        Raises:
            ValueError: bounds that do not rise or lie outside the filter, or too few points.
        """
        if not self.low <= low < high <= self.high:
            raise ValueError(
                f"table: from {low:.6g} to {high:.6g} MPa, expected rising bounds between "
                f"{self.low:.6g} and {self.high:.6g} MPa"
            )
        if points < 2:
            raise ValueError(f"table: {points} points, expected at least 2")
        pressure = np.linspace(low, high, points)
        rounded = np.round(self.angles(pressure), 7) + 0.0  # no minus zero
        angle = rounded.astype(np.float32).astype(float)
        fine = np.linspace(low, high, 20 * (points - 1) + 1)
        error = float(np.abs(np.interp(fine, pressure, angle) - self.angles(fine)).max())
        return LinearTable(pressure, angle, error)


def seconds_per_sample(angle_filter: AngleFilter, samples: int = 100_000) -> float:
    """Time that one sample costs, s: the least of five loops over pressures of the whole table."""
    pressures = np.random.default_rng(0).uniform(angle_filter.low, angle_filter.high, samples)
    plain = pressures.tolist()
    times = []
    for _ in range(5):
        start = time.perf_counter()
        for pressure in plain:
            angle_filter(pressure)
        times.append(time.perf_counter() - start)
    return min(times) / samples


def _check_rising(pressure: Floats, angle: Floats) -> None:
    if not (np.isfinite(pressure).all() and np.isfinite(angle).all()):
        raise ValueError("filter: a point of the curve is not finite")
    rising = (np.diff(pressure) > 0) & (np.diff(angle) > 0)
    if not rising.all():
        where = math.degrees(angle[int(np.argmin(rising))])
        raise ValueError(f"filter: pressure and angle do not both rise beyond {where:.4g}°")
