"""One increment tried: what is found there, and whether it may be kept."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from fem.march.branches import excess
from fem.march.equilibrium import Equilibrium
from fem.march.increments import first_size, guess
from fem.march.limit_points import crossing, last_limit, limit_between, passed
from fem.march.position import Position
from fem.march.predictor import distinct
from fem.march.records import MODES, Ramp, Report, Rules, State, measure
from fem.march.turning import leads_nowhere, toward
from fem.solver.newton import Outcome

STRAY = 0.35
"""Part of a step round a limit point or along another branch that Newton may go beside it."""
JUMPED = "Newton went to another branch"
BEYOND = "the load falls from here on"


def unstable(new: State, old: State, scalar: str) -> bool:
    """Whether a mode that is stable at a state is not at the next, its conjugate given.

    Where the solver tells no modes none is seen: such a run says that nobody has looked.
    """
    return excess(new, scalar) > max(0, excess(old, scalar))


def suspect(new: State, report: Report) -> bool:
    """Whether a mode may have been lost on the way to a state: one was, or nobody has looked.

    Args:
        new: the state, its stability assessed.
        report: of the march up to there.
    """
    modes = new.measures.get(MODES)
    return bool(report.critical) or modes is None or modes > 0


class Attempts:
    """Tries increments from where a march stands.

    Args:
        equilibrium: the scene and what finds its equilibria.
        rules: incrementation.
    """

    def __init__(self, equilibrium: Equilibrium, rules: Rules) -> None:
        self._equilibrium, self._rules = equilibrium, rules

    def begin(self, position: Position, ramp: Ramp, span: float, guided: bool) -> float:
        """The first increment of a ramp, and which way it goes where the load hardly bends.

        Args:
            position: where the march stands, at the beginning of the ramp; is told.
            ramp: the load.
            span: its whole change.
            guided: a guide knows the way.

        Returns:
            Its size; 0 where the load does not bend it, neither way.
        """
        base = position.states[-1]
        seed = self._equilibrium.perturbed(base, ramp.scalar, np.sign(span))
        size = first_size(seed, base, ramp, abs(span), self._rules, guided)
        position.states = [seed, base]
        if leads_nowhere(seed, base, ramp, self._rules):
            find = functools.partial(self.find, position)
            position.toward, size = toward(find, self._equilibrium, seed, base, ramp)
            position.path_following = True
            return size if position.toward else 0.0
        return float(min(size, abs(ramp.largest or np.inf), abs(span)))

    def increment(
        self, position: Position, ramp: Ramp, span: float, kind: str, aim: float
    ) -> tuple[State | None, Outcome, str]:
        """Try an increment; land where it passes a value that was asked for, or a limit point.

        Args:
            position: where the march stands.
            ramp: the load.
            span: its whole change.
            kind: what is given: 'value', 'conjugate' or 'control'.
            aim: its value.

        Returns:
            The state, if one was found that may be kept; how Newton ended; what was given.
        """
        scalar, key, last = ramp.scalar, measure(kind, ramp.scalar), position.states[-1]
        outcome = self.find(position, scalar, kind, aim, (distinct(position.states, key), key, aim))
        new = self.found(position, scalar, outcome)
        why = "" if new is None else self._refused(position, scalar, kind, aim, new)
        if why:
            outcome, new = dataclasses.replace(outcome, reason=why), None
        if new is None or unstable(new, last, scalar):
            return new, outcome, kind
        states, key = [*position.states[-2:], new], measure("conjugate", scalar)
        goal = None
        if position.path_following and not position.toward:
            goal = passed(ramp, span, last, new, last_limit(position.report, scalar))
        if goal is not None:
            start = (distinct(states, key), key, crossing(states, scalar, goal))
            outcome = self.find(position, scalar, "value", goal, start)
            return self.found(position, scalar, outcome), outcome, "landing"
        limit = limit_between(states, scalar) if kind == "conjugate" else None
        if limit is not None:
            outcome = self.find(position, scalar, kind, limit, (distinct(states, key), key, limit))
            return self.found(position, scalar, outcome), outcome, kind
        return new, outcome, kind

    def find(
        self,
        position: Position,
        scalar: str,
        kind: str,
        aim: float,
        start: tuple[list[State], str, float],
    ) -> Outcome:
        """Solve for one equilibrium from an extrapolation, and count what that costs."""
        outcome = self._equilibrium.find(scalar, kind, aim, start)
        position.report.count(outcome)
        return outcome

    def found(self, position: Position, scalar: str, outcome: Outcome) -> State | None:
        """The state that was found, its stability assessed."""
        if not outcome.converged:
            return None
        new = self._equilibrium.capture()
        # a factor of an earlier step knows nothing of this one
        stale = outcome.factorisations == 0
        self._equilibrium.assess_stability(new, position.states[-1], scalar, exactly=stale)
        return new

    def _refused(self, position: Position, scalar: str, kind: str, aim: float, new: State) -> str:
        """Why a state is not kept though Newton's method has found it; empty where it is."""
        if kind == "value" and self._jumped(position.states, scalar, aim, new):
            return JUMPED
        # a path without a critical point may have kinks: threads that go slack
        followed = kind == "conjugate" and position.path_following
        if followed and suspect(new, position.report):
            strayed = self._equilibrium.strayed(new, position.states)
            return JUMPED if strayed > STRAY else ""
        falls = new.measures[measure("rate", scalar)] < 0
        return BEYOND if kind == "value" and falls else ""

    def _jumped(self, states: list[State], scalar: str, aim: float, new: State) -> bool:
        """Whether the conjugate is far from where the last states point to."""
        name = measure("conjugate", scalar)
        now = states[-1].measures[name]
        key = measure("value", scalar)
        expected = guess(states, key, aim, name)
        # a curve through states around a kink may be flat here: the chord tells the size of a step
        (p, v), (q, w) = ((state.measures[key], state.measures[name]) for state in states[-2:])
        step = max(abs(expected - now), abs((w - v) / (q - p) * (aim - q)) if q != p else 0.0)
        return bool(abs(new.measures[name] - expected) > self._rules.jump * step + 1e-6 * abs(now))
