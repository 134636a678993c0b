"""Stiffnesses of a section about its free states, exactly linearised: what other programs take."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from fiberbend.calibration.calibrate import waits
from fiberbend.case.case import Case
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.states.box import words
from fiberbend.sectionlaw.states.held import Held, HeldState
from fiberbend.trial.calibrations import Calibrations
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted
from rod.functions import Floats

SPACE = ("stretch", "curvature", "side_curvature", "twist")
"""Strains of a rod without shear."""


@dataclasses.dataclass(frozen=True)
class Stiffness:
    """A section about the state that it takes by itself.

    Attributes:
        pressure: MPa.
        rest: stretch, and curvatures and twist in rad/mm, where no force acts, (4,).
        matrix: ∂(N, M_x, M_y, T)/∂(stretch, curvature, side curvature, twist) at a given pressure,
            (4, 4), symmetric: N, N mm and N mm².
        chamber: area of the chamber, its volume per length at rest, mm².
        thrust: ∂(N, M_x, M_y, T)/∂P where the strains are held, (4,): −mm² and −mm³.
    """

    pressure: float
    rest: Floats
    matrix: Floats
    chamber: float
    thrust: Floats


def stiffness_at(case: Case, pressures: Sequence[float]) -> list[Stiffness]:
    """Exact linearisations of a section about its free states.

    Args:
        case: a checked case of model section or cell; its own loads do not count.
        pressures: MPa, zero or of one sign.

    Returns:
        For each pressure, in their order.

    Raises:
        CaseError: there is no such free state.
    """
    loaded = tuple(sorted({pressure for pressure in pressures if pressure}, key=abs))
    free = {0.0: np.array([1.0, 0.0, 0.0, 0.0])}
    if loaded:
        answer = solve(case, Wanted(pressures=loaded))
        if not answer.converged:
            raise CaseError([Problem("effects.pressure", f"no such free state: {answer.reason}")])
        length = case.actuator.length
        for point in answer.free:
            turns = np.array([point.angle, point.side_angle, point.twist]) / length
            free[point.pressure] = np.array([point.stretch, *turns])
    ready = Calibrations().ready(case).case if waits(case) else case
    held = Held(ready, SPACE)
    state, known = held.rest, dict[float, HeldState]()
    for pressure in (0.0, *loaded):
        at = np.array([*free[_nearest(free, pressure)], pressure])
        found = held.along(state, at)
        if found is None:
            text = f"no stable state of the section was found at {words(at)}"
            raise CaseError([Problem("effects.pressure", text)])
        known[pressure] = state = found
    return [_about(known[pressure or 0.0]) for pressure in pressures]


def _nearest(free: dict[float, Floats], pressure: float) -> float:
    """The pressure of a free state: that which was asked for, but for round-off."""
    return min(free, key=lambda one: abs(one - pressure))


def _about(state: HeldState) -> Stiffness:
    return Stiffness(
        pressure=float(state.at[-1]),
        rest=state.at[:-1].copy(),
        matrix=state.second[:-1, :-1].copy(),
        chamber=-float(state.slopes[-1]),
        thrust=state.second[:-1, -1].copy(),
    )
