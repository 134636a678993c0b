"""An effect of which nothing is known but its name: refused by all models but a whole body."""

from __future__ import annotations

from pathlib import Path

import pytest

from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section, section_guides
from fiberbend.control.command import left_out
from fiberbend.effects.effect import Effect
from fiberbend.effects.pressure import inflate
from fiberbend.models.choice import MODELS, choose_model, problems
from fiberbend.models.model import ModelKind
from fiberbend.plan.estimate import steps_of
from fiberbend.plan.plan import make_plan
from fiberbend.reader.checks import ValidParts, check
from fiberbend.reader.defaults import complete
from fiberbend.reader.reader import read_case

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


class Lopsided(TipLoad):
    """One that a section is said to have, and of whose symmetry nothing is said."""

    name = "lopsided"

    def needs(self) -> dict[str, str]:
        """Nothing in particular."""
        return {}


@pytest.mark.parametrize("name", ["section", "cell"])
def test_what_may_not_be_symmetric_has_every_unknown(name: str) -> None:
    base = case(name)
    made = base.model_copy(update={"effects": (*base.effects[:2], Lopsided())})
    assert list(problems(made)) == []
    model = MODELS[name].elements()
    assert model is not None
    half, why = model.half(made)
    assert not half
    assert why == (
        "none: it bends about x and y and twists, its section warps (lopsided is not known to be "
        "mirror-symmetric; lopsided is not known to be alike forward and backward)"
    )
    assert model.size(made).scalars == ("curvature", "stretch", "side_curvature", "twist")


def test_control_has_no_effect_that_it_does_not_know() -> None:
    (problem,) = left_out(case("body"))
    assert str(problem).startswith(f"{PATH}: control bends the actuator freely, without it")


def test_a_model_that_says_nothing_supports_nothing() -> None:
    class Bare(ModelKind):
        name = "bare"

    base = case("body")
    refused = [path for path, _ in Bare().refuses(base)]
    assert refused == ["effects.0.pressure", "effects.1.winding", PATH]


def test_its_error_is_not_known() -> None:
    text = " ".join(" ".join(make_plan(case("body")).lines()).split())
    assert "tip-load: what it adds to the error is not known" in text
