"""Damaged cases through validate and plan, the short form; `make survive` has the long one."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from bench.survive import PAGE
from bench.survive_fuzz import (
    KINDS,
    complaint_fault,
    mutant,
    outcome,
    run_fault,
)
from fiberbend.columns import VOLUME
from fiberbend.schema.problems import CaseError, Problem
from tests.conftest import ROOT

SEEDS = range(30)


@pytest.mark.timeout(60)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_damaged_case_is_answered_or_refused(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "case.yaml"
    kind, text = mutant(seed)
    assert kind == KINDS[seed % len(KINDS)]
    path.write_text(text, encoding="utf-8")
    end, fault = outcome(path)
    assert end in ("valid", "refused")
    assert fault == ""


def test_damage_is_the_same_again_and_damages() -> None:
    texts = [mutant(seed)[1] for seed in SEEDS]
    assert texts == [mutant(seed)[1] for seed in SEEDS]
    assert len({*texts}) == len(texts)
    whole = [path.read_text(encoding="utf-8") for path in (ROOT / "cases").rglob("*.yaml")]
    loaded = [yaml.safe_load(text) for text in whole]
    assert not {*texts} & {*whole}
    same = sum(yaml.safe_load(t) in loaded for s, t in enumerate(texts) if KINDS[s % 6] != "text")
    assert same < len(texts) / 5


@pytest.mark.parametrize(
    "text", ["Traceback (most recent call last)", "<object object at 0x7f>", "bell \x07"]
)
def test_a_bad_complaint_is_a_fault(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert complaint_fault(CaseError([Problem("actuator", "expected something")])) == ""
    monkeypatch.setattr(Problem, "__str__", lambda self: text)
    assert complaint_fault(CaseError([Problem("", "")]))


def test_a_bad_end_of_a_run_is_a_fault(tmp_path: Path) -> None:
    def fault(status: str = "converged", code: int = 0, row: str = "0,1000.0,1.0") -> str:
        reason = "" if status == "converged" else "why"
        (tmp_path / "run.json").write_text(f'{{"status": "{status}", "reason": "{reason}"}}')
        head = f"step,{VOLUME},axis_stretch"
        (tmp_path / "history.csv").write_text(f"{head}\n0,1000.0,1.0\n{row}\n")
        return run_fault(tmp_path, code, "")

    assert fault() == fault("failed", 2) == fault("stopped") == ""
    assert fault("failed", 0) == "failed with exit code 0"
    assert fault(row="1,nan,1.0") == f"row 1: {VOLUME} is nan"
    assert fault(row="1,1e3,inf") == "row 1: axis_stretch is inf"
    assert fault(row="1,-3,1.0") == f"row 1: {VOLUME} is -3.0"
    assert fault(row="1,3,") == ""
    assert fault(code=139).startswith("exit code 139")
    assert run_fault(tmp_path, 1, "") == "refused without a word"
    assert run_fault(tmp_path, 2, "Traceback (most recent call last):\nKeyError")


def test_the_page_has_its_table() -> None:
    text = PAGE.read_text(encoding="utf-8")
    part = text.partition("<!-- fuzz,")[2].partition("<!-- end of fuzz -->")[0]
    rows = [line for line in part.splitlines() if line.startswith(tuple(f"| {k} " for k in KINDS))]
    assert len(rows) == len(KINDS)
    assert all(row.endswith("| 0 |") for row in rows)
    assert "Not as expected" not in part
