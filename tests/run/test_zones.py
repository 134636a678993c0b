"""Zones along the length: chained sections and cells, and bodies, against what is known of them."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic.path import arc, chained, screw
from fiberbend import columns as col
from fiberbend.answer.answer import answer
from fiberbend.case.case import Case
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.results.states import States
from fiberbend.running.runner import run_case

ROOT = Path(__file__).resolve().parents[2]
WOUND = {"pattern": "double-helix", "pitch": "4 mm", "fiber": "kevlar", "as": "smeared"}
TURNS = WOUND | {"as": "discrete"}
STRIP = {"at": "bottom", "width": "5 mm", "thickness": "0.2 mm", "modulus": "1 GPa"}
QUIET = {"pictures": False, "fields": False, "report": False}
BASE: dict[str, Any] = {
    "actuator": {
        "radius": "8 mm",
        "length": "48 mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "cap": "6 mm",
    },
    "materials": {"wall": "elastosil-m4601", "floor": "combined-base"},
    "effects": [{"pressure": {"to": "60 kPa"}}],
    "model": "section",
    "mesh": {"section": 1},
    "output": QUIET,
}
ROUND_OFF = {col.ITERATIONS, col.VOLUME_ERROR, col.VOLUME_ERROR_ELEMENT, col.WORK}


def case(*zones: dict[str, Any], wound: dict[str, Any] | None = None, **changes: Any) -> Case:
    data = copy.deepcopy(BASE | changes)
    if wound is not None:
        data["effects"] = [*data["effects"], {"winding": wound}]
    if zones:
        data["zones"] = list(zones)
    return parse_case(data)


def solve(given: Case) -> RunResult:
    result = run_case(given, None)
    assert result.status == "converged", result.reason
    return result


def asked(**output: Any) -> dict[str, Any]:
    return {"output": QUIET | output}


# --- the chain ----------------------------------------------------------------------------------


def test_two_arcs_of_known_curvature_are_chained_exactly() -> None:
    first, second = math.radians(70), math.radians(-40)
    ends = []
    for angle, length in ((first, 60.0), (second, 30.0)):
        rotation, place = screw(np.array([length]), np.array([angle / length, 0, 0]), 1.0)
        ends.append((rotation[0], place[0]))
    frames = chained(ends)
    a, b = arc(first, 60.0), arc(second, 30.0)
    z = a[0] + b[0] * math.cos(first) - b[1] * math.sin(first)
    down = a[1] + b[0] * math.sin(first) + b[1] * math.cos(first)
    np.testing.assert_allclose(frames[-1][1], [0.0, -down, z], atol=1e-12)
    turned = math.degrees(first + second)
    np.testing.assert_allclose(
        frames[-1][0][:, 2],
        [0.0, -math.sin(math.radians(turned)), math.cos(math.radians(turned))],
        atol=1e-12,
    )
    assert len(frames) == 3


@pytest.mark.parametrize("wound", [WOUND, WOUND | {"pattern": "single-helix-left"}])
def test_sections_of_equal_zones_are_the_section_without_zones(wound: dict[str, Any]) -> None:
    output = asked(at_pressures=["20 kPa"])
    alike = solve(case(wound=wound, **output))
    zones: list[dict[str, Any]] = [
        {"length": "18 mm", "winding": wound},
        {"winding": wound, "floor": "combined-base"},
    ]
    chained_run = solve(case(*zones, **output))
    for row in (row for row in alike.rows if row[col.PRESSURE] in (0.0, 20.0, 60.0)):
        (other,) = (
            r for r in chained_run.rows if r[col.PRESSURE] == pytest.approx(row[col.PRESSURE])
        )
        for key in row.keys() - ROUND_OFF - {col.STEP}:
            assert other[key] == pytest.approx(row[key], rel=1e-9, abs=1e-9), key


@pytest.mark.long
def test_cells_of_equal_zones_are_the_cell_without_zones() -> None:
    given: dict[str, Any] = {"model": "cell", "mesh": {"section": 1, "axial": "1 mm"}}
    alike = solve(case(wound=TURNS, **given)).rows[-1]
    zones: list[dict[str, Any]] = [{"length": "16 mm", "winding": TURNS}, {"winding": TURNS}]
    other = solve(case(*zones, **given)).rows[-1]
    for key in (col.ANGLE, col.TIP_Y, col.TIP_Z, col.VOLUME, col.AXIS_STRETCH, col.STORED):
        assert other[key] == pytest.approx(alike[key], rel=1e-7), key


@pytest.mark.long
def test_the_order_reversed_is_the_path_reversed() -> None:
    """Seen from the tip, where it is cut off at the caps, the line is the same."""
    bent, straight = {"length": "18 mm", "floor": "elastosil-m4601"}, {"length": "30 mm"}
    one = solve(case(bent, straight, wound=WOUND)).rows[-1]
    other = solve(case(straight, bent, wound=WOUND)).rows[-1]
    assert one[col.ANGLE] == pytest.approx(other[col.ANGLE], rel=1e-12)
    assert one[col.VOLUME] == pytest.approx(other[col.VOLUME], rel=1e-12)
    assert one["zone_1_angle_deg"] == pytest.approx(other["zone_2_angle_deg"], rel=1e-12)

    def ends(row: dict[str, Any]) -> np.ndarray:
        """The end of the centroids' line (z, y), without the cap, from that at the root."""
        theta = math.radians(row[col.ANGLE])
        actuator, height = parsed.actuator, parsed_height
        cap = actuator.cap
        lever = face - height
        z = row[col.TIP_Z] - cap * math.cos(theta) - lever * math.sin(theta)
        y = row[col.TIP_Y] - height + cap * math.sin(theta) - lever * math.cos(theta)
        return np.array([z, y])

    parsed = case(bent, straight, wound=WOUND)
    from fiberbend.case import convert
    from fiberbend.models.choice import meshed
    from geometry.mesh.centroid import section_fit

    face = convert.dimensions(parsed.actuator).face_height
    parsed_height = float(section_fit(meshed(parsed).mesh(parsed))[2][1])
    theta = math.radians(one[col.ANGLE])
    z, y = ends(one)
    # from the tip, backward: turned by θ and mirrored
    back = np.array(
        [z * math.cos(theta) - y * math.sin(theta), -z * math.sin(theta) - y * math.cos(theta)]
    )
    np.testing.assert_allclose(ends(other), [back[0], back[1]], rtol=1e-9, atol=1e-9)


def test_an_s_goes_back_to_where_it_came_from() -> None:
    tube = {"section": "circle", "radius": "3 mm", "length": "80 mm", "wall": "1 mm", "cap": "6 mm"}
    zones: list[dict[str, Any]] = [
        {"length": "40 mm", "strip": STRIP},
        {"strip": STRIP | {"at": "top"}},
    ]
    given: dict[str, Any] = {"actuator": tube, "materials": {"wall": "elastosil-m4601"}}
    row = solve(case(*zones, wound=WOUND | {"pitch": "2 mm"}, **given)).rows[-1]
    assert row[col.ANGLE] == pytest.approx(0.0, abs=1e-6)
    assert row["zone_1_angle_deg"] == pytest.approx(-row["zone_2_angle_deg"], rel=1e-6)
    assert row["zone_1_angle_deg"] > 30


@pytest.fixture(scope="module")
def three() -> RunResult:
    hand = WOUND | {"pattern": "single-helix-left"}
    zones: list[dict[str, Any]] = [
        {"length": "18 mm"},
        {"length": "10 mm", "floor": "elastosil-m4601"},
        {"winding": hand},
    ]
    output = {"at_angles": ["12 deg"], "at_pressures": ["20 kPa"], "stop_at_angle": "15 deg"}
    return solve(case(*zones, wound=WOUND, **asked(**output)))


def test_angles_of_the_whole_are_met(three: RunResult) -> None:
    angles = [row[col.ANGLE] for row in three.rows]
    assert min(abs(angle - 12) for angle in angles) < 2e-6
    assert angles[-1] == pytest.approx(15, abs=2e-6)
    assert any(row[col.PRESSURE] == pytest.approx(20, rel=1e-12) for row in three.rows)
    assert [row[col.STEP] for row in three.rows] == list(range(len(three.rows)))


def test_parts_of_zones_make_up_the_whole(three: RunResult) -> None:
    for row in three.rows:
        parts = [row[f"zone_{n}_angle_deg"] for n in (1, 2, 3)]
        assert sum(parts) == pytest.approx(row[col.ANGLE], abs=1e-12)
        assert row["zone_3_twist_deg"] == pytest.approx(row[col.TWIST], abs=1e-12)
    assert three.rows[-1][col.TWIST] != 0


def test_the_work_of_the_pressure_is_what_is_stored(three: RunResult) -> None:
    last = three.rows[-1]
    assert last[col.WORK] == pytest.approx(last[col.STORED], rel=2e-3)


def test_a_run_says_what_each_zone_took(three: RunResult) -> None:
    each = three.run["zones"]
    assert [zone["length_mm"] for zone in each] == [18.0, 10.0, 20.0]
    assert three.run["unknowns"] == sum(zone["unknowns"] for zone in each)


def test_the_answer_has_the_part_of_every_zone(three: RunResult) -> None:
    zones: list[dict[str, Any]] = [
        {"length": "18 mm"},
        {"length": "10 mm", "floor": "elastosil-m4601"},
        {"winding": WOUND | {"pattern": "single-helix-left"}},
    ]
    found = answer(case(*zones, wound=WOUND), three.rows, three.run)
    (entry,) = (each for each in found.entries if each.label == "angles of the zones")
    parts = [float(part.strip("°")) for part in entry.value.replace("−", "-").split(", ")]
    assert sum(parts) == pytest.approx(15, abs=0.05)


def test_an_angle_that_is_not_reached_is_said() -> None:
    zones: list[dict[str, Any]] = [{"length": "18 mm", "floor": "elastosil-m4601"}, {}]
    result = run_case(case(*zones, wound=WOUND, **asked(at_angles=["170 deg"])), None)
    assert result.status == "stopped"
    assert "170° not reached" in result.reason


@pytest.mark.long
def test_a_zone_that_balloons_ends_the_run() -> None:
    soft = {"length": "18 mm", "winding": "none"}
    rubber = {"wall": {"law": "neo-hooke", "mu": "0.3 MPa"}, "floor": "combined-base"}
    given: dict[str, Any] = {"effects": [{"pressure": {"to": "400 kPa"}}], "materials": rubber}
    result = run_case(case(soft, {}, wound=WOUND, **given), None)
    assert result.status == "stopped"
    assert result.reason.startswith("zone 1: 400 kPa is not reached: limit point")
    pressures = [row[col.PRESSURE] for row in result.rows]
    assert pressures == sorted(pressures)
    assert 0 < pressures[-1] < 400


@pytest.mark.long
def test_states_are_those_of_the_whole_in_space(tmp_path: Path) -> None:
    zones: list[dict[str, Any]] = [
        {"length": "18 mm", "floor": "elastosil-m4601"},
        {"winding": TURNS},
    ]
    given = case(
        *zones,
        wound=TURNS,
        model="cell",
        mesh={"section": 1, "axial": "2 mm"},
        **asked(fields=True),
    )
    result = run_case(given, tmp_path / "run")
    states = States(tmp_path / "run", given, result.rows)
    shown = states.model_mesh
    assert not shown.uniform
    assert {"wall", "floor", "floor_1"} == set(shown.mesh.regions)
    assert shown.lines is not None
    last = result.rows[-1]
    *_, shot = states
    assert shot.angle_deg == last[col.ANGLE]
    tip = shown.mesh.nodes[:, 2] > 48 - 1e-9
    assert tip.any()
    assert shot.multiplier.shape == shown.mesh.cells.shape


# --- the body -----------------------------------------------------------------------------------

FINE = {"solver": {"tolerance": 1e-11}}


@pytest.mark.long
def test_a_body_of_equal_zones_is_the_body_without() -> None:
    """Turns begin anew at a border: the first zone is two pitches long, and planes agree."""
    turns = TURNS | {"pitch": "8 mm"}
    given: dict[str, Any] = {"model": "body", "mesh": {"axial": "4 mm"}, **FINE}
    alike = solve(case(wound=turns, **given)).rows[-1]
    zones: list[dict[str, Any]] = [
        {"length": "16 mm", "winding": turns},
        {"winding": turns, "floor": "combined-base"},
    ]
    other = solve(case(*zones, **given)).rows[-1]
    for key in (col.ANGLE, col.TIP_Y, col.TIP_Z, col.VOLUME, col.STORED, col.FIBER_MAX):
        assert other[key] == pytest.approx(alike[key], rel=1e-9), key
    parts = other["zone_1_angle_deg"] + other["zone_2_angle_deg"]
    assert parts == pytest.approx(other[col.ANGLE], rel=1e-12)


def test_steps_of_an_s_are_as_short_as_is_asked() -> None:
    """Its bending angle stays zero; each of its halves turns by no more than a step may."""
    tube = {"section": "circle", "radius": "3 mm", "length": "64 mm", "wall": "1 mm"}
    strips = [{"strip": STRIP | {"at": at}} for at in ("bottom", "top")]
    given = case(
        {"length": "32 mm"} | strips[0],
        strips[1],
        wound=WOUND,
        actuator=tube | {"cap": "6 mm"},
        materials={"wall": "elastosil-m4601"},
        model="body",
        mesh={"axial": "8 mm"},
        solver={"max_turn": "3 deg"},
        effects=[{"pressure": {"to": "24 kPa"}}],
    )
    rows = solve(given).rows
    first = np.array([row["zone_1_angle_deg"] for row in rows])
    assert first[-1] > 9
    assert np.abs([row[col.ANGLE] for row in rows]).max() < 0.5
    # caps turn with the ends, and the step to come is foreseen
    assert np.diff(first).max() < 1.25 * 3


@pytest.mark.long
def test_a_body_on_tetrahedra_has_zones_too() -> None:
    given: dict[str, Any] = {"model": "body", "mesh": {"axial": "6 mm", "element": "tetrahedron"}}
    zones: list[dict[str, Any]] = [{"length": "16 mm", "floor": "elastosil-m4601"}, {}]
    row = solve(case(*zones, wound=WOUND, **given)).rows[-1]
    assert row["zone_2_angle_deg"] / 32 > 2 * row["zone_1_angle_deg"] / 16


CLOSE = {"s_shape": (2.0, 3.0), "thumb": (2.0, 3.0)}
"""Greatest distance of the tips in mm, and of the angles in percent of the body's."""


@pytest.mark.hard
@pytest.mark.parametrize("name", CLOSE)
def test_a_chained_section_is_close_to_the_body(name: str) -> None:
    path = ROOT / "cases" / f"{name}.yaml"
    quiet = [f"output.{key}=false" for key in QUIET]
    one = solve(read_case(path, quiet)).rows
    other = solve(read_case(path, [*quiet, "model=body"])).rows
    farthest, percent = CLOSE[name]
    for pressure in (12.0, 24.0):
        a, b = (
            next(row for row in rows if row[col.PRESSURE] == pytest.approx(pressure, rel=1e-9))
            for rows in (one, other)
        )
        tips = [np.array([row[key] for key in (col.TIP_X, col.TIP_Y, col.TIP_Z)]) for row in (a, b)]
        assert np.linalg.norm(tips[0] - tips[1]) < farthest
        turned = [key for key in b if key.startswith("zone_") and key.endswith("_deg")]
        for key in turned:
            assert a.get(key, 0.0) == pytest.approx(b[key], rel=percent / 100, abs=0.6), key
