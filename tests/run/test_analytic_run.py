"""`model: analytic`: the closed form of a case is right, and its run is a run like any other.

A user reads the same columns whatever the model, and takes the closed form's answer for the case
at hand: its rubber, its floor, its sheath.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.closed_form import (
    analytic_curves,
    assumptions,
    no_analytic,
)
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from fiberbend.results.folder import (
    HISTORY_COLUMNS,
    RUN_KEYS,
    RunFolder,
)
from fiberbend.results.reading import read_history
from fiberbend.running.analytic import run_analytic
from fiberbend.running.progress import Progress
from materials.material import Material

ROOT = Path(__file__).resolve().parents[2]
SMEARED = ROOT / "cases" / "free_bending_smeared.yaml"
QUIET = Progress(quiet=True)


def case_with(**sections: Any) -> Case:
    """The baseline with a smeared winding, free bending to 200 kPa, and changes to it."""
    data: dict[str, Any] = yaml.safe_load(SMEARED.read_text(encoding="utf-8"))
    data |= {"model": "analytic", "output": {}}
    for name, change in sections.items():
        data[name] = {**data[name], **change} if isinstance(change, dict) else change
    return parse_case(data)


def loaded(*loads: dict[str, Any]) -> list[dict[str, Any]]:
    winding = {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"}
    return [*loads, {"winding": winding}]


def run(case: Case) -> RunResult:
    return run_analytic(case, None, QUIET)


def column(result: RunResult, name: str) -> np.ndarray:
    return np.array([row[name] for row in result.rows])


# --- the closed form of a case ----------------------------------------------------------------


def test_lines_of_the_baseline() -> None:
    quarters = np.radians([90, 180, 270, 360])
    curves = analytic_curves(case_with())
    kilopascal = {name: 1e3 * curve.pressure(quarters) for name, curve in curves.items()}
    # worked out independently of this project
    assert kilopascal["paper"] == pytest.approx([78.197, 140.691, 192.815, 237.828], abs=5e-4)
    # one moment, two acting areas: 542.395 mm³ and the closed form of a half disk on a rectangle
    ratio = 542.395 / (2 / 3 * 10**3 + math.pi / 2 * 10**2 * 2 + 10 * 2**2)
    assert kilopascal["winding"] == pytest.approx(ratio * kilopascal["zero-fit"], rel=1e-5)
    # the wall's own law and the sheath, by hand at small angles: 4 · 2 W'(3) I/L over κ
    a, b, r, s = 8.0, 2.0, 10.0, 11.0
    wall = _inertia(b, a, r) + 2 * r * b**3 / 3
    sheath = _inertia(b, r, s) + 2 * b**3 / 3 + 2 * s / 3
    slope = 4 * (0.22 * wall + 2 * 0.012662 * sheath) / 160 / 542.395
    assert float(curves["zero-fit"].pressure(1e-5)) == pytest.approx(slope * 1e-5, rel=1e-4)


def _inertia(floor: float, inner: float, outer: float) -> float:
    """∫ y² dA of a half ring on y = `floor`."""
    disk = math.pi / 8 * (outer**4 - inner**4) + 4 / 3 * floor * (outer**3 - inner**3)
    return disk + floor**2 * math.pi / 2 * (outer**2 - inner**2)


def test_law_with_two_invariants_enters_by_both_slopes() -> None:
    law = {"law": "mooney-rivlin", "c10": "0.08 MPa", "c01": "0.03 MPa"}
    closed = analytic_curves(case_with(materials={"wall": law}))["zero-fit"]
    material = Material("mooney-rivlin", {"c10": 0.08, "c01": 0.03})

    def energy(stretch: float) -> float:
        return float(material.energy(stretch, 1.0, 1 / stretch))

    # s = dW/dλ with the circumference held
    for stretch in (0.8, 1.3, 2.0):
        slope = (energy(stretch + 1e-6) - energy(stretch - 1e-6)) / 2e-6
        assert float(closed.stress(np.array(stretch))) == pytest.approx(slope, rel=1e-7)


def test_stiff_floor_is_the_line_and_a_rubber_floor_needs_a_layer() -> None:
    baseline = case_with()
    assert analytic_curves(baseline)["zero-fit"].floor_stress is None
    assert any("the floor enters as rubber" in remark for remark in assumptions(baseline))
    rubber = {"floor": "elastosil-m4601"}
    reason = no_analytic(case_with(materials=rubber, model="body"))
    # area of the floor over the wall's, 40/56.5 mm²
    assert reason is not None
    assert "only 0.71 times as hard as the wall" in reason
    fabric = {"layer": {"law": "neo-hooke", "mu": "1 GPa"}}
    both = case_with(actuator={"layer": "0.2 mm"}, materials=rubber | fabric)
    assert no_analytic(both) is None
    closed = analytic_curves(both)["zero-fit"]
    assert closed.floor_stress is not None
    assert closed.floor_stress(np.array(1.2)) == closed.stress(np.array(1.2))


def test_cases_without_a_closed_form_say_why() -> None:
    free = case_with(effects=[{"pressure": {"to": "10 kPa"}}], model="body")
    assert "no winding" in str(no_analytic(free))
    assert analytic_curves(free) == {}
    with pytest.raises(ValueError, match="no winding fixes the circumference"):
        run(free)


# --- its run ----------------------------------------------------------------------------------


def test_pressures_and_angles_are_hit_exactly_on_a_smooth_curve() -> None:
    output = {"at_angles": ["90 deg", "180 deg"], "at_pressures": ["50 kPa", "123.4 kPa"]}
    case = case_with(output=output)
    result = run(case)
    assert (result.status, result.reason) == ("converged", "")
    pressures, angles = column(result, "pressure_kPa"), column(result, "angle_deg")
    closed = analytic_curves(case)["zero-fit"]
    assert pressures == pytest.approx(1e3 * closed.pressure(np.radians(angles)), rel=1e-9)
    assert {50.0, 123.4, 200.0} <= {round(value, 9) for value in pressures}
    for angle in (90, 180):
        assert np.abs(angles - angle).min() < 1e-9
    assert pressures[-1] == pytest.approx(200, rel=1e-12)
    assert pressures[0] == angles[0] == 0
    # smooth: no step turns more than a tenth of a right angle here
    assert np.all(np.diff(angles) > 0)
    assert np.diff(angles).max() < 9.1


def test_tip_and_volume() -> None:
    result = run(case_with())
    rest = result.rows[0]
    # the centroid of the cap's face: half disk of radius 11 on a rectangle of 22 × 3 below y = 2
    disk, box = math.pi * 11**2 / 2, 22 * 3
    height = (disk * (2 + 44 / (3 * math.pi)) + box * 0.5) / (disk + box)
    assert (rest["tip_z_mm"], rest["tip_y_mm"]) == pytest.approx((175, height))
    assert convert.dimensions(case_with().actuator).face_height == pytest.approx(height)
    assert rest["chamber_mm3"] == pytest.approx(math.pi * 32 * 160)
    # virtual work: P dV = M dθ with P κ = M
    angles, volumes = np.radians(column(result, "angle_deg")), column(result, "chamber_mm3")
    assert np.diff(volumes) / np.diff(angles) == pytest.approx(542.395, rel=1e-5)
    for row in result.rows[1:]:
        # L_tip from the arc's end: straight cap, and the face's height along its normal
        theta = math.radians(row["angle_deg"])
        z = 160 / theta * math.sin(theta) + 15 * math.cos(theta) + height * math.sin(theta)
        y = 160 / theta * (math.cos(theta) - 1) - 15 * math.sin(theta) + height * math.cos(theta)
        assert (row["tip_z_mm"], row["tip_y_mm"]) == pytest.approx((z, y), abs=1e-9)


def test_the_load_can_be_an_angle() -> None:
    result = run(case_with(effects=loaded({"pressure": {"angle": "270 deg"}})))
    assert result.status == "converged"
    assert result.last("angle_deg") == pytest.approx(270)
    backward = run(case_with(effects=loaded({"pressure": {"angle": "-30 deg"}})))
    assert backward.last("angle_deg") == pytest.approx(-30)
    assert backward.last("pressure_kPa") < 0


def test_a_run_stops_where_it_is_told_and_says_what_it_does_not_reach() -> None:
    case = case_with(output={"at_angles": ["90 deg"], "stop_at_angle": "120 deg"})
    result = run(case)
    assert (result.status, result.last("angle_deg")) == ("converged", pytest.approx(120))
    short = run(case_with(output={"at_angles": ["360 deg"], "stop_at_angle": "360 deg"}))
    assert short.status == "stopped"
    # 360° takes 204.6 kPa
    assert short.reason == "the loads end at 351.3°: 360° not reached"


def test_loads_beyond_the_closed_form() -> None:
    output = {"at_pressures": ["50 kPa"]}
    high = run(case_with(effects=loaded({"pressure": {"to": "2 MPa"}}), output=output))
    assert 50.0 in column(high, "pressure_kPa")
    assert high.status == "stopped"
    assert high.reason.startswith("the closed form ends with")
    assert high.last("angle_deg") == pytest.approx(720)
    # a wall that softens has a greatest pressure
    soft = {"wall": {"law": "yeoh", "c1": "0.11 MPa", "c2": "-20 kPa"}}
    limit = run(case_with(materials=soft))
    assert limit.status == "stopped"
    assert limit.reason.startswith("the pressure has its greatest value")
    assert np.all(np.diff(column(limit, "pressure_kPa")) > 0)


def test_kept_straight() -> None:
    straight = case_with(effects=loaded({"pressure": {"to": "200 kPa"}}, {"straight": {}}))
    result = run(straight)
    # by hand: F = κP/L_f at 200 kPa with L_f = 15 mm
    assert result.last("tip_force_N") == pytest.approx(7.23, abs=0.005)
    assert np.all(column(result, "angle_deg") == 0)
    assert result.run["crosscheck"]["analytic_winding"]["band_percent"] is None


def test_folder_of_a_run(tmp_path: Path) -> None:
    case = case_with(output={"at_angles": ["90 deg"]})
    folder = RunFolder.create(tmp_path / "run", case)
    result = run_analytic(case, folder, QUIET)
    assert result.folder == folder.path
    text = (folder.path / "history.csv").read_text(encoding="utf-8").splitlines()
    assert text[0].startswith(",".join(HISTORY_COLUMNS))
    assert text[0].endswith("analytic_winding_kPa,analytic_paper_kPa")
    assert len(read_history(folder.path / "history.csv")) == len(result.rows)
    data = json.loads((folder.path / "run.json").read_text(encoding="utf-8"))
    assert list(data)[: len(RUN_KEYS)] == list(RUN_KEYS)
    assert (data["model"], data["unknowns"], data["status"]) == ("analytic", 0, "converged")
    assert data["analytic"]["line"] == "zero-fit"
    pictures = sorted(path.name for path in (folder.path / "pictures").iterdir())
    assert pictures == ["pressure_angle.png", "rest.png", "tip_path.png"]
