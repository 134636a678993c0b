"""How far a whole body moves beside its middle, in words: what section and cell leave out."""

from __future__ import annotations

from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry, stays_straight

AT_ENDS = "ends: "
"""Begins what a model says of the motion near caps; zones say it of their borders as well."""


def at_ends(case: Case) -> str:
    """How much further or less far the whole body moves than its middle, with the source.

    Args:
        case: whose body is free to move.
    """
    symmetry = Symmetry.of(case.acting)
    if stays_straight(case) and not symmetry.sideways:
        turns = "twists up to 4 % less, " if symmetry.twists else ""
        return (
            f"the whole tube {turns}shortens up to 10 % less or lengthens 0.3 % less than its "
            "middle where it is 100 mm long and 13 mm across (docs/models.md)"
        )
    return (
        "the whole body bends further than its middle, the baseline's by 0.6 to 1.4 % "
        "(docs/evidence/free.md)"
    )


def left_out(case: Case) -> str:
    """What a model without ends says of them."""
    if any(effect.held() for effect in case.acting):
        return (
            f"{AT_ENDS}left out; the hold acts all along the body, and no clamp at its ends does "
            "(docs/results.md)"
        )
    return f"{AT_ENDS}left out; {at_ends(case)}"
