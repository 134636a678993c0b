"""Smooth functions of the pressure with two derivatives."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from rod.functions import Floats
from rod.spline import Axis


@dataclasses.dataclass(frozen=True)
class Curve:
    """Splines of the pressure, any number of them in an array.

    Attributes:
        lines: ends of the intervals, rising, MPa.
        degree: of the splines.
        coefficients: (splines, ...).
    """

    lines: Floats
    degree: int
    coefficients: Floats

    @functools.cached_property
    def axis(self) -> Axis:
        """The splines."""
        return Axis(self.lines, self.degree)

    def at(self, pressure: float) -> tuple[Floats, Floats, Floats]:
        """Value and two derivatives by P, of the shape of a coefficient.

        Args:
            pressure: P, MPa.
        """
        first, basis = self.axis.basis(np.array([pressure]))
        own = self.coefficients[int(first[0]) : int(first[0]) + self.degree + 1]
        value, slope, bent = np.tensordot(basis[:, 0], own, 1)
        return value, slope, bent


def rows(axis: Axis, pressures: Floats) -> Floats:
    """Splines with two derivatives at pressures, (3, n, splines)."""
    first, basis = axis.basis(pressures)
    out = np.zeros((3, len(pressures), axis.count))
    places = first[:, None] + np.arange(axis.degree + 1)
    for order in range(3):
        np.put_along_axis(out[order], places, basis[order], axis=1)
    return out


def through(lines: Floats, degree: int, pressures: Floats, values: Floats, slopes: Floats) -> Curve:
    """By least squares of values, and of slopes at the last of them.

    Args:
        lines: ends of the intervals, MPa.
        degree: of the splines.
        pressures: (n,), MPa.
        values: (n, ...).
        slopes: by the pressure, (m, ...).
    """
    axis, span = Axis(lines, degree), float(lines[-1] - lines[0])
    own, slope, _ = rows(axis, pressures)
    matrix = np.concatenate([own, span * slope[-len(slopes) :]])
    aim = np.concatenate([values, span * slopes]).reshape(len(matrix), -1)
    found, *_ = np.linalg.lstsq(matrix, aim, rcond=None)
    return Curve(lines, degree, found.reshape(axis.count, *values.shape[1:]))
