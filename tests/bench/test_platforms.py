"""What the stacks have answered is one answer, and the stack at hand still gives it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from bench import platforms
from tests.conftest import ROOT

RECORDS = platforms.records()
NAMES = [platforms.release(record) for record in RECORDS]
QUICK = ("section", "cell", "coarse body", "blocked tip")
"""What is solved again on the stack that the tests run on."""
FAST = (ROOT / "tests" / "fast.txt").read_text(encoding="utf-8").split()


def test_three_stacks_have_left_a_record() -> None:
    assert NAMES == ["0.5", "0.9", "0.11"]
    assert all(record["runs"].keys() == platforms.CASES.keys() for record in RECORDS)


@pytest.mark.parametrize("name", platforms.CASES)
@pytest.mark.parametrize("record", RECORDS[1:], ids=NAMES[1:])
def test_stacks_answer_the_same(record: dict[str, Any], name: str) -> None:
    one, other = (r["runs"][name]["answers"] for r in (RECORDS[0], record))
    found = platforms.difference(one, other)
    assert max(found.values()) < platforms.TOLERANCE, found


@pytest.mark.parametrize("record", RECORDS, ids=NAMES)
def test_two_ranks_answer_like_one(record: dict[str, Any]) -> None:
    one, two = (record["runs"][f"coarse body{n}"]["answers"] for n in ("", ", two ranks"))
    assert max(platforms.difference(one, two).values()) < platforms.TOLERANCE


@pytest.mark.parametrize("name", QUICK)
def test_this_stack_answers_as_recorded(name: str, tmp_path: Path) -> None:
    found, _, _ = platforms.solve(name, tmp_path / "run")
    recorded = RECORDS[0]["runs"][name]["answers"]
    worst = platforms.difference(recorded, found)
    assert max(worst.values()) < platforms.TOLERANCE, worst
    # and whoever has never seen the record would call these answers
    assert len(found) >= 3


def test_the_page_is_that_of_the_records() -> None:
    assert platforms.PAGE.read_text(encoding="utf-8") == platforms.page(RECORDS)


def test_other_states_are_no_difference_but_an_error() -> None:
    state = {"pressure_kPa": 10.0, "angle_deg": 90.0}
    assert platforms.difference([state], [state | {"pressure_kPa": 10.001}]) == pytest.approx(
        {"pressure_kPa": 1e-4, "angle_deg": 0.0}
    )
    for other in ([], [state, state], [{"pressure_kPa": 10.0}]):
        with pytest.raises(ValueError, match="states"):
            platforms.difference([state], other)
    with pytest.raises(ValueError, match="0 states"):
        platforms.difference([], [])


def test_the_fast_tests_are_there() -> None:
    assert [name for name in FAST if not (ROOT / name).exists()] == []
    for part in ("test_cell", "test_regression", "test_ranks", "test_hostile", "test_restart"):
        assert any(part in name for name in FAST)
