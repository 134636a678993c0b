"""The box of a table in its chart: found by walking the section where nothing pulls along it."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from fiberbend.sectionlaw.chart import Chart
from fiberbend.sectionlaw.polynomial import fit
from fiberbend.sectionlaw.range import Reach
from fiberbend.sectionlaw.states.held import Held, HeldState
from rod.functions import Floats

MARGIN = 0.25
"""Beyond the strains of the free states, in parts of them, and beyond the loads."""
BENT = 0.025
"""Least strain by bending or twist on the outside."""
_FREE_BENT = 0.005
"""The same where nothing holds the section."""
PRESSURE_MARGIN = 0.05
SOFT = 0.5
"""Bending stiffness over that at rest below which a section without pressure is left alone: it is
about to buckle, and a rod with it."""
FURTHEST = (0.3, 0.1)
"""Greatest strain by bending or twist on the outside that loads are taken to make, whatever they
are: of a table of one strain beside the stretch, and of two, which has to be made at more states.
"""
_STEPS = 8
"""From rest to the end of a walk."""
_ACROSS, _UP = (0.0, 0.25, 0.5, 0.75, 1.0), (0.0, 0.1, 0.4, 1.0)
"""Places of the walk, in parts of the strains and of the pressure."""
_DEGREE = 3
"""Of λ₀."""
_LEAST_PULL, _PULL, _FREE_PULL = 0.005, 0.015, 0.001
"""Least half widths of e, without pressure and at the greatest, and where nothing holds it."""
_FITTED = 1.3
"""Times what λ₀ misses at the places of the walk, for what it misses between."""


class NoStateError(RuntimeError):
    """A section has no stable state that a walk finds.

    Attributes:
        where: in words.
    """

    def __init__(self, where: str) -> None:
        super().__init__(f"no stable state of the section was found at {where}")
        self.where = where


@dataclasses.dataclass(frozen=True)
class Box:
    """The range of a table.

    Attributes:
        chart: its coordinates, from 0 to 1.
        pressures: least and greatest, MPa; one of them is the farthest from zero.
        known: states with nothing to pull along them that were met, from which others are found.
    """

    chart: Chart
    pressures: tuple[float, float]
    known: tuple[HeldState, ...] = ()

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Of u and P."""
        return (*[(0.0, 1.0)] * len(self.chart.least), self.pressures)

    def at(self, parts: Floats) -> Floats:
        """Pressures at rising parts of the way from the one nearest to zero, in rising order."""
        near, far = sorted(self.pressures, key=abs)
        found: Floats = np.sort(near + parts * (far - near))
        return found


def words(at: Floats) -> str:
    """Strains and a pressure in words."""
    turns = ", ".join(f"{1e3 * value:.5g} 1/m" for value in at[1:-1])
    return f"stretch {at[0]:.5g}, bent or twisted by {turns}, {1e3 * at[-1]:.5g} kPa"


def box_of(
    reach: Reach, held: Held, strains: tuple[str, ...], part: float = 1.0, least: float = 0.0
) -> Box:
    """The range of a table.

    Args:
        reach: what the case takes.
        held: its section.
        strains: of the table, the stretch first.
        part: of the margins.
        least: pressure from which the table is, MPa, of the sign of those of the case.

    Raises:
        NoStateError: the section has no state within it.
    """
    free = np.array([[getattr(state, name) for name in strains] for _, state in reach.free])
    # a vacuum is below zero: what moves with the pressure is by its size, and then turned
    pressures = np.abs([pressure for pressure, _ in reach.free])
    sign = math.copysign(1.0, reach.free[0][0])
    high = sign * (1.0 + part * PRESSURE_MARGIN) * float(pressures.max())
    ends = np.array(
        [
            [_end(reach, held, number, way, part, free[:, number]) for way in (-1.0, 1.0)]
            for number in range(1, len(strains))
        ]
    )
    rise = sign * _rise(ends, free[:, 1:], pressures, part if reach.held else None)
    places = _places(ends, rise, high)
    known = _walk(held, places)
    y = np.array([state.at[1:] for state in known])
    slack = np.array([state.slopes[0] / state.second[0, 0] for state in known])
    stretches = np.array([state.at[0] for state in known]) - slack
    pull = _pulls(reach, known, float(pressures.max()))
    share = y[:, -1] / high
    weights = 1.0 / (pull[0] + share * (pull[1] - pull[0]))
    unpulled = fit(y, stretches, weights, _DEGREE, 1.0)
    missed = np.abs(unpulled.value(y) - stretches)
    halves = [
        part * pull[row] + _FITTED * float(missed[near].max())
        for row, near in enumerate((share < 0.2, share > 0.2))
    ]
    grown = (halves[1] - halves[0]) / high
    chart = Chart(
        unpulled,
        least=(-halves[0], *ends[:, 0].tolist()),
        drifts=(-grown, *rise[0].tolist()),
        widths=(2 * halves[0], *np.ptp(ends, axis=1).tolist()),
        growths=(2 * grown, *(rise[1] - rise[0]).tolist()),
    )
    return Box(chart, (min(least, high), max(least, high)), tuple(known))


def _pulls(reach: Reach, known: list[HeldState], pressure: float) -> tuple[float, float]:
    """Half widths of e, without pressure and at the greatest.

    What is held bears the thrust of its chamber. What is not bears its loads alone, at its softest:
    along a strip of fabric a section is fifty times as stiff as where that is slack, and a range of
    a hundredth would hide the kink between the two in one interval.
    """
    stiffnesses = [float(state.second[0, 0]) for state in known]
    if not reach.held:
        free = max(_FREE_PULL, reach.force / min(stiffnesses))
        return free, free
    thrust = reach.force + pressure * -min(float(state.slopes[-1]) for state in known)
    stiff = float(np.median(stiffnesses))
    return max(_LEAST_PULL, reach.force / stiff), max(_PULL, thrust / stiff)


def _end(reach: Reach, held: Held, number: int, sign: float, part: float, free: Floats) -> float:
    """How far a strain goes without pressure: as far as loads take it, or the section bears it."""
    rest = held.rest
    stiff = _own(rest, number)
    bent = BENT if reach.held else _FREE_BENT
    least = max(MARGIN * float(np.abs(free).max()), bent / reach.height)
    load = (1 + MARGIN) * reach.moment
    most = max(least, FURTHEST[min(held.rest.at.size - 3, 1)] / reach.height)
    step = min(max(least, load / stiff), most) / _STEPS
    state, reached = rest, 0.0
    for _ in range(4 * _STEPS):
        goal = state.at[1:].copy()
        goal[number - 1] += sign * step
        new = _unpulled(held, state, goal)
        if new is None or _own(new, number) < SOFT * stiff:
            break
        state, reached = new, abs(float(new.at[number]))
        far = reached >= least * (1 - 1e-9)
        if far and (abs(float(new.slopes[number])) >= load or reached >= most * (1 - 1e-9)):
            break
    if not reached:
        raise NoStateError(words(np.array([1.0, *goal])))
    return sign * part * reached


def _rise(ends: Floats, free: Floats, pressures: Floats, part: float | None) -> Floats:
    """How the ends of the strains but the stretch move with a pressure's size, (2, r), rad/mm/MPa.

    At a pressure they are as far from the free state as they are from rest without, and include
    what is kept straight, with a part of the margin; None: nothing keeps it straight.
    """
    low = high = free
    if part is not None:
        margin = part * MARGIN * np.abs(free).max(axis=0)
        low = np.minimum(free + ends[:, 0], -margin) - ends[:, 0]
        high = np.maximum(free + ends[:, 1], margin) - ends[:, 1]
    by = pressures[:, None]
    rise: Floats = np.array([(low / by).min(axis=0), (high / by).max(axis=0)])
    return rise


def _own(state: HeldState, number: int) -> float:
    """Stiffness against a strain where the stretch is free."""
    second = state.second
    return float(second[number, number] - second[0, number] ** 2 / second[0, 0])


def _unpulled(held: Held, state: HeldState, goal: Floats) -> HeldState | None:
    """A state near another one, at about the stretch at which nothing pulls along the line.

    Args:
        held: the section.
        state: from which it begins.
        goal: curvatures, twist and pressure.
    """
    way = state.slopes[0] + state.second[0, 1:] @ (goal - state.at[1:])
    stretch = state.at[0] - way / state.second[0, 0]
    return held.near(state, np.array([stretch, *goal]))


def _places(ends: Floats, rise: Floats, high: float) -> list[Floats]:
    """Strains but the stretch, and pressures, in an order in which neighbours follow each other."""
    found: list[Floats] = []
    count = len(ends)
    for level, share in enumerate(_UP):
        pressure = share * high
        low, top = ends[:, 0] + rise[0] * pressure, ends[:, 1] + rise[1] * pressure
        grid = np.stack(np.meshgrid(*[_ACROSS] * count, indexing="ij"), axis=-1).reshape(-1, count)
        for parts in grid[:: -1 if level % 2 else 1]:
            found.append(np.array([*(low + parts * (top - low)), pressure]))
    return found


def _walk(held: Held, places: list[Floats]) -> list[HeldState]:
    sizes = np.ptp(np.array(places), axis=0)
    sizes[sizes == 0] = 1.0
    found: list[HeldState] = []
    for place in places:
        begins = [*found, held.rest]
        away = [float(np.abs((state.at[1:] - place) / sizes).max()) for state in begins]
        state = begins[int(np.argmin(away))]
        count = max(1, math.ceil(_STEPS * min(away) / 2))
        way = place - state.at[1:]
        start = state.at[1:]
        for number in range(1, count + 1):
            new = _unpulled(held, state, start + way * (number / count))
            if new is None:
                raise NoStateError(words(np.array([state.at[0], *place])))
            state = new
        found.append(state)
    return found
