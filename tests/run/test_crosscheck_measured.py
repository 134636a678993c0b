"""A run beside measured points: angles, moduli, forces."""

from __future__ import annotations

import json

import numpy as np
import pytest

from analytic.bending import Hemicircle
from analytic.stress import effective
from fiberbend.case.measured import Measured
from fiberbend.compare.check import (
    crosscheck,
)
from tests.run.test_crosscheck import (
    BODY,
    SECTION,
    blocked_rows,
    case_of,
    compared,
    row_at,
    rows_of,
)

# --- measured points --------------------------------------------------------------------------


def test_measured_angles_and_their_modulus() -> None:
    case, random = case_of(), np.random.default_rng(5)
    angles = np.radians(np.arange(20, 361, 20))
    exact = Hemicircle(8, 2, 2, 160, stress=effective(0.264)).pressure(angles)
    measured = Measured("angle_deg", exact + random.normal(0, 0.002, 18), angles, "trial.csv")
    check = crosscheck(case, BODY, rows_of(), SECTION, measured)
    fit = check.entry()["calibration"]
    # synthetic data with noise: inside three standard errors, and the error is of the right size
    assert abs(fit["modulus_MPa"] - 0.264) < 3 * fit["standard_error_MPa"]
    assert 0.0003 < fit["standard_error_MPa"] < 0.003
    assert compared(check, "measured").label == "measured (trial.csv)"
    assert compared(check, "measured").beyond
    assert any(line.startswith("measured angles fit μ̄ = 0.26") for line in check.lines())
    assert check.angles is not None
    assert check.angles.points[0].up[0] == pytest.approx(20)


def test_measured_points_on_the_run_and_beyond_it() -> None:
    angles = np.radians([90.0, 180.0, 400.0])
    measured = Measured("angle_deg", np.array([45.1, 89.2, 200.0]) / 1e3, angles, "trial.csv")
    check = crosscheck(case_of(), BODY, rows_of(), SECTION, measured)
    assert compared(check, "measured").percent == pytest.approx(0, abs=1e-9)
    assert "1 of 3 measured points lie beyond the run" in check.remarks


def test_data_that_give_no_modulus_do_not_stop_the_run() -> None:
    angles = np.radians([90.0, 180.0])
    measured = Measured("angle_deg", np.array([45.1, 89.2]) / 1e3, angles, "trial.csv")
    check = crosscheck(case_of(), BODY, rows_of(), SECTION, measured)
    assert check.entry()["calibration"] == {
        "reason": "too few data: 2 points with an angle, 3 needed"
    }
    assert any("no μ̄ fitted" in line for line in check.lines())


def test_measured_forces() -> None:
    measured = Measured("tip_force_N", np.array([0.05, 0.1]), np.array([2.0, 4.0]), "force.csv")
    check = crosscheck(case_of("blocked_tip"), BODY, blocked_rows(3.6, 8.9), None, measured)
    assert compared(check, "measured").percent == pytest.approx(-10)
    # a measurement is what the run is held to
    line = compared(check, "measured").line()
    assert line.startswith("run: force 10.0 % lower than measured (force.csv) at ")
    assert line.endswith(" kPa, as expected (within 10.5 %)")
    assert not compared(check, "measured").beyond
    assert check.calibration is None
    assert check.forces is not None
    assert check.forces.points[0].label == "measured (force.csv)"
    assert check.angles is None


def test_entry_is_plain_json() -> None:
    rows = [*rows_of(), row_at(400.0, 200.0)]
    measured = Measured("angle_deg", np.array([0.05]), np.array([9.0]), "trial.csv")
    check = crosscheck(case_of(), BODY, rows, SECTION, measured)
    json.dumps(check.entry(), allow_nan=False)
    json.dumps(check.columns, allow_nan=False)
