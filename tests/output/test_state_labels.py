"""Names of states: no two of one run are alike."""

from __future__ import annotations

import numpy as np

from fiberbend.states.labels import angle_labels, pressure_labels, unused


def _labels(*degrees: float) -> list[str]:
    return list(angle_labels([float(np.deg2rad(angle)) for angle in degrees]).values())


def test_angles_are_whole_degrees_unless_two_would_be_alike() -> None:
    assert _labels(8.0, 90.0, -30.0, 360.0) == ["008deg", "090deg", "-30deg", "360deg"]
    assert _labels(20.4) == ["020deg"]
    assert _labels(20.1, 20.4, 45.0) == ["020.1deg", "020.4deg", "045deg"]
    assert _labels(20.0, 20.04, 19.96) == ["020.00deg", "020.04deg", "019.96deg"]
    assert len(set(_labels(*(20 + 1e-6 * n for n in range(9))))) == 9


def test_pressures_have_six_digits_unless_two_would_be_alike() -> None:
    assert list(pressure_labels([0.02, -0.0035]).values()) == ["20kPa", "-3.5kPa"]
    assert len(set(pressure_labels([0.02, 0.02 + 1e-10]).values())) == 2


def test_a_state_met_again_is_counted() -> None:
    assert unused("020deg", []) == "020deg"
    assert unused("020deg", ["020deg"]) == "020deg-2"
    assert unused("020deg", ["020deg", "020deg-2"]) == "020deg-3"
