"""Angles and stops that a case asks for: hit, named, or told to be missed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend import run
from fiberbend.models.result import RunResult
from tests.run.conftest import small
from tests.run.test_angle_drive import QUIET, finger, shaped

HEAVY = {
    "wall": {"name": "elastosil-m4601", "density": "1.1 g/cm^3"},
    "floor": {"name": "combined-base", "density": "1.2 g/cm^3"},
    "sheath": {"name": "ecoflex-0030", "density": "1.07 g/cm^3"},
}
WINDING = {
    "winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"}
}


def gravity(direction: str, acceleration: str = "300 m/s^2") -> dict[str, Any]:
    """Weight thirty times that of the Earth, so that a short body bends by degrees."""
    return {"gravity": {"direction": direction, "acceleration": acceleration}}


def heavy(*effects: dict[str, Any], **output: Any) -> RunResult:
    """The small body with weight."""
    mesh = {"axial": "6 mm"}
    return run(small(effects=list(effects), materials=HEAVY, mesh=mesh, output=QUIET | output))


def section(to: str, **output: Any) -> RunResult:
    """A wound section up to a pressure."""
    effects = [{"pressure": {"to": to}}, WINDING]
    actuator = shaped("hemicircle")
    case = finger(effects=effects, actuator=actuator, mesh={"section": 1}, output=QUIET | output)
    return run(case)


def angles(result: RunResult) -> np.ndarray:
    """The angles of a run, °."""
    return np.array([row["angle_deg"] for row in result.rows])


@pytest.mark.parametrize("side", [1, -1])
def test_angles_are_hit_whichever_way_the_pressure_bends(side: int) -> None:
    asked = [f"{side * angle} deg" for angle in (3, 1)]
    found = section(f"{10 * side} kPa", at_angles=asked, stop_at_angle=f"{4 * side} deg")
    assert (found.status, found.run["warnings"]) == ("converged", [])
    for goal in (1, 3):
        assert np.abs(angles(found) - side * goal).min() < 1e-6
    assert found.last("angle_deg") == pytest.approx(4 * side, abs=1e-6)


@pytest.mark.parametrize(("to", "asked"), [("5 kPa", "-3 deg"), ("-5 kPa", "3 deg")])
def test_an_angle_on_the_other_side_is_told_to_be_missed(to: str, asked: str) -> None:
    for output in ({"at_angles": [asked]}, {"stop_at_angle": asked}):
        found = section(to, **output)
        assert found.status == "stopped"
        assert f"{asked.removesuffix(' deg')}° not reached" in found.reason
        expected = [f"asked for and not reached: {asked.removesuffix(' deg')}°"]
        assert found.run["warnings"] == expected


def test_what_a_failed_run_has_not_reached_is_told(tmp_path: Path) -> None:
    case = finger(
        effects=[{"pressure": {"to": "5 MPa"}}, WINDING],
        actuator=shaped("hemicircle"),
        solver={"first_step": "2 kPa", "max_step": "5 MPa", "max_turn": "700 deg"},
        output=QUIET | {"at_angles": ["1 deg", "700 deg"], "at_pressures": ["4999 kPa"]},
    )
    case["solver"]["max_cutbacks"] = 0
    found = run(case, tmp_path / "run")
    assert found.status == "failed"
    assert found.reason.endswith("700°, 4999 kPa not reached")
    saved = json.loads((tmp_path / "run" / "run.json").read_text())
    assert "asked for and not reached: 700°, 4999 kPa" in saved["warnings"]


def test_states_of_one_whole_degree_have_names_of_their_own(tmp_path: Path) -> None:
    effects = [{"pressure": {"to": "10 kPa"}}, WINDING]
    output = {"at_angles": ["3.1 deg", "3.4 deg", "1 deg"], "pictures": False}
    actuator = shaped("hemicircle")
    case = finger(effects=effects, actuator=actuator, mesh={"section": 1}, output=output)
    assert run(case, tmp_path / "run").status == "converged"
    names = {"001deg", "003.1deg", "003.4deg"}
    assert names < {path.stem for path in (tmp_path / "run" / "snapshots").iterdir()}
    assert names < {path.stem for path in (tmp_path / "run" / "fields").iterdir()}


@pytest.mark.parametrize(("direction", "side"), [("-y", 1), ("+y", -1)])
def test_angles_are_hit_under_weight(direction: str, side: int) -> None:
    found = heavy(gravity(direction), at_angles=[f"{side} deg", f"{-side} deg"])
    assert np.abs(angles(found) - side).min() < 1e-6
    assert found.run["warnings"] == [f"asked for and not reached: {-side}°"]
    assert found.status == "stopped"


def test_weight_is_put_on_whole_and_the_pressure_stops_where_it_crosses() -> None:
    # weight lifts the body to -1.5°; the pressure brings it back through the stop
    found = heavy(gravity("+y"), {"pressure": {"to": "60 kPa"}}, WINDING, stop_at_angle="-0.1 deg")
    assert (found.status, found.run["warnings"]) == ("converged", [])
    assert min(angles(found)) < -0.2
    assert found.last("angle_deg") == pytest.approx(-0.1, abs=1e-6)
    assert found.last("pressure_kPa") > 0


def test_a_stop_that_only_weight_passes_is_told_to_be_missed() -> None:
    # it used to end the pressure at once, 'converged' at 0 kPa
    effects = (gravity("-y"), {"pressure": {"to": "20 kPa"}}, WINDING)
    found = heavy(*effects, stop_at_angle="0.1 deg")
    assert found.status == "stopped"
    assert found.last("pressure_kPa") == pytest.approx(20.0)
    assert "0.1° not reached (0.1° is passed by what is put on before the pressure" in found.reason


def test_a_stop_under_pressure_says_which_load_never_acted() -> None:
    effects = ({"pressure": {"to": "60 kPa"}}, WINDING, gravity("-y"))
    found = heavy(*effects, stop_at_angle="3 deg")
    assert (found.status, found.last("angle_deg")) == ("converged", pytest.approx(3.0))
    assert found.run["warnings"] == ["the run ended at 3°, before gravity acted"]


def test_weight_after_the_pressure_passes_an_angle_again(tmp_path: Path) -> None:
    effects = [{"pressure": {"to": "17.2 kPa"}}, WINDING, gravity("+y")]
    mesh, output = {"axial": "6 mm"}, {"at_angles": ["5 deg"], "pictures": False}
    case = small(effects=effects, materials=HEAVY, mesh=mesh, output=output)
    found = run(case, tmp_path / "run")
    assert np.sum(np.abs(angles(found) - 5.0) < 1e-6) == 2
    names = {path.stem for path in (tmp_path / "run" / "snapshots").iterdir()}
    assert {"005deg", "005deg-2"} <= names


def test_gent_rubber_names_the_limit_that_ends_a_run() -> None:
    # the wall carries ever more pressure and yields no more
    materials = {"wall": {"law": "gent", "mu": "0.3 MPa", "jm": 3}, "floor": "combined-base"}
    case = finger(
        materials=materials,
        actuator=shaped("hemicircle") | {"length": "100 mm"},
        effects=[{"pressure": {"to": "40 MPa"}}, WINDING],
    )
    found = run(case)
    assert found.status != "converged"
    assert "the rubber meets its limiting stretch (gent): it has used 9" in found.reason
