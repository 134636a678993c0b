"""The table of what every quantity changes by, beside cases that are solved anew."""

from __future__ import annotations

from pathlib import Path

import pytest

from fiberbend.design.quantities.seen import Seen
from fiberbend.design.search.confirm import Confirmed, Confirmer
from fiberbend.design.search.search import Search
from fiberbend.design.solving.body import Body
from fiberbend.design.solving.models import Cell, Section
from fiberbend.design.solving.tries import Tries
from fiberbend.design.told.sensitivity import sensitivities
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from tests.design.made_up import design, none


def no_body(_: object) -> RunResult:
    raise AssertionError("not asked for")


def test_the_pitch_acts_as_in_the_cell(tmp_path: Path) -> None:
    targets = [{"strain": {"at": "60 kPa", "most": "90 %"}}]
    varied = {"actuator.wall": ["1.5 mm"]}
    made = design(tmp_path, vary=varied, targets=targets, confirm="cell")
    search = Search(made, Tries(made, Section(1)))
    found = search.whole(none(made), None)
    assert found is not None
    confirmer = Confirmer(made, search, Body(no_body, made.quantities), lambda _line: None)
    done = confirmer.confirm(Confirmed(found, tuple(none(made))))
    rows = {row.path: row for row in sensitivities(made, done)}
    path = "effects.1.winding.pitch"
    (told,) = rows[path].changes
    assert rows[path].step == "0.1 mm"
    (strain,) = made.targets
    beside = []
    for pitch in ("2.98 mm", "3.02 mm"):
        case = parse_case(made.changed([*found.chosen, (path, pitch)]))
        beside.append(strain.read(Seen(case, Cell().states(case, strain.states()))))
    # more rubber bulges between turns that are further apart, of which the section knows nothing
    assert told == pytest.approx((beside[1] - beside[0]) * 0.1 / 0.04, rel=0.1)
    assert told is not None
    assert told > 0
