"""How a ramp is driven: what grows, where its increments end, and what is to be hit."""

from __future__ import annotations

import dataclasses

import numpy as np

from fem.march.limit_points import last_limit
from fem.march.position import Position
from fem.march.records import Ramp, Rules, State, measure
from fem.march.turning import search_end

SHARP = 0.01
"""A load at which stability is lost is known within this part of it before its branch is left."""
STRETCH = 0.2
"""An increment goes so much further, as a part of its own change, to hit what is asked for."""
ROUND_OFF = 1e-9
"""Least distance (rad) at which a value counts as not yet hit."""
REACHED = 1e-12
"""Part of a target by which round-off may miss it."""
MISSED = "the angle that is asked for does not lie ahead in this increment"


@dataclasses.dataclass(frozen=True)
class Way:
    """How a ramp is driven at present.

    Attributes:
        kind: 'value', 'conjugate' or 'control'.
        key: the measure that is driven.
        sign: whether it grows.
        end: its value at the end.
        span: all the way to go.
        stops: its values to be hit exactly.
        largest: greatest increment.
    """

    kind: str
    key: str
    sign: float
    end: float
    span: float
    stops: tuple[float, ...]
    largest: float

    def next(self, now: float, size: float) -> float:
        """Where an increment of a size would end; at a stop that is near."""
        target, nearest = now + self.sign * size, self.stop(now)
        return nearest if self.sign * (target - nearest) > -STRETCH * size else target

    def stop(self, now: float) -> float:
        """The next value to be hit exactly, the end if there is none before it."""
        ahead = (s for s in self.stops if self.sign * (s - now) > 1e-9 * self.span)
        return min((self.end, *ahead), key=lambda s: abs(s - now))


def way_of(ramp: Ramp, span: float, position: Position, rest: State, rules: Rules) -> Way:
    """How a ramp is driven from the last state on.

    Args:
        ramp: the ramp.
        span: all of its way.
        position: where the march stands.
        rest: the state at rest.
        rules: incrementation.
    """
    now = position.states[-1].measures
    if not position.path_following:
        sign = np.sign(ramp.target - now[ramp.key])
        stops = ramp.stops if ramp.drive != "control" else (*ramp.stops, *ramp.at)
        largest = abs(ramp.largest) if ramp.largest else np.inf
        return Way(ramp.drive, ramp.key, sign, ramp.target, abs(span), stops, largest)
    key = measure("conjugate", ramp.scalar)
    volume = abs(now[key])
    sign = position.toward or np.sign(span)
    end = sign * np.inf
    limit = last_limit(position.report, ramp.scalar)
    if position.toward:
        end = search_end(ramp, span, position, rest, rules)
    elif limit is not None and now.get(measure("rate", ramp.scalar), 1.0) < 0:
        end = limit.conjugate * rules.beyond**sign
    return Way("conjugate", key, sign, end, volume, (), rules.swell * volume)


def near(key: str, rest: State, a: float, b: float) -> bool:
    """Whether two values of a measure are apart by no more than 1 % of the way from rest."""
    base = rest.measures[key]
    return abs(b - a) <= SHARP * max(abs(a - base), abs(b - base))


def toward_lost(position: Position, way: Way, rest: State) -> float:
    """Greatest increment toward a state at which a mode is lost: half the way, unless it is near.

    Args:
        position: where the march stands.
        way: how the ramp is driven.
        rest: the state at rest.
    """
    if position.lost is None:
        return np.inf
    now = position.states[-1].measures[way.key]
    gap = abs(position.lost - now)
    return gap if near(way.key, rest, now, position.lost) else gap / 2


class Requests:
    """Values of the control quantity that a ramp hits wherever it crosses them, up or down.

    Args:
        ramp: the ramp; driven by the control quantity, its target is one of them, for where it has
            to be driven otherwise.
        tolerance: of Newton's method, within which a value is hit.
    """

    def __init__(self, ramp: Ramp, tolerance: float) -> None:
        self._ramp = ramp
        goals = {*ramp.at, *([] if ramp.until is None else [ramp.until])}
        if ramp.drive == "control":
            goals.add(ramp.target)
        self._goals = sorted(goals)
        self._within = max(2 * tolerance, ROUND_OFF)
        self._insist: float | None = None
        self._forced = False
        self._beyond: set[float] = set()

    def __bool__(self) -> bool:
        return bool(self._goals)

    def due(self, here: float, expected: float) -> float | None:
        """The value that the next increment is to hit, or None: it goes on by its load.

        Args:
            here: the control quantity at the last state.
            expected: the same where the increment would end.
        """
        insist, self._insist = self._insist, None
        self._forced = insist is not None
        if insist is not None:
            return insist
        ahead = self._between(here, expected + STRETCH * (expected - here))
        return next((goal for goal in ahead if goal not in self._beyond), None)

    def judge(self, old: State, new: State, kind: str, aim: float, way: Way) -> str:
        """Whether a new state may be kept.

        Args:
            old: the state before it.
            new: the state, not yet accepted.
            kind: what was given, 'control' where a value was to be hit.
            aim: what it was to be.
            way: how the ramp is driven.

        Returns:
            'keep'; 'again': from the old state to the value that was run past, or by the load to
            its next stop or its end; 'cut': nothing is ahead where it was thought to be.
        """
        if kind != "control":
            passed = self._between(old.measures["control"], new.measures["control"])
            self._insist = passed[0] if passed else None
            return "again" if passed else "keep"
        load, before = new.measures[way.key], old.measures[way.key]
        if way.sign * (load - way.stop(before)) > 1e-9 * way.span:
            # it lies beyond the load's next stop or end: go there by the load instead
            self._beyond.add(aim)
            return "cut" if self._forced else "again"
        return "keep" if way.sign * (load - before) > 0 else "cut"

    def hits(self, state: State) -> list[float]:
        """The values that a state hits; more than one where they are all but the same."""
        here = state.measures.get("control", np.nan)
        return [goal for goal in self._goals if abs(goal - here) <= self._within]

    def stops(self, state: State) -> bool:
        """Whether the run ends early at a state."""
        return self._ramp.until in self.hits(state)

    def done(self, span: float, state: State) -> bool:
        """Whether the ramp has reached its end at a state, or the value that ends the run early.

        Driven by its conjugate or by the control quantity, Newton's method hits the end within its
        tolerance, not exactly; a run that is resumed at the end has nothing to do.

        Args:
            span: all of what the ramp drives.
            state: the state.
        """
        ramp = self._ramp
        missed = abs(ramp.target - state.measures[ramp.key])
        if missed <= 1e-9 * abs(span) or missed <= REACHED * abs(ramp.target):
            return True
        return self.stops(state) or (ramp.drive == "control" and ramp.target in self.hits(state))

    def _between(self, here: float, there: float) -> list[float]:
        """Values beyond one and before another, both excluded, the nearest first."""
        side = np.sign(there - here)
        ahead = [
            goal
            for goal in self._goals
            if side * (goal - here) > self._within and side * (there - goal) > self._within
        ]
        return sorted(ahead, key=lambda goal: abs(goal - here))


def asked_between(ramp: Ramp, old: State, new: State) -> tuple[str, float] | None:
    """What a ramp asks for first between two states: what is given there, and its value."""
    asked = [(ramp.drive, value) for value in (*ramp.stops, ramp.target)]
    asked += [("control", value) for value in (*ramp.at, ramp.until) if value is not None]
    shares = []
    for kind, value in asked:
        a, b = (state.measures[measure(kind, ramp.scalar)] for state in (old, new))
        # what the old state has hit already is not asked for again
        slack = ROUND_OFF * (1.0 if kind == "control" else abs(value))
        if min(abs(value - a), abs(value - b)) > slack and min(a, b) < value < max(a, b):
            shares.append(((value - a) / (b - a), kind, value))
    return min(shares)[1:] if shares else None
