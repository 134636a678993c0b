"""States of a section whose stretch and curvature are held, from neighbour to neighbour."""

from __future__ import annotations

import math

import numpy as np

from fem.effects.sums.hold import BEND, LENGTHENED, Hold
from fem.march.records import State
from fiberbend.case.case import Case
from fiberbend.effects.hold import hold
from fiberbend.sectionlaw.range import Box
from fiberbend.trial import loads
from fiberbend.uniform.small import PRESSURE, Small
from rod.functions import Floats

_STEPS = (0.25, 0.06, 0.015)
"""Longest steps, in parts of the range, tried in turn."""
_TRIED = 3
"""Neighbours from which a state is looked for: Newton's method may go to and fro at the kink of a
thread that goes slack from one, and not from the next."""
_SOME = 1e-3


class NoStateError(RuntimeError):
    """A section has no stable state that a walk finds.

    Attributes:
        where: in words.
    """

    def __init__(self, where: str) -> None:
        super().__init__(f"no stable state of the section was found at {where}")
        self.where = where


def _at_rest(box: Box) -> Floats:
    place = box.chart.place(np.array([[1.0, 0.0]]), 0.0)[0]
    return np.array([*place, 0.0])


class Walk:
    """A section in one compiled scene; each new state begins at the nearest one that is known.

    Args:
        case: whose winding waits for nothing.
        box: of the table.

    Attributes:
        known: Φ and its slopes by e, u and P, at what was asked for.
        solved: states that were solved.
    """

    def __init__(self, case: Case, box: Box) -> None:
        loaded = loads.inflated(case, (_SOME,))
        effects = (*loaded.effects, hold(1.0, 0.0))
        self._small = Small(loaded.model_copy(update={"effects": effects}))
        self._box, self._length = box, case.actuator.length
        self._share = self._small.scene.body.symmetry_factor / self._length
        low, high = np.array(box.ranges).T
        self._widths: Floats = high - low
        self._places: list[Floats] = [_at_rest(box)]
        self._states: list[State] = [self._small.rest]
        self.known: dict[tuple[float, ...], tuple[float, Floats]] = {}
        self.solved = 0

    def sample(self, points: Floats) -> tuple[Floats, Floats]:
        """As `rod.table.Sample`.

        Raises:
            NoStateError: at one of them.
        """
        found = [self._at(point) for point in points]
        return np.array([value for value, _ in found]), np.array([slopes for _, slopes in found])

    def _at(self, point: Floats) -> tuple[float, Floats]:
        key = tuple(point.tolist())
        if key not in self.known:
            self._go(point)
            self.known[key] = self._read(point)
        return self.known[key]

    def _go(self, point: Floats) -> None:
        """Put the scene to a point, by steps as small as it takes.

        Raises:
            NoStateError: none of them leads there.
        """
        away = np.abs((np.array(self._places) - point) / self._widths).max(axis=1)
        nearest = np.argsort(away, kind="stable")[:_TRIED]
        if not any(self._steps(point, int(number), step) for step in _STEPS for number in nearest):
            raise NoStateError(self._box.words(point))

    def _steps(self, point: Floats, number: int, step: float) -> bool:
        """Go from a known place by equal steps no longer than this; whether that came there."""
        place, state = self._places[number], self._states[number]
        way = point - place
        count = max(1, math.ceil(float(np.abs(way / self._widths).max()) / step))
        for part in range(1, count + 1):
            goal = point if part == count else place + way * (part / count)
            new = self._solve(state, goal)
            if new is None:
                return False
            state = new
            self._places.append(goal)
            self._states.append(new)
        return True

    def _solve(self, state: State, place: Floats) -> State | None:
        stretch, curvature = self._box.chart.strains(place[None, :])[0].tolist()
        holding = Hold({LENGTHENED: stretch, BEND: curvature * self._length})
        self.solved += 1
        return self._small.held(state, holding, float(place[2]))

    def _read(self, point: Floats) -> tuple[float, Floats]:
        """Φ and ∂Φ by e, u and P of the state to which the scene is put."""
        scene = self._small.scene
        forces = [scene.scalar(LENGTHENED), scene.scalar(BEND)]
        forces.append(self._share * scene.conjugate(PRESSURE))
        energy = self._share * sum(scene.energies().values())
        return energy, self._box.chart.slopes(point[None, :], np.array([forces]))[0]
