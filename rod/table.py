"""A law of a section by a table that refines itself: values and forces known at points.

Between them Φ(ε; P) is a smooth spline (`rod.spline`), of which forces, stiffnesses and the area of
the chamber are exact derivatives: a rod by a table keeps its energy as by a formula.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from rod.functions import Floats
from rod.law import Sections
from rod.spline import Axis, Samples, fitted

Sample = Callable[[Floats], tuple[Floats, Floats] | tuple[Floats, Floats, Floats]]
"""Of points (ε, P), (n, m + 1), gives Φ, (n,), ∂Φ by strains and pressure, (n, m + 1), and, where
it is known, ∂²Φ, (n, m + 1, m + 1)."""
Sizes = Callable[[Samples], Floats]
"""Of samples gives what the errors of their slopes are measured by, (n, m + 1)."""
DEGREE, PRESSURE_DEGREE, HIGH_DEGREE = 4, 3, 5
"""Of the splines: three and two continuous derivatives; of all where ∂²Φ is known."""
INTERVALS, PRESSURE_INTERVALS = 3, 1
"""At first: fewer would leave splines of these degrees undetermined."""
_KEPT = 8
"""Pressures of which a table remembers its coefficients."""
_OUTSIDE = 1e-9
_LEAST = 32
"""Fewest points to which a table is compared."""
_HELPED = 0.7
"""Part of the error before to which halved intervals bring it, where more of them help."""
_SPLIT = 0.5
"""Jumps beyond this part of the greatest one halve an interval."""


class NotReachedError(RuntimeError):
    """A table does not reach the error that was asked for with the points it may use."""


@dataclasses.dataclass(frozen=True)
class Table:
    """Φ(ε; P) by splines; a `rod.law.Law`.

    Attributes:
        axes: of the strains and, last, of the pressure in MPa.
        coefficients: of the product splines, N.
        samples: what it is fitted to.
        errors: greatest error of ∂Φ by each variable at points that are not fitted, in parts of its
            size, (m + 1,); at those that are too where ∂²Φ is not known.
    """

    axes: tuple[Axis, ...]
    coefficients: Floats
    samples: Samples
    errors: Floats
    _sheets: dict[float, Floats] = dataclasses.field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def _at(self, strains: Floats, pressure: float, orders: Sequence[tuple[int, ...]]) -> Floats:
        """Derivatives of given orders by each variable, (len(orders), n)."""
        wanted = np.array([(order[-1], *order[:-1]) for order in orders]) @ self._digits
        return self._derived(strains[None], np.array([pressure])).T[wanted]

    @functools.cached_property
    def _digits(self) -> npt.NDArray[np.intp]:
        """What an order by the pressure, and by each strain, counts in the rows of `_derived`."""
        return 3 ** np.arange(len(self.axes) - 1, -1, -1)

    @functools.cached_property
    def _window(self) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """Places of the splines of the strains in a flat sheet.

        Returns:
            Of neighbours along each axis, (m,), and of all splines of a box from its first one on.
        """
        counts = [axis.count for axis in self.axes[:-1]]
        strides = np.cumprod([1, *counts[:0:-1]])[::-1]
        inner = np.zeros(1, dtype=np.intp)
        for axis, stride in zip(self.axes, strides.tolist(), strict=False):
            inner = (inner[:, None] + stride * np.arange(axis.degree + 1)).ravel()
        return strides, inner

    def _sheet(self, pressure: float) -> Floats:
        """Coefficients at a pressure, with two derivatives by it: (splines of the strains, 3)."""
        known = self._sheets
        if pressure not in known:
            last = self.axes[-1]
            first, basis = last.basis(np.array([pressure]))
            reach = slice(int(first[0]), int(first[0]) + last.degree + 1)
            if len(known) >= _KEPT:
                known.clear()
            known[pressure] = (self.coefficients[..., reach] @ basis[:, 0].T).reshape(-1, 3)
        return known[pressure]

    def _derived(self, strains: Floats, pressures: Floats) -> Floats:
        """All derivatives up to the second by each variable, the pressure's first: (k n, 3^d).

        Args:
            strains: (k, n, m).
            pressures: of each k, MPa.
        """
        k, n, m = strains.shape
        sheets = [self._sheet(pressure) for pressure in pressures.tolist()]
        flat = sheets[0] if k == 1 else np.concatenate(sheets)
        strides, inner = self._window
        first: Any = 0 if k == 1 else np.repeat(len(sheets[0]) * np.arange(k), n)
        bases = []
        for axis, x, stride in zip(self.axes, strains.reshape(-1, m).T, strides, strict=False):
            start, values = axis.basis(x)
            first = first + stride * start
            bases.append(values.transpose(1, 0, 2))
        part = flat.take(first[:, None] + inner, axis=0)
        # all derivatives by one variable after the other move to the end
        for values in bases:
            turned = values @ part.reshape(k * n, values.shape[2], -1)
            part = turned.transpose(0, 2, 1)
        return part.reshape(k * n, -1)

    def _unit(self, *strains: int, pressure: int = 0) -> tuple[int, ...]:
        order = [0] * len(self.axes)
        for number in strains:
            order[number] += 1
        order[-1] = pressure
        return tuple(order)

    def first(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ by the strains and the pressure, (n, m + 1)."""
        m = strains.shape[1]
        orders = [*(self._unit(i) for i in range(m)), self._unit(pressure=1)]
        return self._at(strains, pressure, orders).T

    def whole(self, strains: Floats, pressures: Floats) -> Sections:
        """See `rod.law.whole`."""
        k, n, m = strains.shape
        found = self._derived(strains, pressures)[:, self._places]
        return Sections(
            found[:, 0].reshape(k, n),
            found[:, 1 : m + 2].reshape(k, n, m + 1),
            found[:, m + 2 :].reshape(k, n, m + 1, m + 1),
        )

    @functools.cached_property
    def _places(self) -> npt.NDArray[np.intp]:
        """Columns of `_derived` of the value and of the derivatives that `whole` gives."""
        by = np.roll(self._digits, -1)
        return np.concatenate([[0], by, (by[:, None] + by).ravel()])

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self._at(strains, pressure, [self._unit()])[0]

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        m = strains.shape[1]
        return self._at(strains, pressure, [self._unit(i) for i in range(m)]).T

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        m = strains.shape[1]
        pairs = list(itertools.combinations_with_replacement(range(m), 2))
        found = self._at(strains, pressure, [self._unit(*pair) for pair in pairs])
        out = np.empty((len(strains), m, m))
        for (i, j), values in zip(pairs, found, strict=True):
            out[:, i, j] = out[:, j, i] = values
        return out

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return -self._at(strains, pressure, [self._unit(pressure=1)])[0]

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        m = strains.shape[1]
        return -self._at(strains, pressure, [self._unit(i, pressure=1) for i in range(m)]).T

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return -self._at(strains, pressure, [self._unit(pressure=2)])[0]

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`."""
        points = np.column_stack([strains, np.full(len(strains), pressure)])
        for number, axis in enumerate(self.axes):
            x, low, high = points[:, number], axis.lines[0], axis.lines[-1]
            slack = _OUTSIDE * (high - low)
            if x.min() < low - slack or x.max() > high + slack:
                name = "pressure" if number == len(self.axes) - 1 else f"strain {number + 1}"
                return (
                    f"{name} from {x.min():.6g} to {x.max():.6g} in a table from {low:.6g} to "
                    f"{high:.6g}"
                )
        return ""

    def softest(self, pressure: float) -> tuple[float, Floats]:
        """Where Φ is least convex at a pressure: a rod is unstable there by itself if below zero.

        Args:
            pressure: P, MPa.

        Returns:
            Lowest eigenvalue of ∂²Φ/∂ε² in parts of the ranges of the strains, N, and the strains.
        """
        *axes, _ = self.axes
        fine = [np.linspace(axis.lines[0], axis.lines[-1], 4 * len(axis.lines)) for axis in axes]
        strains = np.stack(np.meshgrid(*fine, indexing="ij"), axis=-1).reshape(-1, len(axes))
        ranges = np.array([np.ptp(axis.lines) for axis in axes])
        lowest = np.linalg.eigvalsh(self.hessian(strains, pressure) * np.outer(ranges, ranges))[
            :, 0
        ]
        place = int(np.argmin(lowest))
        return float(lowest[place]), strains[place]


def tabulate(
    sample: Sample,
    ranges: Sequence[tuple[float, float]],
    error: float,
    most: int = 2000,
    begin: Sequence[Floats] | None = None,
    sizes: Sizes | None = None,
    degree: int = HIGH_DEGREE,
    enough: float = 0.0,
) -> Table:
    """A table whose forces are known to an error, by halving intervals where they are not.

    It is fitted on a grid of the lines, with what lies halfway between them: all crossings of those
    too, or the middles of the boxes alone where second derivatives are known. It is compared with
    the law at scattered points, which are never fitted: they would pull it about unevenly. While it
    misses one, the intervals are halved at whose ends its highest derivative jumps most.

    Args:
        sample: the law at points; it is asked in an order in which neighbours follow each other.
        ranges: of the strains and, last, of the pressure in MPa.
        error: of each derivative of Φ in parts of its size.
        most: greatest number of points.
        begin: lines at first, from 0 to 1 over each range.
        sizes: of the derivatives; their ranges over the table unless given.
        degree: of the splines where second derivatives are known.
        enough: an error that serves where finer lines hardly help, as at the kinks of what goes
            slack, or where they need too many points.

    Returns:
        The table.

    Raises:
        NotReachedError: `most` points are not enough.
        ValueError: the law is not finite at a point.
    """
    if begin is None:
        counts = [*[INTERVALS] * (len(ranges) - 1), PRESSURE_INTERVALS]
        begin = [np.linspace(0.0, 1.0, k + 1) for k in counts]
    lines = [low + part * (high - low) for (low, high), part in zip(ranges, begin, strict=True)]
    empty = np.empty((0, len(lines)))
    samples = checks = Samples(empty, np.empty(0), empty)
    missed, second = math.inf, False
    table: Table | None = None
    while True:
        halves = [(axis[1:] + axis[:-1]) / 2 for axis in lines]
        corners = _grid(lines)
        if not len(samples.values):
            samples = _asked(sample, corners[:1], samples)
            second = samples.second is not None
        if second:
            grid = np.concatenate([corners, _grid(halves)])
            count = _LEAST
        else:
            grid = _grid([_merged(*pair) for pair in zip(lines, halves, strict=True)])
            count = max(_LEAST, math.prod(len(half) for half in halves))
        scattered = _scattered(lines, len(checks.values), count)
        points = len(samples.values) + len(_new(grid, samples)) + len(checks.values) + count
        if points > most:
            if table is not None and missed <= enough:
                return table
            raise NotReachedError(
                f"forces of the table are off by {missed:.2g} of their range, {error:.2g} asked "
                f"for: {points} points are needed, {most} allowed"
            )
        samples = _asked(sample, grid, samples)
        checks = _asked(sample, scattered, checks)
        degrees = [DEGREE] * (len(lines) - 1) + [PRESSURE_DEGREE]
        if second:
            degrees = [degree] * len(lines)
        axes = tuple(Axis(*pair) for pair in zip(lines, degrees, strict=True))
        table = Table(axes, fitted(axes, samples), samples, np.empty(0))
        # with second derivatives a fit is close to its points without being exact between them
        errors = _errors(table, checks if second else samples.joined(checks), sizes)
        before, missed = missed, float(errors.max())
        table = dataclasses.replace(table, errors=errors)
        if missed <= error or _HELPED * before < missed <= enough:
            return table
        jumps = [_jumps(axis, table.coefficients, number) for number, axis in enumerate(axes)]
        least = _SPLIT * max(float(jump.max()) for jump in jumps)
        lines = [
            _merged(axis, half[jump >= least])
            for axis, half, jump in zip(lines, halves, jumps, strict=True)
        ]


def _merged(lines: Floats, more: Floats) -> Floats:
    return np.sort(np.concatenate([lines, more]))


def _scattered(lines: Sequence[Floats], first: int, count: int) -> Floats:
    """Points between all lines, of a sequence that fills the box evenly (Roberts 2018: R_d).

    Args:
        lines: of the axes.
        first: number of points that were taken before.
        count: number of points.
    """
    d = len(lines)
    # the root of x^(d + 1) = x + 1
    root = 2.0
    for _ in range(40):
        root = (1 + root) ** (1 / (d + 1))
    number = np.arange(first + 1, first + count + 1)
    parts = (0.5 + number[:, None] / root ** np.arange(1, d + 1)) % 1.0
    low = np.array([axis[0] for axis in lines])
    high = np.array([axis[-1] for axis in lines])
    out: Floats = low + parts * (high - low)
    return out


def _grid(lines: Sequence[Floats]) -> Floats:
    """All crossings, row by row and back, so that neighbours follow each other."""
    points = np.empty((1, 0))
    for axis in lines:
        rows = [
            np.column_stack([np.tile(row, (len(axis), 1)), axis[:: -1 if number % 2 else 1]])
            for number, row in enumerate(points)
        ]
        points = np.concatenate(rows)
    return points


def _new(points: Floats, samples: Samples) -> Floats:
    known = {tuple(point) for point in samples.points.tolist()}
    new = [point for point in points.tolist() if tuple(point) not in known]
    return np.array(new).reshape(-1, points.shape[1])


def _asked(sample: Sample, points: Floats, samples: Samples) -> Samples:
    """With what was not known yet."""
    new = _new(points, samples)
    if not len(new):
        return samples
    values, slopes, *rest = sample(new)
    broken = ~(np.isfinite(values) & np.isfinite(slopes).all(axis=1))
    for second in rest:
        broken |= ~np.isfinite(second).all(axis=(1, 2))
    if broken.any():
        raise ValueError(f"the law is not finite at {new[broken][0].tolist()}")
    return samples.joined(Samples(new, values, slopes, *rest))


def _errors(table: Table, samples: Samples, sizes: Sizes | None) -> Floats:
    """Of the derivatives at all points, in parts of their sizes, (m + 1,)."""
    worst = np.zeros(len(table.axes))
    if sizes is None:
        ranges = np.ptp(samples.slopes, axis=0)
        ranges[ranges == 0] = 1.0
        by = np.broadcast_to(ranges, samples.slopes.shape)
    else:
        by = sizes(samples)
    for pressure in np.unique(samples.points[:, -1]):
        here = samples.points[:, -1] == pressure
        strains, slopes = samples.points[here, :-1], samples.slopes[here]
        found = np.column_stack(
            [table.gradient(strains, pressure), -table.chamber(strains, pressure)]
        )
        worst = np.maximum(worst, np.abs((found - slopes) / by[here]).max(axis=0))
    return worst


def _jumps(axis: Axis, coefficients: Floats, number: int) -> Floats:
    """Of the highest derivative at the ends of each interval, times h^p, (k,)."""
    highest = axis.highest(np.moveaxis(coefficients, number, 0))
    if len(highest) == 1:
        # of one interval nothing jumps: the derivative itself, which is no smaller
        return np.array([np.abs(highest).max() * np.diff(axis.lines)[0] ** axis.degree])
    jumps = np.zeros(len(highest) + 1)
    jumps[1:-1] = np.abs(np.diff(highest, axis=0)).reshape(len(highest) - 1, -1).max(axis=1)
    greatest: Floats = np.maximum(jumps[1:], jumps[:-1]) * np.diff(axis.lines) ** axis.degree
    return greatest
