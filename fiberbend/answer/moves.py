"""How an actuator may move, told by its symmetry before anything is solved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from fiberbend import columns as col
from fiberbend.answer.motion import BEND, SIDE, STRETCH, TWIST, Reading
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry, stays_straight
from fiberbend.case.zones import zone_cases

_OF_ZONES = {
    BEND: ("angle_deg", "angle"),
    TWIST: ("twist_deg", "twist"),
    STRETCH: ("stretch", "stretch"),
}
"""Motions of which zones have columns: end of the column, and words."""


def moves(case: Case) -> tuple[Reading, ...]:
    """What an actuator may do under its pressure: bend, twist, bend to the side.

    Where symmetry leaves none of these, it lengthens or shortens. Of zones those of each zone.

    Args:
        case: valid. What an effect holds all along is no motion.
    """
    if case.zones is None:
        return tuple(_uniform(case))
    found: list[Reading] = []
    for number, zone in enumerate(zone_cases(case)):
        for motion in _uniform(zone):
            if motion in _OF_ZONES:
                end, words = _OF_ZONES[motion]
                name = f"{words} of zone {number + 1}"
                found.append(Reading((col.zone(number, end),), name, motion.unit))
            elif motion not in found:
                found.append(motion)
    return tuple(found)


def bends(cases: Iterable[Case]) -> bool:
    """Whether one of several cases may bend: else no angle tells anything of them."""
    return any(case.zones is not None or BEND in _uniform(case) for case in cases)


def _uniform(case: Case) -> Iterator[Reading]:
    """Of a case that is alike all along.

    ω = (k_x, k_y, τ) is an axial vector: the mirror plane x = 0 leaves k_x alone, the plane z = 0
    no τ, half a turn about y no k_y.
    """
    symmetry = Symmetry.of(case.acting)
    held = {key for effect in case.acting for key in effect.held()}
    may = {
        BEND: not stays_straight(case),
        SIDE: bool(symmetry.across and symmetry.turn),
        TWIST: bool(symmetry.across and symmetry.along),
    }
    turns = [motion for motion, free in may.items() if free and held.isdisjoint(motion.columns)]
    yield from turns
    if not turns and held.isdisjoint(STRETCH.columns):
        yield STRETCH
