"""Where a march stands."""

from __future__ import annotations

import dataclasses
from typing import Any

from fem.march.records import Report, State


@dataclasses.dataclass
class Position:
    """All that a march needs to go on from here; saved and loaded as one thing.

    Attributes:
        states: the last converged states, oldest first, from which the next one is extrapolated.
        increment: of the driven quantity, to try next; None at the start of a ramp.
        begin: what the ramp under way drives, where it began; None before it has begun.
        first: its first increment.
        ramp: number of the ramp under way.
        path_following: the ramp under way has turned from the value of its scalar to the
            conjugate (volume control), which grows also where the value falls.
        toward: sign of the conjugate's way where a ramp of the control quantity has turned to it;
            0 elsewhere.
        nearest: how near the control quantity has come to the target on that way, rad.
        failures: increments that have failed since the last one that counts.
        force_floor: least scale of forces that Newton's method has come to know, N.
        memory: what the march's own hooks remember, in their order.
        lost: what is driven, where a mode was found unstable that is not at the last state; the
            bifurcation lies before it. None: none was found.
        entering: the last state is one of several that lead onto another branch, the next ones
            known already: none to go on from, for near a crossing the branches lie too close.
        report: what happened so far.
    """

    states: list[State]
    increment: float | None = None
    begin: float | None = None
    first: float | None = None
    ramp: int = 0
    path_following: bool = False
    lost: float | None = None
    toward: float = 0.0
    nearest: float | None = None
    failures: int = 0
    force_floor: float = 0.0
    memory: list[dict[str, Any]] = dataclasses.field(default_factory=list)
    entering: bool = False
    report: Report = dataclasses.field(default_factory=Report)
