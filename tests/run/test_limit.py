"""Actuators that nothing holds together balloon: every model passes the limit point and says so."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from fiberbend import run
from fiberbend.reader.reader import as_case
from fiberbend.running.progress import Progress
from fiberbend.running.runner import RunResult, run_case
from materials.material import Material
from tests.exact.solutions import Tube

QUIET = {"pictures": False, "fields": False}
SOFT: dict[str, Any] = {
    "actuator": {
        "section": "hemicircle",
        "radius": "8 mm",
        "length": "40 mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "cap": "8 mm",
    },
    "materials": {
        "wall": {"law": "neo-hooke", "mu": "0.22 MPa"},
        "floor": {"law": "neo-hooke", "mu": "0.5 MPa"},
    },
    "effects": [{"pressure": {"to": "100 kPa"}}],
    "model": "section",
    "mesh": {"axial": "8 mm"},
    "output": QUIET,
}
"""No winding, and a floor that is only twice as stiff as the wall."""
TUBE = {"section": "circle", "radius": "8 mm", "length": "80 mm", "wall": "2 mm", "cap": "8 mm"}


def _limit(result: RunResult) -> dict[str, Any]:
    points: list[dict[str, Any]] = result.run["critical_points"]
    (point,) = (p for p in points if p["kind"] == "limit" and p["unstable_modes_beyond"] == 1)
    return point


def _soft(**changes: Any) -> RunResult:
    return run(SOFT | changes)


@pytest.fixture(scope="module")
def balloon() -> RunResult:
    """The section of the soft actuator."""
    return _soft()


def test_a_neo_hookean_tube_balloons_at_its_exact_limit_point() -> None:
    # greatest pressure over the inner radius of the closed tube 8/10; the mesh is 3e-5 off
    law = Material("yeoh", {"c1": 0.11}).principal

    def pressure(ratio: float) -> float:
        def tube(stretch: float) -> Tube:
            return Tube(law, 8.0, 10.0, 8.0 * ratio, stretch)

        return tube(brentq(lambda s: tube(s).axial_force, 0.5, 3.0)).pressure

    best = minimize_scalar(lambda a: -pressure(a), bounds=(1.1, 2.5), method="bounded")
    materials = {"wall": {"law": "neo-hooke", "mu": "0.22 MPa"}}
    found = _limit(_soft(actuator=TUBE, materials=materials))
    assert found["pressure_kPa"] == pytest.approx(-1e3 * best.fun, rel=2e-4)


def test_the_run_stops_and_says_what_happens(balloon: RunResult) -> None:
    # before: pressure steps to and fro at the limit point, then 'an element turned inside out'
    limit = _limit(balloon)["pressure_kPa"]
    assert balloon.status == "stopped"
    assert f"100 kPa is not reached: limit point at {limit:.4g} kPa" in balloon.reason
    assert "balloons at falling pressure; followed to 4 times the volume" in balloon.reason
    assert len(balloon.run["warnings"]) == 1
    assert balloon.last("pressure_kPa") < limit
    assert [row["unstable_modes"] for row in balloon.rows[1:]].index(1) > 5


def test_history_and_energy_go_through_the_limit_point(balloon: RunResult) -> None:
    # ∫ P dV is what is stored, on the falling branch too; 1e-4 for the spline through the steps
    rows = balloon.rows
    assert np.all(np.diff([row["chamber_mm3"] for row in rows]) > 0)
    assert rows[-1]["work_mJ"] == pytest.approx(rows[-1]["stored_mJ"], rel=1e-4)


def test_the_line_is_printed_once_while_it_happens() -> None:
    stream = io.StringIO()
    run_case(as_case(SOFT), None, progress=Progress(stream=stream))
    lines = stream.getvalue().splitlines()
    (at,) = (i for i, line in enumerate(lines) if line.startswith("limit point at"))
    assert any(line.startswith("step") for line in lines[at + 1 :])


def test_given_angle_passes_the_same_limit_point(balloon: RunResult) -> None:
    # the angle never meets a limit; interpolated between steps of 10°, the flat top's place less
    other = _soft(effects=[{"pressure": {"angle": "60 deg"}}])
    assert other.status == "converged"
    for name, error in (("pressure_kPa", 5e-4), ("angle_deg", 2e-2)):
        assert _limit(other)[name] == pytest.approx(_limit(balloon)[name], rel=error)


def test_requested_angles_are_hit_on_the_falling_branch(balloon: RunResult) -> None:
    beyond = _limit(balloon)["angle_deg"] + 15.0
    other = _soft(output=QUIET | {"at_angles": [f"{beyond} deg"], "stop_at_angle": "70 deg"})
    angles = np.array([row["angle_deg"] for row in other.rows])
    assert other.status == "converged"
    assert np.abs(angles - beyond).min() < 1e-6
    assert angles[-1] == pytest.approx(70.0, abs=1e-6)
    assert other.run["warnings"][-1].startswith("the end is unstable")


@pytest.mark.long
def test_a_body_balloons_too(tmp_path: Path, balloon: RunResult) -> None:
    # caps hold the ends of a chamber that is two and a half diameters long: 5 % more pressure
    body = run(SOFT | {"model": "body"}, tmp_path / "run")
    assert body.status == "stopped"
    more = _limit(body)["pressure_kPa"] / _limit(balloon)["pressure_kPa"]
    assert 1.0 < more < 1.1
    saved = json.loads((tmp_path / "run" / "run.json").read_text())
    assert saved["critical_points"] == body.run["critical_points"]
    assert saved["warnings"] == body.run["warnings"]


def test_a_pressure_beyond_a_snap_is_reached() -> None:
    # a Yeoh tube that stiffens: 41.0 kPa at its limit point, 50 kPa on the far branch
    wall = {"law": "yeoh", "c1": "0.11 MPa", "c2": "0.004 MPa"}
    result = _soft(
        actuator=TUBE, materials={"wall": wall}, effects=[{"pressure": {"to": "50 kPa"}}]
    )
    assert result.status == "converged"
    assert result.last("pressure_kPa") == pytest.approx(50.0, abs=1e-9)
    assert ["balloons" in result.run["warnings"][0], "snaps" in result.run["warnings"][1]] == [
        True,
        True,
    ]


def test_an_actuator_with_its_winding_has_no_critical_point(small_run: RunResult) -> None:
    assert small_run.run["critical_points"] == []
    # its mesh is coarse, and that is all
    unresolved = ("winding NOT resolved", "elements of 4 mm do not resolve a pitch of 3 mm")
    assert all(text.startswith(unresolved) for text in small_run.run["warnings"])
