"""The section model gives a body its start and its direction, and changes no answer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fem.march.guide import Guide
from fem.march.predictor import amplification, lagrange
from fiberbend import run
from fiberbend.running import runner
from tests.run.conftest import small

LONG: dict[str, Any] = {
    "actuator": {
        "section": "hemicircle",
        "radius": "8 mm",
        "length": "80 mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "sheath": "1 mm",
        "cap": "8 mm",
    },
    "effects": [
        {"pressure": {"angle": "160 deg"}},
        {
            "winding": {
                "pattern": "double-helix",
                "pitch": "3 mm",
                "fiber": "kevlar",
                "as": "smeared",
            }
        },
    ],
    "mesh": {"axial": "8 mm"},
    "output": {"fields": False, "pictures": False},
}


@pytest.mark.parametrize("load", [{"to": "190 kPa"}, {"angle": "60 deg"}])
def test_a_body_steered_by_its_section_needs_fewer_iterations(
    load: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # 21 against 32, and 8 against 12
    case = small(**LONG | {"effects": [{"pressure": load}, LONG["effects"][1]]})
    steered = run(case)
    monkeypatch.setattr(runner, "section_guides", lambda _case: False)
    alone = run(case)
    counts = [row["newton_iterations"] for row in steered.rows[1:]]
    assert counts[0] <= np.median(counts)
    assert steered.run["newton_iterations"] < alone.run["newton_iterations"]
    for column in ("angle_deg", "tip_y_mm", "tip_z_mm"):
        assert steered.last(column) == pytest.approx(alone.last(column), rel=1e-6)


def test_a_long_step_behind_a_short_one_is_not_cut_back() -> None:
    # from 60° a parabola through rest, 15° and 60° pointed nowhere: 11 iterations for nothing
    result = run(small(**LONG))
    assert result.status == "converged"
    assert result.run["cutbacks"] == 0
    assert result.run["newton_iterations"] <= 22


def test_weights_of_a_state_and_a_slope_count_as_one() -> None:
    spread, slope = np.array([0.0, 15.0, 60.0]), np.array([0.0, 1e-4, 15.0])
    assert amplification(spread, lagrange(spread, 160.0)) == pytest.approx(48.4, abs=0.1)
    assert amplification(slope, lagrange(slope, 60.0)) == pytest.approx(31.0, abs=0.1)


def test_the_sign_of_round_off_at_rest_decides_nothing() -> None:
    guide = Guide.__new__(Guide)
    guide._measures = {"control": np.array([0.0, 0.2, 3.2])}
    for noise in (5.8e-16, 0.0, -7.4e-16):
        assert guide.covers("control", noise)
        assert guide.covers("control", 3.2 - noise)
    assert not guide.covers("control", -1e-6)
    assert not guide.covers("control", 3.2 + 1e-6)
    assert not guide.covers("value pressure", 0.0)


def test_a_body_can_go_straight_to_a_requested_angle() -> None:
    # max_turn beyond it: one step, which diverges from rest without the section
    case = small(**LONG) | {"solver": {"max_turn": "180 deg"}}
    result = run(case)
    assert result.status == "converged"
    assert result.run["load_steps"] == 1
    assert result.run["cutbacks"] == 0
    assert result.last("angle_deg") == pytest.approx(160, abs=1e-6)
