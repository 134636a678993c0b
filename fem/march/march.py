"""Load stepping: ramps, adaptive increments, exact roll-back, requested outputs hit exactly."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from fem.march.equilibrium import Equilibrium
from fem.march.frames import Frames
from fem.march.guide import Guide
from fem.march.hooks import Hook
from fem.march.limit_points import critical, crossing, limit_ahead, limit_between, softens
from fem.march.position import Position
from fem.march.predictor import Predictor, distinct, lagrange
from fem.march.records import Causes, Critical, Ramp, Report, Rules, State, measure
from fem.march.selfcontact import Rod, first_contact
from fem.march.turning import UNBENT, first_size, leads_nowhere, search_end, slackens, toward
from fem.march.ways import MISSED, Requests, Way
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome
from fem.solver.side_conditions import Functional

JUMPED = "Newton went to another branch"
BEYOND = "the load falls from here on"
CREEPS = "increments shrink to nothing, each of them converging slowly"


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
        self._controlled = control is not None
        self._guided = guide is not None
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
            position.increment = position.begin = position.first = None
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

    def _way(self, ramp: Ramp, span: float) -> Way:
        """How a ramp is driven from the last state on; `span` is all of it."""
        now = self.states[-1].measures
        if not self.position.path_following:
            sign = np.sign(ramp.target - now[ramp.key])
            stops = ramp.stops if ramp.drive != "control" else (*ramp.stops, *ramp.at)
            largest = abs(ramp.largest) if ramp.largest else np.inf
            return Way(ramp.drive, ramp.key, sign, ramp.target, abs(span), stops, largest)
        key = measure("conjugate", ramp.scalar)
        volume = now[key]
        sign = self.position.toward or np.sign(span)
        end = sign * np.inf
        if self.position.toward:
            end = search_end(ramp, span, self.position, self.rest, self.rules)
            return Way("conjugate", key, sign, end, volume, (), self.rules.swell * volume)
        limit = self._limit(ramp)
        if limit is not None and now.get(measure("rate", ramp.scalar), 1.0) < 0:
            end = limit.conjugate * self.rules.beyond**sign
        return Way("conjugate", key, sign, end, volume, (), self.rules.swell * volume)

    def _limit(self, ramp: Ramp) -> Critical | None:
        """The last limit point beyond which the ramp's load falls."""
        found = (
            c
            for c in reversed(self.report.critical)
            if c.kind == "limit" and c.scalar == ramp.scalar and c.after > c.before
        )
        return next(found, None)

    def _ramp(self, ramp: Ramp) -> bool:
        position = self.position
        if position.begin is None:
            position.begin = self.states[-1].measures[ramp.key]
        span = ramp.target - position.begin
        requests = self._requests(ramp)
        if requests.done(span, self.states[-1]):
            return True
        if position.increment is None:
            base = self.states[-1]
            seed = self.equilibrium.perturbed(base, ramp.scalar, np.sign(span))
            size = first_size(seed, base, ramp, abs(span), self.rules, self._guided)
            position.states = [seed, base]
            position.increment = min(size, abs(ramp.largest or np.inf), abs(span))
            if leads_nowhere(seed, base, ramp, self.rules):
                found = toward(self._find, self.equilibrium, seed, base, ramp)
                position.toward, position.increment = found
                position.path_following = True
                if not position.toward:
                    return self._end(UNBENT)
        # a load that hardly bends begins with tiny increments of the angle
        first = position.first = position.first or position.increment
        slow: Outcome | None = None
        while True:
            state = self.states[-1]
            if requests.done(span, state):
                return True
            way = self._way(ramp, span)
            now = state.measures[way.key]
            if position.path_following and way.sign * (way.end - now) <= 1e-9 * way.span:
                return self._end("")
            if slow and position.increment < self.rules.least * min(way.span, first):
                return self._give_up(dataclasses.replace(slow, reason=CREEPS), "")
            size = min(position.increment, self._turn_limit(way.key), way.largest)
            target = way.next(now, size)
            if way.kind == "value" and limit_ahead(self.states, ramp.scalar, target):
                self._follow_path(ramp)
                continue
            kind, aim = way.kind, target
            asked = bool(requests) and self._controlled and kind != "control"
            if asked:
                expected = self._guess(way.key, target, "control")
                goal = requests.due(state.measures["control"], expected)
                if goal is not None:
                    kind, aim = "control", goal
            new, outcome, kind = self._attempt(ramp, span, kind, aim)
            if new is not None and asked:
                verdict = requests.judge(state, new, kind, aim, way)
                if verdict == "again":
                    self.equilibrium.restore(state)
                    continue
                if verdict == "cut":
                    new, outcome = None, dataclasses.replace(outcome, reason=MISSED)
            self._predictor.heed(failed=new is None)
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
                    return self._give_up(outcome, inverted)
                if way.kind == kind == "value" and (
                    outcome.reason == BEYOND or softens(self.states, ramp.scalar)
                ):
                    self._follow_path(ramp)
                elif way.kind == "control" and slackens(self.states, ramp, position.failures):
                    self._follow_path(ramp)
                    position.failures = 0
                continue
            if position.toward or not (position.path_following and np.isfinite(way.end)):
                position.failures = 0
            position.states = [*self.states[1 - self.rules.memory :], new]
            self.report.steps += 1
            self.report.per_step.append(outcome.iterations)
            self.report.hits += [(self.report.steps, hit) for hit in requests.hits(new)]
            self._note(ramp.scalar)
            slow = outcome if outcome.iterations >= self.rules.slow else None
            if outcome.iterations <= self.rules.easy:
                size = min(size * self.rules.grow, way.largest)
            elif slow:
                size *= self.rules.shrink
            position.increment = size
            for hook in self._called:
                hook.after_step(self, new, outcome)

    def _requests(self, ramp: Ramp) -> Requests:
        """What a ramp is to hit."""
        return Requests(ramp, self.equilibrium.newton.settings.tolerance)

    def _attempt(
        self, ramp: Ramp, span: float, kind: str, aim: float
    ) -> tuple[State | None, Outcome, str]:
        """Try an increment; land where it passes a value that was asked for, or a limit point.

        Returns:
            The state, if one was found that is to be kept; how Newton ended; what was given.
        """
        scalar, key = ramp.scalar, measure(kind, ramp.scalar)
        start = (distinct(self.states, key), key, aim)
        outcome = self._find(scalar, kind, aim, start)
        new = self._found(scalar, outcome)
        if new is not None and kind == "value" and self._jumped(scalar, aim, new):
            outcome, new = dataclasses.replace(outcome, reason=JUMPED), None
        if new is not None and kind == "value" and new.measures[measure("rate", scalar)] < 0:
            outcome, new = dataclasses.replace(outcome, reason=BEYOND), None
        if new is None:
            return new, outcome, kind
        states, key = [*self.states[-2:], new], measure("conjugate", scalar)
        goal = self._passed(ramp, span, new)
        if goal is not None:
            start = (distinct(states, key), key, crossing(states, scalar, goal))
            outcome = self._find(scalar, "value", goal, start)
            return self._found(scalar, outcome), outcome, "landing"
        limit = limit_between(states, scalar) if kind == "conjugate" else None
        if limit is not None:
            outcome = self._find(scalar, kind, limit, (distinct(states, key), key, limit))
            return self._found(scalar, outcome), outcome, kind
        return new, outcome, kind

    def _find(
        self, scalar: str, kind: str, aim: float, start: tuple[list[State], str, float]
    ) -> Outcome:
        outcome = self.equilibrium.find(scalar, kind, aim, start)
        self.report.iterations += outcome.iterations
        self.report.factorisations += outcome.factorisations
        return outcome

    def _found(self, scalar: str, outcome: Outcome) -> State | None:
        """The state that was found, its stability assessed."""
        if not outcome.converged:
            return None
        new = self.equilibrium.capture()
        self.equilibrium.assess_stability(new, self.states[-1], scalar)
        return new

    def _jumped(self, scalar: str, aim: float, new: State) -> bool:
        """Whether the conjugate is far from where the last states point to."""
        name = measure("conjugate", scalar)
        now = self.states[-1].measures[name]
        key = measure("value", scalar)
        expected = self._guess(key, aim, name)
        # a curve through states around a kink may be flat here: the chord tells the size of a step
        (p, v), (q, w) = ((state.measures[key], state.measures[name]) for state in self.states[-2:])
        step = max(abs(expected - now), abs((w - v) / (q - p) * (aim - q)) if q != p else 0.0)
        return bool(abs(new.measures[name] - expected) > self.rules.jump * step + 1e-6 * abs(now))

    # --- limit points --------------------------------------------------------------------------

    def _follow_path(self, ramp: Ramp) -> None:
        """Drive the conjugate from here on, at the pace it had."""
        key = measure("conjugate", ramp.scalar)
        a, b = (state.measures[key] for state in self.states[-2:])
        self.position.increment = abs(b - a)
        self.position.path_following = True
        if ramp.drive == "control":
            self.position.toward = float(np.sign(b - a))

    def _passed(self, ramp: Ramp, span: float, new: State) -> float | None:
        """Value asked for that following the path has passed and never reached before."""
        if not self.position.path_following or self.position.toward:
            return None
        sign, key = np.sign(span), measure("value", ramp.scalar)
        limit = self._limit(ramp)
        reached = [self.states[-1].measures[key], *([limit.value] if limit else [])]
        peak = max(sign * value for value in reached)
        top = sign * new.measures[key]
        goals = [sign * goal for goal in (*ramp.stops, ramp.target)]
        margin = 1e-9 * abs(span)
        passed = [goal for goal in goals if peak + margin < goal < top - margin]
        return float(sign * min(passed)) if passed else None

    def _note(self, scalar: str) -> None:
        """Report what happened in the last increment to stability and to the body's clearance."""
        self.report.critical += critical(self.states, scalar)
        if self._rod is None or self.report.self_contact is not None:
            return
        old, new = self.states[-2:]
        share = first_contact(self._rod, old, new)
        if share is not None:
            self.report.self_contact = {
                name: (1 - share) * value + share * new.measures[name]
                for name, value in old.measures.items()
            }

    def _give_up(self, outcome: Outcome, inverted: str) -> bool:
        """No increment leads on from the last state."""
        if self._causes is None:
            return self._end(outcome.reason)
        critical = self.report.critical
        return self._end(self._causes.explain(self.states, self.rest, critical, outcome, inverted))

    def _end(self, reason: str) -> bool:
        """The load cannot be reached."""
        limited = not self.position.toward and any(c.kind == "limit" for c in self.report.critical)
        beyond = self.position.path_following and (limited or not reason)
        self.report.status = "stopped" if beyond else "failed"
        self.report.reason = reason
        return False

    # --- increments ----------------------------------------------------------------------------

    def _guess(self, key: str, target: float, name: str) -> float:
        """Extrapolated value of a measure where the increment of another would end."""
        history = distinct(self.states, key)
        weights = lagrange(np.array([state.measures[key] for state in history]), target)
        return float(weights @ [state.measures[name] for state in history])

    def _turn_limit(self, drive: str) -> float:
        """Increment that changes the control quantity by `turn`, from the last two states."""
        if not self._controlled or len(self.states) < min(self.rules.memory, 3):
            return np.inf
        a, b = (state.measures for state in self.states[-2:])
        turned = abs(b["control"] - a["control"])
        return float(abs(b[drive] - a[drive]) * self.rules.turn / max(turned, 1e-12))
