"""The models in order of cost, and the cheapest that supports a case."""

from __future__ import annotations

import importlib
import itertools
from collections.abc import Iterator

from fiberbend.case import names
from fiberbend.case.case import Case
from fiberbend.models.model import MeshedModel, ModelKind, Objection

MODELS: dict[str, ModelKind] = {
    name: importlib.import_module(f"fiberbend.models.{name.replace('-', '_')}").MODEL
    for name in names.MODELS
}
"""From the cheapest to the dearest. A new model is a file here and a word in that table."""


def choose_model(case: Case) -> tuple[ModelKind, str]:
    """The model that solves a case; the dearest where none can.

    Returns:
        The model and the reason.
    """
    if case.model != "auto":
        if case.accuracy is not None and "model" not in case.model_fields_set:
            return MODELS[case.model], "chosen for its accuracy"
        return MODELS[case.model], "given in the case"
    for model in MODELS.values():
        if objection(case, model) is None:
            return model, "the cheapest that supports everything"
    for model in MODELS.values():
        if _lacks(case, model) is None:
            return model, "the only one that supports everything"
    return model, "no model supports everything"


def meshed(case: Case) -> MeshedModel:
    """The model of finite elements that solves a case.

    Raises:
        ValueError: a closed form does.
    """
    model, _ = choose_model(case)
    elements = model.elements()
    if elements is None:
        raise ValueError(f"model {model.name} has no elements")
    return elements


def problems(case: Case) -> Iterator[Objection]:
    """What the model of a case, given or chosen, has against the case.

    Yields:
        Paths and messages.
    """
    if case.model != "auto":
        for path, reason in MODELS[case.model].refuses(case):
            yield path, f"model {case.model} does not support it: {reason}"
        return
    reasons = []
    for name, model in MODELS.items():
        found = _lacks(case, model)
        if found is None:
            return
        reasons.append(f"{name} not {found[0]} ({found[1]})")
    yield "model", f'"auto", expected effects that one model supports: {"; ".join(reasons)}'


def objection(case: Case, model: ModelKind) -> Objection | None:
    """The first reason why a model is not known to support a case in full; None where it is."""
    return _lacks(case, model) or next(model.unproven(case), None)


def _lacks(case: Case, model: ModelKind) -> Objection | None:
    """The first thing that a model leaves out or refuses."""
    return next(itertools.chain(model.leaves_out(case), model.refuses(case)), None)
