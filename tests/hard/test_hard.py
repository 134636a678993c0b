"""Every hard case ends as its table says: reached, or refused with its physical reason."""

from __future__ import annotations

import pytest

from tests.hard.cases import HARD, MODELS, Hard, find
from tests.hard.solve import solve

ALL = [
    pytest.param(
        hard.name,
        model,
        marks=() if model in hard.fast else pytest.mark.hard,
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
def test_a_case_says_why_a_model_cannot_hold_it(hard: Hard) -> None:
    missing = set(MODELS) - set(hard.models)
    assert all(f"{model}:" in hard.absent for model in missing)
    assert missing or not hard.absent


def test_names_are_unique() -> None:
    names = [hard.name for hard in HARD]
    assert len(set(names)) == len(names)
