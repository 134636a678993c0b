"""Limit points: where a load that is driven has a greatest value, seen from the states around."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from fem.march.predictor import lagrange
from fem.march.records import (
    MODES,
    Critical,
    Ramp,
    Report,
    State,
    measure,
)

Floats = npt.NDArray[np.float64]

APART = 0.02
"""States closer than this part of the distance to the next give no curvature."""
NEAR = 0.05
"""A state within this part of an increment from a limit point is a state at the limit point."""


def _curve(states: Sequence[State], scalar: str) -> tuple[Floats, Floats]:
    """Conjugate and value of a scalar at some states."""
    conjugate = np.array([state.measures[measure("conjugate", scalar)] for state in states])
    value = np.array([state.measures[measure("value", scalar)] for state in states])
    return conjugate, value


def _apart(t: Floats) -> bool:
    """Whether points, at least three, are spread well enough for a polynomial."""
    steps = np.diff(t)
    return bool(np.all(steps != 0) and np.abs(steps).min() > APART * np.abs(steps).max())


def limit_ahead(states: Sequence[State], scalar: str, target: float) -> bool:
    """Whether the parabola through the last three states turns before the value reaches a target.

    Args:
        states: converged states, the last one last.
        scalar: the load that is driven.
        target: the value to be reached next.
    """
    if len(states) < 3:
        return False
    v, p = _curve(states[-3:], scalar)
    if not _apart(v):
        return False
    sign = np.sign(target - p[-1])
    curvature, slope = _parabola(v, sign * p)
    return bool(curvature < 0 and sign * p[-1] - slope**2 / (4 * curvature) < sign * target)


def softens(states: Sequence[State], scalar: str, of: str = "") -> bool:
    """Whether the last increment of the value moved the conjugate more easily than the one before.

    Args:
        states: converged states, the last one last.
        scalar: the load that is driven.
        of: another measure in place of the value.
    """
    if len(states) < 3:
        return False
    v, p = _curve(states[-3:], scalar)
    if of:
        p = np.array([state.measures[of] for state in states[-3:]])
    dv, dp = np.diff(v), np.diff(p)
    return bool(np.all(dp != 0) and abs(dv[1] / dp[1]) > 1.1 * abs(dv[0] / dp[0]))


def _parabola(t: Floats, y: Floats) -> tuple[float, float]:
    """Quadratic and linear coefficient about the last of three points."""
    x = t - t[-1]
    a, b = np.linalg.solve(np.column_stack([x[:2] ** 2, x[:2]]), y[:2] - y[-1])
    return float(a), float(b)


def extreme(states: Sequence[State], scalar: str, slope: float) -> tuple[float, float]:
    """Where the value was greatest or least between the last two states.

    By the cubic through the last three states with the slope at the last; through two, the
    parabola.

    Args:
        states: converged states, the last one beyond the limit.
        scalar: the load that is driven.
        slope: d value / d conjugate at the last state.

    Returns:
        Conjugate and value; those of the state before where the curve has no extreme in between.
    """
    v, p = _curve(states[-3:], scalar)
    scale = v[-1] - v[-2]
    x = (v - v[-1]) / scale
    known = x[:-1]
    if len(v) == 3 and not _apart(v):
        known, p = known[1:], p[1:]
    rows = np.column_stack([known ** (i + 2) for i in range(len(known))])
    top = np.linalg.solve(rows, p[:-1] - p[-1] - slope * scale * known)
    curve = np.polynomial.Polynomial([p[-1], slope * scale, *top])
    # the slope changes its sign on the way to the last state
    turns = [r.real for r in curve.deriv().roots() if abs(r.imag) < 1e-12 and -1 <= r.real <= 0]
    best = max(turns, default=-1.0)
    return float(v[-1] + scale * best), float(curve(best))


def limit_between(states: Sequence[State], scalar: str) -> float | None:
    """The conjugate at a limit point well between the last two states; None where there is none.

    Args:
        states: converged states of assessed stability, the last one last.
        scalar: the load that is driven.
    """
    if not _turned(states, scalar):
        return None
    v, _ = _curve(states[-2:], scalar)
    at, _ = extreme(states, scalar, 1 / states[-1].measures[measure("rate", scalar)])
    share = (at - v[0]) / (v[1] - v[0])
    return at if NEAR < share < 1 - NEAR else None


def _turned(states: Sequence[State], scalar: str) -> bool:
    """Whether the value turned between the last two states."""
    old, new = (state.measures.get(measure("rate", scalar), 1.0) for state in states[-2:])
    return old * new < 0


def crossing(states: Sequence[State], scalar: str, goal: float) -> float:
    """The conjugate at which the value passes a goal between the last two states.

    Args:
        states: converged states; the goal lies between the values of the last two.
        scalar: the load that is driven.
        goal: the value to be hit.
    """
    v, p = _curve(states[-3:], scalar)
    if len(v) < 3 or not _apart(v):
        v, p = v[-2:], p[-2:]
    x = v - v[-2]
    curve = np.polynomial.Polynomial.fit(x, p - goal, len(v) - 1).convert()
    roots = [r.real for r in curve.roots() if abs(r.imag) < 1e-12 * abs(x[-1])]
    between = [r for r in roots if min(0.0, x[-1]) <= r <= max(0.0, x[-1])]
    chord = x[-1] * (goal - p[-2]) / (p[-1] - p[-2])
    return float(v[-2] + (between[0] if between else chord))


def critical(states: Sequence[State], scalar: str) -> list[Critical]:
    """Where stability was lost or gained between the last two states.

    Args:
        states: converged states of assessed stability, the last one last.
        scalar: the load that is driven.
    """
    old, new = states[-2].measures, states[-1].measures
    before, after = int(old.get(MODES, 0)), int(new.get(MODES, 0))
    rate = new[measure("rate", scalar)]
    found = []
    if _turned(states, scalar):
        at, top = extreme(states, scalar, 1 / rate)
        angle = _control(states, scalar, at) if "control" in new else None
        change = 1 if rate < 0 else -1
        found.append(Critical("limit", scalar, top, at, angle, before, before + change))
        before += change
    if after != before:
        value, conjugate = (new[measure(kind, scalar)] for kind in ("value", "conjugate"))
        angle = new.get("control")
        found.append(Critical("bifurcation", scalar, value, conjugate, angle, before, after))
    return found


def last_limit(report: Report, scalar: str) -> Critical | None:
    """The last point at which stability was lost and beyond which a load may fall."""
    found = (c for c in reversed(report.critical) if c.scalar == scalar and c.after > c.before)
    return next(found, None)


def passed(ramp: Ramp, span: float, old: State, new: State, limit: Critical | None) -> float | None:
    """Value asked for that following the path has passed and never reached before.

    Args:
        ramp: the load.
        span: its whole change.
        old: the last state.
        new: the state found.
        limit: the last point where stability was lost.
    """
    sign, key = np.sign(span), measure("value", ramp.scalar)
    reached = [old.measures[key], *([limit.value] if limit else [])]
    peak = max(sign * value for value in reached)
    top = sign * new.measures[key]
    goals = [sign * goal for goal in (*ramp.stops, ramp.target)]
    margin = 1e-9 * abs(span)
    found = [goal for goal in goals if peak + margin < goal < top - margin]
    return float(sign * min(found)) if found else None


def _control(states: Sequence[State], scalar: str, at: float) -> float:
    """The control quantity where the conjugate takes a value, by the last three states."""
    v, _ = _curve(states[-3:], scalar)
    if len(v) < 3 or not _apart(v):
        states, v = states[-2:], v[-2:]
    values = [state.measures["control"] for state in states[-3:]]
    return float(lagrange(v, at) @ values)
