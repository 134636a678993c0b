"""What is called while a march goes on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from fem.march.position import Position
from fem.march.records import Ramp, State
from fem.solver.newton import Outcome


class Marching(Protocol):
    """A march as its hooks see it: where it stands, and how the way from there may be changed."""

    @property
    def position(self) -> Position:
        """Where it stands; to be read."""

    def saved(self) -> Position:
        """Where it stands, with all that it needs to go on as if it had never stopped."""

    def limit_increment(self, size: float) -> None:
        """Let the next increment of the driven quantity be no longer than this."""

    def restart_from_response(self, scalar: str, increment: float) -> None:
        """Start the next increment from the linear response alone: the path has a kink here."""

    def extrapolate_in_frames(self, turning: bool) -> None:
        """Whether displacements are extrapolated in frames that turn with the body."""


class Hook:
    """What is called while a march goes on; a subclass gives the calls that it wants.

    A march calls its hooks in their order, on every rank.
    """

    def before_ramp(self, march: Marching, ramp: Ramp) -> None:
        """The march stands at its last state and drives this load next, or goes on with it."""

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """The march has converged to a state, at which the scene is, and keeps it."""

    def after_cutback(self, march: Marching, reason: str) -> None:
        """An increment has failed; the march is back at its last state and tries a shorter one."""

    def memory(self) -> dict[str, Any]:
        """What it needs to go on as if it had never stopped: numbers, words, None, by name."""
        return {}

    def recall(self, memory: dict[str, Any]) -> None:
        """Go on with what `memory` gave."""


class AfterStep(Hook):
    """Calls a function with every converged state and how Newton's method found it."""

    def __init__(self, call: Callable[[State, Outcome], None]) -> None:
        self._call = call

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Call it."""
        self._call(state, outcome)
