"""What a run in time answers: greatest angle, events, when it settles, what damping took."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.answer.numbers import quantity

BAND = 0.02
"""Part of the change of the angle within which it has settled, as control engineers have it."""
ENTRY = "motion"
"""Of run.json."""


@dataclasses.dataclass(frozen=True)
class Told:
    """Of a motion, from its rows.

    Attributes:
        greatest: bending angle that is farthest from the first, °.
        when: its time, s.
        last: bending angle at the end, °.
        settled: from when on the angle stays within `BAND` of its last value, in parts of its whole
            change, s; None: it has not, for what is left of the motion is too short to tell.
        fastest: greatest speed of the tip, mm/s.
    """

    greatest: float
    when: float
    last: float
    settled: float | None
    fastest: float


def told(rows: Sequence[col.Row]) -> Told:
    """What the rows of a motion tell.

    Args:
        rows: of its history, with times.
    """
    time, angle, speed = (
        np.array([row[key] for row in rows], dtype=float)
        for key in (col.TIME, col.ANGLE, col.SPEED)
    )
    far = int(np.argmax(np.abs(angle - angle[0])))
    return Told(
        float(angle[far]), float(time[far]), float(angle[-1]), _settled(time, angle), speed.max()
    )


def _settled(time: np.ndarray, angle: np.ndarray) -> float | None:
    """Since when the angle stays within the band, if that is long enough to tell."""
    band = BAND * float(np.abs(angle - angle[-1]).max())
    outside = np.flatnonzero(np.abs(angle - angle[-1]) > band)
    if band == 0:
        return float(time[0])
    if not len(outside) or outside[-1] + 1 >= len(time):
        return None
    since = float(time[outside[-1] + 1])
    # a motion that swings on would leave the band again: as long as it took a tenth is looked at
    return since if time[-1] - since >= 0.1 * (time[-1] - time[0]) else None


def entries(rows: Sequence[col.Row], run: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Lines of the answer: label, value and note.

    Args:
        rows: of the history.
        run: content of run.json.
    """
    if len(rows) < 2 or rows[-1].get(col.TIME) is None:
        return
    found = told(rows)
    yield "greatest angle", quantity(found.greatest, "°"), f"at {_time(found.when)}"
    entry = run.get(ENTRY) or {}
    rest = entry.get("rest_angle_deg")
    note = "" if rest is None else f"at rest under the last pressure {quantity(rest, '°')}"
    yield f"angle at {_time(rows[-1][col.TIME])}", quantity(found.last, "°"), note
    settled = "not within the run" if found.settled is None else _time(found.settled)
    yield "settled", settled, f"within {100 * BAND:g} % of its change from then on"
    yield "fastest tip", quantity(found.fastest / 1e3, "m/s"), ""
    for event in entry.get("events") or ():
        what = "touches" if event["touch"] else "lifts off"
        yield f"{what} {event['name']}", f"at {_time(event['time_s'])}", ""
    last = rows[-1]
    lost = quantity(last[col.DISSIPATED], "mJ")
    worst = max(abs(row[col.DRIFT]) for row in rows)
    yield "taken by damping", lost, f"the balance of energy closes to {worst:.1e} mJ"


def _time(seconds: float) -> str:
    return quantity(seconds, "s")
