"""Defaults of a case that depend on other values of it."""

from __future__ import annotations

from typing import Any

from fiberbend import bridge
from fiberbend.case import Case
from fiberbend.case_effects import WindingEffect

DEFAULT_LINES = 5


def complete(case: Case) -> Case:
    """Fill in the defaults that depend on other values of a checked case."""
    effects = tuple(
        _complete_winding(effect) if isinstance(effect, WindingEffect) else effect
        for effect in case.effects
    )
    return case.model_copy(update={"effects": effects})


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
