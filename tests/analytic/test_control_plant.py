"""Valves and chamber against closed forms, and the plants that make no sense."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from analytic.bending import Hemicircle
from analytic.control.controller import Valves
from analytic.control.plant import (
    CONDUCTANCE,
    LAMINAR,
    ArcCurve,
    Plant,
    PlantParameters,
    flow,
)

BASE = Hemicircle(8, 2, 2, 160)
CURVE = ArcCurve.of(BASE, np.linspace(0, 2 * math.pi, 73))
RIGID = dataclasses.replace(CURVE, volume=np.full(73, 16000.0))
P = PlantParameters()


def test_chamber_volume_of_an_arc() -> None:
    # half a disk, bent about the floor's lower face: at 360° its centroid's path is a circle
    assert CURVE.volume[0] == pytest.approx(math.pi / 2 * 64 * 160)
    centroid = 160 / (2 * math.pi) + 2 + 4 * 8 / (3 * math.pi)
    assert CURVE.volume[-1] == pytest.approx(math.pi / 2 * 64 * 2 * math.pi * centroid)


def test_flow_of_a_worked_example() -> None:
    # SMC's catalogue: C = 2 dm³/(s bar), b = 0.3, 4 bar to 3 bar gauge over 1 bar:
    # 600 dm³/min (ANR) choked times 0.7 from the graph; ANR is at 0.1 MPa
    litres = flow(2 * CONDUCTANCE, 0.5, 0.4, 0.3) / 0.1 * 60 / 1e6
    assert litres == pytest.approx(420, rel=1e-3)


def test_flow_is_choked_continuous_and_odd() -> None:
    for b in (0.0, 0.3, 0.5):
        assert flow(1e5, 0.3, 0.3 * b, b) == flow(1e5, 0.3, 0.0, b) == pytest.approx(3e3)
        for edge in (b, LAMINAR):
            sides = [flow(1e5, 0.3, 0.3 * edge * (1 + s), b) for s in (-1e-9, 1e-9)]
            assert sides[0] == pytest.approx(sides[1], rel=1e-5)
        assert flow(1e5, 0.2, 0.3, b) == -flow(1e5, 0.3, 0.2, b)
        assert flow(1e5, 0.3, 0.3, b) == 0


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_choked_filling_of_a_rigid_chamber_is_linear(exponent: float) -> None:
    parameters = dataclasses.replace(P, supply=1.0, exponent=exponent)
    plant = Plant(RIGID, parameters)
    plant.advance(Valves.FILL, 0.03)
    flow_in = 0.1 * P.inlet * CONDUCTANCE * (1.0 + P.atmosphere)
    assert plant.pressure == pytest.approx(exponent * flow_in / 18000 * 0.03, rel=1e-12)


def test_emptying_of_a_rigid_chamber_is_a_hyperbolic_cosine() -> None:
    # b = 0: p' = −k sqrt(p² − p_a²), that is p = p_a cosh(arcosh(p_0/p_a) − k t)
    parameters = dataclasses.replace(P, critical_ratio=0.0)
    plant = Plant(RIGID, parameters, 0.15)
    k, start = 0.1 * P.inlet * CONDUCTANCE / 18000, (0.15 + P.atmosphere) / P.atmosphere
    for _ in range(8):
        plant.advance(Valves.VENT, 0.01)
    exact = P.atmosphere * (math.cosh(math.acosh(start) - k * 0.08) - 1)
    assert exact > 0.001, "not yet laminar"
    assert plant.pressure == pytest.approx(exact, rel=1e-9)


def test_emptied_it_stays_at_the_atmosphere() -> None:
    plant = Plant(CURVE, P, 0.15)
    plant.advance(Valves.VENT, 5.0)
    assert 0 <= plant.pressure < 1e-9
    assert plant.angle == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("lag", [0.0, 0.03])
def test_air_is_neither_made_nor_lost(lag: float) -> None:
    # choked all the way, so that the inflow is known; the chamber swells meanwhile
    plant = Plant(CURVE, dataclasses.replace(P, supply=1.0, lag=lag))
    before = plant.air()
    plant.advance(Valves.FILL, 0.04)
    plant.advance(Valves.HOLD, 0.3)
    inflow = 0.1 * P.inlet * CONDUCTANCE * (1.0 + P.atmosphere)
    assert plant.angle > 1
    assert plant.air() - before == pytest.approx(inflow * 0.04, rel=1e-6)


def test_a_lagging_angle_arrives_at_the_same_rest() -> None:
    quick, slow = (Plant(CURVE, dataclasses.replace(P, lag=lag)) for lag in (0.0, 0.05))
    for plant in (quick, slow):
        plant.advance(Valves.FILL, 0.07)
    assert slow.angle < 0.8 * quick.angle
    assert slow.pressure > quick.pressure, "it has not swollen yet"
    for plant in (quick, slow):
        plant.advance(Valves.HOLD, 1.0)
    assert slow.angle == pytest.approx(quick.angle, rel=2e-3)
    again = Plant(CURVE, dataclasses.replace(P, lag=1e-4))
    again.advance(Valves.FILL, 0.07)
    quick = Plant(CURVE, P)
    quick.advance(Valves.FILL, 0.07)
    assert again.pressure == pytest.approx(quick.pressure, rel=2e-3)


def test_a_pressure_beyond_the_curve_is_said() -> None:
    short = ArcCurve.of(BASE, np.linspace(0, 1, 9))
    with pytest.raises(ValueError, match=r"curve: it ends at 5\d\.\d+ kPa"):
        Plant(short, P).advance(Valves.FILL, 0.5)
    with pytest.raises(ValueError, match=r"curve: it goes from 0 to 5\d\.\d+ kPa, 100 kPa needed"):
        Plant(short, P, 0.1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"supply": 0.0}, "supply: a positive"),
        ({"supply": math.inf}, "supply: a positive"),
        ({"inlet": -0.02}, "inlet: a positive"),
        ({"outlet": 0.0}, "outlet: a positive"),
        ({"outlet": math.nan}, "outlet: a positive"),
        ({"atmosphere": 0.0}, "atmosphere: a positive"),
        ({"dead_time": -0.001}, "dead-time: zero or more"),
        ({"dead_volume": -1.0}, "dead-volume: zero or more"),
        ({"lag": math.inf}, "lag: zero or more"),
        ({"critical_ratio": 1.0}, "critical-ratio: expected from 0 to below 1"),
        ({"exponent": 0.9}, "exponent: expected from 1"),
        ({"exponent": 1.5}, "exponent: expected from 1"),
    ],
)
def test_meaningless_parameters_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        dataclasses.replace(P, **change)


def test_valves_too_large_for_any_time_step_are_refused() -> None:
    with pytest.raises(ValueError, match="plant: time constants below 5 µs"):
        Plant(CURVE, dataclasses.replace(P, inlet=100.0))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"pressure": CURVE.pressure[:-1]}, "one length"),
        ({"volume": np.full(73, np.nan)}, "a volume is not finite"),
        ({"pressure": CURVE.pressure[::-1]}, "do not both rise beyond 0°"),
        ({"angle": np.full(73, 1.0)}, "do not both rise"),
        ({"volume": np.full(73, -1.0)}, "a volume is not positive"),
        ({"volume": 20000 - 250 * np.arange(73.0)}, "falls faster than air is compressed"),
    ],
)
def test_impossible_curves_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Plant(dataclasses.replace(CURVE, **change), dataclasses.replace(P, dead_volume=0.0))
