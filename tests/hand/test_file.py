"""What is wrong with a hand file, a problem a line with its path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.cli import main
from fiberbend.design.reading import read_design
from fiberbend.hand.reading import read_hand
from fiberbend.hand.symmetry import out_of_plane
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.schema.problems import CaseError
from fiberbend.sweep.points import read_sweep
from tests.hand.hands import FILE, ROOT, content, hand, written

FINGERS = content()["fingers"]


def problems(folder: Path, **parts: Any) -> dict[str, str]:
    """Problems of a hand by their paths."""
    with pytest.raises(CaseError) as error:
        hand(folder, **parts)
    return {problem.path: problem.text for problem in error.value.problems}


def test_the_hand_that_comes_with_the_program() -> None:
    read = read_hand(FILE)
    assert [finger.name for finger in read.fingers] == ["finger 1", "finger 2", "finger 3"]
    assert [finger.pressure for finger in read.fingers] == pytest.approx([0.06] * 3)
    assert read.gravity == pytest.approx((0.0, -9810.0, 0.0))
    assert all(finger.case.model == "rod" for finger in read.fingers)
    assert not list(out_of_plane(read))


def test_unknown_keys_name_the_one_that_was_meant(tmp_path: Path) -> None:
    assert "did you mean objects?" in problems(tmp_path, object={})["object"]
    wrong = problems(tmp_path, fingers=[{"plaice": ["0 mm", "0 mm", "0 mm"]}])
    assert "did you mean place?" in wrong["fingers.0.plaice"]
    wrong = problems(tmp_path, objects={"spere": {}})
    assert "did you mean sphere?" in wrong["objects.spere"]
    # a body that is free to move is refused as what it is: unknown
    ball = {"center": ["0 mm", "-100 mm", "0 mm"], "radius": "28 mm", "free": True}
    assert "unknown key" in problems(tmp_path, objects={"sphere": ball})["objects.sphere.free"]


def test_values_have_units(tmp_path: Path) -> None:
    wrong = problems(tmp_path, fingers=[{"place": [0, 0, 0]}], pressure=60)
    assert "with its unit" in wrong["fingers.0.place.0"]
    assert 'such as "200 kPa"' in wrong["pressure"]


def test_all_that_is_wrong_is_said_at_once(tmp_path: Path) -> None:
    bar = {"center": ["0 mm", "0 mm", "0 mm"], "axis": [0, 0, 0], "radius": "5 mm"}
    turned = [{"axis": [0, 0, 0], "angle": "90 deg"}]
    fingers = [{"name": "a"}, {"name": "a", "turns": turned}, {"name": " "}]
    wrong = problems(tmp_path, case=None, fingers=fingers, objects={"cylinder": bar})
    assert set(wrong) == {
        "fingers.0.case",
        "fingers.1.case",
        "fingers.2.case",
        "fingers.1.turns.0.axis",
        "fingers.1.name",
        "fingers.2.name",
        "objects.cylinder.axis",
    }
    assert "at least one" in problems(tmp_path, fingers=[])["fingers"]
    assert "at most 12" in problems(tmp_path, fingers=13 * [{}])["fingers"]


def test_what_is_wrong_with_a_case_has_its_file(tmp_path: Path) -> None:
    wrong = problems(tmp_path, gravity=None, set={"actuator.wal": "2 mm"})
    ((path, text),) = wrong.items()
    assert path.endswith("free_bending_smeared.yaml: actuator.wal")
    assert "did you mean wall?" in text
    wrong = problems(tmp_path, set={})
    assert any("density for gravity" in text for text in wrong.values())


def test_lines_are_named(tmp_path: Path) -> None:
    path = written(tmp_path, pressure="60 kPb")
    with pytest.raises(CaseError, match=r"pressure: .*\(line \d+\)"):
        read_hand(path)


def test_fingers_have_pressure_and_windings_alone(tmp_path: Path) -> None:
    case = yaml.safe_load((ROOT / "cases" / "free_bending_smeared.yaml").read_text("utf-8"))

    def with_effects(*effects: Any) -> dict[str, str]:
        own = tmp_path / "own.yaml"
        own.write_text(yaml.safe_dump(case | {"effects": [*case["effects"], *effects]}), "utf-8")
        return problems(tmp_path, case=str(own))

    assert "expected gravity of the hand" in str(with_effects({"gravity": {"direction": "-y"}}))
    load = {"tip-load": {"force": ["0 N", "-0.1 N", "0 N"]}}
    assert "not known in a hand" in str(with_effects(load))
    no_pressure = [effect for effect in case["effects"] if "pressure" not in effect]
    own = tmp_path / "own.yaml"
    own.write_text(yaml.safe_dump(case | {"effects": no_pressure}), "utf-8")
    assert "no pressure" in str(problems(tmp_path, case=str(own)))


def test_a_pressure_of_one_finger_comes_first(tmp_path: Path) -> None:
    fingers = [FINGERS[0] | {"pressure": "40 kPa"}, *FINGERS[1:]]
    read = hand(tmp_path, fingers=fingers)
    assert [finger.pressure for finger in read.fingers] == pytest.approx([0.04, 0.06, 0.06])
    own = hand(tmp_path, pressure=None)
    case = read_case(ROOT / "cases" / "free_bending_smeared.yaml")
    assert case.inflation is not None
    assert own.fingers[0].pressure == case.inflation.to


def test_what_is_resolved_is_read_again(tmp_path: Path) -> None:
    resolved = hand(tmp_path).resolved
    for finger in resolved["fingers"]:
        assert parse_case(finger["case"]).model == "rod"
    assert "case" not in resolved


def test_other_commands_say_the_right_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path)
    for read in (read_case, read_sweep, read_design):
        with pytest.raises(CaseError, match=f"this is a hand: fiberbend hand {path}"):
            read(path)  # type: ignore[operator]
    cases = ROOT / "cases"
    others = {
        "run": cases / "section.yaml",
        "sweep": cases / "sweeps" / "table1.yaml",
        "design": cases / "designs" / "impossible.yaml",
    }
    for command, file in others.items():
        assert main(["hand", str(file)]) == 1
        assert f"fiberbend {command} {file}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"gravity": {"direction": "-x"}}, "its weight"),
        (
            {"objects": {"sphere": {"center": ["5 mm", "-100 mm", "0 mm"], "radius": "20 mm"}}},
            "the sphere",
        ),
        (
            {
                "objects": {
                    "cylinder": {
                        "center": ["0 mm", "-90 mm", "0 mm"],
                        "axis": [1, 0, 0],
                        "radius": "20 mm",
                    }
                }
            },
            "the cylinder",
        ),
        (
            {"objects": {"plane": {"point": ["0 mm", "-150 mm", "0 mm"], "normal": [0.1, 1, 0]}}},
            "the plane",
        ),
        ({"fingers": FINGERS[:2]}, "finger 2"),
    ],
)
def test_what_pushes_a_finger_aside_is_found(
    tmp_path: Path, changes: dict[str, Any], what: str
) -> None:
    assert what in {cause for _, cause in out_of_plane(hand(tmp_path, **changes))}


def test_a_bar_between_two_fingers_is_the_same_on_both_sides(tmp_path: Path) -> None:
    down = {"axis": [1, 0, 0], "angle": "90 deg"}
    opposite = [
        {"place": ["0 mm", "0 mm", "40 mm"], "turns": [down]},
        {
            "place": ["0 mm", "0 mm", "-40 mm"],
            "turns": [down, {"axis": [0, 1, 0], "angle": "180 deg"}],
        },
    ]
    bar = {"center": ["0 mm", "-90 mm", "0 mm"], "axis": [2, 0, 0], "radius": "20 mm"}
    read = hand(tmp_path, fingers=opposite, objects={"cylinder": bar})
    assert not list(out_of_plane(read))
    short = hand(tmp_path, fingers=opposite, objects={"cylinder": bar | {"length": "60 mm"}})
    assert not list(out_of_plane(short))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("output.stop_at_angle", "30 deg"),
        ("accuracy", "1 %"),
        ("model", "body"),
        ("mesh.element", "tetrahedron"),
        ("solver.max_turn", "1 deg"),
        ("effects.0.pressure.to", "20 kPa"),
    ],
)
def test_changes_that_would_change_nothing_are_refused(
    tmp_path: Path, path: str, value: str
) -> None:
    changes = content()["set"] | {path: value}
    wrong = problems(tmp_path, set=changes, pressure="60 kPa")
    assert [key.rpartition(": ")[2] for key in wrong] == [path]
    assert all("no effect" in text for text in wrong.values())


def test_a_finger_that_twists_by_itself_is_refused(tmp_path: Path) -> None:
    data = yaml.safe_load(Path(content()["case"]).read_text(encoding="utf-8"))
    for effect in data["effects"]:
        if "winding" in effect:
            effect["winding"]["pattern"] = "single-helix-left"
    case = tmp_path / "case.yaml"
    case.write_text(yaml.safe_dump(data), encoding="utf-8")
    wrong = problems(tmp_path, case=str(case))
    assert any("touches that twists by itself is not known" in text for text in wrong.values())


def test_a_finger_in_motion_is_refused(tmp_path: Path) -> None:
    time = {"duration": "1 s", "pressure": {"ramp": {"to": "10 kPa", "over": "1 s"}}}
    wrong = problems(tmp_path, set=content()["set"] | {"time": time})
    assert any("at rest" in text for text in wrong.values())
