"""The angle filter against the model that it inverts, and the dead zone against eq. (22)."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from analytic.bending import Hemicircle
from analytic.control.controller import (
    Controller,
    DeadZone,
    Inside,
    Valves,
)
from analytic.control.filter import TOLERANCE, AngleFilter
from analytic.stress import effective

BASE = Hemicircle(8, 2, 2, 160)
FILTER = AngleFilter.from_model(BASE)


def test_it_inverts_the_model_within_its_stated_error() -> None:
    angle = np.random.default_rng(1).uniform(-1.5, 4 * math.pi, 3000)
    off = [abs(FILTER(p) - a) for p, a in zip(BASE.pressure(angle).tolist(), angle, strict=True)]
    assert max(off) < TOLERANCE
    # the error is measured midway between the knots, where a spline's is greatest to 4th order
    assert max(off) < 1.1 * FILTER.error


@pytest.mark.parametrize(
    ("degrees", "kilopascals"), [(90, 78.197), (180, 140.691), (270, 192.815), (360, 237.828)]
)
def test_reference_values(degrees: float, kilopascals: float) -> None:
    # worked out independently to 0.001 kPa; half of that is 0.0013° at the slope at 360°
    assert math.degrees(FILTER(1e-3 * kilopascals)) == pytest.approx(degrees, abs=2e-3)
    assert FILTER.pressure(math.radians(degrees)) == pytest.approx(1e-3 * kilopascals, abs=1e-6)


def test_samples_and_arrays_agree() -> None:
    pressure = np.linspace(FILTER.low - 0.01, FILTER.high + 0.01, 997)
    one_by_one = [FILTER(p) for p in pressure.tolist()]
    assert one_by_one == pytest.approx(FILTER.angles(pressure), abs=1e-12)


def test_beyond_the_table_it_stays_at_the_end_and_no_number_is_an_error() -> None:
    assert FILTER(FILTER.high + 1) == FILTER(FILTER.high) == pytest.approx(4 * math.pi)
    assert FILTER(-1) == FILTER(FILTER.low) == pytest.approx(-math.pi / 2)
    with pytest.raises(ValueError, match="not a number"):
        FILTER(math.nan)


def test_slope() -> None:
    step = 1e-6
    middle = (FILTER(0.1 + step) - FILTER(0.1 - step)) / (2 * step)
    assert FILTER.slope(0.1) == pytest.approx(middle, rel=1e-7)


def test_a_curve_goes_through_its_points_and_never_leaves_them_in_between() -> None:
    pressure = np.array([0, 10, 20, 21, 22, 80]) * 1e-3
    angle = np.array([0, 0.1, 0.2, 2.0, 2.1, 2.2])
    kinked = AngleFilter.from_curve(pressure, angle)
    assert kinked.angles(pressure) == pytest.approx(angle, abs=1e-15)
    fine = kinked.angles(np.linspace(0, 0.08, 5001))
    assert np.all(np.diff(fine) >= 0)
    assert kinked.error > 0.1, "a spline overshoots here, and the stated error says so"
    straight = AngleFilter.from_curve(pressure, 20 * pressure)
    assert straight.error < 1e-12


def test_a_tabulated_model_is_as_good_as_its_points() -> None:
    # monotone cubics are of second order where they limit a slope, of third elsewhere
    def off(points: int) -> float:
        angle = np.linspace(0, 2 * math.pi, points)
        table = AngleFilter.from_curve(BASE.pressure(angle), angle)
        middle = (angle[1:] + angle[:-1]) / 2
        return float(np.abs(table.angles(BASE.pressure(middle)) - middle).max())

    assert off(37) < 2e-3
    assert off(73) < off(37) / 3.5


@pytest.mark.parametrize(
    ("pressure", "angle", "message"),
    [
        ([0.0], [0.0], "at least 2"),
        ([0.0, 0.1], [0.0, 0.1, 0.2], "one length"),
        ([0.0, 0.1, 0.05], [0.0, 1.0, 2.0], "do not both rise beyond 57.3"),
        ([0.0, 0.1, 0.2], [0.0, 1.0, 1.0], "do not both rise beyond 57.3"),
        ([0.0, math.nan, 0.2], [0.0, 1.0, 2.0], "not finite"),
    ],
)
def test_curves_without_an_inverse_are_refused(
    pressure: list[float], angle: list[float], message: str
) -> None:
    with pytest.raises(ValueError, match=f"filter: .*{message}"):
        AngleFilter.from_curve(np.array(pressure), np.array(angle))


def test_angles_that_it_never_says_are_refused() -> None:
    with pytest.raises(ValueError, match=r"filter: it gives angles from -90 to 720°, not 900°"):
        FILTER.pressure(math.radians(900))


def test_short_table_states_its_error_and_that_falls_with_the_square() -> None:
    table = FILTER.linear_table(0.0, 0.2, 33)
    pressure = np.random.default_rng(2).uniform(0, 0.2, 4000)
    off = np.abs(np.interp(pressure, table.pressure, table.angle) - FILTER.angles(pressure))
    assert 0.9 * table.error < off.max() <= table.error * 1.001
    assert FILTER.linear_table(0.0, 0.2, 65).error == pytest.approx(table.error / 4, rel=0.03)
    for low, high, points in ((0.1, 0.1, 9), (0.0, 99.0, 9), (0.0, 0.2, 1)):
        with pytest.raises(ValueError, match="table: "):
            FILTER.linear_table(low, high, points)


def test_a_stiffer_filter_expects_more_pressure() -> None:
    stiff = AngleFilter.from_model(dataclasses.replace(BASE, stress=effective(0.314 * 1.1)))
    assert stiff.pressure(2.0) == pytest.approx(1.1 * FILTER.pressure(2.0), rel=1e-9)


def test_dead_zone_as_printed() -> None:
    zone = DeadZone()
    assert zone(0.0) == 0.07
    assert zone(math.pi) == pytest.approx(math.pi / 50 + 0.07)


@pytest.mark.parametrize(
    ("inside", "error", "last", "expected"),
    [
        ("hold", 0.12, Valves.HOLD, Valves.FILL),
        ("hold", -0.12, Valves.FILL, Valves.VENT),
        ("hold", 0.08, Valves.FILL, Valves.HOLD),
        ("settle", 0.08, Valves.FILL, Valves.FILL),
        ("settle", -0.01, Valves.FILL, Valves.HOLD),
        ("settle", -0.08, Valves.VENT, Valves.VENT),
        ("settle", 0.08, Valves.HOLD, Valves.HOLD),
        ("relay", -0.08, Valves.FILL, Valves.FILL),
        ("relay", -0.12, Valves.FILL, Valves.VENT),
    ],
)
def test_commands(inside: Inside, error: float, last: Valves, expected: Valves) -> None:
    # the zone at θ_d = 1 is ±0.09 rad
    assert Controller(inside=inside).command(1.0, 1.0 - error, last) is expected


def test_meaningless_controllers_are_refused() -> None:
    for offset in (0.0, -0.1, math.nan):
        with pytest.raises(ValueError, match="dead-zone: a positive angle"):
            DeadZone(offset=offset)
    with pytest.raises(ValueError, match="dead-zone-divisor: "):
        DeadZone(divisor=0.0)
    with pytest.raises(ValueError, match="rate: positive Hz"):
        Controller(rate=0.0)
    with pytest.raises(ValueError, match="inside: hold, settle or relay"):
        Controller(inside="stay")  # type: ignore[arg-type]
