"""An effect of which nothing is known but its name: refused by all models but a whole body."""

from __future__ import annotations

from pathlib import Path

import pytest

from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.effects.effect import Effect
from fiberbend.effects.pressure import inflate
from fiberbend.models.choice import MODELS, choose_model, problems
from fiberbend.plan.estimate import steps_of
from fiberbend.plan.plan import make_plan
from fiberbend.reader.checks import ValidParts, check
from fiberbend.reader.defaults import complete
from fiberbend.reader.reader import read_case
from fiberbend.running.warm import section_guides

ROOT = Path(__file__).resolve().parents[2]
PATH = "effects.2.tip-load"


class TipLoad(Effect):
    """All that a contributor has written so far."""

    name = "tip-load"
    load = True


def case(model: str) -> Case:
    """The baseline with the effect, as the reader would leave it."""
    base = read_case(ROOT / "cases" / "free_bending_smeared.yaml", ["output={}"])
    made = base.model_copy(update={"effects": (*base.effects, TipLoad()), "model": model})
    assert list(check(ValidParts.of(made))) == []
    return complete(made)


@pytest.mark.parametrize("model", [name for name in MODELS if name != "body"])
def test_every_model_but_the_body_refuses_it_by_name(model: str) -> None:
    (problem,) = problems(case(model))
    path, text = problem
    assert path == PATH
    assert (
        text
        == f"model {model} does not support it: only a body in space is known to support tip-load"
    )


def test_auto_takes_the_whole_body_and_plan_says_so() -> None:
    chosen = case("auto")
    assert list(problems(chosen)) == []
    model, _ = choose_model(chosen)
    assert model.name == "body"
    assert model.half(chosen) == (False, "tip-load is not known to be mirror-symmetric")
    plan = make_plan(chosen)
    assert plan.model == "body"
    assert plan.steps is None
    text = " ".join("\n".join(plan.lines()).split())
    for name in ("analytic", "section", "cell"):
        assert (
            f"{name} does not support {PATH}: only a body in space is known to support tip-load"
            in text
        )
    assert "full (tip-load is not known to be mirror-symmetric)" in text


def test_no_phase_takes_it_for_granted() -> None:
    body = case("body")
    elements = choose_model(body)[0].elements()
    assert elements is not None
    # no guide by a section that does not bend so, no such effect in the section beside, and said
    assert not section_guides(body)
    beside = as_section(body, inflate(angle=1.0))
    assert [effect.name for effect in beside.effects] == ["pressure", "winding"]
    assert body.effects[2].alone() == "tip-load acts"
    assert steps_of(body, elements) is None


def test_it_is_not_built_as_nothing() -> None:
    with pytest.raises(NotImplementedError, match="tip-load cannot be built"):
        TipLoad().build(None, None, None)  # type: ignore[arg-type]
