"""The winding patterns, each a line of `PATTERNS`; no numpy, for cases are checked by them."""

from __future__ import annotations

import dataclasses
import itertools
import math


@dataclasses.dataclass(frozen=True)
class Helix:
    """One helix of a pattern.

    Attributes:
        hand: 1 right-handed about +z, −1 left-handed.
        start: z at the top (x = 0) of a turn, over the pitch.

    Raises:
        ValueError: a hand that is none.
    """

    hand: int
    start: float = 0.0

    def __post_init__(self) -> None:
        if self.hand not in (1, -1):
            raise ValueError(f"hand {self.hand}: expected 1 or -1")


@dataclasses.dataclass(frozen=True)
class Pattern:
    """The helices that are wound around a body, all with one pitch.

    Attributes:
        meaning: what it is, as a sentence calls it.
        helices: one or more.

    Raises:
        ValueError: no helix.
    """

    meaning: str
    helices: tuple[Helix, ...]

    def __post_init__(self) -> None:
        if not self.helices:
            raise ValueError(f"{self.meaning}: expected at least one helix")

    @property
    def mirrored(self) -> bool:
        """Whether x = 0, z = 0 and with it every half pitch are mirror planes.

        A mirror changes the hand; that at z = 0 turns the start round as well.
        """
        helices = sorted(_modulo(h.hand, h.start) for h in self.helices)
        across = sorted(_modulo(-h.hand, h.start) for h in self.helices)
        along = sorted(_modulo(-h.hand, -h.start) for h in self.helices)
        return helices == across == along

    @property
    def turned(self) -> bool:
        """Whether half a turn about y maps it onto itself: that keeps hands, and reverses z."""
        helices = sorted(_modulo(h.hand, h.start) for h in self.helices)
        return helices == sorted(_modulo(h.hand, -h.start) for h in self.helices)

    @property
    def gap(self) -> float:
        """Least distance along the axis of neighbouring turns of one hand, in parts of the pitch.

        Helices of the other hand cross them and lie over or under.
        """
        gaps = [1.0]
        for hand in (1, -1):
            starts = sorted(h.start % 1 for h in self.helices if h.hand == hand)
            gaps += [after - before for before, after in itertools.pairwise(starts)]
            gaps += [1 + starts[0] - starts[-1]] if starts else []
        return min(gaps)


def turn_spacing(pattern: str, pitch: float, perimeter: float) -> float:
    """Distance of neighbouring turns of one hand, perpendicular to them.

    On the developed surface (s, z) the turns of a helix are parallel lines of slope pitch/S, which
    lie a pitch apart along z: p S/√(S² + p²) apart, times the gap between several starts.

    Args:
        pattern: name in `PATTERNS`.
        pitch: rise p of a turn, mm.
        perimeter: S of the winding's outline, mm.

    Returns:
        The distance in mm; it grows with the pitch toward gap · S, all around the section.
    """
    return PATTERNS[pattern].gap * pitch * perimeter / math.hypot(perimeter, pitch)


def least_pitch(pattern: str, width: float, perimeter: float) -> float | None:
    """The pitch at which turns as wide as `width` (mm) touch; None where every pitch is too small.

    Args:
        pattern: name in `PATTERNS`.
        width: of what is wound, perpendicular to it, mm.
        perimeter: S of the winding's outline, mm.
    """
    widest = PATTERNS[pattern].gap * perimeter
    return (
        None
        if width >= widest
        else width / math.sqrt(1 - (width / widest) ** 2) * (perimeter / widest)
    )


def _modulo(hand: int, start: float) -> tuple[int, float]:
    """A helix by its hand and its start within one pitch."""
    return hand, round(start % 1, 9) % 1


PATTERNS: dict[str, Pattern] = {
    "double-helix": Pattern("a double helix", (Helix(1), Helix(-1))),
    "single-helix-right": Pattern("a single helix", (Helix(1),)),
    "single-helix-left": Pattern("a single helix", (Helix(-1),)),
}
"""Every pattern by its name in a case."""
