"""Defaults of a case that depend on other values of it."""

from __future__ import annotations

from fiberbend.case.case import Case
from fiberbend.models.choice import MODELS, choose_model


def complete(case: Case) -> Case:
    """Fill in the defaults that depend on other values of a checked case.

    The effects come first: the model is chosen by them, and the mesh by the model.
    """
    named = MODELS.get(case.model)
    offers = None if named is None else named.offers
    effects = tuple(effect.completed(offers) for effect in case.effects)
    case = case.model_copy(update={"effects": effects})
    model, _ = choose_model(case)
    return model.completed(case)
