"""A minimum under conditions, by sequential quadratic programming that survives failures.

Fletcher's Sℓ1QP (Practical Methods of Optimization, 2nd ed. 1987, 14.3): a step d minimises

    gᵀd + ½ dᵀB d + ν w Σ max(0, c + A d) + ν Σ |h + C d|    for  |d| ≤ Δ, low ≤ x + d ≤ high

and is taken where f + ν w Σ max(0, c) + ν Σ |h| falls. Bounds c ≤ 0 weigh w times as much as aims
h = 0: where not all can be met, aims are missed. The subproblem always has a solution, so that
a target out of reach ends at the least miss; a case that cannot be solved halves Δ, which a line
search along an undefined function could not. B is that of BFGS, damped by Powell. scipy's SLSQP
solves the subproblem, which costs no case.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from scipy.optimize import lsq_linear, minimize

Floats = Any

_FIRST, _LEAST = 0.2, 2e-4
"""Radius Δ of the region of trust: at first, and where it gives up; variables run from 0 to 1."""
BOUNDS = 30.0
"""w: so many times what is missed of an aim counts what is missed of a bound."""
_GROW, _SHRINK = 2.0, 0.35
_MOST_STEPS = 40
_FALLS = 1e-5
"""A foreseen fall of the merit below which a point is a minimum; all functions are of order one."""
_ACTIVE = 1e-3
"""Scaled distance within which a bound or a condition is active."""


@dataclasses.dataclass(frozen=True)
class Values:
    """Functions at a point, each of order one.

    Attributes:
        goal: f, to be small.
        below: c, to be at most zero.
        zero: h, to be zero.
    """

    goal: float
    below: Floats
    zero: Floats

    @property
    def miss(self) -> float:
        """w Σ max(0, c) + Σ |h|."""
        return float(BOUNDS * np.maximum(self.below, 0).sum() + np.abs(self.zero).sum())


@dataclasses.dataclass(frozen=True)
class Slopes:
    """Their derivatives by the variables: (n,), (m, n), (k, n)."""

    goal: Floats
    below: Floats
    zero: Floats


class Functions(Protocol):
    """What is minimised, over variables from 0 to 1."""

    def values(self, x: Floats) -> Values | None:
        """At a point; None where there is no such case, or it cannot be solved."""

    def slopes(self, x: Floats) -> Slopes | None:
        """At a point that has values."""


@dataclasses.dataclass(frozen=True)
class Multipliers:
    """What a minimum leans on: how much f, or the miss, falls where something gives way.

    Attributes:
        below: of each condition c ≤ 0.
        zero: of each condition h = 0, of either sign.
        low: of each lower end.
        high: of each upper end.
    """

    below: Floats
    zero: Floats
    low: Floats
    high: Floats


@dataclasses.dataclass(frozen=True)
class Minimum:
    """Where a descent has ended.

    Attributes:
        x: variables.
        values: there.
        slopes: there; None where they are not known.
        multipliers: there, of the goal; where the conditions cannot be met, of the miss.
        steps: points with derivatives.
        whole: it ended because nothing falls any more, not for want of steps.
    """

    x: Floats
    values: Values
    slopes: Slopes | None
    multipliers: Multipliers | None
    steps: int
    whole: bool

    def better(self, other: Minimum | None, tolerance: float) -> bool:
        """Whether it is the better of two: by what it misses, then by its goal."""
        if other is None:
            return True
        mine, theirs = (max(0.0, each.values.miss - tolerance) for each in (self, other))
        if mine > 0 or theirs > 0:
            return mine < theirs
        return self.values.goal < other.values.goal


def descend(
    functions: Functions,
    start: Floats,
    goal: bool = True,
    tell: Callable[[int, Values], None] = lambda _n, _v: None,
) -> Minimum | None:
    """Go down from a point.

    Args:
        functions: what is minimised.
        start: where it begins.
        goal: with the goal; without it the miss alone falls.
        tell: takes the number of a step and its values.

    Returns:
        Where it ends; None where the first point has no values.
    """
    x = np.asarray(start, dtype=float)
    values = functions.values(x)
    if values is None:
        return None
    n, radius, penalty = len(x), _FIRST, 10.0
    curved = np.zeros((n, n))
    slopes = functions.slopes(x)
    steps, whole = 1, False
    while slopes is not None and steps < _MOST_STEPS:
        penalty = max(penalty, 3 * _greatest(lean(x, values, slopes, goal, 0.0)))
        step, foreseen = _step(x, values, slopes, curved, penalty, radius, goal)
        before = _merit(values, penalty, goal)
        falls = before - foreseen
        if falls < _FALLS * max(1.0, abs(before)) or radius < _LEAST:
            whole = True
            break
        there = functions.values(np.clip(x + step, 0.0, 1.0))
        if there is not None and before - _merit(there, penalty, goal) < 0.1 * falls:
            # curved conditions: a second step back onto them
            step, there = _again(functions, x, step, there, slopes, curved, penalty, radius, goal)
        fallen = -np.inf if there is None else before - _merit(there, penalty, goal)
        size = float(np.abs(step).max())
        if fallen < 0.05 * falls:
            radius = _SHRINK * min(radius, size)
        if there is None or fallen <= 0:
            continue
        if fallen > 0.7 * falls and size > 0.9 * radius:
            radius = min(1.0, _GROW * radius)
        moved = np.clip(x + step, 0.0, 1.0)
        new = functions.slopes(moved)
        steps += 1
        if new is not None:
            after = lean(moved, there, new, goal, penalty)
            turn = _lagrangian(new, after, goal) - _lagrangian(slopes, after, goal)
            curved = _bfgs(curved, moved - x, turn)
        tell(steps, there)
        x, values, slopes = moved, there, new
    known = None if slopes is None else lean(x, values, slopes, goal)
    return Minimum(x, values, slopes, known, steps, whole)


def linear_step(x: Floats, values: Values, slopes: Slopes, radius: float) -> Floats:
    """The step that makes the goal least within a radius, all functions taken as linear."""
    penalty = max(10.0, 3 * _greatest(lean(x, values, slopes, True, 0.0)))
    flat = np.zeros((len(x), len(x)))
    return _step(x, values, slopes, flat, penalty, radius, True)[0]


def _greatest(multipliers: Multipliers) -> float:
    return float(np.abs([*multipliers.below, *multipliers.zero]).max(initial=0.0))


def _merit(values: Values, penalty: float, goal: bool) -> float:
    return (values.goal if goal else 0.0) + penalty * values.miss


def _step(
    x: Floats,
    values: Values,
    slopes: Slopes,
    curved: Floats,
    penalty: float,
    radius: float,
    goal: bool,
) -> tuple[Floats, float]:
    """The step of the subproblem, and the merit that it foresees."""
    n, m, k = len(x), len(values.below), len(values.zero)
    low, high = np.maximum(-x, -radius), np.minimum(1 - x, radius)
    rises = slopes.goal if goal else np.zeros(n)
    # the slack variables take up what is missed
    first = np.concatenate([np.zeros(n), np.maximum(values.below, 0), np.abs(values.zero)])
    eye_m, eye_k = np.eye(m), np.eye(k)
    rows = np.block(
        [
            [-slopes.below, eye_m, np.zeros((m, k))],
            [-slopes.zero, np.zeros((k, m)), eye_k],
            [slopes.zero, np.zeros((k, m)), eye_k],
        ]
    )
    right = np.concatenate([-values.below, -values.zero, values.zero])
    weights = penalty * np.concatenate([np.zeros(n), np.full(m, BOUNDS), np.ones(k)])

    def merit(z: Floats) -> float:
        d = z[:n]
        return float(rises @ d + 0.5 * d @ curved @ d + weights @ z)

    def rise(z: Floats) -> Floats:
        found = weights.copy()
        found[:n] += rises + curved @ z[:n]
        return found

    bounds = [*zip(low, high, strict=True), *[(0.0, None)] * (m + k)]
    kept = {"type": "ineq", "fun": lambda z: rows @ z + right, "jac": lambda _z: rows}
    with warnings.catch_warnings():
        # of numbers that it has moved into their bounds
        warnings.simplefilter("ignore", RuntimeWarning)
        solved = minimize(
            merit,
            first,
            jac=rise,
            method="SLSQP",
            bounds=bounds,
            constraints=[kept],
            options={"ftol": 1e-10, "maxiter": 200},
        )
    step = np.clip(solved.x[:n], low, high)
    if not np.all(np.isfinite(step)):
        step = np.zeros(n)
    below, zero = values.below + slopes.below @ step, values.zero + slopes.zero @ step
    foreseen = Values(float(values.goal + rises @ step), below, zero)
    return step, _merit(foreseen, penalty, goal) + 0.5 * float(step @ curved @ step)


def _again(
    functions: Functions,
    x: Floats,
    step: Floats,
    there: Values,
    slopes: Slopes,
    curved: Floats,
    penalty: float,
    radius: float,
    goal: bool,
) -> tuple[Floats, Values | None]:
    """The step with conditions as they were found at its end (Fletcher 1987, 14.4)."""
    below = there.below - slopes.below @ step
    zero = there.zero - slopes.zero @ step
    moved = Values(there.goal, below, zero)
    second, _ = _step(x, moved, slopes, curved, penalty, radius, goal)
    if np.abs(second - step).max() < 0.02 * np.abs(step).max():
        return step, there
    found = functions.values(np.clip(x + second, 0.0, 1.0))
    if found is None or _merit(found, penalty, goal) >= _merit(there, penalty, goal):
        return step, there
    return second, found


def _lagrangian(slopes: Slopes, multipliers: Multipliers, goal: bool) -> Floats:
    own = slopes.goal if goal else 0.0 * slopes.goal
    return own + multipliers.below @ slopes.below + multipliers.zero @ slopes.zero


def _bfgs(curved: Floats, step: Floats, turn: Floats) -> Floats:
    """B after a step, kept positive (Powell 1978, doi 10.1007/BFb0067703)."""
    length = float(step @ step)
    if length < 1e-16:
        return curved
    if not curved.any():
        size = max(float(step @ turn) / length, 1e-3)
        curved = size * np.eye(len(step))
    along = curved @ step
    whole = float(step @ along)
    if step @ turn < 0.2 * whole:
        part = 0.8 * whole / (whole - float(step @ turn))
        turn = part * turn + (1 - part) * along
    return curved - np.outer(along, along) / whole + np.outer(turn, turn) / float(step @ turn)


def lean(
    x: Floats, values: Values, slopes: Slopes, goal: bool, penalty: float = 1.0
) -> Multipliers:
    """Multipliers of what is active at a point, by least squares with their signs.

    A condition that is missed pulls with the penalty, whatever else is active; without the goal
    these pulls are all there is, and what balances them stops the miss from falling.
    """
    n = len(x)
    eye = np.eye(n)
    at_low, at_high = x <= _ACTIVE, x >= 1 - _ACTIVE
    missed, off = values.below > _ACTIVE, np.abs(values.zero) > _ACTIVE
    below = np.where(missed, BOUNDS * penalty, 0.0)
    zero = np.where(off, penalty * np.sign(values.zero), 0.0)
    pull = below @ slopes.below + zero @ slopes.zero + (slopes.goal if goal else np.zeros(n))
    active, held = np.abs(values.below) <= _ACTIVE, ~off
    columns = [slopes.below[active].T, slopes.zero[held].T, -eye[:, at_low], eye[:, at_high]]
    matrix = np.hstack(columns)
    sizes = [int(active.sum()), int(held.sum()), int(at_low.sum()), int(at_high.sum())]
    found = np.zeros(matrix.shape[1])
    if matrix.shape[1]:
        least = np.zeros(matrix.shape[1])
        least[sizes[0] : sizes[0] + sizes[1]] = -np.inf
        found = lsq_linear(matrix, -pull, (least, np.inf)).x
    parts = np.split(found, np.cumsum(sizes)[:-1])
    low, high = np.zeros(n), np.zeros(n)
    below[active], zero[held], low[at_low], high[at_high] = parts
    return Multipliers(below, zero, low, high)
