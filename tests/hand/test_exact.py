"""Hands whose answers are known: one finger, symmetries, turns, action and reaction."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fiberbend.hand.assembled import Assembled
from fiberbend.hand.rows import row, rows, text
from fiberbend.hand.solved import Solved, solve_hand
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError
from fiberbend.slender.actuator import slender
from rod.functions import Floats
from rod.statics import Path as Way
from rod.statics import march
from tests.hand.hands import assembled, content, hand, known_at_once

DOWN = {"axis": [1, 0, 0], "angle": "90 deg"}
STEPS = {"steps": 5, "pictures": False, "animation": False}


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    known_at_once(monkeypatch)


def solved(folder: Path, **changes: Any) -> tuple[Assembled, Solved, list[dict[str, Any]]]:
    made = assembled(folder, **({"output": STEPS} | changes))
    found = solve_hand(made)
    return made, found, rows(made, found)


def triple(row: dict[str, Any], name: str, unit: str) -> Floats:
    return np.array([row[f"{name}_{axis}_{unit}"] for axis in "xyz"])


def test_one_finger_is_its_case_as_a_rod(tmp_path: Path) -> None:
    """With its weight along the axes of the hand, which are those of its case."""
    made, found, told = solved(tmp_path, fingers=[{}], objects=None)
    case = parse_case(hand(tmp_path).fingers[0].case.resolved())
    own = slender(case)
    rest = own.rod.layout.at_rest()
    heavy = march(own.rod, rest, Way(own.level({}), own.level({"gravity": 1.0})), [1.0])[-1]
    end = own.level({"gravity": 1.0, "pressure": 0.06})
    beside = march(own.rod, heavy, Way(heavy.level, end), [0.2, 0.4, 0.6, 0.8, 1.0])
    assert not found.reason
    for moment, state in zip(found.moments[1:], [heavy, *beside], strict=True):
        (shape,) = moment.state.shape.each
        np.testing.assert_allclose(shape.places, state.shape.places, rtol=0.0, atol=1e-10 * 150)
        assert moment.state.unstable == state.unstable
    np.testing.assert_allclose(triple(told[-1], "finger_1_tip", "mm"), own.tip(beside[-1].shape))
    assert made.system.places == (slice(0, rest.size),)


def test_three_fingers_around_a_ball(tmp_path: Path) -> None:
    """Forces are those of the first one, turned; across the axis they have no sum."""
    _, found, told = solved(tmp_path)
    last = told[-1]
    assert not found.reason
    forces = [triple(last, f"finger_{number}_on_sphere", "N") for number in (1, 2, 3)]
    size = float(np.linalg.norm(forces[0]))
    assert size > 0.05
    # places in the file have seven digits
    for number, force in enumerate(forces):
        turn = Rotation.from_euler("y", 120 * number, degrees=True).as_matrix()
        np.testing.assert_allclose(force, turn @ forces[0], atol=1e-5 * size)
    whole = triple(last, "sphere", "N")
    np.testing.assert_allclose(whole, np.sum(forces, axis=0), atol=1e-12)
    np.testing.assert_allclose(whole[[0, 2]], 0.0, atol=1e-5 * size)
    np.testing.assert_allclose(triple(last, "sphere_moment", "Nmm"), 0.0, atol=1e-3 * size)
    # what has no friction pushes each finger along the line from the ball's centre
    assert {touch.other for touch in found.touches} == {"sphere"}
    assert len(found.touches) == 3
    assert told[-1]["unstable_modes"] == 0


def test_a_hand_turns_as_a_whole(tmp_path: Path) -> None:
    _, _, told = solved(tmp_path, gravity=None)
    turn = {"axis": [1, 2, -3], "angle": "70 deg"}
    rotation = Rotation.from_rotvec(
        np.deg2rad(70.0) * np.array([1, 2, -3]) / np.sqrt(14.0)
    ).as_matrix()
    shift = np.array([12.0, -7.0, 30.0])

    def moved(place: list[str]) -> list[str]:
        numbers = np.array([float(text.removesuffix(" mm")) for text in place])
        return [f"{value!r} mm" for value in (rotation @ numbers + shift).tolist()]

    fingers = [
        each | {"place": moved(each["place"]), "turns": [*each["turns"], turn]}
        for each in content()["fingers"]
    ]
    ball = content()["objects"]["sphere"]
    objects = {"sphere": ball | {"center": moved(ball["center"])}}
    _, _, other = solved(tmp_path, gravity=None, fingers=fingers, objects=objects)
    for one, two in zip(told, other, strict=True):
        for number in (1, 2, 3):
            tip, there = (triple(each, f"finger_{number}_tip", "mm") for each in (one, two))
            np.testing.assert_allclose(there, rotation @ tip + shift, atol=1e-7)
            force, turned = (triple(e, f"finger_{number}_on_sphere", "N") for e in (one, two))
            np.testing.assert_allclose(turned, rotation @ force, atol=1e-8)
            for name in ("angle_deg", "sphere_gap_mm"):
                key = f"finger_{number}_{name}"
                assert two[key] == pytest.approx(one[key], abs=1e-7)


def pincers(apart: float) -> dict[str, Any]:
    """Two fingers that bend toward each other."""
    return {
        "fingers": [
            {"place": ["0 mm", "0 mm", f"{apart} mm"], "turns": [DOWN]},
            {
                "place": ["0 mm", "0 mm", f"{-apart} mm"],
                "turns": [DOWN, {"axis": [0, 1, 0], "angle": "180 deg"}],
            },
        ],
        "objects": None,
        "gravity": None,
    }


def test_two_fingers_meet_in_the_middle(tmp_path: Path) -> None:
    made, found, told = solved(tmp_path, **pincers(20.0))
    last = told[-1]
    assert not found.reason
    assert [touch.other for touch in found.touches] == [1]
    one, two = (triple(last, f"finger_{number}_tip", "mm") for number in (1, 2))
    np.testing.assert_allclose(one * [1, 1, -1], two, atol=1e-7)
    force = triple(last, "finger_2_on_1", "N")
    assert force[2] > 0.01
    np.testing.assert_allclose(force[:2], 0.0, atol=1e-6 * force[2])
    assert last["fingers_1_2_gap_mm"] == pytest.approx(0.0, abs=0.02)
    # each as before a wall in the middle
    wall = {"plane": {"point": ["0 mm", "0 mm", "0 mm"], "normal": [0, 0, 1]}}
    first = pincers(20.0) | {"fingers": pincers(20.0)["fingers"][:1], "objects": wall}
    _, _, beside = solved(tmp_path, **first)
    np.testing.assert_allclose(triple(beside[-1], "finger_1_tip", "mm"), one, atol=0.05)
    np.testing.assert_allclose(-triple(beside[-1], "finger_1_on_plane", "N"), force, atol=0.02)
    assert made.system.blocks(found.moments[0].state.shape, found.moments[0].state.level)


def test_fingers_apart_are_those_alone(tmp_path: Path) -> None:
    low = {"objects": None, "pressure": "20 kPa"}
    _, found, told = solved(tmp_path, **low)
    assert not found.touches
    for number in (1, 2, 3):
        _, _, alone = solved(tmp_path, **low, fingers=[content()["fingers"][number - 1]])
        for one, two in zip(told, alone, strict=True):
            tips = triple(one, f"finger_{number}_tip", "mm"), triple(two, "finger_1_tip", "mm")
            np.testing.assert_allclose(*tips, rtol=0.0, atol=1e-9)


def test_weight_is_that_of_the_world(tmp_path: Path) -> None:
    """A finger that lies and one that hangs: both are pulled along −y."""
    lying = solved(tmp_path, fingers=[{}], objects=None)[2]
    hanging = solved(tmp_path, fingers=[{"turns": [DOWN]}], objects=None)[2]
    rest, heavy = (triple(each, "finger_1_tip", "mm") for each in lying[:2])
    assert (heavy - rest)[1] < -1.0
    rest, heavy = (triple(each, "finger_1_tip", "mm") for each in hanging[:2])
    assert -1.0 < (heavy - rest)[1] < 0.0
    assert hanging[0]["weight"] == 0.0
    assert hanging[1]["weight"] == 1.0


def test_what_is_in_the_way_at_rest_is_refused(tmp_path: Path) -> None:
    ball = {"center": ["0 mm", "-100 mm", "0 mm"], "radius": "50 mm"}
    with pytest.raises(CaseError, match="into finger 1 at rest"):
        assembled(tmp_path, objects={"sphere": ball})
    with pytest.raises(CaseError, match="in finger 1 at rest"):
        assembled(tmp_path, **pincers(-2.0))
    with pytest.raises(CaseError, match="out of the plane in which it bends"):
        assembled(tmp_path, gravity={"direction": "-x"})


def test_rows_are_a_table(tmp_path: Path) -> None:
    made, found, told = solved(tmp_path, gravity=None)
    lines = text(told).splitlines()
    assert len(lines) == 1 + len(found.moments) == 7
    names = lines[0].split(",")
    assert names[:2] == ["step", "pressure_kPa"]
    assert "weight" not in names
    assert {line.count(",") for line in lines} == {len(names) - 1}
    assert row(made, 0, found.moments[0], 0)["pressure_kPa"] == 0.0
