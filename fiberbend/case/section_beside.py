"""Cases made from a case: its section beside it."""

from __future__ import annotations

from fiberbend.case.case import Case, Output, Solver
from fiberbend.effects.table import (
    BlockedTipEffect,
    ContactEffect,
    GravityEffect,
    HoopsEffect,
    PressureEffect,
    StraightEffect,
    WindingEffect,
)
from fiberbend.schema.problems import CaseError, Problem

_LEFT_OUT = (PressureEffect, GravityEffect, BlockedTipEffect, ContactEffect, StraightEffect)


def load(*, to: float | None = None, angle: float | None = None) -> PressureEffect:
    """A pressure by its value in MPa or by the bending angle in rad that it holds."""
    return PressureEffect.model_construct(to=to, angle=angle)


def as_section(case: Case, pressure: PressureEffect) -> Case:
    """The same actuator as a section, its winding smeared, under a pressure alone.

    Args:
        case: any case with a winding or without.
        pressure: the load.

    Raises:
        CaseError: hoops instead of a winding: a section has no constraint for them.
    """
    effects = []
    for index, effect in enumerate(case.effects):
        if isinstance(effect, HoopsEffect):
            text = "the section model beside it needs a winding with pitch and fiber"
            raise CaseError([Problem(f"effects.{index}.hoops", text)])
        if isinstance(effect, _LEFT_OUT):
            continue
        if isinstance(effect, WindingEffect):
            effect = effect.model_copy(
                update={"representation": "smeared", "width": None, "lines": None}
            )
        effects.append(effect)
    mesh = case.mesh.model_copy(update={"section": 2, "element": "hexahedron"})
    return case.model_copy(
        update={
            "model": "section",
            "effects": (pressure, *effects),
            "mesh": mesh,
            "solver": Solver(),
            "output": Output(pictures=False, fields=False),
        }
    )
