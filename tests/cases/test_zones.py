"""Zones along the length in a case: what they replace, what is refused, and by which path."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

from fiberbend.case import zones
from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.effects.pressure import inflate
from fiberbend.models.choice import choose_model, meshed
from fiberbend.models.closed_form import analytic_curves
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.schema.problems import CaseError

WOUND = {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"}
HAND = WOUND | {"pattern": "single-helix-left"}
STRIP = {"at": "bottom", "width": "5 mm", "thickness": "0.2 mm", "modulus": "1 GPa"}
BASE: dict[str, Any] = {
    "actuator": {"radius": "8 mm", "length": "160 mm", "wall": "2 mm", "floor": "2 mm"},
    "materials": {"wall": "elastosil-m4601", "floor": "combined-base"},
    "effects": [{"pressure": {"to": "50 kPa"}}, {"winding": WOUND}],
}


def data(*given: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return copy.deepcopy(BASE | changes | {"zones": list(given)})


def read(*given: dict[str, Any], **changes: Any) -> Case:
    return parse_case(data(*given, **changes))


def refusal(*given: dict[str, Any], **changes: Any) -> str:
    with pytest.raises(CaseError) as caught:
        read(*given, **changes)
    return str(caught.value)


def test_a_zone_has_its_own_and_else_the_case_s() -> None:
    case = read(
        {"length": "60 mm", "winding": "none"},
        {"length": "30 mm", "floor": "elastosil-m4601"},
        {"winding": HAND, "strip": STRIP},
    )
    assert zones.lengths(case) == (60.0, 30.0, 70.0)
    assert zones.borders(case) == (60.0, 90.0)
    first, second, third = zones.zone_cases(case)
    assert first.turns is None
    assert second.turns is not None
    assert not second.turns.twists
    assert second.materials.floor is not None
    assert second.materials.floor.name == "elastosil-m4601"
    assert third.turns is not None
    assert third.turns.twists
    assert [effect.name for effect in third.effects] == ["pressure", "winding", "strip"]
    assert [zone.actuator.length for zone in (first, second, third)] == [60.0, 30.0, 70.0]
    assert all(zone.zones is None for zone in (first, second, third))


def test_a_resolved_case_is_read_back() -> None:
    first = {"length": "60 mm", "winding": "none", "strip": [STRIP]}
    case = read(first, {"length": "40 mm", "winding": HAND}, {})
    assert parse_case(case.resolved()) == case


def test_a_zone_without_a_length_takes_the_rest() -> None:
    path = Path(__file__).resolve().parents[2] / "cases" / "thumb.yaml"
    assert zones.lengths(read_case(path)) == (40.0, 60.0, 50.0)
    assert zones.lengths(read_case(path, ["zones.0.length=30 mm"])) == (30.0, 60.0, 60.0)


def test_a_case_without_zones_says_nothing_of_them() -> None:
    case = parse_case(copy.deepcopy(BASE))
    assert "zones" not in case.resolved()
    assert zones.zone_cases(case) == (case,)
    assert zones.borders(case) == ()


@pytest.mark.parametrize(
    ("given", "path", "words"),
    [
        ([], "zones", "no zone"),
        (
            [{"length": "60 mm", "winding": HAND}, {"length": "90 mm"}],
            "zones",
            '"150 mm" in all, expected actuator.length, "160 mm"',
        ),
        ([{"winding": HAND}, {}, {"length": "60 mm"}], "zones.1.length", "zones.0 has none"),
        (
            [{"length": "160 mm", "winding": HAND}, {}],
            "zones.1.length",
            "nothing is left",
        ),
        ([{"length": "60 mm"}, {}], "zones", "no effect without winding or strip or floor"),
        ([{"strip": "none"}], "zones.0.strip", "no effect where the case has no strip"),
        ([{"winding": HAND}], "effects.1.winding", "no effect where every zone has its own"),
        ([{"layer": "elastosil-m4601"}], "zones.0.layer", "no effect without actuator.layer"),
        (
            [{"winding": WOUND | {"pitch": "0.1 mm"}}, {"length": "9 mm"}],
            "zones.0.winding.pitch",
            "",
        ),
        ([{"floor": {"law": "gent", "mu": "1 MPa"}}], "zones.0.floor.jm", "missing"),
        (
            [{"floor": {"name": "elastosil-m4601", "density": "1 g/cm^3"}}],
            "zones.0.floor.density",
            "",
        ),
        ([{"strip": STRIP | {"width": "900 mm"}}], "zones.0.strip.0.width", "outline"),
        ([{"winding": None}, {}], "zones.0", "winding: nothing"),
        ([{"sheath": "ecoflex-0030"}], "zones.0.sheath", "unknown key"),
        (
            [{"winding": WOUND | {"as": "calibrated"}}, {"length": "9 mm"}],
            "zones.0.winding",
            "is to be",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_path(
    given: list[dict[str, Any]], path: str, words: str
) -> None:
    lines = refusal(*given).splitlines()
    assert any(line.startswith(f"{path}:") and words in line for line in lines), lines


TWO: tuple[dict[str, Any], ...] = ({"length": "60 mm", "winding": HAND}, {})


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"model": "analytic"}, "zones: model analytic does not support it"),
        ({"accuracy": "1 %"}, "accuracy: nothing is promised of an actuator with zones"),
        (
            {"model": "section", "effects": [{"pressure": {"angle": "9 deg"}}, {"winding": WOUND}]},
            "effects.0.pressure: model section does not support it: zones share one pressure",
        ),
        (
            {"model": "cell", "effects": [{"pressure": {"volume": "40 mL"}}, {"winding": WOUND}]},
            "effects.0.pressure: model cell does not support it: zones share one pressure",
        ),
        (
            {
                "model": "section",
                "effects": [{"pressure": {"to": "9 kPa"}}, {"winding": WOUND}, {"straight": {}}],
            },
            "effects.2.straight: model section does not support it",
        ),
        (
            {
                "model": "section",
                "effects": [
                    {"pressure": {"to": "9 kPa"}},
                    {"winding": WOUND},
                    {"hold": {"stretch": 1.0}},
                ],
            },
            "effects.2.hold: model section does not support it: zones share a pressure",
        ),
        ({"model": "body", "mesh": {"symmetry": "half"}}, "mesh.symmetry:"),
    ],
)
def test_what_zones_cannot_have_is_refused_by_name(changes: dict[str, Any], line: str) -> None:
    assert line in refusal(*TWO, **changes)


def test_one_body_has_one_kind_of_winding() -> None:
    text = refusal({"length": "60 mm", "winding": HAND | {"as": "discrete"}}, {}, model="body")
    assert text.startswith("effects.1.winding: model body does not support it: as: smeared here")


def test_a_cell_needs_room_for_a_slice_in_every_zone() -> None:
    turns = WOUND | {"as": "discrete"}
    wide = HAND | {"as": "discrete", "pitch": "12 mm"}
    effects = [BASE["effects"][0], {"winding": turns}]
    text = refusal({"length": "10 mm", "winding": wide}, {}, model="cell", effects=effects)
    assert text.startswith("zones.0.winding: model cell does not support it: the slice")


def test_auto_takes_the_cheapest_that_has_zones() -> None:
    assert choose_model(read(*TWO))[0].name == "section"
    weight = [*BASE["effects"], {"gravity": {"direction": "-y"}}]
    dense = {
        part: {"name": name, "density": "1 g/cm^3"} for part, name in BASE["materials"].items()
    }
    heavy = read(*TWO, effects=weight, materials=dense)
    assert choose_model(heavy)[0].name == "body"


def test_a_plan_shows_every_zone() -> None:
    rows = dict(make_plan(read(*TWO)).rows)
    assert rows["zones"][0].startswith("1: 60 mm: winding pattern single-helix-left, pitch 3 mm")
    assert rows["zones"][1] == "2: 100 mm: as the case says"


def test_elements_of_a_body_end_at_borders() -> None:
    with_border = read(
        {"length": "61 mm", "winding": HAND}, {}, model="body", mesh={"axial": "4 mm"}
    )
    without = parse_case(
        copy.deepcopy(BASE | {"model": "body", "mesh": {"axial": "4 mm", "symmetry": "full"}})
    )
    sizes = [meshed(c).size(c) for c in (with_border, without)]
    # 16 and 25 layers in place of 40
    assert sizes[0].elements > sizes[1].elements


def test_what_stands_beside_a_case_is_no_uniform_section() -> None:
    case = read(*TWO)
    assert analytic_curves(case) == {}
    with pytest.raises(CaseError, match="zones"):
        as_section(case, inflate(to=0.1))
