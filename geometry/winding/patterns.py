"""The winding patterns, each a line of `PATTERNS`; no numpy, for cases are checked by them."""

from __future__ import annotations

import dataclasses


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


def _modulo(hand: int, start: float) -> tuple[int, float]:
    """A helix by its hand and its start within one pitch."""
    return hand, round(start % 1, 9) % 1


PATTERNS: dict[str, Pattern] = {
    "double-helix": Pattern("a double helix", (Helix(1), Helix(-1))),
    "single-helix-right": Pattern("a single helix", (Helix(1),)),
    "single-helix-left": Pattern("a single helix", (Helix(-1),)),
}
"""Every pattern by its name in a case."""
