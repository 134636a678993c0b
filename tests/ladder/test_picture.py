"""The picture of a ladder: every rung is on it, the front is named, no two texts overlap."""

from __future__ import annotations

import dataclasses
import functools
import io
import itertools
from typing import Any

import numpy as np
import pytest

from fiberbend.ladder import picture
from fiberbend.ladder.advice import pareto
from fiberbend.ladder.asked import asked
from fiberbend.ladder.errors import Judgement, judge
from fiberbend.ladder.rungs import Rung
from fiberbend.ladder.words import WINDINGS, short, short_mesh
from tests.conftest import ROOT
from tests.ladder.parts import CASE, judged, record, truth, whole

CASES = (CASE, ROOT / "cases" / "blocked_tip.yaml")


def calibrated() -> Judgement:
    """The baseline's ladder with its calibrated windings, which stand on those of every turn."""
    rungs = whole(CASE).rungs
    pairs = []
    for rung in rungs:
        turns = dataclasses.replace(rung.family, winding="turns")
        like = (
            rung if rung.family.winding != "calibrated" else Rung(turns, (), rung.case, rung.mesh)
        )
        values = {each.name: truth(like, each) for each in asked(rung.case)}
        once = 0.5 * rung.seconds if like is not rung else 0.0
        found = dataclasses.replace(record(rung, values), once_s=once)
        pairs.append((rung, found))
    return judge(asked(rungs[0].case), pairs, rungs)


LADDERS = {"free": judged, "blocked": lambda: judged(path=CASES[1]), "calibrated": calibrated}


@functools.cache
def judgement_of(name: str) -> Judgement:
    """One of them, made once, and not where tests are collected."""
    return LADDERS[name]()


def drawn(judgement: Judgement) -> Any:
    """The page of a ladder as it is drawn."""
    pages: list[Any] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(picture, "save", lambda page, target, style: pages.append(page))
        picture.draw(judgement, "A ladder", io.BytesIO())
    return pages[0]


@pytest.fixture(scope="module", params=LADDERS)
def found(request: pytest.FixtureRequest) -> tuple[Any, Judgement]:
    """A ladder and its page."""
    judgement = judgement_of(request.param)
    return drawn(judgement), judgement


def marks(axes: Any) -> list[Any]:
    """The lines that are rungs."""
    lines = [line for line in axes.lines if line.get_linestyle() == "None"]
    return [line for line in lines if len(line.get_xdata()) and line.get_marker() != "|"]


def test_every_rung_is_drawn(found: tuple[Any, Judgement]) -> None:
    page, judgement = found
    (axes,) = page.axes
    assert len(marks(axes)) == len(judgement.rungs)
    assert axes.get_xscale() == axes.get_yscale() == "log"


def test_the_front_is_named_and_no_texts_overlap(found: tuple[Any, Judgement]) -> None:
    page, judgement = found
    (axes,) = page.axes
    for each in pareto(judgement):
        head = short(each.rung).removesuffix(short_mesh(each.rung))
        named = [text.get_text() for text in axes.texts if text.get_text().startswith(head)]
        assert any(short_mesh(each.rung) in name.removeprefix(head).split(", ") for name in named)
    renderer = page.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in axes.texts]
    under = axes.get_legend().get_window_extent(renderer)
    assert not any(one.overlaps(other) for one, other in itertools.combinations([*boxes, under], 2))
    inside = axes.figure.bbox
    assert all(inside.x0 <= box.x0 and box.x1 <= inside.x1 for box in [*boxes, under])
    # no name covers a mark, the legend none of all
    middles = np.array([axes.transData.transform(line.get_xydata()[0]) for line in marks(axes)])
    for box in boxes:
        within = (middles > [box.x0, box.y0]) & (middles < [box.x1, box.y1])
        assert not within.all(axis=1).any()
    assert under.y1 < axes.get_window_extent(renderer).y0


def test_every_family_looks_otherwise_and_everywhere_the_same() -> None:
    looks: dict[str, Any] = {}
    for judgement in map(judgement_of, LADDERS):
        families = {each.rung.family.discretisation for each in judgement.rungs}
        for family in families:
            look = picture._look(family)
            assert looks.setdefault(family.key, look) == look
        assert len({picture._look(family) for family in families}) == len(families)


def test_colours_of_windings_differ_in_lightness() -> None:
    """They are told apart without any colour too."""
    from matplotlib.colors import to_rgb

    weights = np.array([0.2126, 0.7152, 0.0722])
    # a case without a winding has the first colour alone
    colors = picture._COLORS[1 : len(WINDINGS)]
    found = [float(weights @ np.power(to_rgb(color), 2.2)) for color in colors]
    for one, other in itertools.combinations(found, 2):
        assert (max(one, other) + 0.05) / (min(one, other) + 0.05) > 2


def test_the_band_of_the_reference_ends_within_the_axes() -> None:
    """Though the reference were known worse than any rung is off."""

    def rough(judgement: Judgement) -> Judgement:
        reference = judgement.reference
        assert reference is not None
        limits = {
            name: dataclasses.replace(
                each, limit=dataclasses.replace(each.limit, uncertainty=0.9 * each.limit.value)
            )
            for name, each in judgement.limits[reference].items()
        }
        return dataclasses.replace(judgement, limits={**judgement.limits, reference: limits})

    judgement = rough(judged())
    assert judgement.known_to() > max(each.worst() for each in judgement.rungs)
    (axes,) = drawn(judgement).axes
    low, high = axes.get_ylim()
    assert low < judgement.known_to() < high


def test_it_is_a_file() -> None:
    target = io.BytesIO()
    picture.draw(judged(), "A ladder", target)
    assert target.getvalue().startswith(b"\x89PNG")
