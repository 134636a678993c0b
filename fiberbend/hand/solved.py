"""A hand from rest to its whole pressure: states, and where anything is touched."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from fiberbend.hand.assembled import Assembled
from rod.several.system import Levels, Shapes
from rod.statics import Equilibrium, Loading, NoEquilibriumError, Step, steps

State = Equilibrium[Shapes, Levels]


@dataclasses.dataclass(frozen=True)
class Moment:
    """A state of a hand.

    Attributes:
        state: of all rods.
        weight: share of the weight that acts.
        pressure: share of the pressures.
    """

    state: State
    weight: float
    pressure: float


@dataclasses.dataclass(frozen=True)
class Touching:
    """A first touch.

    Attributes:
        finger: its place.
        other: name of an object, or the place of another finger.
        weight: share of the weight.
        pressure: share of the pressures; at most a thousandth of a step beyond the touch.
    """

    finger: int
    other: str | int
    weight: float
    pressure: float


@dataclasses.dataclass(frozen=True)
class Solved:
    """All of it.

    Attributes:
        moments: states at the steps of the file, the first at rest.
        touches: in the order in which they come.
        iterations: of Newton's method in each of the moments, those on the way counted too.
        steps: number of states that were solved.
        reason: why it did not come to its end; empty where it did.
    """

    moments: tuple[Moment, ...]
    touches: tuple[Touching, ...]
    iterations: tuple[int, ...]
    steps: int
    reason: str


Listen = Callable[[Moment, float, int], None]
"""Takes every new moment, the part that is done, and iterations."""


def solve_hand(hand: Assembled, listen: Listen = lambda *_: None) -> Solved:
    """Put the weight on, then all pressures together.

    Args:
        hand: the hand.
        listen: hears of every moment.
    """
    return _Course(hand, listen).go()


class _Course:
    """What is known so far; see `solve_hand`."""

    def __init__(self, hand: Assembled, listen: Listen) -> None:
        self._hand, self._listen = hand, listen
        system = hand.system
        rest, none = system.shape(system.at_rest()), hand.levels(0.0, 0.0)
        self._moments = [Moment(Equilibrium.at(system, rest, none, 0.0, 0), 0.0, 0.0)]
        self._touches: list[Touching] = []
        self._iterations, self._spent, self._count = [0], 0, 0

    def go(self) -> Solved:
        """Both ways."""
        hand, count = self._hand, self._hand.hand.output.steps
        reason = ""
        try:
            if hand.hand.gravity is not None:
                self._along(hand.levels(0.0, 0.0), hand.levels(1.0, 0.0), [1.0], inflates=False)
            targets = [number / count for number in range(1, count + 1)]
            self._along(hand.levels(1.0, 0.0), hand.levels(1.0, 1.0), targets, inflates=True)
        except NoEquilibriumError as error:
            reason = str(error)
        return Solved(
            tuple(self._moments),
            tuple(self._touches),
            tuple(self._iterations),
            self._count,
            reason,
        )

    def _along(self, begin: Levels, end: Levels, targets: list[float], inflates: bool) -> None:
        system, path = self._hand.system, Loading(begin, end)
        start = dataclasses.replace(self._moments[-1].state, share=0.0, level=begin)
        for step in steps(system, start, path, targets):
            self._note(step, (1.0, step.state.share) if inflates else (step.state.share, 0.0))

    def _note(self, step: Step[Shapes, Levels], shares: tuple[float, float]) -> None:
        self._count += 1
        self._spent += step.state.iterations
        for number in step.touches:
            finger, other = self._hand.place(number)
            self._touches.append(Touching(finger, other, *shares))
        if not step.reached:
            return
        self._moments.append(Moment(step.state, *shares))
        self._iterations.append(self._spent)
        self._listen(self._moments[-1], shares[1], self._spent)
        self._spent = 0
