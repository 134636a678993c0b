"""Answers of a stack: how they are found, and how those of several stacks are compared."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from bench import platforms
from tests.conftest import ROOT

FAST = (ROOT / "tests" / "fast.txt").read_text(encoding="utf-8").split()


@pytest.mark.mpi
def test_two_ranks_answer_like_one(tmp_path: Path) -> None:
    names = ("coarse body", "coarse body, two ranks")
    one, two = (platforms.solve(name, tmp_path / name).answers for name in names)
    assert len(one) >= 3
    found = platforms.difference(one, two)
    assert max(found.values()) < platforms.TOLERANCE, found


def record(dolfinx: str, factor: float) -> dict[str, Any]:
    """What a stack might have left, pressures times a factor."""
    run = {
        "answers": [{"pressure_kPa": 10.0 * factor, "angle_deg": 90.0}],
        "cpu_s": 2.0,
        "wall_s": 2.5,
        "factor_cpu_s": 1.0,
        "unknowns": 1000,
        "iterations": 4,
    }
    versions = {"dolfinx": dolfinx, "petsc": "3.18", "python": "3.11", "numpy": "1.24"}
    return {
        "stack": f"stack of {dolfinx}",
        "versions": versions,
        "processor": "a processor",
        "blas": "OpenBLAS",
        "setup_s": None,
        "runs": dict.fromkeys(platforms.CASES, run),
        "orderings": {"PORD": 1.0},
    }


def test_the_page_says_how_far_two_stacks_are_apart() -> None:
    page = platforms.page([record("0.5.2", 1.0), record("0.11.0.post0", 1.001)])
    assert "| section, 90 ° | `pressure_kPa` | 10 | 10.01 |" in page
    assert "| case | stack of 0.11.0.post0, dolfinx 0.11 |" in page
    assert "| section | 1.0e-03 |" in page
    assert "| AMD | not built in | not built in |" in page


def test_all_stacks_answer_alike() -> None:
    first, *others = platforms.records()
    assert [platforms.release(record) for record in (first, *others)] == ["0.5", "0.9", "0.11"]
    for name, run in first["runs"].items():
        for other in others:
            found = platforms.difference(run["answers"], other["runs"][name]["answers"])
            assert max(found.values()) < platforms.TOLERANCE, (name, other["stack"], found)


def test_the_page_is_that_of_the_records() -> None:
    written = platforms.PAGE.read_text(encoding="utf-8")
    assert written == platforms.page(platforms.records()), "make platforms"


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
