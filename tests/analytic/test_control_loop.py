"""The closed loop: the paper's orders of magnitude, its measures, and loops that cannot work."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Sequence

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from analytic.bending import Hemicircle
from analytic.calibration import calibrate
from analytic.control import loop as control_loop
from analytic.control.controller import Controller, DeadZone
from analytic.control.filter import AngleFilter
from analytic.control.loop import (
    Sensor,
    Sine,
    Steps,
    Trace,
    simulate,
)
from analytic.control.metrics import sine_metrics, step_metrics
from analytic.control.plant import ArcCurve, Plant, PlantParameters
from analytic.stress import effective

BASE = Hemicircle(8, 2, 2, 160)
DEGREES = np.linspace(0, 360, 37)
QUARTERS = [0, 90, 180, 270, 360]
# the baseline: P of an independent section model, V of `section_curve`
SECTION = ArcCurve(
    pressure=1e-3 * CubicSpline(QUARTERS, [0, 45.1, 89.2, 134.3, 181.5])(DEGREES),
    angle=np.radians(DEGREES),
    volume=CubicSpline(QUARTERS, [16085, 19038, 21719, 24230, 26646])(DEGREES),
)
MODULUS = calibrate(SECTION.pressure, SECTION.angle, BASE).modulus
FILTER = AngleFilter.from_model(dataclasses.replace(BASE, stress=effective(MODULUS)))
STEPS = Steps(math.radians(150), math.radians(210), cycles=2)
SINE = Sine(0.0, math.pi)
EXACT = Sensor()


def plant(**change: float) -> Plant:
    return Plant(SECTION, dataclasses.replace(PlantParameters(), **change))


def trace(columns: Sequence[Sequence[float]]) -> Trace:
    """A trace at 100 Hz from rows θ_d, θ_a, valves; the zone is ±0.1."""
    desired, filtered, valves = np.array(columns, dtype=float).T
    time, same = 0.01 * np.arange(len(desired)), np.zeros(len(desired))
    zone = same + 0.1
    return Trace(time, desired, filtered, filtered, zone, valves.astype(np.int8), same, same)


def test_orders_of_the_papers_step_response() -> None:
    # section VI: 91 ms to fill, 124 ms to empty, 0.85 % undesired. The size of its steps, its
    # supply and its valves are not stated: within a factor of 1.5
    metrics = step_metrics(simulate(plant(), FILTER, Controller(), STEPS, Sensor(5e-4)), STEPS)
    assert 0.091 / 1.5 < metrics.fill_s < 0.091 * 1.5
    assert 0.124 / 1.5 < metrics.vent_s < 0.124 * 1.5
    assert metrics.vent_s > metrics.fill_s, "the exhaust is slower"
    assert metrics.undesired < 0.01


def test_orders_of_the_papers_sine() -> None:
    # section VI: 60 ms, 0.5 % undesired
    metrics = sine_metrics(simulate(plant(), FILTER, Controller(), SINE, Sensor(5e-4)), SINE)
    assert 0.060 / 1.5 < metrics.delay_s < 0.060 * 1.5
    assert metrics.undesired < 0.01


def test_the_delay_is_what_the_dead_zone_makes() -> None:
    # on the way the error stays at the edge of the zone, a square wave whose first harmonic is
    # 4/π of half the zone; so much the angle is late over the greatest speed
    delays = []
    for offset in (0.07, 0.14):
        controller = Controller(zone=DeadZone(math.inf, offset))
        found = sine_metrics(simulate(plant(), FILTER, controller, SINE, EXACT), SINE)
        delays.append(found.delay_s)
    speed = 2 * math.pi * 0.2 * math.pi / 2
    assert delays[1] - delays[0] == pytest.approx(4 / math.pi * 0.07 / speed, rel=0.1)


def test_without_noise_the_valves_rest_after_a_step() -> None:
    metrics = step_metrics(simulate(plant(), FILTER, Controller(), STEPS, EXACT), STEPS)
    assert metrics.undesired == 0
    assert metrics.openings == 4, "one opening a step, and the start is at rest"


def test_a_relay_never_rests() -> None:
    # the dead zone read to the letter: the reason for the other reading
    relay = Controller(inside="relay")
    metrics = step_metrics(simulate(plant(), FILTER, relay, STEPS, EXACT), STEPS)
    assert metrics.undesired > 0.5
    settle = Controller(inside="settle")
    metrics = step_metrics(simulate(plant(), FILTER, settle, STEPS, EXACT), STEPS)
    assert metrics.undesired < 0.03


def test_more_noise_switches_more_and_a_seed_repeats() -> None:
    runs = [simulate(plant(), FILTER, Controller(), STEPS, Sensor(n)) for n in (0.0, 1e-3, 3e-3)]
    undesired = [step_metrics(run, STEPS).undesired for run in runs]
    assert undesired[0] < undesired[1] < undesired[2]
    again = simulate(plant(), FILTER, Controller(), STEPS, Sensor(1e-3))
    assert np.array_equal(again.measured, runs[1].measured)
    other = simulate(plant(), FILTER, Controller(), STEPS, Sensor(1e-3, seed=1))
    assert not np.array_equal(other.measured, runs[1].measured)


def test_a_filter_that_expects_more_pressure_bends_further() -> None:
    stiff = dataclasses.replace(BASE, stress=effective(1.1 * MODULUS))
    ends = []
    for some in (FILTER, AngleFilter.from_model(stiff)):
        run = simulate(plant(), some, Controller(), STEPS, EXACT)
        assert abs(run.error[-1]) <= run.half[-1], "the loop believes its filter"
        ends.append(run.angle[-1])
    assert ends[1] > ends[0] + 0.1


def test_with_the_plants_own_curve_the_plant_is_in_the_dead_zone() -> None:
    own = AngleFilter.from_curve(SECTION.pressure, SECTION.angle)
    metrics = step_metrics(simulate(plant(), own, Controller(), STEPS, EXACT), STEPS)
    assert metrics.error_rad <= Controller().zone(STEPS.high)


@pytest.mark.parametrize(("dead_time", "late"), [(0.0, 0), (0.004, 0), (0.01, 1), (0.024, 2)])
def test_valves_move_after_their_dead_time(dead_time: float, late: int) -> None:
    steps = dataclasses.replace(STEPS, hold=0.5, cycles=1)
    wide = Controller(zone=DeadZone(offset=0.3))
    run = simulate(plant(dead_time=dead_time), FILTER, wide, steps, EXACT)
    start = int(np.argmax(run.valves == 1))
    assert run.time[start] == pytest.approx(0.5)
    rising = np.flatnonzero(np.diff(run.pressure) > 0)
    assert rising[0] == start + late
    # in the first sample of motion the inlet is open for the rest of that sample
    part = late + 1 - dead_time / 0.01
    first, second = np.diff(run.pressure)[start + late : start + late + 2]
    assert first / second == pytest.approx(part, rel=0.03)


def test_convergence_time_is_read_between_samples() -> None:
    # a step up at 0.04 s; θ_e is 0.3, 0.2, then 0.05: it passes 0.1 at two thirds of a sample
    rows = [(0.0, 0.0, 0)] * 4 + [(1.0, 0.7, 1), (1.0, 0.8, 1), (1.0, 0.95, 0), (1.0, 0.95, 1)]
    # and down at 0.08 s: first the wrong valve, then never inside
    rows += [(0.0, 0.95, 1), (0.0, 0.5, -1), (0.0, 0.4, -1), (0.0, 0.3, -1), (0.0, 0.2, -1)]
    metrics = step_metrics(trace(rows), Steps(0.0, 1.0, hold=0.04, cycles=1))
    assert metrics.fill_s == pytest.approx(0.01 * (1 + 2 / 3))
    assert math.isnan(metrics.vent_s)
    assert metrics.undesired == pytest.approx(2 / 13), "the inlet again, and at the step down"
    assert metrics.openings == 3
    assert metrics.error_rad == pytest.approx(0.3)


def test_delay_and_undesired_switching_of_a_known_sine() -> None:
    time = 0.01 * np.arange(1501)
    late = Sine(0.0, 3.0)
    rows = [(late(t), 0.2 + late(t - 0.083), 0) for t in time]
    found = sine_metrics(trace(rows), late)
    assert found.delay_s == pytest.approx(0.083, rel=1e-3)
    assert found.undesired == 0
    # θ_d rises in the first half of every period
    valves = np.where(time % 5 < 2.5, 1, -1)
    valves[100:115] = -1
    rows = [(late(t), late(t), v) for t, v in zip(time, valves, strict=True)]
    assert sine_metrics(trace(rows), late).undesired == pytest.approx(15 / 1501)


def test_a_supply_below_the_needed_pressure_is_refused() -> None:
    with pytest.raises(ValueError, match=r"supply: 90 kPa, expected more than the 110\.\d kPa"):
        simulate(plant(supply=0.09), FILTER, Controller(), STEPS, EXACT)


def test_a_curve_that_ends_too_early_is_refused() -> None:
    half = ArcCurve.of(BASE, np.linspace(0, math.pi, 19))
    short = Plant(half, PlantParameters(supply=0.3))
    with pytest.raises(ValueError, match=r"curve: it goes from 0 to 140\.7 kPa"):
        simulate(short, AngleFilter.from_model(BASE), Controller(), STEPS, EXACT)


def test_sampling_that_is_too_slow_is_refused_and_the_stated_rate_works() -> None:
    with pytest.raises(ValueError, match=r"rate: 40 Hz, but at 150°.*fills across") as refused:
        simulate(plant(), FILTER, Controller(rate=40.0), STEPS, EXACT)
    stated = re.search(r"more than ([\d.]+) Hz", str(refused.value))
    assert stated is not None
    rate = 1.02 * float(stated[1])
    run = simulate(plant(), FILTER, Controller(rate=rate), STEPS, EXACT)
    assert step_metrics(run, STEPS).undesired == 0


def test_what_is_refused_does_go_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(control_loop, "check", lambda *_: None)
    # the check takes the worst moment of sampling: at the refused 40 Hz these steps happen to rest
    run = simulate(plant(), FILTER, Controller(rate=10.0), STEPS, EXACT)
    metrics = step_metrics(run, STEPS)
    assert metrics.openings >= 2 * 2 * STEPS.cycles
    assert metrics.undesired > 0.05


def test_a_dead_time_that_no_rate_makes_up_for_is_refused() -> None:
    with pytest.raises(ValueError, match=r"dead-time: 40 ms, but at 150°.*at any rate"):
        simulate(plant(dead_time=0.04), FILTER, Controller(rate=1000.0), STEPS, EXACT)


@pytest.mark.parametrize(
    ("low", "high"), [(-0.1, 1.0), (1.0, 1.0), (2.0, 1.0), (0.0, math.inf), (math.nan, 1.0)]
)
def test_references_without_meaning_are_refused(low: float, high: float) -> None:
    with pytest.raises(ValueError, match=r"steps: .*two rising angles from zero up"):
        Steps(low, high)
    with pytest.raises(ValueError, match=r"sine: .*two rising angles from zero up"):
        Sine(low, high)


def test_other_references_and_sensors_without_meaning_are_refused() -> None:
    with pytest.raises(ValueError, match="steps: a positive time"):
        Steps(0.0, 1.0, hold=0.0)
    with pytest.raises(ValueError, match="sine: a positive frequency and at least two"):
        Sine(0.0, 1.0, cycles=1)
    with pytest.raises(ValueError, match="noise: zero or more"):
        Sensor(-1e-3)
