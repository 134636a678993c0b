"""How an actuator moves, in words: it bends, twists, lengthens or shortens."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterable, Iterator, Sequence

from fiberbend import columns as col
from fiberbend.answer.numbers import quantity

SEEN = 5e-3
"""Degrees and millimetres that are shown; less is round-off."""
STRETCHED = 1e-4
"""Change of the stretch that is shown."""


@dataclasses.dataclass(frozen=True)
class Reading:
    """What is read off a row, such as something that an actuator does.

    Attributes:
        columns: that have its value; of zones one each, from root to tip.
        name: what it is.
        unit: of its values; empty for a ratio.
    """

    columns: tuple[str, ...]
    name: str
    unit: str = "°"

    def told(self, row: col.Row) -> str:
        """How far it does it at a row, ready to print; empty where that is not known."""
        known = [row[key] for key in self.columns if row.get(key) is not None]
        return ", ".join(quantity(value, self.unit) for value in known)

    def made(self, row: col.Row) -> bool:
        """Whether it does it at all."""
        rest, seen = (1.0, STRETCHED) if self == STRETCH else (0.0, SEEN)
        return any(abs((row.get(key) or rest) - rest) > seen for key in self.columns)


BEND = Reading((col.ANGLE,), "angle")
TWIST = Reading((col.TWIST,), "twist")
SIDE = Reading((col.SIDE_ANGLE,), "side angle")
STRETCH = Reading((col.AXIS_STRETCH,), "stretch", "")


def motion(row: col.Row) -> str:
    """What an actuator does at a row, such as "bends to 90° and twists by -12°"."""
    bends = _bends(row)
    where = "" if bends == BEND else " in its zones"
    words = [
        words.format(made.told(row))
        for made, words in (
            (bends, f"bends to {{}}{where}"),
            (SIDE, "bends by {} to the side"),
            (TWIST, "twists by {}"),
        )
        if made.made(row)
    ]
    if not words and STRETCH.made(row):
        strain = row[col.AXIS_STRETCH] - 1
        verb = "lengthens" if strain > 0 else "shortens"
        words = [f"{verb} by {quantity(100 * abs(strain), '%')}"]
    return " and ".join(words or [f"bends to {BEND.told(row)}"])


def turn(row: col.Row) -> str:
    """The bending angle of a row, or what an actuator that does not bend does instead."""
    (made,) = told_by((row,), ())
    return made.told(row) if made == BEND else f"{made.name} {made.told(row)}"


def told_by(rows: Sequence[col.Row], kept: Iterable[str]) -> Iterator[Reading]:
    """The motion that tells what an actuator does: the first of those that it makes.

    Args:
        rows: of the history.
        kept: columns of motions that are held, which tell nothing.

    Yields:
        At most one; of an actuator that does not move its bend.
    """
    every = (_bends(rows[-1]), TWIST, SIDE, STRETCH)
    free = [each for each in every if set(kept).isdisjoint(each.columns)]
    made = [each for each in free if any(each.made(row) for row in rows)]
    yield from (made or (BEND,) * (col.ANGLE not in kept))[:1]


def _bends(row: col.Row) -> Reading:
    """Its bend, or those of its zones where they bend against each other and the whole hides it."""
    numbers = itertools.count()
    keys = itertools.takewhile(row.__contains__, (col.zone(n, "angle_deg") for n in numbers))
    zones = tuple(keys)
    most = max((abs(row[key] or 0.0) for key in zones), default=0.0)
    return Reading(zones, "angles of the zones") if most > abs(row[col.ANGLE]) + SEEN else BEND
