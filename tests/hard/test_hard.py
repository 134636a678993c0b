"""Every hard case ends as its table says: reached, or refused with its physical reason."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from bench.hard_cases import HARD, MODELS, Hard, find
from bench.hard_solve import Record, faults, solve


def marks(hard: Hard, model: str) -> pytest.MarkDecorator | tuple[()]:
    """Cells take longer than sections."""
    if model not in hard.fast:
        return pytest.mark.hard
    return () if model == "section" else pytest.mark.long


ALL = [
    pytest.param(
        hard.name,
        model,
        marks=marks(hard, model),
        id=f"{hard.name}-{model}",
    )
    for hard in HARD
    for model in hard.models
]


@pytest.mark.parametrize(("name", "model"), ALL)
def test_a_hard_case_is_reached_or_refused_for_its_reason(name: str, model: str) -> None:
    record = solve(find(name), model)
    assert record.faults == []


@pytest.mark.parametrize("hard", HARD, ids=lambda hard: hard.name)
def test_a_model_that_does_not_support_a_case_gives_the_reason(hard: Hard) -> None:
    missing = [model for model in MODELS if model not in hard.models]
    named, _, reason = hard.absent.partition(": ")
    assert named == ", ".join(missing)
    assert bool(reason) == bool(missing)


@pytest.mark.parametrize("model", MODELS)
def test_a_case_that_is_said_to_end_otherwise_is_a_fault(model: str) -> None:
    base = find("base")
    record = Record(
        name="base",
        model=model,
        status="converged",
        reason="",
        angle_deg=180.0,
        pressure_kpa=180.0,
        steps=3,
        cutbacks=0,
        iterations=9,
        least_det_f=0.9,
        modes=0,
        gap=1e-5,
        warnings=[],
        checks=[("ratio", 1.0, 0.9, 1.1)],
        seconds=1.0,
        faults=[],
    )
    assert faults(base, record) == []
    wrong: dict[str, Any] = {
        "status": "failed",
        "modes": 1,
        "gap": 0.1,
        "checks": [("ratio", float("nan"), 0.9, 1.1)],
    }
    for name, value in wrong.items():
        assert len(faults(base, dataclasses.replace(record, **{name: value}))) == 1
    refused = dataclasses.replace(base, refused={model: "collapses"}, warns=("limit",))
    assert len(faults(refused, record)) == 2


def test_names_are_unique() -> None:
    names = [hard.name for hard in HARD]
    assert len(set(names)) == len(names)
