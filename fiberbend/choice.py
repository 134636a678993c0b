"""What a case leaves to the program: the model, and half or full body."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from fiberbend.case import Case
from fiberbend.case_effects import Effect, GravityEffect, WindingEffect


def choose_model(case: Case) -> tuple[str, str]:
    """The model that solves a case.

    Returns:
        Its name and the reason.
    """
    if case.model == "auto":
        return "body", "the one model of this version, and it holds every effect"
    return case.model, "as the case says"


def choose_half(case: Case) -> tuple[bool, str]:
    """Whether half the body, x ≥ 0, stands for the whole.

    Returns:
        True for half, and the reason.
    """
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
