"""Increment control at obstacles: where steps end, and from which state the next ones start."""

from __future__ import annotations

from fem.march.hooks import Hook, Marching
from fem.march.records import Ramp, State
from fem.results.touch import probes
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

    def _gaps(self) -> dict[str, float]:
        """Least gap to each obstacle, mm."""
        return {name: probe.read().gap for name, probe in self._probes.items()}

    def before_ramp(self, march: Marching, ramp: Ramp) -> None:
        """See what touches where the ramp begins, or where a run goes on."""
        self._ramp = ramp
        self._before = march.position.states[-1], self._gaps()
        march.extrapolate_in_frames(not _touching(self._before[1]))

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Shorten the next step to where touch is foreseen, or start anew after a kink."""
        gaps = self._gaps()
        (earlier, former), self._before = self._before, (state, gaps)
        march.extrapolate_in_frames(not _touching(gaps))
        position, ramp = march.position, self._ramp
        if position.path_following or position.increment is None:
            return
        if _touching(gaps) != _touching(former):
            march.restart_from_response(ramp.scalar, self._usual or position.increment)
            self._usual = None
            return
        driven = state.measures[ramp.key] - earlier.measures[ramp.key]
        increments = [
            gap / (former[name] - gap) * abs(driven)
            for name, gap in gaps.items()
            if 0 < gap < former[name]
        ]
        to_touch = (1 + DEPTH) * min(increments, default=float("inf"))
        if to_touch < position.increment:
            self._usual = self._usual or position.increment
            march.limit_increment(to_touch)


def _touching(gaps: dict[str, float]) -> list[str]:
    """Names of the obstacles that are touched."""
    return [name for name, gap in gaps.items() if gap < 0]
