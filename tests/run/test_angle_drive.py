"""A pressure that is to bend by an angle: whichever way the section bends, or why it does not."""

from __future__ import annotations

import copy
import dataclasses
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from fiberbend import run
from fiberbend.models.choice import meshed
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import as_case
from fiberbend.running.assembly import assemble
from fiberbend.running.messages import angle_missed
from tests.run.conftest import small

QUIET = {"pictures": False, "fields": False}
FINGER: dict[str, Any] = {
    "title": "Finger without a winding",
    "actuator": {
        "section": "rectangle",
        "width": "12 mm",
        "height": "12 mm",
        "length": "100 mm",
        "wall": "2 mm",
        "floor": "2 mm",
    },
    "materials": {"wall": "elastosil-m4601", "floor": "combined-base"},
    "effects": [{"pressure": {"angle": "20 deg"}}],
    "model": "section",
    "output": QUIET,
}
SHAPES = {
    "rectangle": {"section": "rectangle", "width": "12 mm", "height": "12 mm", "floor": "2 mm"},
    "hemicircle": {"section": "hemicircle", "radius": "8 mm", "floor": "2 mm"},
    "circle": {"section": "circle", "radius": "8 mm", "floor": "1 mm"},
}
SOFT = {"law": "neo-hooke", "mu": "0.02 MPa"}
HELIX = {"winding": {"pattern": "single-helix-right", "pitch": "20 mm", "fiber": "kevlar"}}


def finger(angle: str = "20 deg", **changes: Any) -> dict[str, Any]:
    """The finger driven to an angle, with top-level entries changed."""
    return copy.deepcopy(FINGER) | {"effects": [{"pressure": {"angle": angle}}]} | changes


def shaped(shape: str) -> dict[str, Any]:
    """Dimensions of an actuator of one of the shapes."""
    return SHAPES[shape] | {"length": "60 mm", "wall": "2 mm", "cap": "6 mm"}


def _at_rest_it_does_not_bend(case: dict[str, Any]) -> bool:
    checked = as_case(case)
    model = meshed(checked)
    assembly = assemble(checked, model.mesh(checked), MPI.COMM_SELF)
    rest = assembly.march.rest
    seed = assembly.march.equilibrium.perturbed(rest, "pressure")
    key = "conjugate pressure"
    turned = seed.measures["control"] - rest.measures["control"]
    swollen = (seed.measures[key] - rest.measures[key]) / rest.measures[key]
    # wound ones turn by 30 to 300 mrad where the chamber grows by a tenth
    return bool(abs(turned) < 1e-3 * abs(swollen))


def test_a_finger_without_a_winding_is_bent_by_an_angle() -> None:
    # dθ/dP is zero at rest; found by its pressure, 20° are at 40.91 kPa
    found = run(finger())
    assert found.status == "converged", found.reason
    assert found.last("angle_deg") == pytest.approx(20.0, abs=1e-6)
    assert found.last("pressure_kPa") == pytest.approx(40.91, abs=0.01)
    output = QUIET | {"at_angles": ["20 deg"], "stop_at_angle": "20 deg"}
    other = run(finger(effects=[{"pressure": {"to": "45 kPa"}}], output=output))
    assert other.status == "converged", other.reason
    assert other.last("pressure_kPa") == pytest.approx(found.last("pressure_kPa"), rel=1e-6)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("model", ["section", "cell"])
def test_incompressible_sections_bend_by_the_square_of_the_pressure(shape: str, model: str) -> None:
    case = finger(actuator=shaped(shape), model=model, mesh={"section": 1, "axial": "6 mm"})
    assert _at_rest_it_does_not_bend(case)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("side", [1, -1])
def test_each_shape_bends_toward_its_stiff_side(shape: str, side: int) -> None:
    floor = "combined-base" if side > 0 else SOFT
    case = finger(actuator=shaped(shape), mesh={"section": 1})
    case["materials"]["floor"] = floor
    case["effects"] = [{"pressure": {"angle": f"{15 * side} deg"}}]
    found = run(case)
    assert found.status == "converged", found.reason
    assert found.last("angle_deg") == pytest.approx(15 * side, abs=1e-6)
    assert found.last("pressure_kPa") > 0


def test_the_section_turned_upside_down_bends_the_other_way_under_the_same_pressure() -> None:
    ends = []
    for angle, turned in (("20 deg", 1.0), ("-20 deg", -1.0)):
        case = as_case(finger(angle, mesh={"section": 1}))
        mesh = meshed(case).mesh(case)
        mesh = dataclasses.replace(mesh, nodes=mesh.nodes * [1.0, turned])
        assembly = assemble(case, mesh, MPI.COMM_SELF)
        report = assembly.march.run(assembly.ramps)
        assert report.status == "converged", report.reason
        ends.append(assembly.march.states[-1])
    up, down = ends
    assert down.measures["control"] == pytest.approx(-up.measures["control"], abs=1e-9)
    assert down.scalars["pressure"] == pytest.approx(up.scalars["pressure"], rel=1e-7)


def _missed(**changes: Any) -> RunResult:
    found = run(finger(**changes))
    assert found.status == "stopped"
    return found


def test_the_way_that_no_pressure_bends_is_told() -> None:
    found = _missed(angle="-20 deg")
    assert found.reason.startswith("-20° is not reached: the pressure bends it the other way")


def test_a_section_that_bends_one_way_first_and_then_the_other() -> None:
    # one rubber all over: away from its thick floor first (-1.3°), toward it beyond 90 kPa
    actuator = SHAPES["hemicircle"] | {"length": "100 mm", "wall": "2 mm"}
    rubber = {"wall": "elastosil-m4601", "floor": "elastosil-m4601"}
    found = run(finger("2 deg", actuator=actuator, materials=rubber))
    angles = [row["angle_deg"] for row in found.rows]
    assert (found.status, angles[-1]) == ("converged", pytest.approx(2.0, abs=1e-6))
    assert min(angles) < -1.0
    missed = _missed(angle="-20 deg", actuator=actuator, materials=rubber)
    assert "-20° is not reached: the angle is greatest at -1." in missed.reason


def test_an_angle_that_turns_back_under_its_winding_is_told() -> None:
    # Gent's rubber stiffens: wound, it unbends beyond some 96° of the 150 that are asked for
    materials = {
        "wall": {"law": "gent", "mu": "0.3 MPa", "jm": 3},
        "floor": {"law": "gent", "mu": "2 MPa", "jm": 2},
    }
    actuator = SHAPES["hemicircle"] | {"length": "100 mm", "wall": "2 mm"}
    found = _missed(angle="150 deg", actuator=actuator, materials=materials)
    greatest = max(row["angle_deg"] for row in found.rows)
    assert f"150° is not reached: the angle is greatest at {greatest:.4g}°" in found.reason
    assert 90 < greatest < 105


@pytest.mark.parametrize("angle", [25.0, -4.0])
def test_a_twisting_winding_is_bent_both_ways(angle: float) -> None:
    actuator = shaped("hemicircle")
    effects = [{"pressure": {"angle": f"{angle} deg"}}, HELIX]
    found = run(finger(actuator=actuator, effects=effects, mesh={"section": 1}))
    assert (found.status, found.last("angle_deg")) == ("converged", pytest.approx(angle))
    assert np.sign(found.last("pressure_kPa")) == np.sign(angle)
    assert found.last("twist_deg") != 0


def test_a_body_without_a_winding_is_bent_by_an_angle() -> None:
    # between caps that hold their section; the section beside it guides it
    actuator = SHAPES["hemicircle"] | {"length": "40 mm", "wall": "2 mm", "cap": "6 mm"}
    mesh = {"section": 1, "axial": "8 mm"}
    found = run(finger("10 deg", actuator=actuator, model="body", mesh=mesh))
    assert (found.status, found.last("angle_deg")) == ("converged", pytest.approx(10.0))
    beside = run(finger("10 deg", actuator=actuator, mesh=mesh))
    assert found.last("pressure_kPa") == pytest.approx(beside.last("pressure_kPa"), rel=0.15)


@pytest.mark.long
def test_a_body_is_bent_backward_by_vacuum() -> None:
    winding = {"winding": small()["effects"][1]["winding"] | {"as": "smeared"}}
    for name, goal in (("angle", "-3 deg"), ("to", "-20 kPa")):
        output = QUIET if name == "angle" else QUIET | {"stop_at_angle": "-3 deg"}
        effects = [{"pressure": {name: goal}}, winding]
        found = run(small(effects=effects, mesh={"axial": "6 mm"}, output=output))
        assert (found.status, found.last("angle_deg")) == ("converged", pytest.approx(-3.0))
        assert -12 < found.last("pressure_kPa") < -8


def _course(*states: tuple[float, float]) -> list[dict[str, Any]]:
    return [{"pressure_kPa": pressure, "angle_deg": angle} for pressure, angle in states]


def test_what_other_loads_have_done_before_is_not_the_pressure_s_best() -> None:
    # its weight bends it to 15.5°, vacuum back to 13.9° and no further
    rows = _course((0, 0), (0, 9), (0, 15.5), (-3, 14.3), (-5.7, 13.9), (-6.6, 14.1))
    turned, reason = angle_missed(rows, 15.5, 2.0, "")
    assert turned
    assert reason == (
        "2° is not reached: the angle is least at 13.9°, -5.7 kPa, and goes back to 14.1° at "
        "-6.6 kPa"
    )


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_angle_that_has_turned_back_is_greatest_to_either_side(side: float) -> None:
    rows = _course((0, 0), (side * 5, side * 20), (side * 6, side * 12))
    turned, reason = angle_missed(rows, 0.0, side * 45, "")
    assert turned
    assert f"the angle is greatest at {side * 20:.4g}°, {side * 5:.4g} kPa" in reason
