"""The table of what every quantity changes by, beside cases that are solved anew."""

from __future__ import annotations

from pathlib import Path

import pytest

from fiberbend.design.quantities.seen import Seen
from fiberbend.design.reading import Design
from fiberbend.design.search.confirm import Confirmed, Confirmer
from fiberbend.design.search.search import Search
from fiberbend.design.solving.body import Body
from fiberbend.design.solving.models import Cell, Section
from fiberbend.design.solving.tries import Tries
from fiberbend.design.told.doubt import doubt
from fiberbend.design.told.outcome import Times, answer, outcome
from fiberbend.design.told.sensitivity import finest, sensitivities
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from tests.design.made_up import design, none


def no_body(_: object) -> RunResult:
    raise AssertionError("not asked for")


def confirmed(made: Design) -> Confirmed:
    """The answer of a design whose section is confirmed by its cell."""
    search = Search(made, Tries(made, Section(1)))
    found = search.whole(none(made), 0 if made.goals else None)
    assert found is not None
    confirmer = Confirmer(made, search, Body(no_body, made.quantities), lambda _line: None)
    return confirmer.confirm(Confirmed(found, tuple(none(made))))


@pytest.mark.long
def test_the_pitch_acts_as_in_the_cell(tmp_path: Path) -> None:
    targets = [{"strain": {"at": "60 kPa", "most": "90 %"}}]
    varied = {"actuator.wall": ["1.5 mm"]}
    made = design(tmp_path, vary=varied, targets=targets, confirm="cell")
    done = confirmed(made)
    rows = {row.path: row for row in sensitivities(made, finest(made, done))}
    path = "effects.1.winding.pitch"
    (told,) = rows[path].changes
    assert rows[path].step == "0.1 mm"
    (strain,) = made.targets
    beside = []
    for pitch in ("2.98 mm", "3.02 mm"):
        case = parse_case(made.changed([*done.found.chosen, (path, pitch)]))
        beside.append(strain.read(Seen(case, Cell().states(case, strain.states()))))
    # more rubber bulges between turns that are further apart, of which the section knows nothing
    assert told == pytest.approx((beside[1] - beside[0]) * 0.1 / 0.04, rel=0.1)
    assert told is not None
    assert told > 0


@pytest.mark.long
def test_a_goal_whose_least_the_cell_has_elsewhere_is_doubted(tmp_path: Path) -> None:
    parts = {
        "vary": {"actuator.wall": {"from": "1 mm", "to": "3 mm"}},
        "targets": [{"angle": {"at": "60 kPa", "least": "30 deg"}}],
        "goals": [{"minimise": {"strain": {"at": "60 kPa"}}}],
        "confirm": "cell",
    }
    made = design(tmp_path, **parts)
    done = confirmed(made)
    why = doubt(done, finest(made, done))
    assert "less with more wall" in why
    tries = done.found.wishes.tries
    told = answer(outcome(made, tries, done, [], None, Times(), doubt=why))
    assert why in told.warnings
    assert any("least found" in entry.note for entry in told.entries)
    # a size is the same in every model
    parts["goals"] = [{"minimise": {"rubber": {}}}]
    sure = design(tmp_path, **parts)
    done = confirmed(sure)
    assert doubt(done, finest(sure, done)) == ""
