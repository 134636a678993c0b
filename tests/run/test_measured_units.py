"""Measured columns in another unit than their names say are found out beside the run."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fiberbend import columns as col
from fiberbend.compare.unit_check import unit_remark
from fiberbend.drawing.overlay import Points

ANGLE = np.linspace(0, 360, 41)
KPA = 0.35 * ANGLE * (1 + 8e-4 * ANGLE)
FREE = [{col.PRESSURE: float(p), col.ANGLE: float(a)} for p, a in zip(KPA, ANGLE, strict=True)]
BLOCKED = [{col.PRESSURE: float(p), col.TIP_FORCE: 0.035 * float(p)} for p in KPA]
AT = np.array([2.0, 40.0, 80.0, 120.0, 170.0, 230.0, 300.0])
SCATTER = 1 + 0.15 * np.array([2.0, -1.0, 1.0, 0.3, -0.5, 0.8, -0.2])
"""A model and an experiment differ by 15 %, near zero by more."""


def remark(pressure: float = 1.0, value: float = 1.0, blocked: bool = False, sign: int = 1) -> str:
    """What is said of points whose columns are multiplied."""
    kpa = np.interp(AT, ANGLE, KPA)
    up = 0.035 * kpa if blocked else AT
    points = Points("measured (a.csv)", sign * pressure * kpa * SCATTER, sign * value * up)
    rows = BLOCKED if blocked else FREE
    flipped = [{key: sign * number for key, number in row.items()} for row in rows]
    return unit_remark(flipped, points, blocked)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("factor", "unit"),
    [
        (1e3, "like Pa"),
        (1e-3, "like MPa"),
        (0.01, "like bar"),
        (0.1450377, "like psi"),
        (100.0, "100 times too large"),
        (1e-4, "10000 times too small"),
    ],
)
def test_pressures(factor: float, unit: str, sign: int) -> None:
    text = remark(factor, sign=sign)
    assert text.startswith(f"measured (a.csv): pressures look {unit}")
    assert text.endswith(" beside the run, expected kPa and degrees")


def test_pressures_ten_times_too_large() -> None:
    assert "pressures look like m" in remark(10.0)
    assert "pressures look like mmHg" in remark(7.50062)


@pytest.mark.parametrize(
    ("factor", "unit"),
    [(math.pi / 180, "like radians"), (1 / 360, "like turns"), (10.0, "10 times too large")],
)
def test_angles(factor: float, unit: str) -> None:
    assert f"angles look {unit}" in remark(value=factor)


@pytest.mark.parametrize(
    ("pressure", "force", "texts"),
    [
        (1e3, 1.0, ["pressures look like Pa"]),
        (0.01, 1.0, ["pressures look like bar"]),
        (1.0, 1e3, ["forces look like mN"]),
        (1.0, 0.2248, ["forces look like lbf"]),
    ],
)
def test_forces(pressure: float, force: float, texts: list[str]) -> None:
    text = remark(pressure, force, blocked=True)
    assert all(part in text for part in texts)
    assert text.endswith("expected kPa and N")


@pytest.mark.parametrize("factor", [1.0, 0.6, 1.8, 2.3, 1 / 2.3, 4.0])
def test_another_rubber_is_no_other_unit(factor: float) -> None:
    assert remark(factor) == ""


def test_points_that_tell_different_things_tell_nothing() -> None:
    points = Points("p", np.array([10.0, 600.0, 30.0, 2e4]), np.array([30.0, 90.0, 150.0, 240.0]))
    assert unit_remark(FREE, points, False) == ""
    assert unit_remark(FREE, Points("p", np.array([1e5]), np.array([90.0])), False) == ""
    assert unit_remark(FREE[:1], Points("p", KPA[1:] * 1e3, ANGLE[1:]), False) == ""
    assert unit_remark(FREE, Points("p", np.zeros(3), np.zeros(3)), False) == ""


def test_another_unit_than_the_file_is_said_to_have() -> None:
    """Numbers in kPa under a head that says psi are 6.9 times too large once they are read."""
    psi = 6.894757
    kpa = np.interp(AT, ANGLE, KPA) * SCATTER
    for factor, text in ((psi, "like kPa"), (psi / 100, "like bar"), (psi * 10, "like mbar")):
        points = Points("p", factor * kpa, AT)
        found = unit_remark(FREE, points, False, ("psi", "deg"))
        assert found.startswith(f"p: pressures look {text} ")
        assert found.endswith(" beside the run, expected psi and degrees")
    assert unit_remark(FREE, Points("p", kpa, AT), False, ("psi", "rad")) == ""
    degrees_as_radians = Points("p", kpa, np.degrees(AT))
    found = unit_remark(FREE, degrees_as_radians, False, ("kPa", "rad"))
    assert found == "p: angles look like degrees beside the run, expected kPa and rad"
