"""Defaults of a case that depend on other values of it."""

from __future__ import annotations

from typing import Any

from fiberbend.case.case import Case
from fiberbend.models.choice import MODELS, choose_model


def complete(case: Case) -> Case:
    """Fill in the defaults that depend on other values of a checked case.

    The effects come first: the model is chosen by them, and the mesh by the model. What is zero
    and says no more than leaving it out is left out: one actuator is one case.
    """
    weighs = case.time is not None or any(e.needs_density for e in case.effects)
    given = {part: spec for part, spec in dict(case.materials).items() if spec is not None}
    plain = {part: spec.plain(weighs) for part, spec in given.items()}
    case = case.model_copy(update={"materials": case.materials.model_copy(update=plain)})
    named = MODELS.get(case.model)
    offers = None if named is None else named.offers
    if case.accuracy is not None:
        from fiberbend.accuracy import choice as accuracy

        if (found := accuracy.complete(case)) is not None:
            return found
    effects = tuple(effect.completed(offers) for effect in case.effects)
    update: dict[str, Any] = {"effects": effects}
    if case.zones is not None:
        update["zones"] = tuple(zone.completed(offers, weighs) for zone in case.zones)
    case = case.model_copy(update=update)
    model, _ = choose_model(case)
    return model.completed(case)
