"""What a case leaves to the program: the model, half or full body, the pace of its steps."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator

from fiberbend.case.case import Case
from fiberbend.effects.table import (
    BlockedTipEffect,
    ContactEffect,
    Effect,
    GravityEffect,
    HoopsEffect,
    PressureEffect,
    StraightEffect,
    WindingEffect,
)

MODELS = ("analytic", "section", "cell", "body")
"""From the cheapest to the dearest."""
UNIFORM = ("section", "cell")
"""Models of uniform bending between the caps."""
TURN = {"section": math.radians(10), "cell": math.radians(45), "body": math.radians(60)}
"""Greatest change of the angle in a step: fine curves where steps are cheap."""
FIRST_TURN = {"section": math.radians(10), "cell": math.radians(10), "body": math.radians(20)}
"""The same for the first step."""
MEMORY = {"section": 5, "cell": 4, "body": 3}
"""States from which a step is extrapolated: more where steps are short."""
_REACH = 0.5

Objection = tuple[str, str]
"""A path within a case, and what a model has against it."""


def choose_model(case: Case) -> tuple[str, str]:
    """The model that solves a case; `body` where none can.

    Returns:
        Its name and the reason.
    """
    if case.model != "auto":
        return case.model, "as the case says"
    for model in MODELS:
        if objection(case, model) is None:
            return model, "the cheapest that holds everything"
    return "body", "no model holds everything"


def problems(case: Case) -> Iterator[Objection]:
    """What the model of a case, said or chosen, has against the case.

    Yields:
        Paths and messages.
    """
    if case.model != "auto":
        for path, reason in refusals(case, case.model):
            yield path, f"model {case.model} cannot hold it: {reason}"
        return
    reasons = []
    for model in MODELS:
        found = objection(case, model)
        if found is None:
            return
        reasons.append(f"{model} not {found[0]} ({found[1]})")
    yield "model", f'"auto", expected effects that one model holds: {"; ".join(reasons)}'


def objection(case: Case, model: str) -> Objection | None:
    """The first reason why a model does not hold a case in full, or None where it does."""
    return next(itertools.chain(omissions(case, model), refusals(case, model)), None)


def refusals(case: Case, model: str) -> Iterator[Objection]:
    """What of a case a model cannot hold.

    Args:
        case: the case.
        model: one of `MODELS`.

    Yields:
        The path within the case and the reason.
    """
    for index, effect in enumerate(case.effects):
        reason = _refuses(model, effect)
        if reason:
            yield f"effects.{index}.{effect.name}", reason
    if model == "body":
        return
    if case.find(PressureEffect) is None:
        yield "effects", "nothing bends it uniformly but a pressure"
    if case.mesh.element == "tetrahedron":
        yield "mesh.element", "tetrahedra are for a body"
    if model == "analytic":
        yield from _no_closed_form(case)


def _refuses(model: str, effect: Effect) -> str:
    """Why a model cannot hold an effect; empty when it can."""
    if isinstance(effect, HoopsEffect) and model != "analytic":
        return "hoops that cannot stretch are in closed forms only (winding: a real thread)"
    if isinstance(effect, StraightEffect) and model == "body":
        return "only a uniform bend is held straight all along (effect blocked-tip)"
    if model == "body":
        return ""
    if isinstance(effect, GravityEffect):
        return "weight bends no uniform arc"
    if model in UNIFORM and isinstance(effect, BlockedTipEffect):
        return "roof and post need the ends of a body (effect straight: the blocked uniform bend)"
    if isinstance(effect, ContactEffect):
        return "obstacles need a body in space (effect straight: the blocked uniform bend)"
    if isinstance(effect, WindingEffect):
        if effect.representation == "discrete" and model != "cell":
            return "only cell and body have turns (as: smeared, or leave `as` to the model)"
        if model == "analytic" and effect.pattern != "double-helix":
            return "the closed form knows no twist"
    if model == "analytic" and isinstance(effect, PressureEffect) and effect.volume is not None:
        return "the closed form bends by pressure or angle, not by volume"
    return ""


def _no_closed_form(case: Case) -> Iterator[Objection]:
    """What the closed form needs; asked last, because it loads numpy."""
    if case.output.fields and "fields" in case.output.model_fields_set:
        yield "output.fields", "closed forms have no fields"
    if case.actuator.section != "hemicircle":
        yield "actuator.section", f"the closed form is for a hemicircle, not a {_shape(case)}"
        return
    from fiberbend.models.closed_form import no_analytic

    reason = no_analytic(case)
    if reason:
        wound = any(isinstance(effect, WindingEffect | HoopsEffect) for effect in case.effects)
        yield "materials.floor" if wound else "effects", reason


def _shape(case: Case) -> str:
    return str(case.actuator.section)


def omissions(case: Case, model: str) -> Iterator[Objection]:
    """What a model leaves out of what it can hold: no reason to refuse, but not to choose it.

    Yields:
        The path within the case and what becomes of it.
    """
    if model != "analytic":
        return
    for index, effect in enumerate(case.effects):
        path = f"effects.{index}.{effect.name}"
        if isinstance(effect, WindingEffect):
            yield path, "in closed forms a winding has neither pitch nor stretch (effect hoops)"
        if isinstance(effect, BlockedTipEffect):
            yield path, "in closed forms the tip is held rigidly, without roof, post and sheath"
    for part, material in dict(case.materials).items():
        if material is not None and material.bulk is not None:
            yield f"materials.{part}.bulk", "in closed forms every material is incompressible"


def turn_of(case: Case, model: str) -> float:
    """Greatest change of the angle in a step, rad.

    No step passes through a bar: the tip moves less than its radius.
    """
    turn = case.solver.max_turn or TURN[model]
    contact = case.find(ContactEffect)
    if contact is None or contact.cylinder is None:
        return turn
    actuator = case.actuator
    return min(turn, contact.cylinder.radius / (_REACH * actuator.length + actuator.cap))


def choose_half(case: Case) -> tuple[bool, str]:
    """Whether half the section, x ≥ 0, stands for the whole.

    Returns:
        True for half, and the reason.
    """
    if choose_model(case)[0] == "section":
        # a smeared single helix has no mirror plane, but half a turn about y maps it onto itself
        return True, "the section is its own image, by mirror or by half a turn about y"
    if case.mesh.symmetry != "auto":
        return case.mesh.symmetry == "half", "as the case says"
    breakers = list(mirror_breakers(case.effects))
    if breakers:
        return False, "; ".join(breakers)
    return True, "section, winding and loads are mirror-symmetric about x = 0"


def mirror_breakers(effects: Iterable[Effect]) -> Iterator[str]:
    """Why x = 0 is no mirror plane, one reason for each effect that breaks the symmetry."""
    for effect in effects:
        if isinstance(effect, WindingEffect) and effect.pattern != "double-helix":
            yield "a single helix is not its own mirror image"
        if isinstance(effect, GravityEffect) and effect.direction.endswith("x"):
            yield "gravity along x pulls to one side"
        if isinstance(effect, ContactEffect) and effect.plane and effect.plane.normal[0] != 0:
            yield "a plane that leans sideways pushes to one side"
