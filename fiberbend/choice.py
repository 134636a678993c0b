"""What a case leaves to the program: the model, and half or full body."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from fiberbend.case import Case
from fiberbend.case_effects import (
    BlockedTipEffect,
    Effect,
    GravityEffect,
    PressureEffect,
    StraightEffect,
    WindingEffect,
)

MODELS = ("analytic", "section", "cell", "body")
"""From the cheapest to the dearest."""
UNIFORM = ("section", "cell")
"""Models of uniform bending between the caps."""


def choose_model(case: Case) -> tuple[str, str]:
    """The model that solves a case.

    `auto` never takes the analytic model: it holds neither the winding's pitch and stiffness nor
    the stress across the section, and its answers are off by tens of per cent.

    Returns:
        Its name and the reason.
    """
    if case.model != "auto":
        return case.model, "as the case says"
    missing: list[str] = []
    for model in MODELS[1:]:
        reasons = [reason for _, reason in refusals(case, model)]
        if not reasons:
            return model, "; ".join(["the cheapest that holds everything", *missing])
        missing.append(f"{model} does not: {reasons[0]}")
    return "body", "; ".join(["the most that there is", *missing])


def refusals(case: Case, model: str) -> Iterator[tuple[str, str]]:
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
    if not any(isinstance(effect, PressureEffect) for effect in case.effects):
        yield "effects", "uniform bending needs a pressure"
    if case.mesh.element == "tetrahedron":
        yield "mesh.element", "tetrahedra are for a body"
    if case.output.fields and "fields" in case.output.model_fields_set:
        yield "output.fields", "three-dimensional fields are those of a body"
    if model == "analytic" and case.actuator.section != "hemicircle":
        yield "actuator.section", f"the formulas are for a hemicircle, not a {_shape(case)}"


def _shape(case: Case) -> str:
    return str(case.actuator.section)


def _refuses(model: str, effect: Effect) -> str:
    """Why a model cannot hold an effect; empty when it can."""
    if model == "body":
        return (
            "only a uniform bend can be held straight" if isinstance(effect, StraightEffect) else ""
        )
    if isinstance(effect, GravityEffect):
        return "weight bends no uniform arc"
    if isinstance(effect, BlockedTipEffect):
        return "roof and post need the ends of the body (effect straight: the blocked uniform bend)"
    if isinstance(effect, WindingEffect):
        if effect.representation == "discrete" and model != "cell":
            return "a discrete winding has no uniform section (as: smeared has)"
        if model == "analytic" and effect.pattern != "double-helix":
            return "the formulas know no twist"
    if model == "analytic" and isinstance(effect, PressureEffect) and effect.volume is not None:
        return "the formulas know no chamber volume"
    return ""


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
