"""The ways to the states that are wanted, on scenes that are kept from case to case."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

from fem.march.records import State
from fiberbend.case.case import Case
from fiberbend.models.choice import problems
from fiberbend.trial import loads
from fiberbend.trial.calibrations import Calibrations, Ready
from fiberbend.trial.reading import Reader
from fiberbend.trial.wanted import Point, Wanted
from fiberbend.uniform.small import PRESSURE, Small

SCENES = 4
"""Scenes that are kept: a search goes to and fro between few meshes."""
STATES = 64
"""States that are kept with each."""


class Goal(NamedTuple):
    """A state by how it is loaded, as `Wanted` names it, and by its value."""

    kind: str
    value: float


_SOME = 1e-3
"""A load that is not put on, rad or MPa."""
KEPT = "straight"
"""Kind of the states that are kept straight."""
MAKE: dict[str, tuple[Callable[[Case, tuple[float, ...]], Case], str]] = {
    "angles": (loads.bent, "control"),
    "pressures": (loads.inflated, "value"),
    KEPT: (loads.straight, "value"),
}
"""By the kind of a state, the case that has it and what is given there."""


@dataclasses.dataclass(frozen=True)
class Way:
    """States that one march has found; read before another begins.

    Attributes:
        ready: the case under the load of the march.
        small: its scene; None where the case has no such states.
        states: by goal, from rest on.
        reason: why not all that are wanted are there; empty where they are.
    """

    ready: Ready
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
    """Finds states, and keeps what is dear: compiled scenes, and states of the last cases.

    Args:
        calibrations: what gives a winding the numbers that it waits for.
    """

    def __init__(self, calibrations: Calibrations) -> None:
        self._calibrations = calibrations
        self._scenes: list[_Scene] = []

    def to(self, case: Case, wanted: Wanted) -> Iterator[Way]:
        """States of one kind and sign after another.

        Args:
            case: a case of uniform bending.
            wanted: the states.

        Raises:
            CaseError: its winding cannot be calibrated.
        """
        for kind in MAKE:
            values = getattr(wanted, kind)
            if 0 in values:
                yield self._at_rest(case, kind)
            for signed in by_sign(values):
                yield self._way(case, kind, signed)

    def _at_rest(self, case: Case, kind: str) -> Way:
        """The state without a load."""
        ready = self._calibrations.ready(MAKE[kind][0](case, (_SOME,)))
        for path, text in problems(ready.case):
            return Way(ready, None, {}, f"{path}: {text}")
        small = Small(ready.case, *(scene.small for scene in self._scenes))
        self._scene(small)
        return Way(ready, small, {Goal(kind, 0.0): small.rest})

    def _way(self, case: Case, kind: str, values: tuple[float, ...]) -> Way:
        make, given = MAKE[kind]
        ready = self._calibrations.ready(make(case, values))
        loaded = ready.case
        for path, text in problems(loaded):
            return Way(ready, None, {}, f"{path}: {text}")
        small = Small(loaded, *(scene.small for scene in self._scenes))
        goals = [Goal(kind, value) for value in sorted(values, key=abs)]
        scene, reason = self._scene(small), ""
        states = _warm(small, given, goals, scene.found)
        if not states:
            reached = small.reach()
            states = {g: reached.found[g.value] for g in goals if g.value in reached.found}
            if reached.report.status != "converged" or len(states) < len(goals):
                reason = _furthest(given, reached.furthest)
                if reached.report.reason:
                    reason = f"{reason}: {reached.report.reason}"
            if reached.report.critical:
                # beside it another branch may be the one to which a way leads
                scene.found.clear()
                return Way(ready, small, states, reason)
        scene.keep(states)
        return Way(ready, small, states, reason)

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


def _furthest(given: str, state: State) -> str:
    """Why a march has stopped that nothing stopped: what is asked for turns back."""
    pressure = f"{1e3 * state.scalars[PRESSURE]:.4g} kPa"
    if given == "control":
        return f"it bends no further than {math.degrees(state.measures[given]):.4g}°, at {pressure}"
    return f"it takes no pressure beyond {pressure}"


def by_sign(values: Iterable[float]) -> list[tuple[float, ...]]:
    """The values above zero and those below, each once, without what is empty."""
    given = tuple(dict.fromkeys(values))
    parts = (tuple(v for v in given if v > 0), tuple(v for v in given if v < 0))
    return [part for part in parts if part]
