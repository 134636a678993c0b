"""Defaults of a case that depend on other values of it."""

from __future__ import annotations

from typing import Any

from fiberbend import bridge
from fiberbend.case import Case, Mesh
from fiberbend.case_effects import WindingEffect
from fiberbend.choice import UNIFORM, choose_model

DEFAULT_LINES = 5


def complete(case: Case) -> Case:
    """Fill in the defaults that depend on other values of a checked case."""
    effects = tuple(
        _complete_winding(effect) if isinstance(effect, WindingEffect) else effect
        for effect in case.effects
    )
    case = case.model_copy(update={"effects": effects})
    return case.model_copy(update={"mesh": _complete_mesh(case)})


def _complete_mesh(case: Case) -> Mesh:
    """Finer sections where they are cheap, and two layers in a cell."""
    model, mesh = choose_model(case)[0], case.mesh
    update: dict[str, Any] = {}
    if model in UNIFORM and "section" not in mesh.model_fields_set:
        update["section"] = 2
    winding = case.find(WindingEffect)
    if model == "cell" and "axial" not in mesh.model_fields_set and winding is not None:
        update["axial"] = winding.pitch / 4
    return mesh.model_copy(update=update)


def _complete_winding(winding: WindingEffect) -> WindingEffect:
    fiber = winding.fiber
    if fiber.name is None and fiber.radius_factor is None:
        fiber = fiber.model_copy(update={"radius_factor": 1.0})
    update: dict[str, Any] = {"fiber": fiber}
    if winding.representation == "discrete":
        width = winding.width
        if width is None:
            width = bridge.fiber(fiber).diameter
        update["width"] = width
        update["lines"] = winding.lines or (DEFAULT_LINES if width else 1)
    return winding.model_copy(update=update)
