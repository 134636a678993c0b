"""What is known of a section for an export: free states, stiffness, and how far it holds."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from fiberbend.case.case import Case
from fiberbend.export.section import Section, axis_of
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted
from rod.functions import Floats

_KPA = 1e3
_STRAIGHT = (0.25, 0.5, 0.75, 1.0)
"""Parts of the greatest pressure at which the section is straightened."""


@dataclasses.dataclass(frozen=True)
class Known:
    """A section and its caps.

    Attributes:
        section: of the chamber.
        cap: stiffness of a cap, (4, 4).
        validity: range, and how far a constant stiffness holds, as rod.json has them.
    """

    section: Section
    cap: Floats
    validity: dict[str, Any]


def known(case: Case, states: int) -> Known:
    """Solve a section from no pressure to the case's own.

    Args:
        case: of model section or cell, under a pressure alone.
        states: number of pressures.

    Raises:
        CaseError: the section has no law, or does not come there.
    """
    from fiberbend.sectionlaw.stiffness import cap_stiffness, stiffness_at

    pressures = np.linspace(0.0, greatest(case), states)
    found = stiffness_at(case, pressures.tolist())
    section = Section(
        pressures,
        np.array([state.rest for state in found]),
        np.array([state.matrix for state in found]),
        np.array([state.area for state in found]),
    )
    return Known(section, cap_stiffness(case), _validity(case, section))


def greatest(case: Case) -> float:
    """Pressure at the end of the case, MPa.

    Raises:
        CaseError: it has none, or does not come there.
    """
    load = case.inflation
    goal = None if load is None else (load.angle or load.to)
    if load is None or goal is None or (load.to is not None and load.to < 0):
        text = "expected effect pressure with an angle, or with a pressure above zero"
        raise CaseError([Problem("effects", text)])
    if load.to is not None:
        return load.to
    answer = solve(case, Wanted(angles=(goal,)))
    if not answer.converged:
        raise CaseError([Problem("effects.pressure", f"no such free state: {answer.reason}")])
    return answer.free[0].pressure


def _validity(case: Case, section: Section) -> dict[str, Any]:
    """The moment that straightens the free section, solved and by its stiffness."""
    pressures = tuple(part * float(section.pressures[-1]) for part in _STRAIGHT)
    straight = solve(case, Wanted(straight=pressures)).straight
    axis = axis_of(section)
    soft = axis.bending[:, 0, 0] * axis.rest[:, 1]
    at = [point.pressure for point in straight]
    return {
        "pressure_kPa": [_KPA * float(section.pressures[0]), _KPA * float(section.pressures[-1])],
        "straightened": {
            "pressure_kPa": [_KPA * pressure for pressure in at],
            "moment_N_mm": [point.moment for point in straight],
            "by_stiffness_N_mm": np.interp(at, section.pressures, soft).tolist(),
        },
    }
