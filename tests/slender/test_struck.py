"""Cases in motion with obstacles, masses at the tip and zones."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.running.runner import run_case
from fiberbend.slender.frequencies import vibrations
from rod.law import Law
from tests.slender.rods import WOUND, case, linear
from tests.slender.rods import by_law as by_law

Put = Callable[[Law], None]
WEIGHT = {"gravity": {"direction": "-y"}}
PRESSED = {"pressure": {"to": "20 kPa"}}
BENT = linear((30.0, 400.0))
TABLE = {"contact": {"plane": {"point": ["0 mm", "-12 mm", "0 mm"], "normal": [0, 1, 0]}}}
BAR = {"contact": {"cylinder": {"center": ["-16 mm", "80 mm"], "radius": "10 mm"}}}
TILTED = {"contact": {"plane": {"point": ["0 mm", "-15 mm", "60 mm"], "normal": [0, 1, 0.2]}}}
ROOF: dict[str, Any] = {"contact": {"roof": {}, "post": {}}}
BLOCKED: dict[str, Any] = {"blocked-tip": {}}
SLOW = {
    "duration": "800 ms",
    "step": "10 ms",
    "pressure": {"ramp": {"to": "20 kPa", "over": "300 ms"}},
    "damping": {"retardation_time": "20 ms", "drag": "20 1/s"},
}


def moving(*effects: dict[str, Any], **changes: Any) -> Case:
    return case(*effects, time=SLOW | changes)


LONG = [pytest.param(each, marks=pytest.mark.long) for each in (BAR, TILTED, BLOCKED)]


@pytest.mark.parametrize("obstacle", [TABLE, ROOF, *LONG])
def test_a_slow_motion_ends_where_the_run_at_rest_does(
    obstacle: dict[str, Any], by_law: Put
) -> None:
    """With the same obstacle: angle, tip, and the forces of all that is touched."""
    by_law(BENT)
    at_rest = run_case(case(obstacle, PRESSED), None)
    found = run_case(moving(obstacle, PRESSED), None)
    assert (found.status, at_rest.status) == ("converged", "converged"), found.reason
    last, exact = found.rows[-1], at_rest.rows[-1]
    forces = [key for key in exact if key.endswith("_N") or key.endswith("moment_x_Nmm")]
    assert max(abs(exact[key]) for key in forces) > 0.01
    greatest = max(abs(exact[key]) for key in forces if key.endswith("_N"))
    for key in forces:
        scale = greatest * (1.0 if key.endswith("_N") else 100.0)
        assert last[key] == pytest.approx(exact[key], abs=1e-2 * scale), key
    for key in (col.TIP_Y, col.TIP_Z):
        assert last[key] == pytest.approx(exact[key], abs=5e-3), key
    assert last[col.ANGLE] == pytest.approx(exact[col.ANGLE], abs=2e-2)
    most = max(row[col.KINETIC] for row in found.rows)
    assert max(abs(row[col.DRIFT]) for row in found.rows) < 1e-6 * max(most, 1.0)


def test_what_it_touches_is_an_event_with_its_time(by_law: Put) -> None:
    """Of a finger that swings on a table; halved steps find the first touch at the same time."""
    by_law(BENT)
    times = []
    fast = {"pressure": {"ramp": {"to": "20 kPa", "over": "20 ms"}}, "duration": "150 ms"}
    fast |= {"damping": {"retardation_time": "3 ms"}}
    for step in ("5 ms", "2.5 ms", "1.25 ms"):
        found = run_case(moving(TABLE, PRESSED, **fast, step=step), None)
        assert found.status == "converged", found.reason
        first = found.run["motion"]["events"][0]
        assert first["name"] == "plane"
        assert first["touch"]
        times.append(first["time_s"])
        row = next(row for row in found.rows if row[col.TIME] == first["time_s"])
        assert abs(row[col.contact("plane", "gap_mm")]) < 1e-4
        assert row[col.contact("plane", "y_N")] == pytest.approx(0.0, abs=1e-3)
        assert max(row[col.contact("plane", "y_N")] for row in found.rows) > 0.01
    first, second = np.abs(np.diff(times))
    assert math.log2(first / second) == pytest.approx(2.0, abs=0.5)


def test_zones_that_are_alike_move_as_one(by_law: Put) -> None:
    by_law(BENT)
    time = {"duration": "100 ms", "damping": {"retardation_time": "3 ms", "drag": "1 1/s"}}
    whole = run_case(moving(WEIGHT, PRESSED, **time), None)
    parted = [{"length": "50 mm", "winding": WOUND}, {"length": "50 mm"}]
    halves = case(WEIGHT, PRESSED, time=SLOW | time, zones=parted)
    parts = run_case(halves, None)
    assert parts.status == "converged", parts.reason
    for one, two in zip(whole.rows, parts.rows, strict=True):
        for key in (col.TIME, col.ANGLE, col.TIP_Y, col.TIP_Z, col.KINETIC, col.DISSIPATED):
            assert two[key] == pytest.approx(one[key], rel=1e-8, abs=1e-10), key
        bends = sum(two[col.zone(number, "angle_deg")] for number in (0, 1))
        assert bends == pytest.approx(one[col.ANGLE], abs=1e-8)


def slender_bar(*effects: dict[str, Any]) -> Case:
    return case(
        *effects,
        PRESSED,
        time=SLOW,
        actuator={
            "section": "circle",
            "radius": "1 mm",
            "length": "200 mm",
            "wall": "1 mm",
            "cap": "1 mm",
        },
        materials={"wall": {"law": "neo-hooke", "mu": "0.3 MPa"}},
    )


def test_a_mass_at_the_tip_is_inert_without_weight(by_law: Put) -> None:
    """1 + cos β cosh β = μ β (sin β cosh β − cos β sinh β) of a clamped bar, μ its share of it."""
    outer, inner, young, mass = 2.0, 1.0, 0.9, 2e-6
    bending = young * math.pi / 4 * (outer**4 - inner**4)
    each = 1.1e-9 * math.pi * (outer**2 - inner**2)
    law, length = linear(), 202.0
    area = young * math.pi * (outer**2 - inner**2)
    by_law(type(law)(np.diag([area, bending]), np.array([1.0, 0.0])))
    share = mass / (each * length)

    def missed(b: float) -> float:
        return (
            1
            + math.cos(b) * math.cosh(b)
            - share * b * (math.sin(b) * math.cosh(b) - math.cos(b) * math.sinh(b))
        )

    root = float(brentq(missed, 0.1, 1.8751))
    exact = root**2 / (2 * math.pi * length**2) * math.sqrt(bending / each)
    (found,) = vibrations(slender_bar({"tip-mass": {"mass": "2 g"}}), [0.0], 1)
    assert found.frequencies[0] == pytest.approx(exact, rel=5e-3)
    (bare,) = vibrations(slender_bar(), [0.0], 1)
    assert found.frequencies[0] < 0.8 * bare.frequencies[0]
