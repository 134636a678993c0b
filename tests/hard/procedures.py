"""What is done with a hard case."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from fiberbend.derived import as_section, load
from fiberbend.reader import parse_case
from fiberbend.result import RunResult
from fiberbend.runner import run_case
from tests.hard.cases import Hard

Check = tuple[str, float, float, float]
"""What was measured, its value, and the least and the greatest one that is right."""

BESIDE = {"section": (1.0, 1.0), "cell": (0.99, 1.08), "body": (0.97, 1.03)}
"""Pressure of a model over that of the section, where the case has no other bounds: rubber bulges
between the turns of a cell, 3 to 6 % at a pitch of 3 mm; the middle half of a short and coarse body
feels its caps."""


@dataclasses.dataclass
class Done:
    """What a procedure has found.

    Attributes:
        rows: of history.csv.
        run: of run.json.
        checks: what was compared.
    """

    rows: list[dict[str, Any]]
    run: dict[str, Any]
    checks: list[Check] = dataclasses.field(default_factory=list)


def plain(hard: Hard, model: str) -> Done:
    """Run it; the pressure of cell and body beside the section's at the same angle."""
    case = parse_case(hard.case(model))
    result = run_case(case, None)
    done = Done(result.rows, result.run)
    if result.status == "converged" and model != "section":
        done.checks.append(_beside(hard, model, result))
    return done


def _beside(hard: Hard, model: str, result: RunResult) -> Check:
    """Pressure over that of the section that bends as much."""
    low, high = hard.beside.get(model, BESIDE[model])
    angle = result.last("uniform_angle_deg" if model == "body" else "angle_deg")
    case = as_section(parse_case(hard.case(model)), load(angle=float(np.deg2rad(angle))))
    section = run_case(case, None)
    ratio = result.last("pressure_kPa") / section.last("pressure_kPa")
    return "pressure over the section's", ratio, low, high
