"""What each zone along the length has of the bending angle and of the twist."""

from __future__ import annotations

from collections.abc import Iterator

from fiberbend import columns as col
from fiberbend.answer.numbers import quantity

_PARTS = (("angle_deg", "angles of the zones"), ("twist_deg", "twists of the zones"))
_SEEN = 5e-3
"""Degrees that are shown; less is round-off."""


def parts_of_zones(row: col.Row, zones: int) -> Iterator[tuple[str, str, str]]:
    """Angles and twists of all zones, each where there is any, in words.

    Args:
        row: of the history.
        zones: how many there are.

    Yields:
        What it is, the values, and where.
    """
    for name, label in _PARTS:
        values = [float(row.get(col.zone(number, name)) or 0.0) for number in range(zones)]
        if any(abs(value) > _SEEN for value in values):
            text = ", ".join(quantity(value, "°") for value in values)
            yield label, text, "at the end, from root to tip"
