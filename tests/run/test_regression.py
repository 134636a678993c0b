"""Tip angle and tip force of the baseline, each number with its origin."""

from __future__ import annotations

import pytest
import yaml

from fiberbend import run
from fiberbend.models.result import RunResult
from tests.conftest import ROOT

CASE = yaml.safe_load((ROOT / "cases" / "free_bending.yaml").read_text(encoding="utf-8"))
BASELINE = {key: CASE[key] for key in ("actuator", "materials", "model")} | {
    "mesh": {"axial": "4 mm"}
}
SMEARED = {
    "winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"}
}


@pytest.fixture(scope="module")
def blocked() -> RunResult:
    """Baseline with a blocked tip to 100 kPa on a coarse mesh."""
    effects = [{"pressure": {"to": "100 kPa"}}, SMEARED, {"blocked-tip": {}}]
    return run(BASELINE | {"effects": effects})


def test_smeared_baseline_at_90_degrees() -> None:
    """45.1 kPa of an independent section model (uniform bending, numpy); 1 % is its own band.

    At 2 kPa that model gives 3.87°.
    """
    output = {"stop_at_angle": "90 deg", "at_pressures": ["2 kPa"]}
    result = run(
        BASELINE | {"effects": [{"pressure": {"to": "60 kPa"}}, SMEARED], "output": output}
    )
    assert result.last("angle_deg") == pytest.approx(90.0, abs=1e-6)
    assert result.last("pressure_kPa") == pytest.approx(45.1, rel=0.01)
    (small,) = [row for row in result.rows if abs(row["pressure_kPa"] - 2.0) < 1e-9]
    assert small["angle_deg"] == pytest.approx(3.87, rel=0.01)
    # constant curvature puts the tip's centroid near (z, −y) = (L/θ, L/θ) and a cap's length on
    assert result.last("tip_y_mm") == pytest.approx(-160 / 1.5708 - 15, rel=0.02)


def test_blocked_tip_balances(blocked: RunResult) -> None:
    """Clamp, roof and post hold a closed pressurised body in balance: 1e-6 of the greatest."""
    for row in blocked.rows[1:]:
        assert row["balance_force"] < 1e-6
        assert row["balance_moment"] < 1e-6


def test_blocked_tip_force(blocked: RunResult) -> None:
    """3.60 N at 100 kPa: this program's converged value with the discrete winding.

    Found with sections of 1 and 2 elements through the wall and elements of 3 mm: 3.604 and
    3.602 N; smeared and at 4 mm it may differ by 3 %. κ P / L_f of eqs. (20), (21) is 3.87 N.
    """
    assert blocked.last("tip_force_N") == pytest.approx(3.60, rel=0.03)
    assert blocked.last("roof_force_N") > blocked.last("tip_force_N") > 0
