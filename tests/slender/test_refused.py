"""What a rod cannot have is refused by name, and nothing is left out in silence."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from fiberbend.case.case import Case
from fiberbend.control.rod_plant import rod_of
from fiberbend.models.choice import MODELS, choose_model, objection
from fiberbend.plan.doubts import doubts
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError
from fiberbend.sectionlaw import store, table
from fiberbend.sectionlaw.range import Loads, loads_of, loads_on
from fiberbend.sectionlaw.store import Store
from fiberbend.slender.beside import section_case
from fiberbend.slender.kept import laws_to_make
from fiberbend.slender.laws import SPACE, section_law, strains_of, twists_by_itself, zone_names
from rod.table import NotReachedError
from tests.slender.rods import DENSITY, QUIET, ROUND, RUBBER, WOUND, case, spec
from tests.trial.cases import shipped

PRESSED = {"pressure": {"to": "20 kPa"}}


@pytest.mark.parametrize(
    ("effects", "changes", "line"),
    [
        ([PRESSED, {"straight": {}}], {}, "effects.1.straight: model rod does not support it"),
        ([{"hold": {"bend": "10 deg"}}], {}, "effects.0.hold: model rod does not support it"),
        ([{"gravity": {"direction": "-y"}}], {}, "expected effect pressure with one"),
        ([PRESSED], {"output": QUIET | {"fields": True}}, "output.fields: model rod does not"),
        ([PRESSED], {"accuracy": "1 %"}, "but model rod has no known error"),
        (
            [{"pressure": {"angle": "20 deg"}}],
            {"zones": [{"length": "50 mm", "floor": RUBBER}, {"length": "50 mm"}]},
            "effects.0.pressure.angle: model rod does not support it",
        ),
        (
            [{"pressure": {"volume": "9 ml"}}],
            {"zones": [{"length": "50 mm", "floor": RUBBER}, {"length": "50 mm"}]},
            "effects.0.pressure.volume: model rod does not support it",
        ),
    ],
)
def test_what_it_cannot_have_is_refused_by_name(
    effects: list[dict[str, Any]], changes: dict[str, Any], line: str
) -> None:
    with pytest.raises(CaseError) as refused:
        case(*effects, **changes)
    assert line in str(refused.value)


MOVES = {"duration": "1 s", "pressure": {"ramp": {"to": "20 kPa", "over": "0.1 s"}}}
HANDED = {"winding": WOUND | {"pattern": "single-helix-left"}}


def test_a_winding_with_a_hand_is_a_rod_in_space() -> None:
    handed = parse_case(spec() | {"effects": [PRESSED, HANDED]})
    assert strains_of(handed) == SPACE
    assert make_plan(handed).unknowns == 4 * (48 + 2 * 4)
    assert choose_model(parse_case(handed.resolved() | {"model": "auto"}))[0].name != "rod"


def test_a_rod_that_twists_by_itself_does_not_shear() -> None:
    """Weight makes no shears of it: they are known about rest alone, and it is far from there."""
    data = spec() | {"effects": [PRESSED, HANDED, {"gravity": {"direction": "-y"}}]}
    for material in data["materials"].values():
        material["density"] = DENSITY
    heavy = parse_case(data)
    assert strains_of(heavy) == strains_of(heavy, touched=True) == SPACE
    assert make_plan(heavy).unknowns == 4 * (48 + 2 * 4)


def test_a_twisting_rod_is_no_plant() -> None:
    with pytest.raises(CaseError, match=r"plant rod: a motion is known .* keep to their plane"):
        rod_of(parse_case(spec() | {"effects": [PRESSED, HANDED]}), 0.3)


@pytest.mark.parametrize(
    ("effects", "changes", "line"),
    [
        ([{"blocked-tip": {}}], {}, "effects.2.blocked-tip: model rod does not support it"),
        ([], {"time": MOVES}, "time: model rod does not support it"),
    ],
)
def test_what_a_twisting_rod_cannot_have(
    effects: list[dict[str, Any]], changes: dict[str, Any], line: str
) -> None:
    data = spec(PRESSED, **changes)
    data["effects"] = [PRESSED, HANDED, *effects]
    with pytest.raises(CaseError) as refused:
        parse_case(data)
    assert line in str(refused.value)


def test_what_twists_and_has_a_slack_strip_is_refused() -> None:
    """Each by itself has a law, and zones may have one each: the thumb is a rod."""
    data = shipped("thumb") | {"model": "rod"}
    assert twists_by_itself(parse_case(data))
    data["zones"][2]["strip"] = data["zones"][1]["strip"]
    with pytest.raises(CaseError, match="twists by itself and has slack fabric"):
        parse_case(data)


def test_one_line_makes_a_body_of_it() -> None:
    """Mesh and solver of the body are of no use to the rod, and `plan` says so."""
    given = {
        "mesh": {"axial": "8 mm", "section": 1},
        "solver": {"tolerance": 1e-9, "max_turn": "5 deg"},
    }
    weight = {"gravity": {"direction": "-y"}}
    rod, body = (case(weight, PRESSED, model=name, **given) for name in ("rod", "body"))
    assert choose_model(rod)[0].name == "rod"
    assert choose_model(body)[0].name == "body"
    text = " ".join(make_plan(rod).lines())
    assert "mesh.axial, mesh.section, solver.tolerance" in text
    assert "solver.max_turn" not in text


@pytest.mark.parametrize(
    "name", ["rod", "free_bending", "grasp", "blocked_tip", "rectangle", "extending"]
)
def test_a_shipped_case_is_a_rod_by_one_line(name: str) -> None:
    """And nothing else of it changes but the fields, which a rod does not have."""
    given = shipped(name)
    rod, body = (parse_case(given | {"model": model}).resolved() for model in ("rod", "body"))
    for each in (rod, body):
        del each["model"]
        each["output"].pop("fields", None)
        # each model completes its own mesh
        each.pop("mesh", None)
    assert rod == body


def test_the_plan_tells_steps_and_time() -> None:
    plan = make_plan(case({"pressure": {"angle": "90 deg"}}))
    assert plan.model == "rod"
    assert plan.unknowns == 112
    assert plan.steps == 9
    assert plan.seconds is not None
    assert plan.seconds < 10


def auto(*effects: dict[str, Any]) -> Case:
    return case(*effects, model="auto")


def test_auto_takes_it_where_it_is_beside_a_body() -> None:
    """Under a weight in its plane; not for fields, nor where nobody has measured it."""
    weight = {"gravity": {"direction": "-y"}}
    weighed = auto(weight, PRESSED)
    assert choose_model(weighed)[0].name == "rod"
    assert not weighed.output.fields
    assert parse_case(weighed.resolved()) == weighed
    assert not any("leaves out" in line for line in doubts(weighed))
    fields = case(weight, PRESSED, model="auto", output=QUIET | {"fields": True})
    assert choose_model(fields)[0].name == "body"
    assert fields.output.fields
    steps = case(weight, PRESSED, model="auto", output=QUIET | {"field_steps": "all"})
    found = objection(steps, MODELS["rod"])
    assert found is not None
    assert found[0] == "output.field_steps"


def test_the_plan_says_what_is_not_measured() -> None:
    """A round tube under its weight is no case that has been put beside a body."""
    actuator = ROUND["actuator"] | {"floor": "1 mm"}
    tube = case({"gravity": {"direction": "-y"}}, PRESSED, model="auto", actuator=actuator)
    assert choose_model(tube)[0].name == "body"
    assert list(MODELS["rod"].refuses(tube)) == []
    text = " ".join(make_plan(tube).lines())
    assert "rod is not measured for actuator.section" in text


def test_cases_that_share_a_section_share_its_law(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A law is of section and pressure: a direction of the weight makes no other one."""
    monkeypatch.setattr(store, "Store", lambda: Store(tmp_path / "tables"))
    weighed = [case({"gravity": {"direction": d}}, PRESSED) for d in ("-y", "+y", "-z")]
    one, seconds = laws_to_make(weighed)
    assert one == 1
    assert seconds > 0
    further = case({"gravity": {"direction": "-y"}}, {"pressure": {"to": "30 kPa"}})
    assert laws_to_make([*weighed, further])[0] == 2
    body = case({"gravity": {"direction": "-y"}}, PRESSED, model="body")
    assert laws_to_make([body]) == (0, 0)


def test_a_law_reaches_as_far_as_the_loads_that_it_bears() -> None:
    """A thin tube as far as its own; whoever moves or touches as far as usual."""
    thin = ROUND | {"actuator": ROUND["actuator"] | {"radius": "3 mm", "wall": "1 mm"}}

    def loads(*effects: dict[str, Any], **changes: Any) -> Loads:
        return loads_on(case(*effects, PRESSED, **thin, **changes))

    bare = loads()
    assert not bare.held
    weight = bare.force
    assert weight == pytest.approx(loads_of(case(PRESSED, **thin)).force - 0.2)
    pulled = loads({"tip-load": {"force": ["0 N", "0.03 N", "0.04 N"]}})
    assert pulled.force == pytest.approx(weight + 0.05)
    assert pulled.moment == pytest.approx(bare.moment + 0.05 * 120.0)
    turned = loads({"tip-load": {"moment": ["-3 N mm", "0 N mm", "0 N mm"]}})
    assert turned.moment == pytest.approx(bare.moment + 3.0)
    hung = loads({"gravity": {"direction": "-y"}}, {"tip-mass": {"mass": "10 g"}})
    assert hung.force == pytest.approx(weight + 0.0981, rel=1e-3)
    assert loads_on(case(PRESSED)) == loads_of(case(PRESSED)), "the usual ones of a stout one"
    ramp = {"ramp": {"to": "20 kPa", "over": "0.1 s"}}
    moving = spec(PRESSED, time={"duration": "0.1 s", "pressure": ramp}, **thin)
    assert loads_on(parse_case(moving)).held


def test_a_message_names_the_law_that_it_speaks_of(monkeypatch: pytest.MonkeyPatch) -> None:
    """An option that a run does not have is not blamed, and no zone where there is none."""

    def fails(*_: Any, **__: Any) -> Any:
        raise NotReachedError("forces of the table are off")

    reach = SimpleNamespace(free=((0.02, None),), remarks=())
    monkeypatch.setattr(table, "reach_of", lambda *_: reach)
    monkeypatch.setattr(table, "Held", lambda *_: None)
    monkeypatch.setattr(table, "box_of", fails)
    monkeypatch.setattr(Store, "find", lambda *_: None)
    with pytest.raises(CaseError, match="model: the law of the chamber: forces of the table"):
        section_law(case(PRESSED), ("stretch", "curvature"))
    with pytest.raises(CaseError, match="--error: forces of the table"):
        table.table_of(section_case(case(PRESSED)))
    assert zone_names(3) == ("zone 1", "zone 2", "zone 3")
