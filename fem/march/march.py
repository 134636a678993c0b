"""Load stepping: ramps, adaptive increments, exact roll-back, requested outputs hit exactly."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from fem.march.equilibrium import Equilibrium
from fem.march.frames import Frames
from fem.march.limit_points import (
    critical,
    crossing,
    limit_ahead,
    limit_between,
    softens,
)
from fem.march.predictor import distinct, lagrange
from fem.march.records import Causes, Critical, Ramp, Report, Rules, State, measure
from fem.march.selfcontact import Rod, first_contact
from fem.scene import Scene
from fem.solver.closures import Functional
from fem.solver.newton import Newton, Outcome

JUMPED = "Newton went to another branch"
BEYOND = "the load falls from here on"
CREEPS = "increments shrink to nothing, each of them converging slowly"


@dataclasses.dataclass(frozen=True)
class _Way:
    """How a ramp is driven at present.

    Attributes:
        kind: 'value', 'conjugate' or 'followed'.
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


class _Requests:
    """Values of the followed functional that a ramp is to hit.

    Attributes:
        insist: the next increment hits one, whatever is expected.
    """

    def __init__(self, ramp: Ramp) -> None:
        self.insist = False
        self._pending = sorted(ramp.at) if ramp.drive != "followed" else []
        if ramp.until is not None:
            before = (a for a in self._pending if a < ramp.until)
            self._pending = sorted({*before, ramp.until})

    def due(self, state: State) -> float | None:
        """The next one."""
        here = state.measures.get("followed", np.inf)
        return next((a for a in self._pending if a > here + 1e-9), None)

    def met(self, new: State, goal: float, kind: str, way: _Way) -> bool:
        """Whether a new state may be kept: it has not run past the one that was due."""
        if kind != "followed":
            self.insist = new.measures["followed"] > goal + 1e-9
            return not self.insist
        if way.kind != kind and way.sign * (new.measures[way.key] - way.end) > 0:
            # the angle lies beyond the load's end: go there by the load instead
            self._pending = [a for a in self._pending if a < goal - 1e-12]
            return False
        return True


class March:
    """Drives a scene along its ramps.

    Args:
        scene: the problem, at rest.
        newton: solver of that problem.
        frames: rod frames for the predictor; None where the kinematics turns by itself.
        followed: functional that requests refer to (the bending angle), or None.
        rules: incrementation.
        on_step: called after every converged increment with the state and its outcome.
        warn: called with a line of text when an increment fails.
    """

    def __init__(
        self,
        scene: Scene,
        newton: Newton,
        frames: Frames | None,
        followed: Functional | None,
        rules: Rules,
        on_step: Callable[[State, Outcome], None],
        warn: Callable[[str], None],
    ) -> None:
        self.followed = followed
        self.rules = rules
        self.on_step = on_step
        self.warn = warn
        self.equilibrium = Equilibrium(scene, newton, frames, followed)
        self.predictor = self.equilibrium.predictor
        self.causes: Causes | None = None
        """What tells physical causes of a failure; None: how Newton ended is all that is said."""
        self.rod: Rod | None = None
        """The states as rods, to see whether the body passes through itself; None: not looked."""
        self.states: list[State] = []
        self.report = Report()
        self.ramp = 0
        """Number of the ramp under way."""
        self.increment: float | None = None
        """Increment of the driven quantity to try next; None at the start of a ramp."""

    def start(self) -> None:
        """Capture the state at rest; without it nothing can be predicted."""
        scene = self.equilibrium.scene
        scene.set(scene.w.copy())
        self.rest = self.equilibrium.capture()
        self.states = [self.rest]

    def run(self, ramps: Sequence[Ramp]) -> Report:
        """March through all ramps in order, earlier loads held."""
        if not self.states:
            self.start()
        for ramp in ramps[self.ramp :]:
            if not self._ramp(ramp):
                break
            self.ramp += 1
            self.increment = None
            self.report.detour = False
        return self.report

    def _way(self, ramp: Ramp, span: float) -> _Way:
        """How a ramp is driven from the last state on; `span` is all of it."""
        now = self.states[-1].measures
        if not self.report.detour:
            sign = np.sign(ramp.target - now[ramp.key])
            stops = ramp.stops if ramp.drive != "followed" else (*ramp.stops, *ramp.at)
            largest = abs(ramp.largest) if ramp.largest else np.inf
            return _Way(ramp.drive, ramp.key, sign, ramp.target, abs(span), stops, largest)
        key = measure("conjugate", ramp.scalar)
        volume = now[key]
        sign = np.sign(span)
        end = sign * np.inf
        limit = self._limit(ramp)
        if limit is not None and now.get(measure("rate", ramp.scalar), 1.0) < 0:
            end = limit.conjugate * self.rules.beyond**sign
        return _Way("conjugate", key, sign, end, volume, (), self.rules.swell * volume)

    def _limit(self, ramp: Ramp) -> Critical | None:
        """The last limit point beyond which the ramp's load falls."""
        found = (
            c
            for c in reversed(self.report.critical)
            if c.kind == "limit" and c.scalar == ramp.scalar and c.after > c.before
        )
        return next(found, None)

    def _ramp(self, ramp: Ramp) -> bool:
        span = ramp.target - self.states[-1].measures[ramp.key]
        if span == 0:
            return True
        if self.increment is None:
            base = self.states[-1]
            seed = self.equilibrium.neighbour(base, ramp.scalar)
            size = abs(ramp.first) if ramp.first else self._first_size(seed, ramp, abs(span))
            self.states = [seed, base]
            self.increment = min(size, abs(ramp.largest or np.inf), abs(span))
        requests = _Requests(ramp)
        # a load that hardly bends begins with tiny increments of the angle
        first = self.increment
        failures = 0
        slow: Outcome | None = None
        while True:
            state = self.states[-1]
            if abs(ramp.target - state.measures[ramp.key]) <= 1e-9 * abs(span):
                return True
            way = self._way(ramp, span)
            now = state.measures[way.key]
            if self.report.detour and way.sign * (way.end - now) <= 1e-9 * way.span:
                return self._end("")
            if slow and self.increment < self.rules.least * min(way.span, first):
                return self._give_up(dataclasses.replace(slow, reason=CREEPS), "")
            size = min(self.increment, self._turn_limit(way.key), way.largest)
            target = way.next(now, size)
            if way.kind == "value" and limit_ahead(self.states, ramp.scalar, target):
                self._turn_off(ramp)
                continue
            kind, aim = way.kind, target
            goal = requests.due(state)
            if goal is not None and (
                requests.insist or self._guess(way.key, target, "followed") > goal - 0.02
            ):
                kind, aim = "followed", goal
            requests.insist = False
            new, outcome, kind = self._attempt(ramp, span, kind, aim)
            self.predictor.astray = new is None
            if new is None:
                failures += 1
                self.report.cutbacks += 1
                # what was tried: a stop may have clipped it, and the next try would be the same
                self.increment = min(size, abs(target - now)) * self.rules.cut
                hopeless = (
                    failures > self.rules.cutbacks or self.increment < self.rules.least * way.span
                )
                inverted = self.causes.inverted() if hopeless and self.causes else ""
                self.equilibrium.restore(state)
                self.warn(f"increment cut back: {outcome.reason}")
                if hopeless:
                    return self._give_up(outcome, inverted)
                if way.kind == kind == "value" and (
                    outcome.reason == BEYOND or softens(self.states, ramp.scalar)
                ):
                    self._turn_off(ramp)
                continue
            if goal is not None and not requests.met(new, goal, kind, way):
                self.equilibrium.restore(state)
                continue
            if not (self.report.detour and np.isfinite(way.end)):
                failures = 0
            self.states = [*self.states[1 - self.rules.memory :], new]
            self.report.steps += 1
            self.report.per_step.append(outcome.iterations)
            self._note(ramp.scalar)
            slow = outcome if outcome.iterations >= self.rules.slow else None
            if outcome.iterations <= self.rules.easy:
                size = min(size * self.rules.grow, way.largest)
            elif slow:
                size *= self.rules.shrink
            self.increment = size
            self.on_step(new, outcome)
            if kind == "followed" and ramp.until is not None and aim >= ramp.until - 1e-9:
                return True

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
            outcome.reason, new = JUMPED, None
        if new is not None and kind == "value" and new.measures[measure("rate", scalar)] < 0:
            outcome.reason, new = BEYOND, None
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
        """The state that was found, judged."""
        if not outcome.converged:
            return None
        new = self.equilibrium.capture()
        self.equilibrium.judge(new, self.states[-1], scalar)
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

    def _turn_off(self, ramp: Ramp) -> None:
        """Drive the conjugate from here on, at the pace it had."""
        key = measure("conjugate", ramp.scalar)
        a, b = (state.measures[key] for state in self.states[-2:])
        self.increment = abs(b - a)
        self.report.detour = True

    def _passed(self, ramp: Ramp, span: float, new: State) -> float | None:
        """Value asked for that a detour has passed and never reached before."""
        if not self.report.detour:
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
        if self.rod is None or self.report.self_contact is not None:
            return
        old, new = self.states[-2:]
        share = first_contact(self.rod, old, new)
        if share is not None:
            self.report.self_contact = {
                name: (1 - share) * value + share * new.measures[name]
                for name, value in old.measures.items()
            }

    def _give_up(self, outcome: Outcome, inverted: str) -> bool:
        """No increment leads on from the last state."""
        if self.causes is None:
            return self._end(outcome.reason)
        critical = self.report.critical
        return self._end(self.causes.explain(self.states, self.rest, critical, outcome, inverted))

    def _end(self, reason: str) -> bool:
        """The load cannot be reached."""
        beyond = self.report.detour and any(c.kind == "limit" for c in self.report.critical)
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
        """Increment that turns the followed functional by `turn`, from the last two states."""
        if self.followed is None or len(self.states) < min(self.rules.memory, 3):
            return np.inf
        a, b = (state.measures for state in self.states[-2:])
        turned = abs(b["followed"] - a["followed"])
        return float(abs(b[drive] - a[drive]) * self.rules.turn / max(turned, 1e-12))

    def _first_size(self, seed: State, ramp: Ramp, span: float) -> float:
        """First increment, by the linear response.

        It turns the followed functional by `first_turn`, a twentieth of the load where nothing
        turns, and changes the conjugate by no more than `swell`, unless a guide knows the way.
        """
        base = self.states[-1].measures
        change = {name: abs(value - base[name]) for name, value in seed.measures.items()}
        driven, turned = change[ramp.key], change.get("followed", 0.0)
        volume = measure("conjugate", ramp.scalar)
        if driven < 1e-300:
            return span / 20
        size = span / 20 if turned < 1e-14 else driven / turned * self.rules.first_turn
        if self.predictor.guide is None and base[volume] and change[volume]:
            size = min(size, driven * self.rules.swell * abs(base[volume]) / change[volume])
        return float(size)
