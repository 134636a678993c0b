"""Where a load hardly moves the control quantity: which way it is found all the same.

An incompressible section that nothing winds does not bend at all to first order, whatever its
materials: stretched by the mean of its other two stresses, σ_zz = (σ_xx + σ_yy)/2, it balances the
pressure on the ends and its moment exactly (principle of virtual work with the conformal field
v = (x y, (y² − x²)/2)). It bends by the square of the pressure, and may turn back later. There the
work-conjugate leads on, the chamber's volume: it grows all along an inflation.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem.march.equilibrium import Equilibrium
from fem.march.limit_points import softens
from fem.march.position import Position
from fem.march.records import Ramp, Rules, State, measure
from fem.solver.newton import Outcome

Find = Callable[[str, str, float, tuple[list[State], str, float]], Outcome]

POOR = 1.0
"""The linear response changes the conjugate by so much of itself before the control quantity moves
by a first increment: wound actuators need 0.02 to 0.3, sections without a winding 700 and more."""
PROBE = 0.1
"""Change of the conjugate at which is seen where the control quantity moves, as a part of it."""
HALVINGS = 3
NEARER = 4.0
"""Where that leads the other way, both ways, a probe so many times nearer shows whether the target
lies within as many times its own way."""
UNMOVED = 1e-7
"""Change of the control quantity (rad) by round-off: asymmetric sections have 1e-4 and more."""
UNBENT = (
    "the load does not bend it, neither way: a tenth of the chamber's volume more or less leaves "
    "the angle as it is"
)
TRIES = 2
"""Failed increments after which a control quantity that hardly moves any more is not driven."""


def leads_nowhere(seed: State, base: State, ramp: Ramp, rules: Rules) -> bool:
    """Whether a control quantity that is to be driven hardly answers the load at first.

    Args:
        seed: the base, perturbed by its linear response.
        base: where the ramp begins.
        ramp: the ramp.
        rules: incrementation.
    """
    conjugate = measure("conjugate", ramp.scalar)
    if ramp.drive != "control" or not base.measures.get(conjugate):
        return False
    moved, changed = (abs(seed.measures[k] - base.measures[k]) for k in ("control", conjugate))
    return bool(changed * rules.first_turn > POOR * moved * abs(base.measures[conjugate]))


def slackens(states: list[State], ramp: Ramp, failures: int) -> bool:
    """Whether a control quantity that is driven moves ever less, and increments of it fail.

    Args:
        states: converged states, the last one last.
        ramp: the ramp.
        failures: failed increments in a row.
    """
    if ramp.drive != "control" or failures < TRIES:
        return False
    return softens(states, ramp.scalar, of="control")


def toward(
    find: Find, equilibrium: Equilibrium, seed: State, base: State, ramp: Ramp
) -> tuple[float, float]:
    """Which way the conjugate must go for the control quantity to move to a ramp's target.

    An inflation where that moves it there, else the reverse where that does, else an inflation,
    which leads further than a chamber that is emptied: the angle may turn back. The scene is left
    at the base.

    Args:
        find: solves for an equilibrium, and counts what it costs.
        equilibrium: captures and restores states.
        seed: the base, perturbed by its linear response.
        base: where the ramp begins.
        ramp: driven by the control quantity.

    Returns:
        Sign of the way of the conjugate, 0 where nothing moves the control quantity; and a first
        increment.
    """
    begin = base.measures["control"]
    far = PROBE * abs(base.measures[measure("conjugate", ramp.scalar)])
    found = {}
    # where it turns back soon, a small change may do
    for first, least in ((far, UNMOVED), (far / NEARER, abs(ramp.target - begin) / NEARER)):
        for sign in (1.0, -1.0):
            state, size = _probe(find, equilibrium, seed, base, ramp, sign, first)
            if state is not None:
                gain = (state.measures["control"] - begin) * np.sign(ramp.target - begin)
                if gain > max(least, UNMOVED):
                    return sign, size
                found[sign, first] = gain, size
    if found and all(abs(gain) <= UNMOVED for gain, _ in found.values()):
        return 0.0, 0.0
    return 1.0, found.get((1.0, far), (0.0, far))[1]


def _probe(
    find: Find,
    equilibrium: Equilibrium,
    seed: State,
    base: State,
    ramp: Ramp,
    sign: float,
    size: float,
) -> tuple[State | None, float]:
    """A state some way off the base, and how far its conjugate is; None where none is found."""
    key = measure("conjugate", ramp.scalar)
    now = base.measures[key]
    for _ in range(HALVINGS + 1):
        aim = now + sign * size
        outcome = find(ramp.scalar, "conjugate", aim, ([seed, base], key, aim))
        state = equilibrium.capture() if outcome.converged else None
        equilibrium.restore(base)
        if state is not None:
            return state, size
        size /= 2
    return None, size


def search_end(ramp: Ramp, span: float, position: Position, rest: State, rules: Rules) -> float:
    """The conjugate at which a control quantity is looked for no longer.

    Args:
        ramp: driven by the control quantity.
        span: all of its way.
        position: where the march stands; there the search ends where the control quantity has gone
            astray. It is told how near that has come.
        rest: the state at rest.
        rules: incrementation.
    """
    key, now = measure("conjugate", ramp.scalar), position.states[-1].measures
    to_go = float(np.sign(span) * (ramp.target - now["control"]))
    position.nearest = to_go if position.nearest is None else min(position.nearest, to_go)
    if to_go > position.nearest + rules.astray:
        return now[key]
    return rest.measures[key] * (rules.search if position.toward > 0 else 1 / rules.beyond)
