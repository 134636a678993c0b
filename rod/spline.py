"""Smooth functions of several variables: products of B-splines, fitted to values and slopes.

A spline of degree p has p − 1 continuous derivatives: Newton's method sees no corners. Its basis on
each interval is a polynomial in u, 0 ≤ u ≤ 1, by the recursion of Cox and de Boor (de Boor 1978, A
Practical Guide to Splines, doi 10.1007/978-1-4612-6333-3).
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import numpy.typing as npt

from rod.functions import Floats


class Axis:
    """B-splines of one variable.

    Args:
        lines: ends of the intervals, rising, (k + 1,).
        degree: p.

    Attributes:
        lines: as given.
        degree: as given.
        count: number of B-splines, k + p.

    Raises:
        ValueError: lines that do not rise.
    """

    def __init__(self, lines: Floats, degree: int) -> None:
        if len(lines) < 2 or not np.all(np.diff(lines) > 0):
            raise ValueError(f"lines of a table: at least two that rise expected, not {lines}")
        self.lines, self.degree = lines, degree
        self.count = len(lines) - 1 + degree
        self._pieces = _pieces(lines, degree)

    def basis(self, x: Floats) -> tuple[npt.NDArray[np.intp], Floats]:
        """The splines that are not zero at given points, with two derivatives.

        Args:
            x: points, (n,); beyond the lines the last polynomials go on.

        Returns:
            Number of the first of the p + 1 splines, (n,), and their values, slopes and second
            derivatives, (3, n, p + 1).
        """
        lines, p = self.lines, self.degree
        place = np.clip(np.searchsorted(lines, x, side="right") - 1, 0, len(lines) - 2)
        width = np.diff(lines)[place]
        u = (x - lines[place]) / width
        power = np.arange(p + 1)
        rise = np.zeros((3, len(x), p + 1))
        rise[0] = u[:, None] ** power
        rise[1, :, 1:] = rise[0, :, :-1] * power[1:] / width[:, None]
        rise[2, :, 1:] = rise[1, :, :-1] * power[1:] / width[:, None]
        return place.astype(np.intp), np.einsum("dnk,nbk->dnb", rise, self._pieces[place])

    def highest(self, coefficients: Floats) -> Floats:
        """The derivative of order p, which is constant on each interval.

        Args:
            coefficients: of the splines, (count, ...).

        Returns:
            On the intervals, (k, ...).
        """
        p, widths = self.degree, np.diff(self.lines)
        leading = [
            np.tensordot(self._pieces[k, :, p], coefficients[k : k + p + 1], axes=1) / width**p
            for k, width in enumerate(widths)
        ]
        out: Floats = float(math.factorial(p)) * np.stack(leading)
        return out


def _pieces(lines: Floats, degree: int) -> Floats:
    """Coefficients of the powers of u on each interval, (k, p + 1 splines, p + 1 powers)."""
    low, high = lines[0], lines[-1]
    knots = np.concatenate([np.full(degree, low), lines, np.full(degree, high)])
    out = np.zeros((len(lines) - 1, degree + 1, degree + 1))
    for interval in range(len(lines) - 1):
        at = interval + degree
        start, width = knots[at], knots[at + 1] - knots[at]
        splines = {at: np.eye(degree + 1)[0]}
        for p in range(1, degree + 1):
            raised = {}
            for i in range(at - p, at + 1):
                total = np.zeros(degree + 1)
                for j, sign in ((i, 1.0), (i + 1, -1.0)):
                    below = splines.get(j)
                    if below is None:
                        continue
                    # sign (x − end)/(span of the knots) times the spline below, x = start + width u
                    span = knots[j + p] - knots[j]
                    end = knots[i] if sign > 0 else knots[i + p + 1]
                    total += sign * (start - end) / span * below
                    total[1:] += sign * width / span * below[:-1]
                raised[i] = total
            splines = raised
        for b in range(degree + 1):
            out[interval, b] = splines[at - degree + b]
    return out


@dataclasses.dataclass(frozen=True)
class Samples:
    """A function at points.

    Attributes:
        points: x, (n, d).
        values: f, (n,).
        slopes: ∂f/∂x, (n, d).
    """

    points: Floats
    values: Floats
    slopes: Floats

    def joined(self, more: Samples) -> Samples:
        """With others behind."""
        return Samples(
            np.concatenate([self.points, more.points]),
            np.concatenate([self.values, more.values]),
            np.concatenate([self.slopes, more.slopes]),
        )


def fitted(axes: tuple[Axis, ...], samples: Samples) -> Floats:
    """Coefficients of the product splines by least squares of values and slopes.

    Slopes count by the range of their axis, so that units do not matter.

    Args:
        axes: of every variable.
        samples: values and slopes.

    Returns:
        Coefficients, (count, ...), an axis for each variable.

    Raises:
        ValueError: the points do not determine them.
    """
    n, shape = len(samples.points), tuple(axis.count for axis in axes)
    found = [axis.basis(x) for axis, x in zip(axes, samples.points.T, strict=True)]
    rows, aims = [], []
    for slope in range(-1, len(axes)):
        scale = 1.0 if slope < 0 else float(np.ptp(axes[slope].lines))
        block = np.ones((n, 1))
        for number, (axis, (first, basis)) in enumerate(zip(axes, found, strict=True)):
            part = np.zeros((n, axis.count))
            places = first[:, None] + np.arange(axis.degree + 1)
            np.put_along_axis(part, places, basis[int(number == slope)], axis=1)
            block = (block[:, :, None] * part[:, None, :]).reshape(n, -1)
        rows.append(scale * block)
        aims.append(samples.values if slope < 0 else scale * samples.slopes[:, slope])
    matrix = np.concatenate(rows)
    solution, _, rank, _ = np.linalg.lstsq(matrix, np.concatenate(aims), rcond=1e-12)
    if rank < matrix.shape[1]:
        raise ValueError(f"{n} points do not determine {matrix.shape[1]} coefficients")
    out: Floats = solution.reshape(shape)
    return out
