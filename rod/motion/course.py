"""The course of a motion: states at given times, steps that end at corners, events between them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence

from scipy.optimize import brentq

from rod.motion.motion import Motion
from rod.motion.moving import Moving

_SAME = 1e-9
"""Part of a step below which two times are one."""
_NEAR = 1e-6
"""Part of a step to which an event is located."""


@dataclasses.dataclass(frozen=True)
class Watch:
    """Something whose change of sign is an event.

    Attributes:
        name: of it.
        value: of a state; a gap in mm, which is below zero in contact.
        free: the motion without what is watched. A touch is where this motion passes it, which is
            smooth there. A lift-off then cuts no step: it is where the straight line from gap to
            gap is zero.
    """

    name: str
    value: Callable[[Moving], float]
    free: Motion | None = None


@dataclasses.dataclass(frozen=True)
class Event:
    """A change of sign.

    Attributes:
        name: of the watch.
        below: the value is below zero from here on: a gap that has closed.
        time: s.
    """

    name: str
    below: bool
    time: float


@dataclasses.dataclass(frozen=True)
class Passed:
    """A state that a course comes through.

    Attributes:
        moving: the state.
        events: at its time, or in a step that ends there; see `Watch`.
    """

    moving: Moving
    events: tuple[Event, ...] = ()


class Course:
    """A motion through given times.

    The steps end at every corner of what acts, so that the scheme keeps its order, and at every
    event: what lies behind it, a contact for instance, begins with a step of its own.

    Args:
        motion: makes the steps.
        start: the first state.
        watches: what is looked at.
        corners: times at which what acts has no slope, s, in any order.
    """

    def __init__(
        self,
        motion: Motion,
        start: Moving,
        watches: Sequence[Watch] = (),
        corners: Sequence[float] = (),
    ) -> None:
        self._motion, self._moving, self._watches = motion, start, watches
        self._corners = sorted(corners)
        self._below = [watch.value(start) < 0 for watch in watches]
        self._left: list[Event] = []

    def through(self, times: Sequence[float]) -> Iterator[Passed]:
        """States at given times and at the events between them.

        Args:
            times: rising, s.

        Raises:
            NoEquilibriumError: a step does not converge.
        """
        before = self._moving.time
        for time in times:
            slack = _SAME * (time - before)
            ends = [c for c in self._corners if before + slack < c < time - slack]
            for end in [*ends, time]:
                yield from self._to(end, slack, end == time)
            before = time

    def _to(self, end: float, slack: float, shown: bool) -> Iterator[Passed]:
        """A step to a time, in parts where events lie within it."""
        while self._moving.time < end - slack:
            before = self._moving
            after = self._motion.step(before, end - before.time)
            found = self._first(before, after)
            if found is None:
                self._moving, self._left = after, [*self._left, *self._leaves(before, after)]
                continue
            self._moving, changed = found
            events = []
            for number in changed:
                self._below[number] = not self._below[number]
                watch = self._watches[number]
                events.append(Event(watch.name, self._below[number], self._moving.time))
            yield Passed(self._moving, tuple(events))
        if shown:
            left, self._left = tuple(self._left), []
            yield Passed(self._moving, left)

    def _leaves(self, before: Moving, after: Moving) -> list[Event]:
        """What is left in a step that it does not cut."""
        events = []
        for number, watch in enumerate(self._watches):
            value = watch.value(after)
            if self._below[number] and not value < 0:
                self._below[number] = False
                first = min(watch.value(before), 0.0)
                part = -first / (value - first) if value > first else 0.0
                time = before.time + part * (after.time - before.time)
                events.append(Event(watch.name, False, time))
        return events

    def _first(self, before: Moving, after: Moving) -> tuple[Moving, list[int]] | None:
        """The state of the first event in a step, and the watches that change there."""
        changed = [
            number
            for number, watch in enumerate(self._watches)
            if (watch.value(after) < 0) != self._below[number]
            and not (self._below[number] and watch.free is not None)
        ]
        if not changed:
            return None
        whole = after.time - before.time
        best = (whole, after, changed)
        for number in changed:
            share, state = self._located(before, after, number)
            if share < best[0]:
                best = (share, state, [number])
        return best[1], best[2]

    def _located(self, before: Moving, after: Moving, number: int) -> tuple[float, Moving]:
        """When in a step a watch changes its sign, as a time from its begin, and the state."""
        watch, whole = self._watches[number], after.time - before.time
        motion = self._motion if watch.free is None else watch.free
        states = {whole: after} if watch.free is None else {}

        def value(step: float) -> float:
            if step not in states:
                states[step] = motion.step(before, step)
            return watch.value(states[step])

        # what was an event a moment ago may still be on its other side by round-off
        first, sign = watch.value(before), -1.0 if self._below[number] else 1.0
        if first * sign <= 0:
            least = _NEAR * whole
            if value(least) * sign <= 0:
                return least, self._motion.step(before, least)
            start = least
        else:
            start = 0.0
            states[0.0] = before
        if value(whole) * sign > 0:
            # only what else is touched has brought it there
            return whole, after
        root = float(brentq(value, start, whole, xtol=_NEAR * whole, rtol=1e-12, maxiter=60))
        if root not in states or watch.free is not None:
            states[root] = self._motion.step(before, root)
        return root, states[root]
