"""States of a section whose strains are held, from neighbour to neighbour."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fiberbend.sectionlaw.states.box import Box, NoStateError, words
from fiberbend.sectionlaw.states.held import Held, HeldState
from rod.functions import Floats

_STEPS = (1.0, 0.25, 0.06, 0.015)
"""Longest steps, in parts of the range, tried in turn."""
_TRIED = 3
"""Neighbours from which a state is looked for: Newton's method may go to and fro at the kink of a
thread that goes slack from one, and not from the next."""
_TOLD = 50
"""States between two lines of progress."""


class Walk:
    """A section in one compiled scene; each new state begins at the nearest one that is known.

    Args:
        held: the section.
        box: of the table.
        tell: takes a line of progress.
        columns: of the strains of the table among those that are held, all of them unless given;
            the others are zero.

    Attributes:
        known: states by u and P, at what was asked for.
    """

    def __init__(
        self,
        held: Held,
        box: Box,
        tell: Callable[[str], None] | None = None,
        columns: tuple[int, ...] | None = None,
    ) -> None:
        self._held, self._box, self._tell = held, box, tell
        count = len(held.rest.at) - 1
        self._columns = list(range(count) if columns is None else columns)
        self._count = count
        low, high = np.array(box.ranges).T
        self._widths: Floats = high - low
        self._states = [held.rest, *box.known]
        self._places = [self._place(state.at) for state in self._states]
        self.known: dict[tuple[float, ...], HeldState] = {}

    def sample(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """As `rod.table.Sample`.

        Raises:
            NoStateError: at one of them.
        """
        chart, states = self._box.chart, [self.state(point) for point in points]
        forces = np.array([state.slopes for state in states])
        second = np.array([state.second for state in states])
        values = np.array([state.energy for state in states])
        return values, chart.carried(points, forces), chart.bent(points, forces, second)

    def state(self, point: Floats) -> HeldState:
        """The state at u and P.

        Raises:
            NoStateError: none is found.
        """
        key = tuple(point.tolist())
        if key not in self.known:
            self.known[key] = self._go(point)
            if self._tell is not None and len(self.known) % _TOLD == 0:
                self._tell(f"table of the section: {len(self.known)} states")
        return self.known[key]

    def _place(self, at: Floats) -> Floats:
        """u and P by strains and P."""
        place = self._box.chart.place(at[None, self._columns], float(at[-1]))[0]
        return np.array([*place, at[-1]])

    def _go(self, point: Floats) -> HeldState:
        """The state at a point, by steps as small as it takes.

        Raises:
            NoStateError: none of them leads there.
        """
        goal = np.zeros(self._count + 1)
        goal[self._columns] = self._box.chart.strains(point[None, :])[0]
        goal[-1] = point[-1]
        away = np.abs((np.array(self._places) - point) / self._widths).max(axis=1)
        nearest = np.argsort(away, kind="stable")[:_TRIED].tolist()
        for step in _STEPS:
            for number in nearest:
                count = max(1, math.ceil(away[number] / step))
                state = self._steps(self._states[number], goal, count)
                if state is not None:
                    return state
        raise NoStateError(words(goal))

    def _steps(self, state: HeldState, goal: Floats, count: int) -> HeldState | None:
        """Go from a known state by equal steps; None: not by these."""
        start, found = state.at, state
        for part in range(1, count + 1):
            new = self._held.near(
                found, goal if part == count else start + (goal - start) * (part / count)
            )
            if new is None:
                return None
            found = new
            self._states.append(new)
            self._places.append(self._place(new.at))
        return found
