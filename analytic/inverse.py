"""Inverse of P(θ): tabulated, fast enough for a control loop, or one angle as far as it goes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from analytic.stress import Floats

BACKWARD = -math.pi / 2
FORWARD = 4 * math.pi
"""Greatest angles in each direction for which θ(P) is looked for, rad."""

WITHIN = 0.97
"""A table of θ(P) ends so near the angle at which some rubber meets its limiting stretch: P grows
there without bound."""

ROUND_OFF = 1e-9
"""Part of a range by which a value at its end may miss it."""
_INTERVALS = 400
_GRID = 181
_HALVINGS = 60


def angle_range(length: float, roof: float, below: float = 0.0) -> tuple[float, float]:
    """Least and greatest angle in rad for which θ(P) of an actuator is looked for.

    Backward bending ends at half the angle at which the roof is squeezed to nothing, forward
    bending just before what lies below y = 0 is.

    Args:
        length: length L of the inextensible line y = 0, mm.
        roof: height of the highest line above it, mm.
        below: depth of the lowest line below it, mm.
    """
    forward = min(FORWARD, 0.99 * length / below) if below else FORWARD
    return max(BACKWARD, -length / roof / 2), forward


def table_range(
    pressure: Callable[[Floats], Floats], low: float, high: float
) -> tuple[float, float]:
    """The part of a range of angles in rad for which θ(P) is tabulated.

    Args:
        pressure: P(θ) in MPa, elementwise, also a little beyond the range; no number beyond the
            limiting stretch of a rubber.
        low: least θ, at most 0.
        high: greatest θ, at least 0.
    """
    ends = []
    for end in (low, high):
        last = _last_number(pressure, 0.0, end / WITHIN)
        ends.append(end if last == end / WITHIN else WITHIN * last)
    return ends[0], ends[1]


def _last_number(pressure: Callable[[Floats], Floats], start: float, end: float) -> float:
    """The angle nearest to an end at which P is a number, as it is at the start; rad.

    It is one on a range of angles: a stretch that grows with θ meets its limit once.
    """
    if np.isfinite(pressure(np.asarray(end))):
        return end
    for _ in range(_HALVINGS):
        middle = (start + end) / 2
        if np.isfinite(pressure(np.asarray(middle))):
            start = middle
        else:
            end = middle
    return start


class FoundAngle(NamedTuple):
    """An angle that `first_angle` found."""

    angle: float
    """θ in rad."""
    pressure: float
    """P there, MPa, without sign."""
    end: Literal["", "peak", "limit", "bound"]
    """Nothing where P(θ) is the target; else why it is not reached: P has its greatest value at
    θ, the rubber meets its limiting stretch beyond θ, or θ is the bound."""


def first_angle(pressure: Callable[[Floats], Floats], target: float, bound: float) -> FoundAngle:
    """The first angle from 0 on at a pressure, or the last one before P falls or θ ends.

    Args:
        pressure: P(θ) in MPa, elementwise, P(0) = 0.
        target: P wanted, MPa, of the sign of P(bound).
        bound: where the search ends, rad, of either sign.
    """
    from scipy.optimize import brentq

    angles = np.linspace(0.0, bound, _GRID)
    values = np.abs(pressure(angles))
    falls = np.flatnonzero(~(np.diff(values) > 0))
    last = int(falls[0]) if len(falls) else _GRID - 1
    limited = len(falls) > 0 and not np.isfinite(values[last + 1])
    if limited:
        # P grows without bound in the last piece: all of it counts
        angles[last + 1] = _last_number(pressure, angles[last], angles[last + 1])
        values[last + 1] = abs(pressure(angles[last + 1]))
        last += int(values[last + 1] > values[last])
    beyond = np.flatnonzero(values[: last + 1] >= abs(target))
    if len(beyond):
        first = int(beyond[0])
        angle = brentq(lambda x: float(pressure(x)) - target, angles[first - 1], angles[first])
        return FoundAngle(float(angle), abs(target), "")
    end: Literal["peak", "limit", "bound"] = "bound"
    if len(falls):
        end = "limit" if limited else "peak"
    return FoundAngle(float(angles[last]), float(values[last]), end)


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
            ValueError: P does not rise with θ everywhere.
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
        slack = ROUND_OFF * (high - low)
        outside = ~((pressure >= low - slack) & (pressure <= high + slack))
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
