"""How an actuator moves, in words: it bends, twists, lengthens or shortens."""

from __future__ import annotations

from collections.abc import Iterator

from fiberbend import columns as col
from fiberbend.answer.numbers import quantity

SEEN = 5e-3
"""Degrees and millimetres that are shown; less is round-off."""
_STRETCHED = 1e-4
"""Change of the stretch that is shown."""


def motion(row: col.Row) -> str:
    """What an actuator does at a row, such as "bends to 90° and twists by -12°"."""
    words = [
        words.format(quantity(row[key], "°"))
        for key, words in (
            (col.ANGLE, "bends to {}"),
            (col.SIDE_ANGLE, "bends by {} to the side"),
            (col.TWIST, "twists by {}"),
        )
        if _turned(row, key)
    ]
    words = words or list(_lengthened(row)) or [f"bends to {quantity(row[col.ANGLE], '°')}"]
    return " and ".join(words)


def turn(row: col.Row) -> str:
    """The bending angle of a row, or the twist or stretch of an actuator that does not bend."""
    if not _turned(row, col.ANGLE):
        if _turned(row, col.TWIST):
            return f"twist {quantity(row[col.TWIST], '°')}"
        if any(_lengthened(row)) and not _turned(row, col.SIDE_ANGLE):
            return f"stretch {row[col.AXIS_STRETCH]:.4g}"
    return quantity(row[col.ANGLE], "°")


def _turned(row: col.Row, key: str) -> bool:
    return abs(row.get(key) or 0.0) > SEEN


def _lengthened(row: col.Row) -> Iterator[str]:
    """By how many percent its centre-line is longer or shorter."""
    strain = (row.get(col.AXIS_STRETCH) or 1.0) - 1
    if abs(strain) > _STRETCHED:
        yield f"{'lengthens' if strain > 0 else 'shortens'} by {quantity(100 * abs(strain), '%')}"
