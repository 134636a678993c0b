"""The case schema: what it reads, fills in, writes back and refuses."""

from __future__ import annotations

import copy
import json
import math
import typing
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.case import convert
from fiberbend.case.case import Case, MaterialSpec
from fiberbend.effects.table import (
    EFFECTS,
    GravityEffect,
    PressureEffect,
    WindingEffect,
)
from fiberbend.reader.json_schema import json_schema
from fiberbend.reader.reader import (
    as_case,
    parse_case,
    read_case,
)
from fiberbend.schema.problems import CaseError
from materials.laws.table import LAWS
from tests.cases import bad_cases, contradictions

ROOT = Path(__file__).resolve().parents[2]
CASES = sorted((ROOT / "cases").glob("*.yaml"))
BASELINE = ROOT / "cases" / "free_bending.yaml"


def complaint(settings: list[str]) -> list[str]:
    with pytest.raises(CaseError) as error:
        read_case(BASELINE, settings)
    return str(error.value).splitlines()


@pytest.fixture
def data() -> dict[str, Any]:
    loaded: dict[str, Any] = yaml.safe_load(BASELINE.read_text(encoding="utf-8"))
    return loaded


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_example_cases_are_valid_and_round_trip(path: Path) -> None:
    case = read_case(path)
    assert parse_case(case.resolved()) == case
    assert parse_case(yaml.safe_load(yaml.safe_dump(case.resolved()))) == case


def test_baseline_in_internal_units() -> None:
    case = read_case(BASELINE)
    assert case.actuator.radius == 8.0
    assert case.find(PressureEffect) == PressureEffect.model_construct(to=0.2, volume=None)
    winding = case.find(WindingEffect)
    assert winding is not None
    assert (winding.pitch, winding.representation) == (3.0, "discrete")
    assert case.output.at_angles == pytest.approx([math.pi / 2, math.pi, 2 * math.pi])
    assert case.find(GravityEffect) is None


def test_defaults_appear_in_the_resolved_case(data: dict[str, Any]) -> None:
    data.pop("mesh", None)
    del data["output"], data["actuator"]["cap"], data["model"]
    resolved = parse_case(data).resolved()
    assert resolved["actuator"]["cap"] == "15 mm"
    # auto takes a cell here: four layers in half a pitch are its default
    assert resolved["mesh"] == {
        "element": "hexahedron",
        "axial": "0.375 mm",
        "section": 1,
        "symmetry": "auto",
    }
    assert resolved["model"] == "auto"
    assert parse_case(data | {"model": "body"}).resolved()["mesh"] == {
        "element": "hexahedron",
        "axial": "1.5 mm",
        "section": 1,
        "symmetry": "auto",
    }
    winding = resolved["effects"][1]["winding"]
    assert (winding["width"], winding["lines"], winding["fiber"]) == ("0.38 mm", 5, "kevlar")


@pytest.mark.parametrize(
    "settings",
    [
        ["effects.0={pressure: {volume: 45 mL}}"],
        ["effects.0.pressure.to=-20 kPa"],
        ["effects.1.winding.width=0 mm"],
        ["effects.1.winding.fiber={modulus: 3 GPa, diameter: 0.2 mm}"],
        ["effects.1.winding.pitch=0.1 in", "solver.max_step=5 psi"],
        ["materials.wall={law: yeoh, c1: 0.11 MPa, c2: -20 Pa, bulk: 200 MPa}"],
        ["materials.wall={name: elastosil-m4601, bulk: 200 MPa}"],
        ["materials.wall={law: gent, mu: 0.3 MPa, jm: 50}"],
        ["materials.wall={law: ogden, mu1: 0.3 MPa, alpha1: 1.3, mu2: -1 kPa, alpha2: -2.5}"],
        ["actuator.layer=0.1 mm", "materials.layer={law: neo-hooke, mu: 1 GPa}"],
        ["actuator.sheath=", "materials.sheath="],
        ["effects.2.gravity.direction=-x", "materials.floor={law: neo-hooke, mu: 1 MPa, "
         "density: 1100 kg/m^3}"],
        ["effects=[{gravity: {direction: -y}}]", "output.at_angles=[]",
         "materials.floor={name: combined-base, density: 1.2 g/cm^3}"],
        ["output.stop_at_angle=360 deg", "output.at_pressures=[100 kPa]"],
        ["model=auto", "mesh.element=tetrahedron", "mesh.section=2"],
        ["effects.0={pressure: {angle: 360 deg}}", "output={}", "solver.max_turn=20 deg"],
        ["model=auto", "effects.1={hoops: {}}"],
        ["model=analytic"],
        ["model=section", "effects.1.winding.tension_only=true"],
        ["model=cell", "effects.2.straight={stretch: held}", "output={}"],
    ],
    ids=lambda settings: settings[0],
)  # fmt: skip
def test_valid_variants_round_trip(settings: list[str]) -> None:
    case = read_case(BASELINE, settings)
    assert parse_case(case.resolved()) == case


@pytest.mark.parametrize(("setting", "line"), bad_cases.BAD_SETTINGS)
def test_wrong_input_is_named(setting: str, line: str) -> None:
    lines = complaint([setting])
    assert any(text.startswith(line) for text in lines), lines


@pytest.mark.parametrize(("settings", "line"), contradictions.CONTRADICTIONS)
def test_a_contradiction_names_both_sides(settings: list[str], line: str) -> None:
    lines = complaint(settings)
    assert any(text.startswith(line) for text in lines), lines


@pytest.mark.parametrize(("setting", "path", "bound", "meant"), contradictions.UNIT_SLIPS)
def test_a_slip_of_the_unit_is_asked_back(setting: str, path: str, bound: str, meant: str) -> None:
    (line,) = (text for text in complaint([setting]) if text.startswith(f"{path}: "))
    assert bound in line
    assert line.endswith(f'; did you mean "{meant}"?')


@pytest.mark.parametrize("unit", ["um", "mm", "m"])
@pytest.mark.parametrize("model", ["section", "cell", "body"])
def test_micrometres_and_metres_are_legal(unit: str, model: str, data: dict[str, Any]) -> None:
    text = json.dumps(data | {"model": model, "mesh": {}}).replace(' mm"', f' {unit}"')
    scaled = json.loads(text)
    scaled["actuator"]["cap"] = f"15 {unit}"
    if model == "body":
        scaled["mesh"] = {"axial": f"1.5 {unit}"}
    scaled["effects"][1]["winding"]["fiber"] = {"modulus": "31 GPa", "diameter": f"0.38 {unit}"}
    assert parse_case(scaled).actuator.wall == pytest.approx({"um": 2e-3, "mm": 2, "m": 2e3}[unit])


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_rubber_of_any_stiffness_is_legal(factor: float) -> None:
    mu = f"{{law: neo-hooke, mu: {0.22 * factor} MPa}}"
    settings = [f"materials.{part}={mu}" for part in ("wall", "floor", "sheath")]
    thread = f"{{modulus: {31e3 * factor} MPa, diameter: 0.38 mm}}"
    read_case(
        BASELINE,
        [
            *settings,
            f"effects.0.pressure.to={0.2 * factor} MPa",
            f"effects.1.winding.fiber={thread}",
        ],
    )


@pytest.mark.parametrize(
    ("setting", "word"),
    [
        ("effects.1.winding.pich=3 mm", "pitch"),
        ("effects.2.gravty.direction=-y", "gravity"),
        ("actuatr=1", "actuator"),
        ("actuator.Wall=2 mm", "wall"),
        ("actuator.section=hemicirle", "hemicircle"),
        ("model=bodi", "body"),
        ("materials.wall=Elastosil", "elastosil-m4601"),
        ("materials.wall={law: yoeh, c1: 1 MPa}", "yeoh"),
        ("effects.1.winding.fiber=kevlr", "kevlar"),
        ("effects.1.winding.pattern=double-helx", "double-helix"),
    ],
)
def test_a_slip_is_told_what_was_meant(setting: str, word: str) -> None:
    lines = complaint([setting])
    assert any(line.endswith(f"; did you mean {word}?") for line in lines), lines


def test_nothing_is_guessed_where_nothing_is_near() -> None:
    assert not any("did you mean" in line for line in complaint(["colour=red", "model=xyz"]))


@pytest.mark.parametrize(("settings", "line"), bad_cases.UNFIT_MODELS)
def test_model_that_does_not_support_the_case_is_refused(settings: list[str], line: str) -> None:
    lines = complaint(settings)
    assert any(text.startswith(line) for text in lines), lines


def test_all_problems_at_once(data: dict[str, Any]) -> None:
    data["actuator"]["radius"] = 8
    data["effects"][1]["winding"]["pitch"] = "0 mm"
    data["effects"].append({"pressure": {"to": "1 kPa"}})
    data["output"]["at_pressures"] = ["300 kPa"]
    data["modle"] = "body"
    with pytest.raises(CaseError) as error:
        parse_case(data)
    assert {problem.path for problem in error.value.problems} == {
        "actuator.radius",
        "effects.1.winding.pitch",
        "effects.2.pressure",
        "modle",
    }


@pytest.mark.parametrize("name", bad_cases.BAD_FILES)
def test_bad_files(name: str, tmp_path: Path) -> None:
    content, what = bad_cases.BAD_FILES[name]
    path = tmp_path / "case.yaml"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(CaseError) as error:
        read_case(path)
    (line,) = str(error.value).splitlines()
    assert line.startswith(str(path))
    assert what in line


def test_missing_file_and_folder(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="no such file, expected a case file"):
        read_case(tmp_path / "none.yaml")
    with pytest.raises(CaseError, match="expected a case file"):
        read_case(tmp_path)


def test_half_body_needs_the_mirror() -> None:
    single = "effects.1.winding.pattern=single-helix-right"
    (line,) = complaint(["mesh.symmetry=half", single])
    assert line.startswith('mesh.symmetry: "half", expected auto or full: a single helix')


def test_gravity_needs_every_density() -> None:
    (line,) = complaint(["effects.2.gravity.direction=-y"])
    assert line.startswith("materials.floor.density: missing")


def test_steps_of_pressure_need_a_pressure() -> None:
    settings = ["effects.0={pressure: {volume: 45 mL}}", "solver.first_step=1 kPa"]
    (line,) = complaint(settings)
    assert line.startswith("solver.first_step: no effect without a pressure to reach")


def test_angles_beyond_the_stop() -> None:
    (line,) = complaint(["output.stop_at_angle=200 deg"])
    assert line.startswith('output.at_angles.2: "360 deg", expected an angle up to stop_at_angle')


def test_order_of_effects_is_kept(data: dict[str, Any]) -> None:
    data["effects"].reverse()
    assert [effect.name for effect in parse_case(data).effects] == ["winding", "pressure"]


def test_a_case_is_frozen_and_comes_in_three_forms(data: dict[str, Any]) -> None:
    case = as_case(BASELINE)
    assert as_case(copy.deepcopy(data)) == as_case(case) == as_case(str(BASELINE)) == case
    with pytest.raises(ValueError, match="frozen"):
        case.actuator.radius = 9.0  # type: ignore[misc]


def test_schema_has_a_key_for_every_parameter_of_a_law() -> None:
    annotation = MaterialSpec.model_fields["law"].annotation
    (literal,) = (part for part in typing.get_args(annotation) if part is not type(None))
    assert set(typing.get_args(literal)) == set(LAWS)
    described = {name: field.description or "" for name, field in MaterialSpec.model_fields.items()}
    for law in LAWS.values():
        for parameter in law.parameters:
            assert parameter.meaning in described[parameter.name]
            assert law.name in described[parameter.name]


@pytest.mark.parametrize(
    ("zero", "plain"),
    [
        (
            ["materials.wall={law: yeoh, c1: 0.11 MPa, c2: 0 MPa, c3: 0 kPa}"],
            ["materials.wall={law: yeoh, c1: 0.11 MPa}"],
        ),
        (
            ["materials.wall={law: ogden, mu1: 1 MPa, alpha1: 2, mu2: 0 MPa, alpha2: 3}"],
            ["materials.wall={law: ogden, mu1: 1 MPa, alpha1: 2}"],
        ),
        (
            ["actuator.sheath=0 mm", "actuator.layer=0 mm", "materials.sheath="],
            ["actuator.sheath=", "materials.sheath="],
        ),
        (
            ["materials.wall={law: mooney-rivlin, c10: 1 MPa, c01: 0 Pa, density: 0 g/cm^3}"],
            ["materials.wall={law: mooney-rivlin, c10: 1 MPa}"],
        ),
        (
            ["actuator={section: circle, radius: 8 mm, length: 160 mm, wall: 2 mm, floor: 0 mm}",
             "materials.floor=", "materials.sheath="],
            ["actuator={section: circle, radius: 8 mm, length: 160 mm, wall: 2 mm}",
             "materials.floor=", "materials.sheath="],
        ),
    ],
    ids=["yeoh", "ogden", "sheath", "mooney-rivlin and density", "floor"],
)  # fmt: skip
def test_zero_is_the_same_as_left_out(zero: list[str], plain: list[str]) -> None:
    with_zero, without = read_case(BASELINE, zero), read_case(BASELINE, plain)
    assert with_zero.actuator == without.actuator
    # one actuator is one case: resumed, and the same point of a sweep
    assert with_zero.resolved() == without.resolved()
    rubbers = [convert.material(case.materials.wall) for case in (with_zero, without)]
    law = LAWS[rubbers[0].law]
    (one, used), (other, alike) = ((r.values, law.used([r.values])) for r in rubbers)
    assert used == alike
    assert [one[name] for name in used] == [other[name] for name in used]
    assert parse_case(with_zero.resolved()) == with_zero


def test_bridge_takes_what_the_case_says() -> None:
    case = read_case(
        BASELINE,
        [
            "materials.wall={name: elastosil-m4601, bulk: 200 MPa}",
            "effects.1.winding.fiber={modulus: 3 GPa, diameter: 0.2 mm}",
        ],
    )
    wall = convert.material(case.materials.wall)
    assert (wall.law, wall.parameters["c1"], wall.bulk) == ("yeoh", 0.11, 200.0)
    winding = case.find(WindingEffect)
    assert winding is not None
    assert winding.fiber is not None
    assert winding.fiber.thread().stiffness == pytest.approx(3000 * math.pi * 0.1**2)
    assert convert.dimensions(case.actuator).total_length == 190.0
    own = MaterialSpec.model_validate({"law": "neo-hooke", "mu": "1 MPa", "density": "1.1 g/cm^3"})
    assert convert.material(own).density == pytest.approx(1100.0)


def test_committed_schema_is_current() -> None:
    committed = json.loads((ROOT / "cases" / "case.schema.json").read_text(encoding="utf-8"))
    assert committed == json_schema(), "run `make schema`"


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_json_schema_takes_the_example_cases(path: Path) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(yaml.safe_load(path.read_text(encoding="utf-8")), json_schema())
    jsonschema.validate(read_case(path).resolved(), json_schema())
    wrong = read_case(path).resolved()
    wrong["actuator"]["radius"] = 8
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(wrong, json_schema())


def test_json_schema_describes_every_effect_and_shows_defaults_with_units() -> None:
    definitions = json_schema()["$defs"]
    assert set(definitions["EffectEntry"]["properties"]) == set(EFFECTS)
    assert definitions["Mesh"]["properties"]["axial"]["default"] == "1.5 mm"
    described = [
        field.get("description") for field in definitions["WindingEffect"]["properties"].values()
    ]
    assert all(described)
    assert Case.__doc__


def test_a_setting_that_a_later_one_replaces_is_refused() -> None:
    whole = "actuator={section: hemicircle, radius: 8 mm, length: 160 mm, wall: 2 mm, floor: 2 mm}"
    with pytest.raises(CaseError) as refused:
        read_case(BASELINE, ["actuator.floor=3 mm", whole, "materials.sheath="])
    (problem,) = refused.value.problems
    assert problem.path == "actuator.floor"
    assert problem.text == "no effect: actuator is set after it, expected it before"
    case = read_case(BASELINE, [whole, "actuator.floor=3 mm", "materials.sheath="])
    assert case.actuator.floor == 3
