"""Which rungs the shipped cases have, and why not others."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest
import yaml

from fiberbend.case.case import Mesh
from fiberbend.case.shapes import SHAPES
from fiberbend.ladder.asked import asked
from fiberbend.ladder.command import Options, _part
from fiberbend.ladder.rungs import BARE, ladder, representations
from fiberbend.ladder.words import WINDINGS
from fiberbend.models.choice import MODELS
from fiberbend.reader.reader import as_case, read_case
from fiberbend.schema.problems import CaseError
from tests.conftest import ROOT
from tests.ladder.parts import CASE, of_case

CASES = sorted((ROOT / "cases").glob("*.yaml")) + sorted((ROOT / "cases" / "fig11").glob("*.yaml"))
BODY = ["body-spread-hexahedron", "body-turns-hexahedron"]
ROD = ["rod-spread", "rod-turns"]
FAMILIES = {
    "blocked_contact": [*ROD, *BODY],
    "blocked_tip": ["analytic-spread", *ROD, *BODY],
    "cell": ["analytic-spread", "section-spread", "cell-turns", *ROD, *BODY],
    "circle": ["section-spread", "cell-turns", *ROD, *BODY],
    "free_bending": ["analytic-spread", "section-spread", "cell-turns", *ROD, *BODY],
    "grasp": [*ROD, *BODY],
    "rectangle": ["section-spread", "cell-turns", *ROD, *BODY],
    "s_shape": ["section-spread", "cell-turns", *ROD, *BODY],
    "thumb": ["section-spread", "cell-turns", *ROD, *BODY],
    "twisting": ["section-spread", "cell-turns", *ROD, *BODY],
}


READ = {path: read_case(path) for path in CASES}
TIMED = [path for path, case in READ.items() if case.time is not None]


@pytest.mark.parametrize("path", TIMED, ids=lambda path: path.stem)
def test_nothing_is_there_to_compare_a_motion_with(path: Path) -> None:
    with pytest.raises(CaseError, match="time: a rod alone moves"):
        of_case(path)


ALIKE = [path for path in CASES if path not in TIMED]


@pytest.mark.parametrize("path", ALIKE, ids=lambda path: path.stem)
def test_every_shipped_case_has_a_ladder(path: Path) -> None:
    found = of_case(path)
    names = [rung.name for rung in found.rungs]
    assert len(set(names)) == len(names) >= 4
    assert asked(found.rungs[0].case)
    seconds = [rung.seconds for rung in found.rungs]
    assert seconds == sorted(seconds)
    for each in found.missing:
        assert each.reason, each.name
    # what a model refuses it has no rungs of, and no family is lost without a word
    models = {rung.family.model for rung in found.rungs}
    assert models | {each.name.partition("-")[0] for each in found.missing} == set(MODELS)
    words = {rung.family.winding for rung in found.rungs}
    assert ("" in words) == (READ[path].turns is None)


@pytest.mark.parametrize(("name", "families"), FAMILIES.items(), ids=FAMILIES)
def test_families(name: str, families: list[str]) -> None:
    found = of_case(ROOT / "cases" / f"{name}.yaml")
    keys = {rung.family.discretisation.key for rung in found.rungs}
    known = {key for key in keys if "tetrahedron" not in key and "calibrated" not in key}
    assert known == set(families)


def test_reasons_are_those_of_the_models() -> None:
    missing = {each.name: each.reason for each in of_case().missing}
    assert "only cell and body have turns" in missing["section-turns"]
    assert "the same as section-spread" in missing["cell-spread"]
    blocked = {
        each.name: each.reason for each in of_case(ROOT / "cases" / "blocked_tip.yaml").missing
    }
    assert "roof and post need the ends of a body" in blocked["cell-turns"]
    analytic = of_case(ROOT / "cases" / "blocked_tip.yaml").rungs[0]
    assert analytic.family.model == "analytic"
    assert any("no surfaces of it" in text for text in analytic.left_out)


def test_every_direction_has_meshes_of_its_own() -> None:
    meshes: dict[str, list[dict[str, float]]] = {}
    for rung in of_case().rungs:
        meshes.setdefault(rung.family.key, []).append(rung.mesh)
    assert len(meshes["section-spread"]) == 4
    assert [set(mesh) for mesh in meshes["section-spread"]] == [{"section"}] * 4
    hexahedra = [f"{body}-half" for body in BODY if "tetrahedron" not in body]
    for key in ("cell-turns", *hexahedra):
        axial = {mesh["axial"] for mesh in meshes[key]}
        section = {mesh["section"] for mesh in meshes[key]}
        assert len(axial) == 3
        assert len(section) == (3 if key == "cell-turns" else 2)
    # tetrahedra become smaller in all directions at once
    for key in ("body-turns-tetrahedron-half", "body-spread-tetrahedron-half"):
        assert [set(mesh) for mesh in meshes[key]] == [{"axial"}] * 3
    given: dict[str, set[float]] = {rung.family.key: set() for rung in of_case().rungs}
    for rung in of_case().rungs:
        given[rung.family.key].add(rung.case.mesh.axial)
    assert given["body-turns-hexahedron-half"] == {3.0, 1.5, 0.75}
    assert given["cell-turns"] == {0.75, 0.375, 0.1875}
    assert given["body-turns-tetrahedron-half"] == {6.0, 3.0, 1.5}
    assert len(meshes["body-turns-hexahedron-full"]) == 1


def test_a_section_is_refined_where_the_turns_are_resolved() -> None:
    refined = [
        rung.case.mesh.axial
        for rung in of_case().rungs
        if rung.family.key == "body-turns-hexahedron-half" and rung.case.mesh.section == 2
    ]
    assert refined == [0.75]


def test_settings_make_the_rung() -> None:
    for rung in of_case().rungs:
        again = read_case(CASE, [*BARE, *rung.settings])
        assert again == rung.case, rung.name


def test_the_sizes_are_those_of_elements_that_fit() -> None:
    """A length that no element divides: the sizes are those that are made, and halve about."""
    found = ladder(CASE, ["actuator.length=113 mm"])
    body = [rung for rung in found.rungs if rung.family.key == f"{BODY[0]}-half"]
    sizes = sorted({rung.mesh["axial"] for rung in body}, reverse=True)
    assert [round(113 / size, 6) for size in sizes] == [14, 28, 56]


def test_a_twisting_winding_has_no_half_body() -> None:
    found = of_case(ROOT / "cases" / "single_helix.yaml")
    bodies = {rung.family.key for rung in found.rungs if rung.family.model == "body"}
    assert bodies
    assert not any(key.endswith("half") for key in bodies)


def test_representations_come_from_the_schema() -> None:
    paths, words = representations(read_case(CASE))
    assert paths == ("effects.1.winding.as",)
    assert {"discrete", "smeared"} <= set(words)
    thumb, _ = representations(read_case(ROOT / "cases" / "thumb.yaml"))
    assert thumb == ("effects.1.winding.as", "zones.2.winding.as")
    bare = yaml.safe_load(CASE.read_text(encoding="utf-8"))
    bare["effects"] = bare["effects"][:1]
    bare["actuator"]["length"] = "80 mm"
    found = ladder({**bare, "model": "auto"})
    assert {rung.family.winding for rung in found.rungs} == {""}
    assert {rung.family.model for rung in found.rungs} == {"section", "rod", "body"}


def test_shapes_and_windings_of_a_case_have_their_words() -> None:
    assert tuple(SHAPES) == get_args(Mesh.model_fields["element"].annotation)
    assert {rung.family.winding for rung in ladder(CASE).rungs} <= set(WINDINGS)


def test_a_rung_of_a_case_with_an_accuracy_is_typed_without_it() -> None:
    settings = ["accuracy=1 %", "mesh={}"]
    rung = ladder(CASE, settings).rungs[-1]
    typed = read_case(CASE, [*settings, *rung.settings])
    assert typed.accuracy is None
    assert typed.mesh == rung.case.mesh


def test_asked() -> None:
    def names(name: str, *settings: str) -> list[str]:
        case = read_case(ROOT / "cases" / f"{name}.yaml", settings)
        return [each.name for each in asked(case)]

    assert names("free_bending") == [f"pressure_{deg}deg_kPa" for deg in (90, 180, 360)]
    assert names("blocked_tip")[0] == "tip_force_50kPa_N"
    assert names("blocked_tip", "output={}") == ["end_tip_force_N"]
    assert names("free_bending", "output={}") == ["end_angle_deg"]
    assert names("section", "output={}") == ["pressure_360deg_kPa"]
    assert names("grasp")[1] == "angle_37.5kPa_deg"
    assert names("twisting") == [f"twist_{kPa}kPa_deg" for kPa in (10, 20, 30)]
    assert names("twisting", "output={}") == ["end_twist_deg"]
    assert names("extending") == [f"lengthening_{kPa}kPa_percent" for kPa in (20, 40)]
    assert names("thumb")[3:] == [
        "lengthening_of_zone_1_24kPa_percent",
        "angle_of_zone_2_24kPa_deg",
        "twist_of_zone_3_24kPa_deg",
    ]


def test_what_is_held_is_asked_for_its_force() -> None:
    held = yaml.safe_load((ROOT / "cases" / "twisting.yaml").read_text(encoding="utf-8"))
    held["effects"].insert(0, {"hold": {"twist": "0 deg", "stretch": 1.05}})
    names = {each.name for each in asked(as_case(held))}
    assert names == {
        f"{force}_{kPa}kPa_{unit}"
        for kPa in (10, 20, 30)
        for force, unit in (("axial_force", "N"), ("torque", "Nmm"))
    }


def test_a_lengthening_counts_from_rest_in_percent() -> None:
    first, last = asked(read_case(ROOT / "cases" / "extending.yaml"))
    rows: list[dict[str, float | None]] = [
        {"pressure_kPa": 0.0, "axis_stretch": 1.0},
        {"pressure_kPa": 20.0, "axis_stretch": 1.064},
        {"pressure_kPa": 40.0, "axis_stretch": 0.9},
    ]
    assert first.value(rows, True) == pytest.approx(6.4)
    assert last.value(rows, True) == pytest.approx(-10)


def test_values_are_read_off_the_first_row_that_has_them() -> None:
    first, *_, last = asked(read_case(CASE))
    rows: list[dict[str, float | None]] = [
        {"pressure_kPa": 0.0, "angle_deg": 0.0},
        {"pressure_kPa": 46.0, "angle_deg": 90.00000001},
        {"pressure_kPa": 30.0, "angle_deg": 90.0},
    ]
    assert first.value(rows, True) == 46.0
    assert last.value(rows, True) is None
    (end,) = asked(read_case(CASE, ["output={}"]))
    assert end.value(rows, True) == 90.0
    assert end.value(rows, False) is None
    assert end.value(rows[:1], True) is None


def test_only_and_within() -> None:
    part = _part(of_case(), Options(only=("body-turns", "analytic")))
    assert {rung.family.model for rung in part.rungs} == {"analytic", "body"}
    assert all(rung.family.winding == "turns" for rung in part.rungs if rung.family.model == "body")
    late = _part(of_case(), Options(within=10.0))
    assert all(rung.seconds <= 10 for rung in late.rungs)
    skipped = {each.name for each in late.missing if "--within" in each.reason}
    assert skipped == {rung.name for rung in of_case().rungs if rung.seconds > 10}
