"""Runs with the laws beyond the paper's."""

from __future__ import annotations

from typing import Any

import pytest
import yaml

from fiberbend import run
from fiberbend.models.result import RunResult
from tests.conftest import ROOT

CASE = yaml.safe_load((ROOT / "cases" / "free_bending.yaml").read_text(encoding="utf-8"))
WINDING = {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}}


def baseline(wall: dict[str, Any], model: str = "section", **pressure: str) -> dict[str, Any]:
    """The baseline with a wall of another rubber."""
    return {
        "actuator": CASE["actuator"],
        "materials": CASE["materials"] | {"wall": wall},
        "effects": [{"pressure": pressure}, WINDING],
        "model": model,
        "output": {"pictures": False, "fields": False},
    }


def column(result: RunResult, name: str) -> list[float]:
    return [row[name] for row in result.rows]


def test_ogden_with_an_exponent_of_two_is_neo_hooke() -> None:
    neo, ogden = (
        run(baseline(wall, to="60 kPa"))
        for wall in (
            {"law": "neo-hooke", "mu": "0.3 MPa"},
            {"law": "ogden", "mu1": "0.3 MPa", "alpha1": 2},
        )
    )
    for name in ("pressure_kPa", "angle_deg", "tip_y_mm", "tip_z_mm", "chamber_mm3", "min_det_F"):
        assert column(ogden, name) == pytest.approx(column(neo, name), rel=1e-9, abs=1e-9)
    assert column(ogden, "newton_iterations") == column(neo, "newton_iterations")


def test_gent_far_from_its_limit_is_neo_hooke() -> None:
    stiff = run(baseline({"law": "gent", "mu": "0.3 MPa", "jm": 1e9}, to="20 kPa"))
    plain = run(baseline({"law": "neo-hooke", "mu": "0.3 MPa"}, to="20 kPa"))
    assert stiff.last("angle_deg") == pytest.approx(plain.last("angle_deg"), rel=1e-7)


def test_a_rubber_at_its_limiting_stretch_fails_honestly() -> None:
    # the roof would need I1 − 3 = 0.2 at some 145°, beyond which no state exists
    gent = {"law": "gent", "mu": "0.3 MPa", "jm": 0.2}
    result = run(baseline(gent, angle="360 deg"))
    assert result.status == "stopped"
    angles, pressures = column(result, "angle_deg"), column(result, "pressure_kPa")
    most = max(angles)
    assert f"the angle is greatest at {most:.4g}°" in result.reason
    assert pressures == sorted(pressures), "the actuator locks"
    assert 120 < most < 180
    # a pressure it can always bear: it bends less the more it is pressed
    held = run(baseline(gent, to="200 kPa"))
    assert held.status == "converged"
    assert held.last("angle_deg") < most


def test_closed_form_names_the_limiting_stretch() -> None:
    gent = {"law": "gent", "mu": "0.3 MPa", "jm": 0.2}
    result = run(baseline(gent, "analytic", angle="360 deg"))
    assert result.status == "stopped"
    assert result.reason.startswith("the rubber meets its limiting stretch beyond")
    assert result.last("angle_deg") < 200
    # a pressure as great as one likes is met before
    pressed = run(baseline(gent, "analytic", to="2 MPa"))
    assert pressed.status == "converged"
    assert pressed.last("angle_deg") < result.last("angle_deg")
