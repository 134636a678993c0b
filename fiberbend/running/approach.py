"""How a march meets obstacles: where its steps end, and where the next ones start from."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from fem.effects.contact import Contact
from fem.march.march import March
from fem.march.records import Ramp, State
from fem.results.touch import Probe
from fem.scene import Scene
from fem.solver.newton import Outcome

Step = Callable[[State, Outcome], None]

DEPTH = 0.05
"""A step to an obstacle aims so far beyond its surface, as a share of the way there."""


class Approach:
    """Leads a march to its obstacles and along them.

    - A step that would run into an obstacle ends where touch is foreseen: deep inside, a step of
      Newton's method flattens all that lies there onto the surface.
    - Touch and lift-off turn the path: the next step starts from the linear response.
    - While something touches, displacements are extrapolated as they are. They stay on a plane; in
      frames that turn with the body they leave it by more than the depth at which it carries, and
      Newton's method starts from a body that nothing holds.

    Args:
        scene: the scene.
        march: its march, at rest.
        ramps: what the march will run.
    """

    def __init__(self, scene: Scene, march: March, ramps: Sequence[Ramp]) -> None:
        self._march, self._ramps = march, ramps
        self._frames = march.predictor.frames
        contacts = [e for e in scene.effects.values() if isinstance(e, Contact)]
        self._probes = {contact.name: Probe(scene, contact) for contact in contacts}
        self._before = march.states[-1], self._gaps()
        self._usual: float | None = None
        self._next = march.on_step
        march.on_step = self._after

    def _gaps(self) -> dict[str, float]:
        """Least gap to each obstacle, mm."""
        return {name: probe.read().gap for name, probe in self._probes.items()}

    def _after(self, state: State, outcome: Outcome) -> None:
        self._next(state, outcome)
        gaps = self._gaps()
        (earlier, former), self._before = self._before, (state, gaps)
        touching = [name for name, gap in gaps.items() if gap < 0]
        march = self._march
        march.predictor.frames = None if touching else self._frames
        ramp = self._ramps[march.ramp]
        if march.report.detour or march.increment is None:
            return
        if touching != [name for name, gap in former.items() if gap < 0]:
            march.states = [march.equilibrium.neighbour(state, ramp.scalar), state]
            march.increment = self._usual or march.increment
            self._usual = None
            return
        driven = state.measures[ramp.key] - earlier.measures[ramp.key]
        ways = [
            gap / (former[name] - gap) * abs(driven)
            for name, gap in gaps.items()
            if 0 < gap < former[name]
        ]
        way = (1 + DEPTH) * min(ways, default=float("inf"))
        if way < march.increment:
            self._usual = self._usual or march.increment
            march.increment = way
