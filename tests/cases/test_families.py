"""A winding by families in a case: what is refused, what a plan says, what is written back."""

from __future__ import annotations

from typing import Any

import pytest

from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError
from tests.run.conftest import small

HELIX = {"angle_from_axis": "70 deg", "hand": "right", "starts": 6}
HOOPS = {"angle_from_axis": "90 deg", "spacing": "3 mm"}
ALONG = {"angle_from_axis": "0 deg", "starts": 12}
PLACES = {"angle_from_axis": "0 deg", "at": ["170 deg", "180 deg", "190 deg"]}
ROPE = {"modulus": "3 GPa", "diameter": "0.5 mm"}


def case(
    *families: dict[str, Any], model: str = "section", kind: str | None = "smeared", **winding: Any
) -> dict[str, Any]:
    """The small case with families, smeared unless said."""
    given = {"families": list(families), "fiber": "kevlar", "as": kind} | winding
    kept = {key: value for key, value in given.items() if value is not None}
    return small(model=model, effects=[{"pressure": {"to": "60 kPa"}}, {"winding": kept}])


def without(given: dict[str, Any], *keys: str, **more: Any) -> dict[str, Any]:
    """A family with other entries."""
    return {key: value for key, value in given.items() if key not in keys} | more


W, F = "effects.1.winding", "effects.1.winding.families.0"
WRONG: list[tuple[dict[str, Any], str]] = [
    (case(HELIX, pattern="double-helix"), f"{W}.pattern: no effect beside families"),
    (case(HELIX, pitch="3 mm"), f"{W}.pitch: no effect beside families"),
    (case(), f"{W}.families: "),
    (case(without(HELIX, "angle_from_axis")), f"{F}: neither angle_from_axis nor pitch, expected"),
    (case(HELIX | {"pitch": "9 mm"}), f"{F}: both angle_from_axis and pitch, expected one of them"),
    (case(without(HELIX, "hand")), f"{F}.hand: missing, expected right or left"),
    (case(HELIX | {"starts": 0}), f"{F}.starts: 0, expected at least 1"),
    (case(HELIX | {"spacing": "3 mm"}), f"{F}.spacing: no effect but of hoops"),
    (case(HELIX | {"at": ["0 deg"]}), f"{F}.at: no effect but along the axis"),
    (
        case(HELIX | {"angle_from_axis": "110 deg"}),
        f'{F}.angle_from_axis: "110 deg", expected one from "0 deg" to "90 deg", and a hand',
    ),
    (case(HELIX | {"angle_from_axis": "-70 deg"}), f'{F}.angle_from_axis: "-70 deg", expected an'),
    (case(HELIX | {"turns": 3}), f"{F}.turns: unknown key, expected one of angle_from_axis, pitch"),
    (case(without(HOOPS, "spacing")), f"{F}.spacing: missing, expected the distance of hoops"),
    (case(HOOPS | {"hand": "left"}), f"{F}.hand: no effect on hoops, at 90° from the axis"),
    (case(HOOPS | {"starts": 2}), f"{F}.starts: no effect on hoops"),
    (case(ALONG | {"hand": "left"}), f"{F}.hand: no effect on threads along the axis, at 0°"),
    (case(ALONG | {"spacing": "3 mm"}), f"{F}.spacing: no effect on threads along the axis"),
    (case(PLACES | {"starts": 3}), f"{F}.starts: no effect beside `at`, expected no value"),
    (case(PLACES | {"phase": "3 deg"}), f"{F}.phase: no effect beside `at`, expected no value"),
    (case(PLACES | {"at": []}), f"{F}.at: "),
    (
        case(PLACES | {"around": "wall"}),
        f"{F}.at.0: a place on the floor, expected one on the wall",
    ),
    (case(HELIX | {"fiber": "rope"}), f'{F}.fiber: "rope", expected kevlar'),
    (case(HELIX, fiber=None), f"{W}.fiber: missing, expected a named fiber or its modulus and"),
    (case(HELIX | {"fiber": ROPE}), f"{W}.fiber: no effect where every family has its own"),
    (
        case(HELIX | {"fiber": ROPE | {"diameter": "4 mm"}}, fiber=None),
        f"{F}.starts: lays its threads over each other, 3.",
    ),
    (case(HELIX | {"starts": 60}), "apart where they are 0.38 mm wide, expected at most 49"),
    (
        case(HOOPS | {"spacing": "0.2 mm"}),
        f"{F}.spacing: lays its threads over each other, 0.2 mm apart where they are 0.38 mm wide, "
        'expected at least "0.38 mm"',
    ),
    (
        case(HOOPS, HOOPS | {"phase": "10 deg"}),
        f"{W}.families.1: lies over families.0: threads of one direction 0.0833 mm apart where "
        "they are 0.38 mm wide, expected another phase or another place",
    ),
    (case(PLACES | {"at": ["180 deg", "-180 deg"]}), f"{F}: lies over itself: threads of one"),
    (
        case(HOOPS | {"spacing": "60 mm", "phase": "300 deg"}),
        f'{F}.spacing: "60 mm", but no hoop lies on the chamber, the first one at z = 50 mm',
    ),
    (
        case(HELIX, bulging={"stiffness": "1 MPa/mm"}, kind=None),
        f"{W}.bulging: no effect beside families, expected bedding",
    ),
    (
        case(HELIX, bedding={"normal": "0 MPa", "along": "1 MPa"}, kind="calibrated"),
        f'{W}.bedding.normal: "0 MPa"',
    ),
    (
        case(HELIX, tension_only=True, kind="calibrated"),
        f"{W}.tension_only: families whose rubber yields are calibrated taut",
    ),
    (
        case(HELIX, bedding={"normal": "1 MPa", "along": "1 MPa"}, kind="smeared"),
        f"{W}.bedding: no effect on a smeared winding",
    ),
    (
        case(HELIX, kind="calibrated") | {"model": "cell"},
        f"{W}: model cell does not support it: families are calibrated in a section",
    ),
    (case(HELIX, width="1 mm"), f"{W}.width: no effect on a smeared winding"),
]


@pytest.mark.parametrize(("given", "line"), WRONG)
def test_a_wrong_family_is_refused(given: dict[str, Any], line: str) -> None:
    with pytest.raises(CaseError) as raised:
        parse_case(given)
    assert line in str(raised.value)


def test_a_wrong_family_is_named_once() -> None:
    with pytest.raises(CaseError) as error:
        parse_case(case(HELIX | {"starts": 0}))
    assert [problem.path for problem in error.value.problems] == [f"{F}.starts"]


def test_a_body_without_a_floor_has_no_wall_alone() -> None:
    given = case(HOOPS, around="wall")
    given["actuator"] = {
        "section": "circle",
        "radius": "8 mm",
        "length": "24 mm",
        "wall": "2 mm",
        "sheath": "1 mm",
    }
    del given["materials"]["floor"]
    with pytest.raises(CaseError, match=r'winding.around: "wall", but a circle has no floor'):
        parse_case(given)


@pytest.mark.parametrize("wrong", [{"pitch": "3 mm"}, {"families": [{"hand": "left"}]}])
def test_what_is_missing_is_said_where_half_is_asked_for(wrong: dict[str, Any]) -> None:
    winding = {"winding": wrong | {"fiber": "kevlar"}}
    given = small(effects=[{"pressure": {"to": "60 kPa"}}, winding], mesh={"symmetry": "half"})
    with pytest.raises(CaseError, match=r"missing|neither"):
        parse_case(given)


def test_a_pattern_has_no_around() -> None:
    given = small()
    given["effects"][1]["winding"]["around"] = "wall"
    with pytest.raises(CaseError, match="around: no effect without families"):
        parse_case(given)


def test_what_is_written_is_read_back() -> None:
    given = case(
        HELIX | {"phase": "30 deg"},
        without(HELIX, "angle_from_axis", pitch="200 mm", fiber=ROPE),
        HOOPS | {"around": "wall"},
        PLACES,
        model="body",
        kind="discrete",
    )
    read = parse_case(given)
    assert parse_case(read.resolved()) == read


def test_a_plan_shows_every_family() -> None:
    families: list[dict[str, Any]] = [
        HELIX,
        {"pitch": "200 mm", "hand": "left"},
        HOOPS | {"around": "wall"},
        ALONG | {"phase": "15 deg"},
        PLACES,
    ]
    rows = dict(make_plan(parse_case(case(*families, model="body"))).rows)
    helix, steep, hoops, along, places = rows["threads"]
    assert helix.startswith("families.0: 70° from the axis, pitch 20.")
    assert helix.endswith("mm apart, right")
    assert ", 6 starts, threads 3.1" in helix
    assert "° from the axis, pitch 200 mm, 1 start, threads " in steep
    assert steep.endswith(", left")
    assert hoops == "families.2: 90° from the axis, hoops 3 mm apart, around the wall alone"
    assert along.startswith("families.3: 0° from the axis, 12 around, 4.")
    assert places == "families.4: 0° from the axis, at 170°, 180°, 190° around"
    assert "threads" not in dict(make_plan(parse_case(small())).rows)


def test_every_turn_by_itself_is_the_default_where_a_model_has_turns() -> None:
    pair = [HELIX, HELIX | {"hand": "left"}]
    for model, discrete in (("cell", True), ("body", True), ("section", False)):
        turns = parse_case(case(*pair, model=model, kind=None)).turns
        assert turns is not None
        assert turns.discrete is discrete
        assert not turns.twists
    # threads along the axis alone are the same in a section
    alone = parse_case(case(PLACES, kind="discrete"))
    assert alone.model == "section"


def test_longer_than_the_chamber() -> None:
    read = parse_case(case({"pitch": "500 mm", "hand": "left", "starts": 8}, model="body"))
    assert read.turns is not None
    assert read.turns.period == pytest.approx(62.5)
    assert read.turns.twists
