"""Increment control at obstacles: where steps end, and from which state the next ones start."""

from __future__ import annotations

from typing import Any

from fem.march.hooks import Hook, Marching
from fem.march.records import Ramp, State
from fem.results.touch import Touch, probes
from fem.scene import Scene
from fem.solver.newton import Outcome

DEPTH = 0.05
"""A step to an obstacle aims so far beyond its surface, as a share of the distance."""


class Approach(Hook):
    """Increment control of a march toward its obstacles and along them.

    - A step that would run into an obstacle ends where touch is foreseen: deep inside, a step of
      Newton's method flattens all that lies there onto the surface.
    - Touch and lift-off turn the path: the next step starts from the linear response.
    - While something touches, displacements are extrapolated as they are. They stay on a plane; in
      frames that turn with the body they leave it by more than the depth at which it carries, and
      Newton's method starts from a body without contact.

    Args:
        scene: the scene.
    """

    def __init__(self, scene: Scene) -> None:
        self._probes = probes(scene)
        self._usual: float | None = None
        self._ramp: Ramp | None = None
        self._before: tuple[State, dict[str, Touch]] | None = None

    def _touches(self) -> dict[str, Touch]:
        """How each obstacle is met at the present state."""
        return {name: probe.read() for name, probe in self._probes.items()}

    def memory(self) -> dict[str, Any]:
        """The increment before an approach has shortened it."""
        return {"usual": self._usual}

    def recall(self, memory: dict[str, Any]) -> None:
        """Go on with it."""
        self._usual = memory["usual"]

    def before_ramp(self, march: Marching, ramp: Ramp) -> None:
        """See what touches where the ramp begins, or where a run goes on."""
        if self._ramp is not None and ramp != self._ramp:
            # the increment of another load
            self._usual = None
        self._ramp = ramp
        touches = self._touches()
        self._before = march.position.states[-1], touches
        march.extrapolate_in_frames(not _touching(touches))

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Shorten the next step to where touch is foreseen, or start anew after a kink."""
        touches, ramp, before = self._touches(), self._ramp, self._before
        assert ramp is not None
        assert before is not None
        (earlier, former), self._before = before, (state, touches)
        march.extrapolate_in_frames(not _touching(touches))
        position = march.position
        if position.path_following or position.increment is None:
            return
        if _touching(touches) != _touching(former):
            march.restart_from_response(ramp.scalar, self._usual or position.increment)
            self._usual = None
            return
        driven = state.measures[ramp.key] - earlier.measures[ramp.key]
        increments = [
            touch.gap / (former[name].gap - touch.gap) * abs(driven)
            for name, touch in touches.items()
            if touch.apart and touch.gap < former[name].gap - touch.slack
        ]
        to_touch = (1 + DEPTH) * min(increments, default=float("inf"))
        if to_touch < position.increment:
            self._usual = self._usual or position.increment
            march.limit_increment(to_touch)


def _touching(touches: dict[str, Touch]) -> list[str]:
    """Names of the obstacles that are touched."""
    return [name for name, touch in touches.items() if touch.touches]
