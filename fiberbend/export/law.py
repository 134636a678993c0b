"""What is known of a section for an export: free states, stiffness, and how far it holds."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from fiberbend.case.case import Case
from fiberbend.export.section import Section, axis_of
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.stiffness import stiffness_at
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted

_KPA = 1e3
_STRAIGHT = (0.25, 0.5, 0.75, 1.0)
"""Parts of the greatest pressure at which the section is straightened."""


@dataclasses.dataclass(frozen=True)
class Known:
    """A section from no pressure to the greatest.

    Attributes:
        section: free states and stiffness about them.
        validity: range, and how far a constant stiffness holds, as rod.json has them.
    """

    section: Section
    validity: dict[str, Any]


def known(case: Case, states: int, reached: float | None = None) -> Known:
    """Solve a section from no pressure to the case's own.

    Args:
        case: of model section or cell, under a pressure alone.
        states: number of pressures.
        reached: greatest pressure, MPa, where that is less than the case's own.

    Raises:
        CaseError: the section does not come there.
    """
    pressures = np.linspace(0.0, greatest(case) if reached is None else reached, states)
    found = stiffness_at(case, pressures.tolist())
    section = Section(
        pressures,
        np.array([state.rest for state in found]),
        np.array([state.matrix for state in found]),
        np.array([state.chamber for state in found]),
    )
    return Known(section, _validity(case, section))


def greatest(case: Case) -> float:
    """Pressure at the end of the case, MPa.

    Raises:
        CaseError: it does not come there.
    """
    load = case.inflation
    assert load is not None, "refused before"
    if load.to is not None:
        return load.to
    assert load.angle is not None, "refused before"
    answer = solve(case, Wanted(angles=(load.angle,)))
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
