"""Tip of a constant-curvature arc."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.path import tip

RIGHT = math.pi / 2


def test_tip_without_cap() -> None:
    points = tip(np.radians([90, 180, 360]), 160)
    stated = np.array([[101.86, 101.86], [0, 101.86], [0, 0]])
    assert points == pytest.approx(stated, abs=0.005)
    radius = 160 / np.radians([90, 180])
    assert points[:2, 0] == pytest.approx(radius * [1, 0], abs=1e-12)
    assert points[:2, 1] == pytest.approx(radius * [1, 2], abs=1e-12)


def test_straight_actuator_is_the_limit() -> None:
    assert tip(0.0, 160, cap=15, height=4) == pytest.approx(np.array([175, -4]), abs=1e-12)
    near = tip(1e-9, 160, cap=15)
    assert near == pytest.approx(np.array([175, 1e-9 * (160 / 2 + 15)]), rel=1e-12)


def test_cap_goes_on_along_the_tangent() -> None:
    angles = np.linspace(-3, 9, 25)
    tangent = tip(angles, 160, cap=15) - tip(angles, 160)
    assert tangent == pytest.approx(15 * np.column_stack([np.cos(angles), np.sin(angles)]))
    assert tip(RIGHT, 160, cap=15) - tip(RIGHT, 160) == pytest.approx(np.array([0, 15]), abs=1e-12)


def test_height_is_normal_to_the_arc() -> None:
    angles = np.linspace(-3, 9, 25)
    normal = tip(angles, 160, height=2) - tip(angles, 160)
    assert normal == pytest.approx(2 * np.column_stack([np.sin(angles), -np.cos(angles)]))


def test_arc_has_its_length_and_its_curvature() -> None:
    share = np.linspace(0, 1, 2001)
    arc = tip(4.0 * share, 160 * share)
    assert np.hypot(*np.diff(arc, axis=0).T).sum() == pytest.approx(160, rel=1e-6)
    assert np.hypot(arc[:, 0], arc[:, 1] - 40) == pytest.approx(np.full(2001, 40.0))


@pytest.mark.parametrize(("length", "cap"), [(-1.0, 0.0), (math.nan, 0.0), (160.0, -1.0)])
def test_meaningless_lengths_are_refused(length: float, cap: float) -> None:
    with pytest.raises(ValueError, match="zero or positive mm expected"):
        tip(1.0, length, cap)
