"""Runs with the laws beyond the paper's, and a law that somebody adds."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
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
    assert result.status == "failed"
    angles, pressures = column(result, "angle_deg"), column(result, "pressure_kPa")
    assert angles == sorted(angles)
    assert pressures == sorted(pressures), "the actuator locks"
    assert 120 < angles[-1] < 180
    # a pressure it can always bear: it bends less the more it is pressed
    held = run(baseline(gent, to="200 kPa"))
    assert held.status == "converged"
    assert held.last("angle_deg") < angles[-1]


def test_closed_form_names_the_limiting_stretch() -> None:
    gent = {"law": "gent", "mu": "0.3 MPa", "jm": 0.2}
    for pressure in ({"angle": "360 deg"}, {"to": "2 MPa"}):
        result = run(baseline(gent, "analytic", **pressure))
        assert result.status == "stopped"
        assert result.reason.startswith("the rubber meets its limiting stretch beyond")
        assert result.last("angle_deg") < 200


FUNG = '''"""An exponential law."""

from materials.laws.law import Law, Parameter


def energy(state, mu, stiffening):
    """W = mu/(2 b) (exp(b (I1 - 3)) - 1)."""
    return mu / (2 * stiffening) * (state.exp(stiffening * (state.i1 - 3)) - 1)


LAW = Law(
    "fung",
    energy,
    (
        Parameter("mu", "Shear modulus", allowed="above zero"),
        Parameter("stiffening", "b", unit="1", allowed="above zero"),
    ),
)
'''
"""One file."""

USE = """
import numpy as np
from fiberbend import run
from fiberbend.case import convert
from fiberbend.models.closed_form import analytic_curves
from fiberbend.reader.json_schema import json_schema
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError
from fiberbend.states.recovery import cauchy_stress

case = {case}
rubber = convert.material(parse_case(case).materials.wall)
assert abs(rubber.initial_shear_modulus - 0.3) < 1e-12
curve = analytic_curves(parse_case(case))["zero-fit"]
stretch = np.array(1.3)
by_hand = 0.3 * np.exp(0.5 * (stretch - 1 / stretch) ** 2) * (stretch - stretch**-3.0)
assert abs(curve.stress(stretch) - by_hand) < 1e-12
f = np.diag([stretch, 1.0, 1 / stretch])
stress = cauchy_stress(rubber, f, np.array(0.0))
assert abs((stress[0, 0] - stress[2, 2]) / stretch - by_hand) < 1e-12
assert "fung" in str(json_schema()["$defs"]["Material"])
case["materials"]["wall"]["jm"] = 3
try:
    parse_case(case)
except CaseError as error:
    assert "materials.wall.jm: no effect on fung" in str(error)
else:
    raise AssertionError("jm is no parameter of it")
del case["materials"]["wall"]["jm"]
result = run(case)
assert result.status == "converged", result.reason
print(result.last("angle_deg"))
"""


def test_a_law_is_one_file_and_one_line(tmp_path: Path) -> None:
    for package in ("materials", "geometry", "analytic", "fem", "fiberbend"):
        shutil.copytree(ROOT / package, tmp_path / package)
    (tmp_path / "materials" / "laws" / "fung.py").write_text(FUNG, encoding="utf-8")
    table = tmp_path / "materials" / "laws" / "table.py"
    text = table.read_text(encoding="utf-8")
    table.write_text(text.replace('    "gent",\n', '    "gent",\n    "fung",\n'), encoding="utf-8")
    fung = {"law": "fung", "mu": "0.3 MPa", "stiffening": 0.5}
    case = baseline(fung, to="20 kPa")
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-c", USE.replace("{case}", repr(case))],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    # stiffer than neo-Hooke, softer than twice as stiff
    plain = run(baseline({"law": "neo-hooke", "mu": "0.3 MPa"}, to="20 kPa"))
    assert 0.8 * plain.last("angle_deg") < float(done.stdout.split()[-1]) < plain.last("angle_deg")
