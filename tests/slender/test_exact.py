"""Rods of cases beside closed forms: moments, caps, masses, loads, symmetries, requests."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from analytic.path import tip
from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from fiberbend.running.runner import run_case
from fiberbend.slender.laws import PLANE, cap_law, masses, pulled
from fiberbend.slender.moments import section_of
from materials.material import Material
from rod.law import Law
from rod.quartic import Quartic
from tests.slender.rods import (
    QUIET,
    ROUND,
    RUBBER,
    STIFFNESS,
    Softening,
    case,
    linear,
    spec,
)
from tests.slender.rods import by_law as by_law

Put = Callable[[Law], None]
PRESSED = {"pressure": {"to": "20 kPa"}}
TINY = {"pressure": {"to": "1 Pa"}}


def solve(given: Case) -> RunResult:
    result = run_case(given, None)
    assert result.status == "converged", result.reason
    return result


def baseline() -> Case:
    """With a floor and a sheath of other rubbers, and weight."""
    base = spec()
    materials = base["materials"] | {"sheath": RUBBER | {"mu": "0.02 MPa"}}
    actuator = base["actuator"] | {"sheath": "1 mm"}
    weight = {"gravity": {"direction": "-y"}}
    return case(weight, PRESSED, actuator=actuator, materials=materials)


def test_moments_are_those_of_the_closed_forms() -> None:
    given = baseline()
    actuator, section = convert.dimensions(given.actuator), section_of(given)
    for name, area in actuator.region_areas().items():
        assert section.hollow[name][2, 2] == pytest.approx(area, rel=1e-6)
    whole = np.sum(list(section.filled.values()), axis=0)
    assert whole[2, 2] == pytest.approx(actuator.profile.outer_area, rel=1e-6)
    height = section.height + whole[1, 2] / whole[2, 2]
    assert height == pytest.approx(actuator.face_height, rel=1e-6)
    assert abs(whole[0, 2]) < 1e-9 * whole[2, 2]


def test_the_mass_is_that_of_the_whole_body() -> None:
    given = baseline()
    actuator, site = convert.dimensions(given.actuator), convert.site(given)
    hollow, cap = masses(given, section_of(given))
    found = hollow.mass * actuator.length + 2 * cap.mass * actuator.cap
    densities = {name: each.mass_density or 0.0 for name, each in site.materials.items()}
    exact = sum(densities[name] * v for name, v in actuator.region_volumes().items())
    assert found == pytest.approx(exact, rel=1e-6)


def test_a_cap_of_one_material_is_a_beam_of_its_own_section() -> None:
    """A solid circle: EA and EI of a disk, E = 3 μ, about its centre, where the line is."""
    given = case(**ROUND)
    law = cap_law(given, section_of(given), PLANE)
    assert isinstance(law, Quartic)
    radius, young = 7.0, 0.9
    exact = young * np.diag([math.pi * radius**2, math.pi * radius**4 / 4])
    np.testing.assert_allclose(law.stiffness, exact, rtol=1e-5, atol=1e-5 * exact.max())


def test_a_cap_is_pulled_as_its_rubber_in_a_test() -> None:
    """σ = μ (λ − 1/λ²) of a neo-Hookean rubber, to the third power of λ − 1."""
    given = case(**ROUND)
    law = cap_law(given, section_of(given), PLANE)
    for stretch in (0.97, 1.03):
        exact = 0.3 * math.pi * 7.0**2 * (stretch - stretch**-2)
        force = law.gradient(np.array([[stretch, 0.0]]), 0.0)[0, 0]
        assert force == pytest.approx(exact, rel=2e-4)
    # bent, it is alike up and down, and shortens: rubber is stiffer where it is pressed
    up, down = law.gradient(np.array([[1.0, 0.02], [1.0, -0.02]]), 0.0)
    assert up == pytest.approx([down[0], -down[1]], rel=1e-9)
    assert up[0] < 0


def test_slopes_of_a_test_of_tension_are_those_of_the_law() -> None:
    """U = μ/2 (λ² + 2/λ − 3): 3 μ, −6 μ and 24 μ; compressible by less at a bulk modulus."""
    rubber = Material("neo-hooke", {"mu": 0.3})
    assert pulled(rubber) == pytest.approx([0.9, -1.8, 7.2], rel=1e-9)
    soft = dataclasses.replace(rubber, bulk=0.6)
    assert pulled(soft) == pytest.approx(np.array([0.9, -1.8, 7.2]) * 1.8 / 2.1, rel=1e-9)


def test_a_cap_is_stiffer_where_its_floor_is() -> None:
    """Pulled without a moment about the line, it bends up: its stiff floor stretches less."""
    given = baseline()
    law = cap_law(given, section_of(given), PLANE)
    assert isinstance(law, Quartic)
    curvature = np.linalg.solve(law.stiffness, [1.0, 0.0])[1]
    assert curvature > 0


def test_at_rest_it_is_as_made(by_law: Put) -> None:
    by_law(linear())
    row = run_case(baseline(), None).rows[0]
    actuator = convert.dimensions(baseline().actuator)
    assert row[col.TIP_X] == 0.0
    assert row[col.TIP_Y] == pytest.approx(actuator.face_height, rel=1e-12)
    assert row[col.TIP_Z] == pytest.approx(actuator.length + actuator.cap, rel=1e-12)
    assert row[col.ANGLE] == row[col.WORK] == row[col.STORED] == 0.0
    assert row[col.AXIS_STRETCH] == pytest.approx(1.0, rel=1e-12)


def test_free_bending_is_that_of_the_section(by_law: Put) -> None:
    """k = P t/EI and λ = 1 + P a/EA all along the chamber; caps stay straight and unstretched."""
    by_law(linear((90.0, 500.0)))
    given = case(PRESSED)
    row = solve(given).rows[-1]
    k, stretch = 0.02 * 500 / STIFFNESS[1, 1], 1 + 0.02 * 90 / STIFFNESS[0, 0]
    length, cap = given.actuator.length, given.actuator.cap
    assert row[col.ANGLE] == pytest.approx(math.degrees(k * length), rel=1e-9)
    assert row[col.UNIFORM_ANGLE] == pytest.approx(row[col.ANGLE], rel=1e-12)
    assert row[col.AXIS_STRETCH] == pytest.approx(stretch, rel=1e-12)
    height = section_of(given).height
    arm = convert.dimensions(given.actuator).face_height - height
    along, down = tip(k * length, stretch * length, cap, arm)
    assert row[col.TIP_Z] == pytest.approx(along, abs=1e-7)
    assert row[col.TIP_Y] == pytest.approx(height - down, abs=1e-7)
    volume = length * (70 + 90 * (stretch - 1) + 500 * k)
    assert row[col.VOLUME] == pytest.approx(volume, rel=1e-9)
    assert row[col.MODES] == 0
    stored = length / 2 * (STIFFNESS[0, 0] * (stretch - 1) ** 2 + STIFFNESS[1, 1] * k**2)
    assert row[col.STORED] == pytest.approx(stored, rel=1e-9)
    assert row[col.WORK] == pytest.approx(stored, rel=1e-3)


def test_up_is_the_mirror_image_of_down(by_law: Put) -> None:
    by_law(linear())
    down, up = (
        solve(case({"gravity": {"direction": way}}, TINY, **ROUND)).rows[-1] for way in ("-y", "+y")
    )
    height = section_of(case(**ROUND)).height
    assert down[col.ANGLE] > 1
    assert up[col.ANGLE] == pytest.approx(-down[col.ANGLE], rel=1e-9)
    assert up[col.TIP_Y] - height == pytest.approx(height - down[col.TIP_Y], rel=1e-9)
    assert up[col.TIP_Z] == pytest.approx(down[col.TIP_Z], rel=1e-9)
    conjugate = "conjugate_gravity_mJ"
    assert down["load_gravity"] == 1.0
    assert up[conjugate] == pytest.approx(down[conjugate], rel=1e-9)
    # by a chord: its weight is put on in one step
    assert down[col.WORK] == pytest.approx(down[col.STORED], rel=0.01)


def test_its_weight_along_the_axis_stretches_it(by_law: Put) -> None:
    """Half of its own and all of the cap beyond: Δ = (w L²/2 + w_c c L)/EA and a little in caps."""
    by_law(linear())
    given = case({"gravity": {"direction": "+z"}}, TINY, **ROUND)
    row = solve(given).rows[-1]
    hollow, cap = masses(given, section_of(given))
    length, reach, g = given.actuator.length, given.actuator.cap, 9810.0
    grown = g * (hollow.mass * length**2 / 2 + cap.mass * reach * length) / STIFFNESS[0, 0]
    assert (row[col.AXIS_STRETCH] - 1) * length == pytest.approx(grown, rel=1e-3)
    assert row[col.ANGLE] == pytest.approx(0.0, abs=1e-6)


def test_a_tip_moment_bends_an_arc(by_law: Put) -> None:
    by_law(linear())
    moment = {"tip-load": {"moment": ["12 N mm", "0 N mm", "0 N mm"]}}
    row = solve(case(TINY, moment, **ROUND)).rows[-1]
    exact = math.degrees(12 / STIFFNESS[1, 1] * 100)
    assert row[col.ANGLE] == pytest.approx(exact, rel=1e-4)
    assert row["load_tip_load"] == 1.0
    turned = row["conjugate_tip_load_mJ"] / 12
    assert math.degrees(turned) > row[col.ANGLE], "the caps bend too"
    assert row[col.WORK] == pytest.approx(row[col.STORED], rel=1e-3)


def test_a_mass_at_the_tip_hangs_as_a_dead_force(by_law: Put) -> None:
    by_law(linear((90.0, 500.0)))
    weight = {"gravity": {"direction": "-y", "acceleration": "0.1 m/s^2"}}
    light = {name: each | {"density": "3 kg/m^3"} for name, each in spec()["materials"].items()}
    mass = {"tip-mass": {"mass": "200 g"}}
    hung = solve(case(weight, mass, PRESSED, materials=light)).rows[-1]
    force = {"tip-load": {"force": ["0 N", "-0.02 N", "0 N"]}}
    pulled = solve(case(force, PRESSED)).rows[-1]
    assert hung[col.ANGLE] == pytest.approx(pulled[col.ANGLE], rel=1e-3)
    assert hung[col.TIP_Y] == pytest.approx(pulled[col.TIP_Y], abs=0.01)


def test_the_order_of_dead_loads_does_not_matter(by_law: Put) -> None:
    by_law(linear((90.0, 500.0)))
    force = {"tip-load": {"force": ["0 N", "0.05 N", "0.03 N"]}}
    one, other = (solve(case(*each)).rows[-1] for each in ((PRESSED, force), (force, PRESSED)))
    for key in (col.ANGLE, col.TIP_Y, col.TIP_Z, col.STORED):
        assert one[key] == pytest.approx(other[key], rel=1e-8)


def test_all_lengths_twice_and_half_the_density_bend_it_alike(by_law: Put) -> None:
    rows = []
    for scale in (1.0, 2.0):
        by_law(linear((90.0, 500.0), scale))
        data = spec({"gravity": {"direction": "-y"}}, PRESSED, **copy.deepcopy(ROUND))
        sizes = {"radius": 5, "length": 100, "wall": 2, "cap": 10}
        data["actuator"] |= {key: f"{scale * value} mm" for key, value in sizes.items()}
        data["materials"]["wall"]["density"] = f"{1100 / scale} kg/m^3"
        rows.append(solve(parse_case(data)).rows[-1])
    assert rows[1][col.ANGLE] == pytest.approx(rows[0][col.ANGLE], rel=1e-9)
    assert rows[1][col.TIP_Z] == pytest.approx(2 * rows[0][col.TIP_Z], rel=1e-9)
    assert rows[1][col.VOLUME] == pytest.approx(8 * rows[0][col.VOLUME], rel=1e-9)
    assert rows[1][col.WORK] == pytest.approx(8 * rows[0][col.WORK], rel=1e-6)


def asked(**output: Any) -> dict[str, Any]:
    return {"output": QUIET | output}


def test_what_is_asked_for_is_hit(by_law: Put) -> None:
    by_law(linear((90.0, 500.0)))
    output = asked(at_angles=["10 deg", "20 deg"], at_pressures=["7 kPa", "15 kPa"])
    rows = solve(case(**output)).rows
    for angle in (10.0, 20.0):
        assert min(abs(row[col.ANGLE] - angle) for row in rows) < 1e-9
    for pressure in (7.0, 15.0):
        assert min(abs(row[col.PRESSURE] - pressure) for row in rows) < 1e-9
    assert [row[col.STEP] for row in rows] == list(range(len(rows)))
    angles = [row[col.ANGLE] for row in rows]
    assert np.all(np.diff(angles) > 0)
    assert np.diff(angles).max() < 10 * 1.2 + 1e-6


def test_it_stops_at_an_angle(by_law: Put) -> None:
    by_law(linear((90.0, 500.0)))
    result = solve(case(**asked(stop_at_angle="12 deg")))
    assert result.rows[-1][col.ANGLE] == pytest.approx(12.0, abs=1e-9)


def test_what_is_not_reached_is_said(by_law: Put) -> None:
    by_law(linear((90.0, 500.0)))
    result = run_case(case(**asked(at_angles=["170 deg"])), None)
    assert result.status == "stopped"
    assert "170° not reached" in result.reason
    assert any("170°" in line for line in result.run["warnings"])


def test_an_angle_is_driven(by_law: Put) -> None:
    by_law(linear((90.0, 500.0)))
    result = solve(case({"pressure": {"angle": "30 deg"}}))
    pressure = math.radians(30) / 100 * STIFFNESS[1, 1] / 500
    assert result.rows[-1][col.ANGLE] == pytest.approx(30.0, abs=1e-9)
    assert result.rows[-1][col.PRESSURE] == pytest.approx(1e3 * pressure, rel=1e-9)


def softening() -> Softening:
    return Softening(STIFFNESS, np.array([1.0, 0.0]), 70.0, np.array([0.0, 500.0]))


def test_an_angle_leads_over_the_greatest_pressure(by_law: Put) -> None:
    """P = EI (k − k³/(3 k₀²))/t; beyond k₀ every piece is unstable at a given pressure."""
    by_law(softening())
    result = solve(case({"pressure": {"angle": "80 deg"}}))
    for row in result.rows[1:]:
        k = math.radians(row[col.ANGLE]) / 100
        exact = STIFFNESS[1, 1] * (k - k**3 / (3 * 0.01**2)) / 500
        assert row[col.PRESSURE] == pytest.approx(1e3 * exact, rel=1e-8, abs=1e-9)
        assert row[col.MODES] == (48 if k > 0.01 else 0)
    (point,) = result.run["critical_points"]
    assert point["kind"] == "limit"
    assert point[col.ANGLE] == pytest.approx(math.degrees(1.0), rel=1e-4)
    greatest = 2e3 / 3 * STIFFNESS[1, 1] * 0.01 / 500
    assert point[col.PRESSURE] == pytest.approx(greatest, rel=1e-6)
    assert any("limit point" in line for line in result.run["warnings"])
    assert any("the end is unstable" in line for line in result.run["warnings"])


def test_a_pressure_beyond_the_greatest_one_stops_there(by_law: Put) -> None:
    by_law(softening())
    result = run_case(case({"pressure": {"to": "25 kPa"}}), None)
    assert result.status == "stopped"
    assert "25 kPa is not reached: limit point at 20 kPa" in result.reason
    assert max(row[col.PRESSURE] for row in result.rows) == pytest.approx(20.0, rel=1e-3)


def test_it_buckles_at_eulers_load(by_law: Put) -> None:
    """Pressed along its axis by a dead force; caps as stiff as the chamber would be, nearly."""
    by_law(linear())
    force = {"tip-load": {"force": ["0 N", "0 N", "-0.4 N"]}}
    result = solve(case(TINY, force, **ROUND))
    (point,) = result.run["critical_points"]
    assert point["kind"] == "bifurcation"
    assert point["side"] == "not looked for"
    length = 120.0
    euler = math.pi**2 * STIFFNESS[1, 1] / (4 * length**2)
    # caps of 10 mm are 13 % stiffer, and it is shorter by P/EA
    assert 0.4 * point["value"] == pytest.approx(euler, rel=0.05)
    assert 0.4 * point["value"] > euler
    assert any("goes on along the old one" in line for line in result.run["warnings"])
    assert result.rows[-1][col.MODES] == 1
