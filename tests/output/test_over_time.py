"""A motion over time: names of events and of the greatest angle."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from fiberbend import columns as col
from fiberbend.drawing.moving import over_time

KEYS = (col.TIME, col.PRESSURE, col.ANGLE, col.TIP_Y, col.SPEED)
ENERGIES = (
    col.KINETIC,
    col.ELASTIC,
    col.POTENTIAL,
    col.AIR_WORK,
    col.LOADS_WORK,
    col.DISSIPATED,
)
TIMES = np.linspace(0.0, 0.6, 61)


def drawn(events: list[tuple[float, str]], monkeypatch: pytest.MonkeyPatch) -> Any:
    """The page of an angle that is greatest at the end."""
    pages: list[Any] = []
    monkeypatch.setattr(over_time, "save", lambda page, target: pages.append(page))
    rows = [dict.fromkeys((*KEYS, *ENERGIES), float(time)) for time in TIMES]
    over_time.plot_over_time(rows, io.BytesIO(), "A finger", "it stopped", events)
    return pages[0]


@pytest.mark.parametrize(
    "times",
    [
        (0.0966, 0.3053, 0.31, 0.315),
        (0.4 + 0.004 * np.arange(12)),
        (0.55, 0.57, 0.58, 0.585, 0.59, 0.6, 0.6),
        (*np.linspace(0.0, 0.6, 150),),
    ],
)
def test_no_name_of_an_event_covers_another_and_all_are_counted(
    times: tuple[float, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ("touches plane", "leaves plane")
    events = [(float(time), names[number % 2]) for number, time in enumerate(times)]
    page = drawn(events, monkeypatch)
    texts = [text for text in page.axes[0].texts if "plane" in text.get_text()]
    boxes = [text.get_window_extent() for text in texts]
    assert not any(a.overlaps(b) for n, a in enumerate(boxes) for b in boxes[:n])
    assert all(box.x0 >= 0 and box.x1 <= page.bbox.width for box in boxes)
    # below the line that says why it ended
    reason = next(text for text in page.texts if "it stopped" in text.get_text())
    assert max(box.y1 for box in boxes) < reason.get_window_extent().y0
    counted = [text.get_text().partition(" and ")[2] for text in texts]
    assert len(texts) + sum(int(more.split()[0]) for more in counted if more) == len(times)


def test_the_greatest_angle_at_the_end_is_written_on_the_page(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    page = drawn([], monkeypatch)
    (text,) = page.axes[1].texts
    assert text.get_text() == "0.6° at 0.6 s"
    assert text.get_window_extent().x1 < page.bbox.width
