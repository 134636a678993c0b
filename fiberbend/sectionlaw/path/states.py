"""Free states of a section along the pressure, and states about them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from fiberbend.sectionlaw.path.chart import PathChart
from fiberbend.sectionlaw.path.curve import Curve, rows, through
from fiberbend.sectionlaw.range import Reach
from fiberbend.sectionlaw.states.box import NoStateError, words
from fiberbend.sectionlaw.states.held import Held, HeldState
from rod.functions import Floats

MARGIN = 0.25
"""Beyond what loads make."""
BENT, TWISTED, LONG = 0.08, 0.05, 0.01
"""Greatest curvature and twist about a free state, times the height of the section, and strain of
the line by forces, whatever the loads: a helix of threads yields to a twist at once, and then
hardly."""
_ALONG = 12
"""Free states from rest to the greatest pressure."""
_LINES, _DEGREE = 4, 5
"""Of the splines of the free states."""
_CLOSE = 1e-6
"""Step to a free state, of strains times lengths, at which it is found: the chart needs no more."""
_CORRECTIONS = 5
_ROUND_OFF = 1e-6
"""Part of a size by which a free state moves that has no sign."""
_TRIED = 2
"""Neighbours from which a state is looked for."""
_COUNTS = (1, 3, 8)
"""Steps to it, tried in turn."""
_GRADED = 1.25
_TOLD = 20
"""States between two lines of progress."""


def graded(high: float, intervals: int) -> Floats:
    """Lines of splines by the pressure: threads go taut in the first kilopascals."""
    lines: Floats = high * (np.arange(intervals + 1) / intervals) ** _GRADED
    return lines


def free_path(held: Held, high: float, height: float) -> list[HeldState]:
    """Free states from rest to a pressure, next to enough.

    Args:
        held: the section with all strains held.
        high: MPa.
        height: of the section, mm.

    Raises:
        NoStateError: none is found on the way.
    """
    size = np.array([1.0, height, height, height])
    found = [held.rest]
    for part in (1 - np.cos(np.pi * np.arange(1, _ALONG + 1) / _ALONG)) / 2:
        last = found[-1]
        pressure = part * high
        at = np.append(last.at[:4] + _rate(last) * (pressure - last.at[4]), pressure)
        state = _near(held, last, at)
        for _ in range(_CORRECTIONS):
            step = np.linalg.solve(state.second[:4, :4], state.slopes[:4])
            if float(np.abs(step * size).max()) < _CLOSE:
                break
            state = _near(held, state, np.append(state.at[:4] - step, pressure))
        found.append(state)
    return found


def _near(held: Held, known: HeldState, at: Floats) -> HeldState:
    state = held.near(known, at) or held.along(known, at)
    if state is None:
        raise NoStateError(words(at))
    return state


def _rate(state: HeldState) -> Floats:
    """dε₀/dP, (4,)."""
    rate: Floats = -np.linalg.solve(state.second[:4, :4], state.second[:4, 4])
    return rate


def chart_of(
    path: list[HeldState], reach: Reach, parts: tuple[float, float], alike: bool
) -> PathChart:
    """Coordinates in which the states that loads make fill a box.

    Args:
        path: free states.
        reach: with the loads and the height of the section.
        parts: of the usual sizes, at rest and at the greatest pressure.
        alike: the section is bent alike in all directions.
    """
    pressures = np.array([state.at[4] for state in path])
    high = float(pressures[-1])
    rates = np.array([_rate(state) for state in path[1:]])
    # what is left to a free state, to the first order
    ends = np.array([s.at[:4] - np.linalg.solve(s.second[:4, :4], s.slopes[:4]) for s in path])
    # at rest threads and strips may be about to go slack: what it is there is no rate
    curve = through(graded(high, _LINES), _DEGREE, pressures, ends, rates)
    slopes = np.array([state.second[0, 1:4] / state.second[0, 0] for state in path[1:]])
    beside = _values(curve, pressures[1:], slopes)
    joined = Curve(curve.lines, curve.degree, np.concatenate([curve.coefficients, beside], axis=1))
    own = [np.diag(_condensed(state)) for state in path]
    turns = (1 + MARGIN) * reach.moment / np.min(own, axis=0)
    turns = np.minimum(turns, np.array([BENT, BENT, TWISTED]) / reach.height)
    if alike:
        turns[:2] = turns[:2].min()
    stiff = min(float(state.second[0, 0]) for state in path)
    stretch = min((1 + MARGIN) * reach.force / stiff, LONG)
    way = ends[-1, 1:] - ends[0, 1:]
    signs = np.where(way < -_ROUND_OFF * turns, -1.0, 1.0)
    low, part = parts
    sizes = part * np.array([stretch, *(signs * turns)])
    return PathChart(joined, tuple(sizes.tolist()), low / part)


def _condensed(state: HeldState) -> Floats:
    """Stiffnesses of curvatures and twist where the stretch is free, (3, 3)."""
    second = state.second
    beside = second[0, 1:4]
    own: Floats = second[1:4, 1:4] - np.outer(beside, beside) / second[0, 0]
    return own


def _values(curve: Curve, pressures: Floats, values: Floats) -> Floats:
    """Coefficients of the same splines by values alone."""
    found, *_ = np.linalg.lstsq(rows(curve.axis, pressures)[0], values, rcond=None)
    return np.asarray(found)


@dataclasses.dataclass(frozen=True)
class About:
    """A state about a free one.

    Attributes:
        point: u and P, (5,).
        state: there.
        slopes: ∂Φ/∂(u, P), (5,).
        second: ∂²Φ/∂(u, P)², (5, 5).
    """

    point: Floats
    state: HeldState
    slopes: Floats
    second: Floats


class Surroundings:
    """States about the free ones; each begins at the nearest that is known.

    Args:
        held: the section with all strains held.
        chart: about its free states.
        path: these.
        tell: takes a line of progress.

    Attributes:
        chart: as given.
        found: what was asked for.
    """

    def __init__(
        self,
        held: Held,
        chart: PathChart,
        path: list[HeldState],
        tell: Callable[[str], None] | None = None,
    ) -> None:
        self._held, self.chart, self._tell = held, chart, tell
        self._high = float(path[-1].at[4])
        self._known = list(path)
        self._places = [self._place(state.at) for state in path]
        self.found: list[About] = []

    def _place(self, at: Floats) -> Floats:
        u = self.chart.place(at[None, :4], float(at[4]))[0]
        return np.append(u, 4 * at[4] / self._high)

    def ask(self, points: Floats) -> None:
        """Solve for states at u and P over the greatest, (n, 5), in an order of rising pressure.

        Raises:
            NoStateError: at one of them.
        """
        for part in points[np.argsort(points[:, 4], kind="stable")]:
            point = np.append(part[:4], part[4] * self._high)
            goal = np.append(self.chart.strains(point[None])[0], point[4])
            state = self._go(goal)
            self._known.append(state)
            self._places.append(self._place(goal))
            slopes, second = self.chart.carried(point, state.slopes, state.second)
            self.found.append(About(point, state, slopes, second))
            if self._tell is not None and len(self.found) % _TOLD == 0:
                self._tell(f"law of the section: {len(self.found)} states")

    def _go(self, goal: Floats) -> HeldState:
        away = np.abs(np.array(self._places) - self._place(goal)).max(axis=1)
        nearest = [self._known[i] for i in np.argsort(away, kind="stable")[:_TRIED].tolist()]
        for count in _COUNTS:
            for known in nearest:
                state: HeldState | None = known
                for number in range(1, count + 1):
                    if state is not None:
                        way = (goal - known.at) * (number / count)
                        state = self._held.near(state, known.at + way)
                if state is not None:
                    return state
        raise NoStateError(words(goal))


def spread(first: int, count: int, alike: bool, turned: bool = False) -> Floats:
    """Places that fill the box, closer together toward its faces, (count, 5), P from 0 to 1.

    Polynomials by least squares at such places (arcsine, as Chebyshev's) are good up to the faces.
    The sequence is R_d (Roberts 2018).

    Args:
        first: number of the sequence to begin with.
        count: of them.
        alike: bent about x alone, which stands for all directions.
        turned: in any direction nevertheless.
    """
    root = 2.0
    for _ in range(40):
        root = (1 + root) ** (1 / 6)
    number = np.arange(first, first + count)[:, None] + 1
    parts = (0.5 + number / root ** np.arange(1, 6)) % 1.0
    out = -np.cos(np.pi * parts)
    out[:, 4] = (1 + out[:, 4]) / 2
    if alike:
        way = np.pi * parts[:, 2] if turned else np.zeros(count)
        out[:, 1], out[:, 2] = out[:, 1] * np.cos(way), out[:, 1] * np.sin(way)
    return out
