"""Lengths of increments: the first one, and what the last states say of the next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fem.march.equilibrium import STILL
from fem.march.predictor import distinct, lagrange
from fem.march.records import TURN, Ramp, Rules, State, measure
from fem.solver.newton import Outcome


def guess(states: Sequence[State], key: str, target: float, name: str) -> float:
    """Extrapolated value of a measure where the increment of another would end."""
    history = distinct(states, key)
    weights = lagrange(np.array([state.measures[key] for state in history]), target)
    return float(weights @ [state.measures[name] for state in history])


def turn_limit(states: Sequence[State], drive: str, rules: Rules) -> float:
    """Increment that turns the body by `turn`, from the last two states."""
    if "control" not in states[-1].measures or len(states) < min(rules.memory, 3):
        return np.inf
    a, b = (state.measures for state in states[-2:])
    turned = abs(_turned(b) - _turned(a))
    return float(abs(b[drive] - a[drive]) * rules.turn / max(turned, 1e-12))


def _turned(measures: Mapping[str, float]) -> float:
    """The control quantity, or where it is a part of the turn all of that, rad."""
    return measures.get(TURN, measures.get("control", 0.0))


def next_size(size: float, outcome: Outcome, largest: float, rules: Rules) -> float:
    """The next increment after one of a size, by how Newton's method converged.

    Args:
        size: of the last one.
        outcome: how Newton's method ended.
        largest: greatest increment.
        rules: incrementation.
    """
    if outcome.effort <= rules.easy:
        return min(size * rules.grow, largest)
    return size * rules.shrink if outcome.effort >= rules.slow else size


def first_size(
    seed: State, base: State, ramp: Ramp, span: float, rules: Rules, guided: bool
) -> float:
    """First increment of a ramp, as it is given or by the linear response.

    It turns the body by `first_turn`, a twentieth of the load where nothing turns,
    and changes the conjugate by no more than `swell`, unless a guide knows the way.

    Args:
        seed: the base, perturbed by its linear response.
        base: where the ramp begins.
        ramp: the ramp.
        span: all of what it drives.
        rules: incrementation.
        guided: a guide knows the way.
    """
    if ramp.first:
        return abs(ramp.first)
    now = base.measures
    change = {name: abs(value - now[name]) for name, value in seed.measures.items()}
    driven, turned = change[ramp.key], _turned(change)
    volume = measure("conjugate", ramp.scalar)
    if driven < 1e-300:
        return span / 20
    size = span / 20 if turned < STILL else driven / turned * rules.first_turn
    if not guided and now[volume] and change[volume]:
        size = min(size, driven * rules.swell * abs(now[volume]) / change[volume])
    return float(size)
