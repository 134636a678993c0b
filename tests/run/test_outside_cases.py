"""Small cases that once went wrong, each with what is right and why."""

from __future__ import annotations

from typing import Any

import pytest

import fiberbend
from fem.march.predictor import Predictor
from fiberbend.models.result import RunResult

NO_FILES = {"fields": False, "pictures": False}
THREAD = {"modulus": "31067 MPa", "diameter": "0.1778 mm"}


def _tube(mu: str, wall: str = "2 mm", **more: Any) -> dict[str, Any]:
    return {
        "actuator": {"section": "circle", "length": "160 mm", "wall": wall, **more},
        "materials": {"wall": {"law": "neo-hooke", "mu": mu}},
        "model": "section",
        "output": NO_FILES,
    }


def _smeared(pattern: str, pitch: str, fiber: Any) -> dict[str, Any]:
    return {"winding": {"pattern": pattern, "pitch": pitch, "fiber": fiber, "as": "smeared"}}


def _run(case: dict[str, Any], *effects: dict[str, Any]) -> RunResult:
    return fiberbend.run({"title": "outside", **case, "effects": list(effects)})


@pytest.mark.parametrize(("hand", "sign"), [("right", 1), ("left", -1)])
def test_a_tube_with_one_helix_twists_about_its_axis(hand: str, sign: int) -> None:
    # exact tube of neo-Hookean rubber with one family of fibers, 9 psi
    case = _tube("0.24 MPa", radius="6.35 mm")
    winding = _smeared(f"single-helix-{hand}", "30.29 mm", THREAD)
    result = _run(case, {"pressure": {"to": "9 psi"}}, winding)
    assert result.last("angle_deg") == pytest.approx(0, abs=1e-6)
    assert result.last("side_angle_deg") == pytest.approx(0, abs=1e-6)
    assert result.last("twist_deg") == pytest.approx(-334.45 * sign, rel=1e-4)
    assert result.last("axis_stretch") == pytest.approx(1.0825, rel=1e-4)
    assert result.last("chamber_mm3") == pytest.approx(39484.29, rel=1e-5)
    # the tip stays on the axis
    assert result.last("tip_x_mm") == pytest.approx(0, abs=1e-6)
    assert result.last("tip_y_mm") == pytest.approx(8.35, abs=1e-6)


def test_a_braid_near_the_axis_hardly_shortens() -> None:
    # exact tube with two families 10° from the axis: the pitch is longer than the chamber
    case = _tube("0.24 MPa", radius="6.35 mm")
    result = _run(case, {"pressure": {"to": "60 kPa"}}, _smeared("double-helix", "297 mm", THREAD))
    assert result.last("axis_stretch") == pytest.approx(0.9873859, abs=2e-7)
    assert result.last("angle_deg") == pytest.approx(0, abs=1e-6)


def test_a_held_round_tube_pushes_along_its_axis_alone() -> None:
    case = _tube("0.22 MPa", radius="8 mm")
    case["actuator"]["length"] = "100 mm"
    result = _run(case, {"pressure": {"to": "0.3 bar"}}, {"straight": {"stretch": "held"}})
    assert result.last("tip_force_N") == pytest.approx(0, abs=1e-9)
    assert result.last("axial_force_N") == pytest.approx(2.8113, rel=1e-4)


def test_an_unwound_finger_with_a_stiff_floor_reaches_its_angle() -> None:
    # dθ/dP is zero at rest; 40.91 kPa is what a pressure by value finds
    case = {
        "actuator": {
            "section": "rectangle",
            **dict.fromkeys(("width", "height"), "12 mm"),
            **dict.fromkeys(("wall", "floor"), "2 mm"),
            "length": "100 mm",
        },
        "materials": {"wall": "elastosil-m4601", "floor": "combined-base"},
        "model": "section",
        "output": NO_FILES,
    }
    driven = _run(case, {"pressure": {"angle": "20 deg"}})
    assert driven.status == "converged"
    assert driven.last("angle_deg") == pytest.approx(20, abs=1e-6)
    assert driven.last("pressure_kPa") == pytest.approx(40.91, abs=0.005)


def test_what_is_zero_is_what_is_left_out() -> None:
    wall = {"law": "yeoh", "c1": "0.11 MPa"}
    base = _tube("1 MPa", wall="1 mm", radius="10 mm")
    zeros = {**base, "actuator": {**base["actuator"], "sheath": "0 mm"}}
    zeros["materials"] = {"wall": {**wall, "c2": "0 MPa", "c3": "0 MPa"}}
    pressure = {"pressure": {"to": "5 kPa"}}
    plain = _run({**base, "materials": {"wall": wall}}, pressure)
    assert _run(zeros, pressure).rows == plain.rows


def test_bend_and_twist_have_one_meaning() -> None:
    # the line y = 0 bends by 95.83° and twists by 47.61°; the centroids' line by its own
    case = {
        "actuator": {"radius": "8 mm", "length": "80 mm", "sheath": "1 mm", "section": "hemicircle"}
        | dict.fromkeys(("wall", "floor"), "2 mm"),
        "materials": {
            "wall": "elastosil-m4601",
            "floor": "combined-base",
            "sheath": "ecoflex-0030",
        },
        "model": "section",
        "output": NO_FILES,
    }
    winding = _smeared("single-helix-left", "6 mm", "kevlar")
    result = _run(case, {"pressure": {"to": "100 kPa"}}, winding)
    assert result.last("angle_deg") == pytest.approx(98.572, abs=0.01)
    assert result.last("twist_deg") == pytest.approx(41.648, abs=0.01)


def _tube_under_vacuum(step: str | None) -> RunResult:
    wall = {"law": "neo-hooke", "mu": "0.22 MPa", "density": "1.1 g/cm^3"}
    case = {
        "actuator": {
            **{"section": "circle", "radius": "8 mm", "length": "60 mm"},
            **{"wall": "1 mm", "cap": "5 mm"},
        },
        "materials": {"wall": wall},
        "model": "body",
        "mesh": {"axial": "6 mm"},
        "output": NO_FILES,
    }
    if step:
        case["solver"] = {"max_step": step}
    return _run(case, {"gravity": {"direction": "-y"}}, {"pressure": {"to": "-1.2 kPa"}})


@pytest.mark.verify
@pytest.mark.parametrize("step", [None, "0.3 kPa", "0.1 kPa"])
def test_a_tube_under_vacuum_ends_alike_whatever_the_step(step: str | None) -> None:
    result = _tube_under_vacuum(step)
    assert result.status == "converged"
    lost = next(p for p in result.run["critical_points"] if p["kind"] == "limit")
    assert lost["pressure_kPa"] == pytest.approx(-0.531, abs=0.002)
    assert result.last("chamber_mm3") == pytest.approx(2533.38, rel=1e-3)
    assert result.last("angle_deg") == pytest.approx(48.85, abs=0.05)
    assert result.last("unstable_modes") == 0


@pytest.mark.verify
def test_a_predictor_that_went_astray(monkeypatch: pytest.MonkeyPatch) -> None:
    """After a failure it goes straight on from two states: else the tube's collapse ends early."""
    monkeypatch.setattr(Predictor, "heed", lambda *_, **__: None)
    assert _tube_under_vacuum(None).status == "stopped"
