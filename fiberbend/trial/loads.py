"""The case of a trial under the loads of its states."""

from __future__ import annotations

import math

from fiberbend.case.case import Case, Output
from fiberbend.effects.effect import Effect
from fiberbend.effects.pressure import inflate
from fiberbend.effects.straight import straight_of

TOLERANCE = 1e-10
"""Of Newton's method at most: an answer hangs on no way by more than a hundredth of a run's own."""
TURN = math.radians(90)
"""Greatest change of the angle in a step, unless the case says: no curve is drawn."""


def bent(case: Case, angles: tuple[float, ...]) -> Case:
    """Bent by pressure to angles of one sign, rad, the greatest of them last."""
    ordered = tuple(sorted(angles, key=abs))
    return _under(case, inflate(angle=ordered[-1]), at_angles=ordered)


def inflated(case: Case, pressures: tuple[float, ...]) -> Case:
    """Under pressures of one sign, MPa."""
    ordered = tuple(sorted(pressures, key=abs))
    return _under(case, inflate(to=ordered[-1]), at_pressures=ordered)


def filled(case: Case, volume: float) -> Case:
    """Inflated or evacuated to a volume of the chamber, mm³."""
    return _under(case, inflate(volume=volume))


def straight(case: Case, pressures: tuple[float, ...]) -> Case:
    """The same, kept straight."""
    kept = inflated(case, pressures)
    return kept.model_copy(update={"effects": (*kept.effects, straight_of(case.effects))})


def _under(case: Case, load: Effect, **asked: tuple[float, ...]) -> Case:
    """In place of the case's own pressure, and nothing keeps it straight."""
    effects = tuple(
        load if effect.inflation() is not None else effect
        for effect in case.effects
        if not effect.keeps_straight()
    )
    if load not in effects:
        effects = (*effects, load)
    given = case.solver
    solver = given.model_copy(
        update={
            "tolerance": min(given.tolerance, TOLERANCE),
            "max_turn": given.max_turn or TURN,
            "first_step": None,
            "max_step": None,
        }
    )
    output = Output().model_copy(update=asked)
    update = {"effects": effects, "solver": solver, "output": output, "accuracy": None}
    return case.model_copy(update=update)
