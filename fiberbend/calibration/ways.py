"""The way on which families are calibrated, their cell beside their section; no numpy."""

from __future__ import annotations

import dataclasses
from typing import Any

from fiberbend.calibration import digest
from fiberbend.case.case import Case, Mesh, Output, Solver
from fiberbend.effects.effect import Effect
from fiberbend.effects.pressure import inflate

LAYERS = 6
"""Elements of the cell along the least distance of neighbouring threads of a family."""
PARTS = (0.1, 0.3, 0.5, 0.75, 1.0)
"""Of the pressure or the angle of a case, at which its cell is looked at."""


def of_families(case: Case) -> bool:
    """Whether the winding of a case is families, which have no pitch of their own."""
    return case.turns is not None and case.turns.pitch is None


def objection(case: Case) -> str:
    """Why the families of a case are not calibrated; empty where they are."""
    load, turns = case.inflation, case.turns
    if load is None or (load.to is None and load.angle is None):
        return "families are calibrated on the way to a pressure or an angle"
    if case.straight or any(effect.held() for effect in case.effects):
        return "families are calibrated where nothing is held"
    return "" if turns is None or turns.period is not None else turns.misfit


def content(case: Case) -> dict[str, Any]:
    """All that enters; caps and densities do not.

    Args:
        case: its winding is families.
    """
    load = case.inflation
    return digest.common(case) | {
        "effects": [
            {effect.name: effect.model_dump(exclude={"representation", "bedding"})}
            for effect in case.effects
            if effect.inflation() is None
        ],
        "length": case.actuator.length,
        "load": None if load is None else dataclasses.asdict(load),
        "mesh": [digest.CELL, LAYERS, digest.SECTION, digest.TOLERANCE],
    }


def small(case: Case, model: str) -> Case:
    """Cell or section of a case, at parts of its load.

    Args:
        case: driven by a pressure or an angle.
        model: cell or section; of a section the winding has its numbers.
    """
    load, turns, cell = case.inflation, case.turns, model == "cell"
    assert load is not None
    assert turns is not None
    end, key = (load.angle, "at_angles") if load.to is None else (load.to, "at_pressures")
    assert end is not None
    drive: Effect = inflate(angle=end) if load.to is None else inflate(to=end)
    others = (
        (effect.in_cell() or effect) if cell else effect
        for effect in case.effects
        if effect.inflation() is None
    )
    mesh: dict[str, Any] = {"section": digest.SECTION}
    if cell:
        mesh = {"section": digest.CELL, "axial": turns.spacing / LAYERS}
    return case.model_copy(
        update={
            "model": model,
            "effects": (drive, *others),
            "mesh": Mesh().model_copy(update=mesh),
            "solver": Solver().model_copy(update={"tolerance": digest.TOLERANCE}),
            "output": Output().model_copy(update={key: tuple(part * end for part in PARTS)}),
            "accuracy": None,
        }
    )
