"""The ways to the states that are wanted, on scenes that are kept from case to case."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

from fem.march.records import State
from fiberbend.case.case import Case
from fiberbend.models.choice import problems
from fiberbend.trial import loads
from fiberbend.trial.reading import Reader
from fiberbend.trial.wanted import Point, Wanted
from fiberbend.uniform.small import Small

SCENES = 4
"""Scenes that are kept: a search goes to and fro between few meshes."""
STATES = 64
"""States that are kept with each."""


class Goal(NamedTuple):
    """A state by how it is loaded, 'angles', 'pressures' or 'straight', and by its value."""

    kind: str
    value: float


MAKE: dict[str, tuple[Callable[[Case, tuple[float, ...]], Case], str]] = {
    "angles": (loads.bent, "control"),
    "pressures": (loads.inflated, "value"),
    "straight": (loads.straight, "value"),
}
"""By the kind of a state, the case that has it and what is given there."""


@dataclasses.dataclass(frozen=True)
class Way:
    """States that one march has found; read before another begins.

    Attributes:
        case: under the load of the march.
        small: its scene; None where the case has no such states.
        states: by goal, from rest on.
        reason: why not all that are wanted are there; empty where they are.
    """

    case: Case
    small: Small | None
    states: dict[Goal, State]
    reason: str = ""

    def points(self) -> dict[Goal, Point]:
        """What is told of each state."""
        if self.small is None:
            return {}
        reader = Reader(self.small)
        return {goal: reader.point(state) for goal, state in self.states.items()}


@dataclasses.dataclass
class _Scene:
    """A scene that is kept.

    Attributes:
        small: the last case that had it.
        found: states of the last cases; a way without a critical point leads to each.
    """

    small: Small
    found: dict[Goal, State] = dataclasses.field(default_factory=dict)

    def keep(self, states: dict[Goal, State]) -> None:
        """Keep the states of a case, and as many of those before as there is room for."""
        others = {goal: state for goal, state in self.found.items() if goal not in states}
        self.found = dict([*others.items(), *states.items()][-STATES:])


class Ways:
    """Finds states, and keeps what is dear: compiled scenes, and states of the last cases."""

    def __init__(self) -> None:
        self._scenes: list[_Scene] = []

    def to(self, case: Case, wanted: Wanted) -> Iterator[Way]:
        """States of one kind and sign after another.

        Args:
            case: a case of uniform bending; its winding is calibrated.
            wanted: the states.
        """
        for kind in MAKE:
            for values in by_sign(getattr(wanted, kind)):
                yield self._way(case, kind, values)

    def _way(self, case: Case, kind: str, values: tuple[float, ...]) -> Way:
        make, given = MAKE[kind]
        loaded = make(case, values)
        for path, text in problems(loaded):
            return Way(loaded, None, {}, f"{path}: {text}")
        small = Small(loaded, *(scene.small for scene in self._scenes))
        goals = [Goal(kind, value) for value in sorted(values, key=abs)]
        scene, reason = self._scene(small), ""
        states = _warm(small, given, goals, scene.found)
        if not states:
            found, report = small.march()
            states = dict(zip(goals, found, strict=False))
            if report.status != "converged" or len(states) < len(goals):
                reason = report.reason or "not all states lie on the way"
            if report.critical:
                # beside it another branch may be the one to which a way leads
                scene.found.clear()
                return Way(loaded, small, states, reason)
        scene.keep(states)
        return Way(loaded, small, states, reason)

    def _scene(self, small: Small) -> _Scene:
        """The scene of a case, now the first of those that are kept."""
        same = (scene for scene in self._scenes if scene.small.scene is small.scene)
        scene = next(same, None) or _Scene(small)
        scene.small = small
        others = [other for other in self._scenes if other is not scene]
        self._scenes = [scene, *others][:SCENES]
        return scene


def _warm(
    small: Small, given: str, goals: Sequence[Goal], before: dict[Goal, State]
) -> dict[Goal, State]:
    """States from those of the last cases; none where not all can be had so."""
    found: dict[Goal, State] = {}
    for goal in goals:
        start = before.get(goal)
        state = None if start is None else small.from_neighbour(start, given, goal.value)
        if state is None:
            return {}
        found[goal] = state
    return found if small.keeps_symmetry(found[goals[-1]]) else {}


def by_sign(values: Iterable[float]) -> list[tuple[float, ...]]:
    """The values above zero and those below, each once, without what is empty."""
    given = tuple(dict.fromkeys(values))
    parts = (tuple(v for v in given if v > 0), tuple(v for v in given if v < 0))
    return [part for part in parts if part]
