"""How a ramp is driven: what grows, where its increments end, and what is to be hit."""

from __future__ import annotations

import dataclasses

import numpy as np

from fem.march.records import Ramp, State, measure

NEAR = 0.02
"""An increment that would end so near before a value that is asked for hits it (rad, an angle)."""


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
        target = now + self.sign * size
        stops = [s for s in (*self.stops, self.end) if self.sign * (s - now) > 1e-9 * self.span]
        nearest = min(stops, key=lambda s: abs(s - now))
        return nearest if self.sign * (target - nearest) > -0.2 * size else target


class Requests:
    """Values of the control quantity that a ramp is to hit."""

    def __init__(self, ramp: Ramp) -> None:
        self._insist = False
        self._pending = sorted(ramp.at) if ramp.drive != "control" else []
        if ramp.until is not None:
            before = (a for a in self._pending if a < ramp.until)
            self._pending = sorted({*before, ramp.until})

    def due(self, state: State) -> float | None:
        """The next one."""
        here = state.measures.get("control", np.inf)
        return next((a for a in self._pending if a > here + 1e-9), None)

    def hits(self, goal: float, expected: float) -> bool:
        """Whether the next increment is to hit the one that is due, not the end of the increment.

        Args:
            goal: the value that is due.
            expected: the value where the increment would end.
        """
        insist, self._insist = self._insist, False
        return insist or expected > goal - NEAR

    def met(self, new: State, goal: float, kind: str, way: Way) -> bool:
        """Whether a new state may be kept: it has not run past the one that was due."""
        if kind != "control":
            self._insist = new.measures["control"] > goal + 1e-9
            return not self._insist
        if way.kind != kind and way.sign * (new.measures[way.key] - way.end) > 0:
            # the angle lies beyond the load's end: go there by the load instead
            self._pending = [a for a in self._pending if a < goal - 1e-12]
            return False
        return True


def asked_between(ramp: Ramp, old: State, new: State) -> tuple[str, float] | None:
    """What a ramp asks for first between two states: what is given there, and its value."""
    asked = [(ramp.drive, value) for value in (*ramp.stops, ramp.target)]
    asked += [("control", value) for value in (*ramp.at, ramp.until) if value is not None]
    shares = []
    for kind, value in asked:
        a, b = (state.measures[measure(kind, ramp.scalar)] for state in (old, new))
        if min(a, b) < value < max(a, b):
            shares.append(((value - a) / (b - a), kind, value))
    return min(shares)[1:] if shares else None
