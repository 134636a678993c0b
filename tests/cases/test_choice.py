"""The cheapest model that a case allows, and what a case leaves to the model.

A user of `auto` wants the fastest answer that supports everything in the case: a model
too cheap answers another question, one too dear costs minutes.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from fiberbend.case.case import Case
from fiberbend.effects.winding import WindingEffect
from fiberbend.models.choice import (
    MODELS,
    choose_model,
    objection,
)
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.schema.problems import CaseError
from tests.cases.bad_cases import BLOCKED, HOOPS, SMEARED, WEIGHT

ROOT = Path(__file__).resolve().parents[2]
BASELINE = ROOT / "cases" / "free_bending.yaml"
SINGLE = "effects.1.winding.pattern=single-helix-left"
TABLE = "effects.2={contact: {plane: {point: [0 mm, -30 mm, 0 mm], normal: [0, 1, 0]}}}"
BULK = "materials.wall={name: elastosil-m4601, bulk: 200 MPa}"


def case(*settings: str) -> Case:
    return read_case(BASELINE, settings)


def winding(case: Case) -> WindingEffect:
    found = case.find(WindingEffect)
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("settings", "model"),
    [
        ([HOOPS], "analytic"),
        ([HOOPS, "effects.2.straight={}", "output={}"], "analytic"),
        ([SMEARED], "section"),
        ([SMEARED, SINGLE], "section"),
        ([SMEARED, BULK], "section"),
        ([SMEARED, "effects.0={pressure: {volume: 40 mL}}"], "section"),
        ([SMEARED, "effects.2.straight={}", "output={}"], "section"),
        (["effects=[{pressure: {to: 10 kPa}}]"], "section"),
        ([SMEARED, "materials.floor=elastosil-m4601"], "section"),
        ([], "cell"),
        ([SINGLE], "cell"),
        (["effects.2.straight={}", "output={}"], "cell"),
        ([SMEARED, BLOCKED], "body"),
        ([BLOCKED], "body"),
        ([SMEARED, *WEIGHT], "rod"),
        ([SMEARED, "effects.2={tip-load: {moment: [50 N mm, 0 N mm, 0 N mm]}}"], "rod"),
        ([SMEARED, "effects.2={tip-load: {moment: [0 N mm, 5 N mm, 0 N mm]}}"], "body"),
        ([SMEARED, TABLE], "body"),
        ([SMEARED, *WEIGHT, "effects.2.gravity.direction=+x"], "body"),
        ([SMEARED, "effects.2={tip-load: {moment: [60 N mm, 0 N mm, 0 N mm]}}"], "body"),
        ([SMEARED, "effects.2={tip-load: {force: [0 N, -0.2 N, 0 N]}}"], "rod"),
        ([SMEARED, "effects.2={tip-load: {force: [0 N, -0.2 N, 0.1 N]}}"], "body"),
        ([SMEARED, "effects.2={tip-load: {force: [0 N, -0.1 N, 0 N], follows: true}}"], "body"),
        ([SMEARED, *WEIGHT, "effects.3={tip-mass: {mass: 20 g}}"], "rod"),
        ([SMEARED, *WEIGHT, "effects.3={tip-mass: {mass: 30 g}}"], "body"),
        ([SMEARED, *WEIGHT, "effects.2.gravity.acceleration=20 m/s^2"], "body"),
        ([SMEARED, *WEIGHT, "output.fields=true"], "body"),
        ([SMEARED, *WEIGHT, "output.field_steps=all"], "body"),
        ([SMEARED, *WEIGHT, "mesh.element=tetrahedron"], "body"),
        (WEIGHT, "rod"),
        (["effects.1.winding.as=calibrated", *WEIGHT], "body"),
        ([SMEARED, "mesh.element=tetrahedron"], "body"),
    ],
    ids=str,
)
def test_auto_takes_the_cheapest_that_supports_everything(settings: list[str], model: str) -> None:
    automatic = case("model=auto", *settings)
    assert choose_model(automatic)[0].name == model
    cheaper = itertools.takewhile(lambda name: name != model, MODELS)
    assert all(objection(automatic, MODELS[name]) for name in cheaper)
    # what was chosen can be asked for by name, and is then the same case
    said = case(f"model={model}", *settings)
    assert said.model_copy(update={"model": "auto"}) == automatic
    assert parse_case(automatic.resolved()) == automatic


@pytest.mark.parametrize(
    ("model", "kind"),
    [
        ("analytic", "smeared"),
        ("section", "smeared"),
        ("cell", "discrete"),
        ("body", "discrete"),
        ("auto", "discrete"),
    ],
)
def test_one_case_file_for_all_models(model: str, kind: str) -> None:
    """Where the file leaves `as` out, each model has the winding as finely as it can."""
    resolved = case(f"model={model}")
    assert winding(resolved).representation == kind
    assert parse_case(resolved.resolved()) == resolved
    assert winding(case(f"model={model}", SMEARED)).representation == "smeared"


def test_a_ribbon_means_a_discrete_winding() -> None:
    assert winding(case("model=auto", "effects.1.winding.lines=3")).lines == 3
    ribbon = case("model=auto", "effects.1.winding.width=0 mm")
    assert choose_model(ribbon)[0].name == "cell"


def test_what_a_closed_form_leaves_out_is_said_but_not_refused() -> None:
    closed = MODELS["analytic"]
    paths = [path for path, _ in closed.leaves_out(case("model=analytic", BLOCKED, BULK))]
    assert paths == ["effects.1.winding", "effects.2.blocked-tip", "materials.wall.bulk"]
    assert list(closed.leaves_out(case("model=auto", HOOPS))) == []


def test_a_closed_form_is_not_chosen_for_what_poissons_ratio_says() -> None:
    """The ratio stands for a bulk modulus, without the key `bulk`."""
    wall = "materials.wall={young: 1 MPa, poisson: 0.3}"
    found = list(MODELS["analytic"].leaves_out(case("model=analytic", wall)))
    assert "materials.wall.poisson" in [path for path, _ in found]
    whole = "materials.wall={young: 1 MPa, poisson: 0.5}"
    assert choose_model(case("model=auto", HOOPS, whole))[0].name == "analytic"
    with pytest.raises(CaseError, match=r"analytic not materials\.wall\.poisson"):
        case("model=auto", HOOPS, wall)


def choose_half(case: Case) -> tuple[bool, str]:
    return choose_model(case)[0].half(case)


def test_half_or_full() -> None:
    assert choose_half(case()) == (
        True,
        "section, winding and loads are mirror-symmetric about x = 0",
    )
    assert choose_half(case(SINGLE)) == (False, "a single helix is not its own mirror image")
    assert choose_half(case("model=cell", SINGLE))[0] is False
    # half a turn about y maps a section onto itself, whatever its winding
    assert choose_half(case("model=section", SMEARED, SINGLE))[0] is True
    assert choose_half(case("mesh.symmetry=full")) == (False, "given in the case")
    assert choose_half(case(*WEIGHT, "effects.2.gravity.direction=+x"))[0] is False


@pytest.mark.parametrize("pitch", [3.0, 3.9, 3.3, 5.1])
def test_the_coarsest_mesh_that_counts_hangs_on_no_quotient(pitch: float) -> None:
    # elements of 4/3 of the pitch give 0.2 of the bulging; 5.2/3.9 rounds to a little more
    coarse = case(f"effects.1.winding.pitch={pitch} mm", f"mesh.axial={4 / 3 * pitch:.10g} mm")
    assert MODELS["body"].resolved_bulging(coarse) == pytest.approx(0.2, rel=1e-6)
