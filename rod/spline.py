"""Smooth functions of several variables: products of B-splines, fitted to values and slopes.

A spline of degree p has p − 1 continuous derivatives: Newton's method sees no corners. Its basis on
each interval is a polynomial in u, 0 ≤ u ≤ 1, by the recursion of Cox and de Boor (de Boor 1978, A
Practical Guide to Splines, doi 10.1007/978-1-4612-6333-3).
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt
from scipy.linalg import solve_triangular

from rod.functions import Floats

_SINGULAR = 1e-11
"""Part of the greatest pivot below which a coefficient is not determined."""


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
        self._inner, self._widths = lines[1:-1], np.diff(lines)
        self._polynomials = _derived(self._pieces, self._widths)

    def basis(self, x: Floats) -> tuple[npt.NDArray[np.intp], Floats]:
        """The splines that are not zero at given points, with two derivatives.

        Args:
            x: points, (n,); beyond the lines the last polynomials go on.

        Returns:
            Number of the first of the p + 1 splines, (n,), and their values, slopes and second
            derivatives, (3, n, p + 1).
        """
        # few calls: numpy needs a microsecond for each
        place = self._inner.searchsorted(x, side="right")
        u = (x - self.lines[place]) / self._widths[place]
        powers = np.empty((len(x), self.degree + 1))
        powers[:, 0], powers[:, 1:] = 1.0, u[:, None]
        np.multiply.accumulate(powers, axis=1, out=powers)
        found = (self._polynomials[place] @ powers[:, :, None])[..., 0]
        return place, found.reshape(len(x), 3, -1).transpose(1, 0, 2)

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


def _derived(pieces: Floats, widths: Floats) -> Floats:
    """Powers of u in values, slopes and second derivatives, (k, 3 splines, powers)."""
    k, b, count = pieces.shape
    out = np.zeros((k, 3, b, count))
    out[:, 0] = pieces
    rise = np.arange(1, count) / widths[:, None]
    for order in (1, 2):
        out[:, order, :, :-1] = out[:, order - 1, :, 1:] * rise[:, None, :]
    return out.reshape(k, 3 * b, count)


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
        second: ∂²f/∂x², (n, d, d); None: not known.
    """

    points: Floats
    values: Floats
    slopes: Floats
    second: Floats | None = None

    def joined(self, more: Samples) -> Samples:
        """With others behind; of none it is those."""
        if not len(self.values):
            return more
        second = None
        if self.second is not None and more.second is not None:
            second = np.concatenate([self.second, more.second])
        return Samples(
            np.concatenate([self.points, more.points]),
            np.concatenate([self.values, more.values]),
            np.concatenate([self.slopes, more.slopes]),
            second,
        )


def fitted(axes: tuple[Axis, ...], samples: Samples) -> Floats:
    """Coefficients of the product splines by least squares of values, slopes, second derivatives.

    Derivatives count by the ranges of their axes, so that units do not matter.

    Args:
        axes: of every variable.
        samples: values and slopes, and what is known of second derivatives.

    Returns:
        Coefficients, (count, ...), an axis for each variable.

    Raises:
        ValueError: the points do not determine them.
    """
    count, shape = len(axes), tuple(axis.count for axis in axes)
    orders: list[tuple[int, ...]] = [(), *((i,) for i in range(count))]
    aims = [samples.values, *samples.slopes.T]
    if samples.second is not None:
        pairs = list(itertools.combinations_with_replacement(range(count), 2))
        orders += pairs
        aims += [samples.second[:, i, j] for i, j in pairs]
    spans = [float(np.ptp(axis.lines)) for axis in axes]
    scales = [math.prod(spans[i] for i in order) for order in orders]
    matrix = np.concatenate(
        [
            scale * rows
            for scale, rows in zip(scales, _rows(axes, samples.points, orders), strict=True)
        ]
    )
    aim = np.concatenate([scale * each for scale, each in zip(scales, aims, strict=True)])
    return _solved(matrix, aim, len(samples.points)).reshape(shape)


def fitted_values(axes: tuple[Axis, ...], points: Floats, values: Floats) -> Floats:
    """Coefficients of the product splines by least squares of values alone.

    Args:
        axes: of every variable.
        points: (n, d).
        values: of several functions there, (n, k).

    Returns:
        Coefficients, (k, count, ...), an axis for each variable behind the functions.

    Raises:
        ValueError: the points do not determine them.
    """
    (rows,) = _rows(axes, points, [()])
    found = _solved(rows, values, len(points))
    return found.T.reshape(-1, *(axis.count for axis in axes))


def _solved(matrix: Floats, aim: Floats, points: int) -> Floats:
    """Least squares, whose columns are made equally long: splines at the ends reach few points."""
    lengths = np.sqrt(np.sum(matrix**2, axis=0))
    if len(matrix) >= len(lengths) and lengths.all():
        q, r = np.linalg.qr(matrix / lengths)
        pivots = np.abs(np.diag(r))
        if pivots.min() > _SINGULAR * pivots.max():
            found: Floats = (solve_triangular(r, q.T @ aim).T / lengths).T
            return found
    raise ValueError(f"{points} points do not determine {len(lengths)} coefficients")


def _rows(
    axes: tuple[Axis, ...], points: Floats, orders: Sequence[tuple[int, ...]]
) -> Iterator[Floats]:
    """Derivatives of all product splines at points, (n, coefficients), one by one.

    Args:
        axes: of every variable.
        points: (n, d).
        orders: numbers of the variables by which to derive.
    """
    n, found = len(points), []
    for axis, x in zip(axes, points.T, strict=True):
        first, basis = axis.basis(x)
        full = np.zeros((3, n, axis.count))
        places = first[:, None] + np.arange(axis.degree + 1)
        for times in range(3):
            np.put_along_axis(full[times], places, basis[times], axis=1)
        found.append(full)
    for order in orders:
        block = np.ones((n, 1))
        for number, full in enumerate(found):
            part = full[order.count(number)]
            block = (block[:, :, None] * part[:, None, :]).reshape(n, -1)
        yield block
