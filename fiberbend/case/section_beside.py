"""Cases made from a case: its section beside it."""

from __future__ import annotations

from fiberbend.case.case import Case, Output, Solver
from fiberbend.case.symmetry import wound
from fiberbend.effects.effect import Effect
from fiberbend.schema.problems import CaseError, Problem

MODEL = "section"
"""The model that stands beside a case."""


def as_section(case: Case, load: Effect) -> Case:
    """The same actuator as a section, its winding smeared, under a load of the chamber alone.

    Args:
        case: any case with a winding or without.
        load: of the chamber.

    Raises:
        CaseError: a section cannot have an effect of the case.
    """
    if case.zones is not None:
        text = "one section stands for no actuator with zones (model section chains one of each)"
        raise CaseError([Problem("zones", text)])
    problems = [
        Problem(f"effects.{index}.{effect.name}", reason)
        for index, effect in enumerate(case.effects)
        if (reason := effect.not_beside())
    ]
    if problems:
        raise CaseError(problems)
    beside = (effect.beside() for effect in case.effects)
    mesh = case.mesh.model_copy(update={"section": 2, "element": "hexahedron"})
    return case.model_copy(
        update={
            "model": MODEL,
            "accuracy": None,
            "time": None,
            "effects": (load, *(effect for effect in beside if effect is not None)),
            "mesh": mesh,
            "solver": Solver(),
            "output": Output(pictures=False, fields=False),
        }
    )


def section_guides(case: Case) -> bool:
    """Whether a section bends as the body of a case does, between its ends."""
    alike = case.zones is None and case.inflation is not None
    if not alike or not all(effect.follows_section() for effect in case.effects):
        return False
    return wound(case).plane
