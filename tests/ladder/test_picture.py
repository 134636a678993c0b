"""The picture of a ladder: every rung is on it, the front is named, no two texts overlap."""

from __future__ import annotations

import io
import itertools
from typing import Any

import pytest

from fiberbend.ladder import picture
from fiberbend.ladder.advice import pareto
from fiberbend.ladder.words import short
from tests.ladder.parts import judged


@pytest.fixture(scope="module")
def page() -> Any:
    """The page of the baseline's whole ladder, as it is drawn."""
    pages: list[Any] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(picture, "save", lambda page, target, style: pages.append(page))
        picture.draw(judged(), "A ladder", io.BytesIO())
    return pages[0]


def test_every_rung_is_drawn(page: Any) -> None:
    (axes,) = page.axes
    drawn = [line for line in axes.lines if line.get_linestyle() == "None"]
    assert sum(len(line.get_xdata()) for line in drawn) == len(judged().rungs)
    assert axes.get_xscale() == axes.get_yscale() == "log"


def test_the_front_is_named_and_no_texts_overlap(page: Any) -> None:
    (axes,) = page.axes
    texts = {text.get_text(): text for text in axes.texts}
    for each in pareto(judged()):
        assert short(each.rung) in texts
    renderer = page.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in axes.texts]
    boxes.append(axes.get_legend().get_window_extent(renderer))
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
    inside = axes.figure.bbox
    assert all(inside.x0 <= box.x0 and box.x1 <= inside.x1 for box in boxes)


def test_it_is_a_file() -> None:
    target = io.BytesIO()
    picture.draw(judged(), "A ladder", target)
    assert target.getvalue().startswith(b"\x89PNG")
