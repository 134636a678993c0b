"""Curves in the pictures of a design."""

from __future__ import annotations

from pathlib import Path

import pytest

from fiberbend.design.search.confirm import Confirmed
from fiberbend.design.search.search import Search
from fiberbend.design.solving.models import Section
from fiberbend.design.solving.tries import Tries
from fiberbend.design.told.outcome import Times, outcome
from fiberbend.design.told.picture import _curve
from tests.design.made_up import design, none


def test_a_curve_begins_where_the_actuator_is_at_rest(tmp_path: Path) -> None:
    moment = {"straight-moment": {"at": "60 kPa", "least": "1 N*mm"}}
    targets = [{"tip-z": {"at": "60 kPa", "most": "1 m"}}, moment]
    made = design(tmp_path, vary={"actuator.wall": ["2 mm"]}, targets=targets)
    tries = Tries(made, Section(1))
    found = Search(made, tries).whole(none(made), None)
    assert found is not None
    told = outcome(made, tries, Confirmed(found, tuple(none(made))), [], None, Times())
    tip, kept = (list(_curve(told, each.quantity)) for each in told.told)
    actuator = made.base.actuator
    assert tip[0] == pytest.approx((0.0, actuator.length + actuator.cap))
    assert tip[-1][0] == pytest.approx(60.0)
    assert kept[0] == pytest.approx((0.0, 0.0), abs=1e-6)
