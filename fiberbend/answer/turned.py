"""How a body is turned beside its bending angle: twist, side angle, and what each zone has."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fiberbend import columns as col
from fiberbend.answer.motion import SEEN
from fiberbend.answer.numbers import quantity

_WHOLE = ((col.TWIST, "twist"), (col.SIDE_ANGLE, "side angle"))
_PARTS = (("angle_deg", "angles of the zones"), ("twist_deg", "twists of the zones"))


def turned(rows: Sequence[col.Row], zones: int) -> Iterator[tuple[str, str, str]]:
    """Twist, side angle, and the parts of zones along the length, each where there is any.

    Args:
        rows: of the history.
        zones: how many there are.

    Yields:
        What it is, the values, and a note.
    """
    for key, label in _WHOLE:
        values = [row[key] for row in rows if row.get(key) is not None]
        if values and max(map(abs, values)) > SEEN:
            yield f"{label} at the end", quantity(values[-1], "°"), ""
    for name, label in _PARTS:
        values = [rows[-1].get(col.zone(number, name)) or 0.0 for number in range(zones)]
        if any(abs(value) > SEEN for value in values):
            text = ", ".join(quantity(value, "°") for value in values)
            yield label, text, "at the end, from root to tip"
