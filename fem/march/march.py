"""Load stepping: ramps, adaptive increments, exact roll-back, requested outputs hit exactly."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from fem.march.attempts import BEYOND, Attempts, unstable
from fem.march.branches import Branches, excess
from fem.march.equilibrium import Equilibrium
from fem.march.frames import Frames
from fem.march.guide import Guide
from fem.march.hooks import Hook
from fem.march.increments import guess, next_size, turn_limit
from fem.march.limit_points import critical, limit_ahead, softens
from fem.march.position import Position
from fem.march.predictor import Predictor
from fem.march.records import Causes, Ramp, Report, Rules, State, measure
from fem.march.selfcontact import Rod, touching
from fem.march.turning import UNBENT, slackens
from fem.march.ways import MISSED, Requests, Way, asked_between, near, toward_lost, way_of
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome
from fem.solver.side_conditions import Functional

CREEPS = "increments shrink to nothing, each of them converging slowly"
LOST = "along the mode that is lost no state is found on which the body rests"
NEARBY = "on the way to where a mode is lost"
WRINKLES = "; the softest mode is a wrinkle of less than three elements, whose size gives its load"
ACROSS = "the body would leave its symmetry, and half of it does not know how"
LEAST_GAP = 1e-6
"""Part of a ramp between a stable and an unstable state that are not brought nearer."""


class March:
    """Drives a scene along its ramps.

    Args:
        scene: the problem, at rest.
        newton: solver of that problem.
        rules: incrementation.
        frames: rod frames for the predictor; None where the kinematics turns by itself.
        control: the quantity that requests refer to (the bending angle), or None.
        guide: a cheaper model's shapes, on which the predictor leans, or None.
        rod: the states as rods, to see whether the body passes through itself; None: not looked.
        causes: what tells physical causes of a failure; None: how Newton ended is all that is
            said.
        hooks: what belongs to the scene and is called meanwhile, in this order.

    Attributes:
        rest: the state at rest.
        position: where it stands.
    """

    def __init__(
        self,
        scene: Scene,
        newton: Newton,
        rules: Rules,
        *,
        frames: Frames | None = None,
        control: Functional | None = None,
        guide: Guide | None = None,
        rod: Rod | None = None,
        causes: Causes | None = None,
        hooks: Sequence[Hook] = (),
    ) -> None:
        self.rules = rules
        self.hooks = self._called = tuple(hooks)
        self._predictor = Predictor(scene, frames, guide)
        self.equilibrium = Equilibrium(scene, newton, self._predictor, control)
        self._controlled, self._guided = control is not None, guide is not None
        self._branches = Branches(self.equilibrium)
        self._attempts = Attempts(self.equilibrium, rules)
        self._rod, self._causes = rod, causes
        scene.set(scene.w.copy())
        self.rest = self.equilibrium.capture()
        self.position = Position([self.rest])

    @property
    def states(self) -> list[State]:
        """The last converged states, oldest first; to be read."""
        return self.position.states

    @property
    def report(self) -> Report:
        """What happened so far; to be read."""
        return self.position.report

    def resume(self, position: Position) -> None:
        """Go on from where a march of the same scene stood; puts the scene there."""
        self.position = position
        self.equilibrium.order(self.rest)
        self.equilibrium.restore(position.states[-1])
        self.equilibrium.scene.raise_force_floor(position.force_floor)
        self._predictor.heed(0, bool(position.report.critical))
        for hook, memory in zip(self.hooks, position.memory, strict=False):
            hook.recall(memory)

    def saved(self) -> Position:
        """Where it stands, with what solver and hooks remember."""
        floor, memory = self.equilibrium.scene.force_floor, [hook.memory() for hook in self.hooks]
        return dataclasses.replace(self.position, force_floor=floor, memory=memory)

    def run(self, ramps: Sequence[Ramp], hooks: Sequence[Hook] = ()) -> Report:
        """March through all ramps in order; earlier loads keep their values.

        Args:
            ramps: the loads.
            hooks: what listens to this run, called after the march's own.
        """
        position = self.position
        self._called = (*self.hooks, *hooks)
        for ramp in ramps[position.ramp :]:
            for hook in self._called:
                hook.before_ramp(self, ramp)
            if not self._ramp(ramp):
                break
            if self._requests(ramp).stops(self.states[-1]):
                position.report.ended_at = ramp.until
                break
            position.ramp += 1
            position.increment = position.begin = position.first = position.lost = None
            position.path_following, position.toward, position.nearest = False, 0.0, None
            position.failures = 0
        return position.report

    # --- what hooks may change -----------------------------------------------------------------

    def limit_increment(self, size: float) -> None:
        """Let the next increment of the driven quantity be no longer than this."""
        if self.position.increment is not None:
            self.position.increment = min(self.position.increment, size)

    def restart_from_response(self, scalar: str, increment: float) -> None:
        """Start the next increment from the linear response alone: the path has a kink here.

        Args:
            scalar: the load that is driven.
            increment: the next increment of the driven quantity.
        """
        state = self.states[-1]
        self.position.states = [self.equilibrium.perturbed(state, scalar), state]
        self.position.increment = increment

    def extrapolate_in_frames(self, turning: bool) -> None:
        """Whether displacements are extrapolated in frames that turn with the body, or as they are.

        Frames are the better start unless something touches the body from outside.
        """
        self._predictor.turn(turning)

    # --- ramps ---------------------------------------------------------------------------------

    def _ramp(self, ramp: Ramp) -> bool:
        position = self.position
        if position.begin is None:
            position.begin = self.states[-1].measures[ramp.key]
        span = ramp.target - position.begin
        requests = self._requests(ramp)
        if requests.done(span, self.states[-1]):
            return True
        if position.increment is None:
            position.increment = self._attempts.begin(position, ramp, span, self._guided)
            if not position.increment:
                return self._end(UNBENT)
        # a load that hardly bends begins with tiny increments of the angle
        first = position.first = position.first or position.increment
        missed = 0
        slow: Outcome | None = None
        while True:
            state = self.states[-1]
            if requests.done(span, state):
                return True
            way = way_of(ramp, span, position, self.rest, self.rules)
            now = state.measures[way.key]
            if position.path_following and way.sign * (way.end - now) <= 1e-9 * way.span:
                return self._end("")
            if slow and position.increment < self.rules.least * min(way.span, first):
                return self._give_up(ramp, dataclasses.replace(slow, reason=CREEPS), "")
            turn = turn_limit(self.states, way.key, self.rules)
            size = min(position.increment, turn, way.largest, toward_lost(position, way, self.rest))
            target = way.next(now, size)
            if way.kind == "value" and limit_ahead(self.states, ramp.scalar, target):
                self._follow_path(ramp)
                continue
            kind, aim = way.kind, target
            asked = bool(requests) and self._controlled and kind != "control"
            if asked:
                expected = guess(self.states, way.key, target, "control")
                goal = requests.due(state.measures["control"], expected)
                if goal is not None:
                    kind, aim = "control", goal
            new, outcome, kind = self._attempts.increment(position, ramp, span, kind, aim)
            if new is not None and asked:
                verdict = requests.judge(state, new, kind, aim, way)
                if verdict == "again":
                    self.equilibrium.restore(state)
                    continue
                if verdict == "cut":
                    new, outcome = None, dataclasses.replace(outcome, reason=MISSED)
            missed = missed + 1 if new is None else 0
            self._predictor.heed(missed, bool(self.report.critical))
            if new is None:
                position.failures += 1
                self.report.cutbacks += 1
                # what was tried: a stop may have clipped it, and the next try would be the same
                position.increment = min(size, abs(target - now)) * self.rules.cut
                hopeless = (
                    position.failures > self.rules.cutbacks
                    or position.increment < self.rules.least * way.span
                )
                inverted = self._causes.inverted() if hopeless and self._causes else ""
                self.equilibrium.restore(state)
                for hook in self._called:
                    hook.after_cutback(self, outcome.reason)
                if hopeless:
                    if self._round(ramp, way):
                        continue
                    self.equilibrium.restore(state)
                    return self._give_up(ramp, outcome, inverted)
                if way.kind == kind == "value" and (
                    outcome.reason == BEYOND or softens(self.states, ramp.scalar)
                ):
                    self._follow_path(ramp)
                elif way.kind == "control" and slackens(self.states, ramp, position.failures):
                    self._follow_path(ramp)
                    position.failures = 0
                continue
            if position.lost is not None or requests.done(span, new):
                # near a bifurcation, and where a ramp ends, no old factor may tell
                self.equilibrium.assess_stability(new, state, ramp.scalar, exactly=True)
            if unstable(new, state, ramp.scalar):
                if not self._lost(ramp, span, way, new):
                    return False
                continue
            if requests.done(span, new) and self.equilibrium.opposite_modes(new, self.rest):
                self.equilibrium.restore(state)
                return self._end(ACROSS, failed=True)
            if position.lost is not None:
                left = way.sign * (position.lost - new.measures[way.key])
                position.lost = position.lost if left > LEAST_GAP * way.span else None
            if position.toward or not (position.path_following and np.isfinite(way.end)):
                position.failures = 0
            self._keep(ramp, [*self.states[1 - self.rules.memory :], new], state, outcome)
            self.report.critical += critical(self.states, ramp.scalar)
            slow = outcome if outcome.effort >= self.rules.slow else None
            position.increment = next_size(size, outcome, way.largest, self.rules)
            self._tell(outcome)

    def _requests(self, ramp: Ramp) -> Requests:
        """What a ramp is to hit."""
        return Requests(ramp, self.equilibrium.newton.settings.tolerance)

    # --- bifurcations --------------------------------------------------------------------------

    def _lost(self, ramp: Ramp, span: float, way: Way, new: State) -> bool:
        """A new state has one more unstable mode: come nearer to where it is lost, or leave there.

        The new state is not kept. Driven by its value, a load may have jumped over a limit point
        too: its conjugate, which grows there, tells the two apart.

        Returns:
            Whether the march goes on.
        """
        position, state, scalar = self.position, self.states[-1], ramp.scalar
        position.lost = new.measures[way.key]
        least = (gap := abs(position.lost - state.measures[way.key])) <= LEAST_GAP * way.span
        keys = (way.key, measure("value", scalar))
        sharp = least or all(near(k, self.rest, state.measures[k], new.measures[k]) for k in keys)
        if sharp and way.kind == "value" and ramp.conjugated:
            self.equilibrium.restore(state)
            self._follow_path(ramp)
            return True
        crossing = self._branches.crossing(scalar, state, new) if sharp else None
        if crossing is None or not (crossing.seen or least):
            self.equilibrium.restore(state)
            position.increment = gap / 2
            return True
        found, outcome = self._branches.leave(
            scalar,
            crossing,
            self.report.count,
            lambda new: asked_between(ramp, state, new) is not None,
        )
        self.report.critical.append(crossing.critical(scalar, left=bool(found)))
        if not found:
            self.equilibrium.restore(state)
            return self._give_up(ramp, dataclasses.replace(outcome, reason=LOST), "")
        # another branch may be flat: its load hardly grows, or falls
        follows = ramp.drive == "value" and ramp.conjugated
        position.path_following = follows or bool(position.toward)
        return self._enter_all(ramp, found)

    def _round(self, ramp: Ramp, way: Way) -> bool:
        """Go round a bend of the path near which a mode is lost on another one, if there is one."""
        position = self.position
        if (lost := position.lost) is None or way.kind != "conjugate":
            return False
        found = self._branches.onward(
            ramp.scalar,
            self.states,
            self.report.count,
            lambda new: way.sign * (new.measures[way.key] - lost) > 0,
        )
        return bool(found) and self._enter_all(ramp, found)

    def _enter_all(self, ramp: Ramp, found: list[tuple[State, Outcome]]) -> bool:
        """Keep states on another branch, up to what is asked for."""
        position, entered = self.position, list[State]()
        position.lost, position.failures = None, 0
        for number, (one, how) in enumerate(found, start=1):
            position.entering = number < len(found)
            if self._enter(ramp, entered, one, how):
                break
        position.entering = False
        return True

    def _enter(self, ramp: Ramp, entered: list[State], new: State, outcome: Outcome) -> bool:
        """Keep a state on another branch, or what was asked for before it.

        Args:
            ramp: the load.
            entered: states of the branch that are kept already; the new one joins them.
            new: the state.
            outcome: how it was found.

        Returns:
            Whether the march goes on from there in its ordinary way.
        """
        position, old, scalar = self.position, self.states[-1], ramp.scalar
        seed = self.equilibrium.perturbed(new, scalar)
        goal = asked_between(ramp, old, new)
        if goal is not None:
            key = measure(goal[0], scalar)
            again = self._attempts.find(
                position, scalar, *goal, ([*(entered[-2:] or [seed]), new], key, goal[1])
            )
            landed = self._attempts.found(position, scalar, again)
            if landed is not None and excess(landed, scalar) <= 0:
                new, outcome = landed, again
                seed = self.equilibrium.perturbed(new, scalar)
        self.equilibrium.restore(new)
        entered.append(new)
        key = measure("conjugate", scalar) if position.path_following else ramp.key
        position.increment = abs(new.measures[key] - old.measures[key])
        self._keep(ramp, entered[-3:] if len(entered) > 1 else [seed, new], old, outcome)
        self._tell(outcome)
        return goal is not None

    def _keep(self, ramp: Ramp, states: list[State], old: State, outcome: Outcome) -> None:
        """Go on from these states; the last one is new and follows the old one."""
        self.position.states = states
        self.report.steps += 1
        self.report.per_step.append(outcome.iterations)
        hits = self._requests(ramp).hits(states[-1])
        self.report.hits += [(self.report.steps, hit) for hit in hits]
        if self._rod is not None and self.report.self_contact is None:
            self.report.self_contact = touching(self._rod, old, states[-1])

    def _tell(self, outcome: Outcome) -> None:
        """Tell the hooks of the last state."""
        for hook in self._called:
            hook.after_step(self, self.states[-1], outcome)

    # --- limit points --------------------------------------------------------------------------

    def _follow_path(self, ramp: Ramp) -> None:
        """Drive the conjugate from here on, at the pace it had."""
        key = measure("conjugate", ramp.scalar)
        a, b = (state.measures[key] for state in self.states[-2:])
        self.position.increment = abs(b - a)
        self.position.path_following, self.position.lost = True, None
        if ramp.drive == "control":
            self.position.toward = float(np.sign(b - a))

    def _give_up(self, ramp: Ramp, outcome: Outcome, inverted: str) -> bool:
        """No increment leads on from the last state."""
        reason = outcome.reason
        if self.position.lost is not None and reason != LOST:
            reason += f" {NEARBY}"
        if self._branches.wrinkles(self.states[-1], ramp.scalar):
            reason += WRINKLES
        outcome = dataclasses.replace(outcome, reason=reason)
        if self._causes is None:
            return self._end(outcome.reason)
        critical = self.report.critical
        return self._end(self._causes.explain(self.states, self.rest, critical, outcome, inverted))

    def _end(self, reason: str, failed: bool = False) -> bool:
        """The load cannot be reached."""
        position = self.position
        lost = any(point.after > point.before for point in self.report.critical)
        limited = lost and not position.toward
        beyond = position.path_following and position.lost is None and (limited or not reason)
        self.report.status = "stopped" if beyond and not failed else "failed"
        self.report.reason = reason
        return False
