"""What a section does when it is bent to the side and twisted a little, beside its table."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable

import numpy as np

from fiberbend.sectionlaw.law import SectionLaw
from fiberbend.sectionlaw.range import Reach
from fiberbend.sectionlaw.space import Round, Space
from fiberbend.sectionlaw.states.box import Box, NoStateError, words
from fiberbend.sectionlaw.states.held import Held, HeldState
from fiberbend.sectionlaw.states.walk import Walk
from rod.functions import Floats
from rod.law import Law
from rod.spline import Axis, Samples, fitted_values
from rod.table import Table

ERROR = 0.02
"""Greatest error of moments to the side and torques, of those at the limits: strains may be as
large as that allows."""
_MARGIN = 1.25
"""Times the strains that loads make."""
_SHEARED = 0.2
"""Greatest strain of the outside by them."""
_STEPS = 8
"""Times that the limits are made smaller."""
_STILL = 1e-6
"""Side curvature and twist, over the height of the section, that are of round-off."""
_FAR = 4.0
"""Error over what is allowed that stands for that of a state that is not there."""
_LINES = ((0.0, 1.0), (0.0, 0.5, 1.0), (0.0, 0.2, 1.0))
_DEGREES = (1, 3, 3)
"""Splines of H by e, by each other strain, and by the pressure."""
_ASKED = ((0.0, 1.0), (0.0, 0.25, 0.5, 0.75, 1.0), (0.0, 0.07, 0.25, 0.6, 1.0))
"""Lines of the states at which H is solved for; the middles of their boxes are asked too."""
_CHECKS = 12
_SAME = 1e-6
"""Part of the stiffnesses that is zero by symmetry."""


@dataclasses.dataclass(frozen=True)
class Side:
    """H of `fiberbend.sectionlaw.space.Space` as it was made.

    Attributes:
        small: names of the strains.
        alike: the section is alike in all directions.
        limits: greatest of each, rad/mm.
        pairs: i and j of each H_ij.
        lines: of the axes of the splines.
        degrees: of the axes.
        coefficients: of H_ij by u and P, (pairs, ...).
        error: of forces at scattered states within the limits, in parts of those at the limits.
        states: that were solved for it.
    """

    small: tuple[str, ...]
    alike: bool
    limits: tuple[float, ...]
    pairs: tuple[tuple[int, int], ...]
    lines: tuple[tuple[float, ...], ...]
    degrees: tuple[int, ...]
    coefficients: Floats
    error: float
    states: int

    def law(self, section: SectionLaw) -> Space | Round | SectionLaw:
        """The law in space.

        Args:
            section: of the table.
        """
        axes = tuple(
            Axis(np.array(lines), degree)
            for lines, degree in zip(self.lines, self.degrees, strict=True)
        )
        none = Samples(np.empty((0, len(axes))), np.empty(0), np.empty((0, len(axes))))
        tables = [Table(axes, each, none, np.empty(0)) for each in self.coefficients]
        laws = [SectionLaw(table, section.chart, section.strains) for table in tables]
        parts = tuple(
            (i, j, Round(law) if self.alike else law)
            for (i, j), law in zip(self.pairs, laws, strict=True)
        )
        base = Round(section) if self.alike else section
        return Space(base, self.small, parts, self.limits) if self.small else base


def side_of(
    held: Held,
    strains: tuple[str, ...],
    section: SectionLaw,
    box: Box,
    reach: Reach,
    alike: bool,
    tell: Callable[[str], None] | None = None,
) -> Side:
    """Second derivatives by the strains that are not in a table, and how far they serve.

    Args:
        held: the section with all strains held.
        strains: names of all.
        section: the law of the table.
        box: of the table.
        reach: with its loads and its height.
        alike: the section is alike in all directions.
        tell: takes lines of progress.

    Raises:
        NoStateError: the section has no state somewhere.
        ValueError: no symmetry turns the sign of the small strains.
    """
    large = section.strains
    around = ("side_curvature",) if alike else ()
    small = tuple(name for name in strains if name not in (*large, *around))
    columns = tuple(strains.index(name) for name in large)
    places = [strains.index(name) for name in small]
    walk = Walk(held, dataclasses.replace(box, known=()), tell, columns)
    states = _states(walk, box, len(large)) if small else {}
    points = np.array(list(states))
    second = np.array([state.second for state in states.values()])
    pairs = list(itertools.combinations_with_replacement(range(len(small)), 2))
    axes, coefficients = _axes(box, len(large)), np.empty((0,))
    stiff = np.ones(0)
    if small:
        mixed = second[:, places][:, :, [*columns, len(strains)]]
        own = np.diagonal(second, axis1=1, axis2=2)
        size = np.sqrt(np.abs(own[:, places, None] * own[:, None, [*columns, len(strains)]]))
        if np.any(np.abs(mixed) > _SAME * size):
            raise ValueError("no symmetry of the section keeps it from bending to the side")
        values = np.array([second[:, places[i], places[j]] for i, j in pairs])
        used = [
            number
            for number, (i, j) in enumerate(pairs)
            if i == j or np.any(np.abs(values[number]) > _SAME * np.abs(values).max())
        ]
        pairs = [pairs[number] for number in used]
        coefficients = fitted_values(axes, points, values[used].T)
        stiff = own[:, places].min(axis=0)
    side = Side(
        small=small,
        alike=alike,
        limits=tuple(np.minimum(_MARGIN * reach.moment / stiff, _SHEARED / reach.height).tolist()),
        pairs=tuple(pairs),
        lines=tuple(tuple(axis.lines.tolist()) for axis in axes),
        degrees=tuple(axis.degree for axis in axes),
        coefficients=coefficients,
        error=0.0,
        states=held.solved,
    )
    try:
        return _limited(held, strains, section, walk, side, box)
    except NoStateError:
        if not (reach.idle and small) or alike:
            raise
        # no force leads it there: beyond round-off a rod is outside
        return dataclasses.replace(side, limits=(_STILL / reach.height,) * len(small))


def _axes(box: Box, count: int) -> tuple[Axis, ...]:
    first, turns, last = (np.array(part) for part in _LINES)
    lines = [first, *[turns] * (count - 1), box.at(last)]
    degrees = [_DEGREES[0], *[_DEGREES[1]] * (count - 1), _DEGREES[2]]
    return tuple(Axis(line, degree) for line, degree in zip(lines, degrees, strict=True))


def _states(walk: Walk, box: Box, count: int) -> dict[tuple[float, ...], HeldState]:
    first, turns, last = (np.array(part) for part in _ASKED)
    lines = [first, *[turns] * (count - 1), box.at(last)]
    halves = [(line[1:] + line[:-1]) / 2 for line in lines]
    grids = [np.meshgrid(*each, indexing="ij") for each in (lines, halves)]
    points = np.concatenate([np.stack(grid, axis=-1).reshape(-1, count + 1) for grid in grids])
    order = np.lexsort(points.T)
    return {tuple(point.tolist()): walk.state(point) for point in points[order]}


def _limited(
    held: Held,
    strains: tuple[str, ...],
    section: SectionLaw,
    walk: Walk,
    side: Side,
    box: Box,
) -> Side:
    """With limits within which its forces are known, and their error at scattered states."""
    count, extra = len(section.strains), len(strains) - len(section.strains)
    columns = [strains.index(name) for name in section.strains]
    others = [number for number in range(len(strains)) if number not in columns]
    limits = {strains.index(n): limit for n, limit in zip(side.small, side.limits, strict=True)}
    # side curvature of what is alike in all directions is as large as the table has it
    around = [number for number in others if number not in limits]
    parts = _parts(count + 1 + extra, _CHECKS)
    widest = section.chart.widths[1]
    low, high = np.array(box.ranges).T
    error = 0.0
    for _ in range(_STEPS):
        law, error = side.law(section), 0.0
        for part in parts:
            point = low + (0.1 + 0.8 * part[: count + 1]) * (high - low)
            state = walk.state(point)
            at = state.at.copy()
            for number, share in zip(others, part[count + 1 :], strict=True):
                at[number] = (2 * share - 1) * limits.get(number, 0.0)
            for number in around:
                turn = 2 * np.pi * part[-1]
                at[1], at[number] = at[1] * np.cos(turn), at[1] * np.sin(turn)
            found = held.along(state, at)
            if found is None:
                if not limits:
                    raise NoStateError(words(at))
                # as far out as that there is no state
                error = _FAR * ERROR
                break
            error = max(error, _off(law, found, limits | dict.fromkeys(around, widest)))
        side = dataclasses.replace(
            side,
            limits=tuple(limits[strains.index(name)] for name in side.small),
            error=error,
            states=held.solved,
        )
        if error <= ERROR or not limits:
            break
        limits = {number: 0.9 * (ERROR / error) ** 0.5 * limit for number, limit in limits.items()}
    if error > ERROR:
        raise NoStateError(f"strains of {max(side.limits):.3g} 1/mm to the side")
    return side


def _off(law: Law, state: HeldState, limits: dict[int, float]) -> float:
    """Error of moments to the side at a state, of those at the limits."""
    told = law.gradient(state.at[None, :-1], float(state.at[-1]))[0]
    off = np.abs(told - state.slopes[:-1])
    worst = [
        off[number] / (state.second[number, number] * limit) for number, limit in limits.items()
    ]
    return max([float(value) for value in worst], default=0.0)


def _parts(d: int, count: int) -> Floats:
    """Numbers from 0 to 1 that fill the cube evenly, (count, d)."""
    root = 2.0
    for _ in range(40):
        root = (1 + root) ** (1 / (d + 1))
    number = np.arange(1, count + 1)
    parts: Floats = (0.5 + number[:, None] / root ** np.arange(1, d + 1)) % 1.0
    return parts
