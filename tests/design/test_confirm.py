"""An answer of the section, corrected until a finer model agrees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import pytest

from fiberbend.design.quantities.seen import State
from fiberbend.design.search.confirm import BODY, Confirmed, Confirmer
from fiberbend.design.solving.body import Body
from fiberbend.design.solving.models import States
from fiberbend.design.told.outcome import MET, Times, outcome
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError, Problem
from tests.design.made_up import MadeUp, design, none, search

WALL = {"actuator.wall": {"from": "1 mm", "to": "3 mm"}}


class MadeUpBody:
    """Bends less than the section, the more so the thicker its wall."""

    def states(
        self, data: Mapping[str, Any], wanted: Sequence[State], _zones: int
    ) -> tuple[States, list[str]]:
        """As of `Body`."""
        case = parse_case(data)
        part = 1 - 0.05 * case.actuator.wall
        found = MadeUp().states(case, wanted)
        return {
            state: (one._replace(angle=part * one.angle),) for state, (one,) in found.items()
        }, []


@pytest.mark.parametrize(("within", "bodies"), [({}, 3), ({"within": "0.02 deg"}, 5)])
def test_a_target_that_is_to_be_met_closely_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, within: dict[str, str], bodies: int
) -> None:
    def no_cell(*_: object) -> None:
        raise CaseError([Problem("model", "no cell")])

    monkeypatch.setattr("fiberbend.design.solving.models.Cell.states", no_cell)
    target = {"angle": {"at": "60 kPa", "is": "90 deg", **within}}
    made = design(tmp_path, vary=WALL, targets=[target])
    tried = search(made)
    found = tried.whole(none(made), None)
    assert found is not None
    body = cast(Body, MadeUpBody())
    start = Confirmed(found, tuple(none(made)))
    done = Confirmer(made, tried, body, lambda _line: None).confirm(start)
    told = outcome(made, tried.tries, done, [], None, Times())
    assert told.status == MET
    assert len([check for check in done.checks if check.model == BODY]) <= bodies
