"""What an accuracy chooses: the cheapest that can be promised, and what is given stays."""

import pytest

from fiberbend.accuracy.choice import NEAR, candidates, chosen, picked
from fiberbend.accuracy.words import expected_lines
from fiberbend.models.choice import choose_model
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.schema.problems import CaseError
from tests.accuracy.test_budget import case
from tests.conftest import ROOT

OPEN = {
    "model": "auto",
    "effects__1__winding": "{pattern: double-helix, pitch: 3 mm, fiber: kevlar}",
}


def test_model_mesh_and_winding_are_chosen() -> None:
    loose, tight = (case(accuracy=f"{asked} %", **OPEN) for asked in (8, 3))
    assert loose.model == "section"
    assert loose.turns is not None
    assert not loose.turns.discrete
    assert tight.model == "cell"
    assert tight.turns is not None
    assert tight.turns.discrete
    assert tight.mesh.axial < 1.5 / 2
    assert choose_model(tight)[1] == "chosen for its accuracy"


def test_nothing_cheaper_would_do() -> None:
    unchosen = read_case(ROOT / "cases" / "section.yaml")
    for asked in (8.0, 3.0):
        made = case(accuracy=f"{asked} %", **OPEN)
        ways = candidates(unchosen.model_copy(update={"model": "auto", "accuracy": asked}))
        assert [way.seconds for way in ways] == sorted(way.seconds for way in ways)
        way = chosen(made)
        assert way is not None
        assert way.estimate.meets(asked)
        cheaper = [each for each in ways if each.seconds < way.seconds and each.affordable]
        assert not any(each.estimate.meets(asked) for each in cheaper)


def test_a_chosen_case_reads_back_as_given() -> None:
    made = case(accuracy="3 %", **OPEN)
    assert picked(made)
    again = parse_case(made.resolved())
    assert again == made
    assert not picked(again)
    # chosen once more, nothing changes
    assert parse_case(again.resolved()) == made


def test_what_is_given_stays() -> None:
    given = case(accuracy="0.5 %", model="auto", mesh__section=1, mesh__axial="1.5 mm")
    assert (given.mesh.section, given.mesh.axial) == (1, 1.5)
    assert given.turns is not None
    assert not given.turns.discrete, "the case says as: smeared"
    assert case("cell", accuracy="8 %").model == "cell"
    only = case("cell", accuracy="1 %", mesh__section=2)
    assert only.mesh.section == 2


def test_a_given_model_gets_its_mesh() -> None:
    loose, tight = (
        case("cell", accuracy=f"{asked} %", actuator__length="1600 mm",
             effects__0__pressure__angle="720 deg", output="{}")
        for asked in (5, 0.6)
    )  # fmt: skip
    assert loose.model == tight.model == "cell"
    assert loose.mesh.axial > tight.mesh.axial


def test_a_box_takes_no_calibrated_winding() -> None:
    """Its thread is straight apart from corners, and presses on these only."""
    settings = {"effects__1__winding": OPEN["effects__1__winding"], "output": "{}"}
    box, half = (
        case(name, accuracy="1 %", **{**OPEN, **settings}) for name in ("rectangle", "section")
    )
    for made, able in ((box, False), (half, True)):
        open_case = made.model_copy(update={"model": "auto"})
        kinds = {w.case.turns.bulges for w in candidates(open_case) if w.case.turns is not None}
        assert (True in kinds) == able


def test_without_an_accuracy_nothing_changes() -> None:
    made = case()
    assert made.accuracy is None
    assert not picked(made)
    assert made.mesh.section == 2
    assert list(expected_lines(made)) == []
    assert "accuracy" not in dict(make_plan(made).rows)


def test_where_none_can_be_promised_the_cheapest_near_the_best_is_taken() -> None:
    made = case(accuracy="0.1 %", **OPEN)
    way = chosen(made)
    assert way is not None
    assert not way.estimate.meets(0.1)
    ways = candidates(case(accuracy="20 %", **OPEN).model_copy(update={"model": "auto"}))
    able = [each for each in ways if each.affordable]
    least = min(each.estimate.total for each in able)
    assert way.estimate.total <= NEAR * least
    lines = dict(make_plan(made).rows)["accuracy"]
    assert "cannot be promised" in lines[0]


def test_the_plan_says_what_was_chosen_and_why() -> None:
    plan = make_plan(case(accuracy="3 %", **OPEN))
    rows = dict(plan.rows)
    assert rows["model"] == ("cell (chosen for its accuracy)",)
    first, way, *others = rows["accuracy"]
    assert first.startswith("3 % asked, about ")
    assert first.endswith("promised")
    assert way.startswith("cell, section ")
    assert any(line.startswith("section, ") for line in others)
    assert "error" not in rows


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"accuracy": "1"}, "with its unit"),
        ({"accuracy": "0.01 %"}, "from 0.1 % to 20 %"),
        ({"accuracy": "30 %"}, "from 0.1 % to 20 %"),
        ({"accuracy": "1 mm"}, "with its unit"),
        ({"accuracy": "-1 %"}, "above zero"),
        ({"accuracy": "1 %", "model": "analytic"}, "closed form has no known error"),
    ],
)
def test_refused(settings: dict[str, str], words: str) -> None:
    with pytest.raises(CaseError) as error:
        case(**settings)
    assert any(p.path == "accuracy" and words in p.text for p in error.value.problems)


def test_no_pressure_no_accuracy() -> None:
    with pytest.raises(CaseError) as error:
        read_case(
            ROOT / "cases" / "grasp.yaml",
            {
                "accuracy": "1 %",
                "effects": [{"gravity": {"direction": "-y"}}],
                "output": {},
                "compare": [],
                "materials.floor": {"law": "yeoh", "c1": "7.9 MPa", "density": "1.2 g/cm^3"},
            },
        )
    assert any(p.path == "accuracy" for p in error.value.problems)
