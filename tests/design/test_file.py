"""What is wrong with a design file, a problem a line with its path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fiberbend.design.reading import read_design
from fiberbend.reader.reader import read_case
from fiberbend.schema.problems import CaseError
from fiberbend.sweep.points import read_sweep
from tests.design.made_up import ROOT, SECTION, design

DESIGNS = sorted((ROOT / "cases" / "designs").glob("*.yaml"))

VARY = {"actuator.wall": {"from": "1 mm", "to": "3 mm"}}
TARGETS = [{"angle": {"at": "60 kPa", "is": "90 deg"}}]


def problems(folder: Path, **parts: Any) -> dict[str, str]:
    """Problems of a design by their paths."""
    with pytest.raises(CaseError) as error:
        design(folder, **({"vary": VARY, "targets": TARGETS} | parts))
    return {problem.path: problem.text for problem in error.value.problems}


def test_unknown_keys_name_the_one_that_was_meant(tmp_path: Path) -> None:
    assert "did you mean targets?" in problems(tmp_path, target=[])["target"]
    wrong = problems(tmp_path, targets=[{"angel": {"at": "60 kPa"}}])
    assert "did you mean angle?" in wrong["targets.0.angel"]
    wrong = problems(tmp_path, targets=[{"angle": {"at": "60 kPa", "equals": "90 deg"}}])
    assert "unknown key" in wrong["targets.0.angle.equals"]


def test_values_have_units(tmp_path: Path) -> None:
    wrong = problems(tmp_path, targets=[{"angle": {"at": 60, "is": "90 mm"}}])
    assert 'such as "200 kPa"' in wrong["targets.0.angle.at"]
    assert 'such as "90 deg"' in wrong["targets.0.angle.is"]


def test_what_is_wanted_is_one_thing(tmp_path: Path) -> None:
    targets = [
        {"angle": {"at": "60 kPa"}},
        {"angle": {"at": "60 kPa", "is": "90 deg", "most": "95 deg"}},
        {"width": {"least": "20 mm", "most": "10 mm"}},
        {"width": {"most": "10 mm", "within": "1 mm"}},
        {"angle": {"at": "60 kPa", "is": "90 deg"}, "width": {"most": "10 mm"}},
    ]
    assert problems(tmp_path, targets=targets[4:])["targets.0"]
    wrong = problems(tmp_path, targets=targets[:4])
    assert "expected is, least or most" in wrong["targets.0.angle"]
    assert "expected it alone" in wrong["targets.1.angle.is"]
    assert "expected at least 20 mm" in wrong["targets.2.width.most"]
    assert "no effect without is" in wrong["targets.3.width.within"]


def test_goals_have_a_side_and_no_bounds(tmp_path: Path) -> None:
    goals = [{}, {"minimise": {"rubber": {"most": "10 mL"}}}]
    wrong = problems(tmp_path, goals=goals)
    assert "expected one of minimise and maximise" in wrong["goals.0"]
    assert "expected it under targets" in wrong["goals.1.minimise.rubber.most"]
    same: list[dict[str, Any]] = [{"minimise": {"rubber": {}}}, {"maximise": {"rubber": {}}}]
    assert "expected another" in problems(tmp_path, goals=same)["goals.1"]
    three = [*same, {"minimise": {"width": {}}}]
    assert problems(tmp_path, goals=three)["goals"] == "3 goals, expected at most 2"


def test_fields_have_ends_of_one_kind(tmp_path: Path) -> None:
    vary = {
        "actuator.radius": {"from": "8 mm", "to": "6 mm"},
        "actuator.wall": {"from": "1 mm", "to": "3 kPa"},
        "actuator.floor": {"from": "1 mm"},
        "actuator.sheath": "1 mm",
        "actuator.cap": [],
    }
    wrong = problems(tmp_path, vary=vary)
    assert "not above from" in wrong["vary.actuator.radius.to"]
    assert "two quantities of one kind" in wrong["vary.actuator.wall"]
    assert "missing" in wrong["vary.actuator.floor.to"]
    assert "a list of choices" in wrong["vary.actuator.sheath"]
    assert "expected at least one" in wrong["vary.actuator.cap"]


def test_fields_are_those_of_the_case(tmp_path: Path) -> None:
    vary = {
        "actuator.wal": {"from": "1 mm", "to": "3 mm"},
        "actuator.radius": {"from": "0 mm", "to": "8 mm"},
        "materials.wall": ["elastosil-m4601", "rubbr"],
    }
    wrong = problems(tmp_path, vary=vary)
    assert "unknown key" in wrong["vary.actuator.wal.from"]
    assert "above zero" in wrong["vary.actuator.radius.from"]
    assert "rubbr" in wrong["vary.materials.wall.1"]
    nowhere = {
        "effects.7.winding.pitch": {"from": "1 mm", "to": "4 mm"},
        "materials.wall.c1": {"from": "0.1 MPa", "to": "0.2 MPa"},
        "actuator.wall": {"from": 1, "to": 4},
    }
    wrong = problems(tmp_path, vary=nowhere)
    assert "no such entry" in wrong["vary.effects.7.winding.pitch.from"]
    assert "no such path" in wrong["vary.materials.wall.c1.to"]
    assert [key for key in wrong if key.startswith("vary.actuator")] == [
        "vary.actuator.wall.from",
        "vary.actuator.wall.to",
    ]


def test_too_many_combinations_are_refused(tmp_path: Path) -> None:
    many = [f"{number} mm" for number in range(1, 10)]
    vary = {"actuator.wall": many, "actuator.floor": many}
    assert "81 combinations" in problems(tmp_path, vary=vary)["vary"]
    whole = {"mesh.section": {"from": 1, "to": 100}}
    assert "100 whole numbers" in problems(tmp_path, vary=whole)["vary.mesh.section"]


def test_fields_that_make_no_other_actuator_are_refused(tmp_path: Path) -> None:
    vary = {
        "effects.0.pressure.angle": {"from": "10 deg", "to": "90 deg"},
        "mesh.axial": {"from": "1 mm", "to": "3 mm"},
    }
    wrong = problems(tmp_path, vary=vary)
    assert "targets and goals say" in wrong["vary.effects.0.pressure.angle"]
    assert "says nothing of the actuator" in wrong["vary.mesh.axial"]


def test_a_pressure_of_the_base_case_that_is_set_is_refused(tmp_path: Path) -> None:
    load = {"effects.0.pressure.angle": "30 deg"}
    wrong = problems(tmp_path, set={**load, "output": {}, "compare": []})
    assert "targets and goals say" in wrong["set.effects.0.pressure.angle"]
    design(tmp_path, vary=VARY, targets=TARGETS)
    with pytest.raises(
        CaseError, match=r"--set effects\.0\.pressure\.angle.*targets and goals say"
    ):
        read_design(tmp_path / "design.yaml", ["effects.0.pressure.angle=30 deg"])


def test_what_is_wanted_goes_together(tmp_path: Path) -> None:
    again = [*TARGETS, {"angle": {"at": "60 kPa", "most": "95 deg"}}]
    assert "of targets.0 again" in problems(tmp_path, targets=again)["targets.1.angle"]
    force = {"at": "60 kPa", "least": "1 N"}
    posts = [{"blocked-force": force}, {"blocked-force": {**force, "at": "50 kPa"}}]
    assert len(design(tmp_path, vary=VARY, targets=posts).targets) == 2
    posts[1]["blocked-force"]["roof_width"] = "6 mm"
    assert "another roof" in problems(tmp_path, targets=posts)["targets.1.blocked-force"]
    both = [*TARGETS, {"angle": {"at": "-20 kPa", "most": "0 deg"}}]
    assert "both signs" in problems(tmp_path, targets=both)["targets"]


def test_a_quantity_that_the_case_does_not_have(tmp_path: Path) -> None:
    targets = [{"angle": {"zone": 2, "at": "60 kPa", "is": "90 deg"}}]
    wrong = problems(tmp_path, targets=targets)
    assert "no zones" in wrong["targets.0.angle.zone"]
    wrong = problems(tmp_path, targets=[{"work": {"most": "20 mJ"}}])
    assert "expected one of at (a pressure) and angle" in wrong["targets.0.work"]
    grasp = {"case": str(ROOT / "cases" / "grasp.yaml"), "set": {}}
    assert any("obstacles act" in text for text in problems(tmp_path, **grasp).values())
    loads = {"effects.0": {"pressure": {"to": "60 kPa"}}, "effects.2": {"straight": {}}}
    straight = {"set": {**loads, "output": {}, "compare": []}}
    assert any("keeps it straight" in text for text in problems(tmp_path, **straight).values())


def test_other_commands_know_a_design(tmp_path: Path) -> None:
    made = str(ROOT / "cases" / "designs" / "impossible.yaml")
    for read in (read_case, read_sweep):
        with pytest.raises(CaseError, match="this is a design: fiberbend design"):
            read(made)
    with pytest.raises(CaseError, match="this is a case: fiberbend run"):
        read_design(SECTION)
    with pytest.raises(CaseError, match="this is a sweep: fiberbend sweep"):
        read_design(ROOT / "cases" / "sweeps" / "table1.yaml")


@pytest.mark.parametrize("path", DESIGNS, ids=lambda path: path.stem)
def test_example_designs_are_valid(path: Path) -> None:
    assert read_design(path).quantities
