"""Defaults of a case that depend on other values of it."""

from __future__ import annotations

from typing import Any

from fiberbend.case import convert
from fiberbend.case.case import Case, Mesh, Output
from fiberbend.effects.table import WindingEffect
from fiberbend.models.choice import choose_model

DEFAULT_LINES = 5
WITHOUT_TURNS = ("analytic", "section")
"""Models that spread a winding unless the case says otherwise."""


def complete(case: Case) -> Case:
    """Fill in the defaults that depend on other values of a checked case.

    The winding comes first: the model is chosen by it, and the mesh by the model.
    """
    effects = tuple(
        _complete_winding(effect, case.model) if isinstance(effect, WindingEffect) else effect
        for effect in case.effects
    )
    case = case.model_copy(update={"effects": effects})
    model, _ = choose_model(case)
    return case.model_copy(
        update={"mesh": _complete_mesh(case, model), "output": _complete_output(case, model)}
    )


def _complete_mesh(case: Case, model: str) -> Mesh:
    """A finer section where it is cheap; four layers in a cell, where layers count most."""
    mesh = case.mesh
    update: dict[str, Any] = {}
    if model == "section" and "section" not in mesh.model_fields_set:
        update["section"] = 2
    winding = case.find(WindingEffect)
    if model == "cell" and "axial" not in mesh.model_fields_set and winding is not None:
        update["axial"] = winding.pitch / 8
    return mesh.model_copy(update=update)


def _complete_output(case: Case, model: str) -> Output:
    """A closed form has no fields to write."""
    output = case.output
    if model != "analytic" or "fields" in output.model_fields_set:
        return output
    return output.model_copy(update={"fields": False})


def _complete_winding(winding: WindingEffect, model: str) -> WindingEffect:
    """The winding as the model of the case, which may be auto, has it."""
    fiber = winding.fiber
    if fiber.name is None and fiber.radius_factor is None:
        fiber = fiber.model_copy(update={"radius_factor": 1.0})
    kind = winding.representation
    if kind is None:
        ribbon = winding.width is not None or winding.lines is not None
        kind = "smeared" if model in WITHOUT_TURNS and not ribbon else "discrete"
    update: dict[str, Any] = {"fiber": fiber, "representation": kind}
    if kind == "discrete":
        width = winding.width
        if width is None:
            width = convert.fiber(fiber).diameter
        update["width"] = width
        update["lines"] = winding.lines or (DEFAULT_LINES if width else 1)
    return winding.model_copy(update=update)
