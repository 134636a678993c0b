"""Actuators that buckle end on the branch on which they rest, whatever their steps."""

from __future__ import annotations

import functools
from typing import Any

import pytest

from fiberbend import run
from fiberbend.models.result import RunResult

QUIET = {"pictures": False, "fields": False}
TUBE: dict[str, Any] = {
    "actuator": {
        "section": "circle",
        "radius": "8 mm",
        "length": "60 mm",
        "wall": "1 mm",
        "cap": "5 mm",
    },
    "materials": {"wall": {"law": "neo-hooke", "mu": "0.22 MPa"}},
    "output": QUIET,
}
RING = 1e3 * 0.22 * (1 / 8.5) ** 3
"""3 E I/R³ in plane strain, E = 4 μ, I = t³/12: 0.358 kPa (Bresse 1866, Lévy 1884)."""
COARSE = "one step"
STEPS = (COARSE, "0.13 kPa", "0.05 kPa")


def _steps(step: str) -> dict[str, str]:
    return {} if step == COARSE else {"max_step": step}


@functools.cache
def ring(step: str) -> RunResult:
    """A long tube under vacuum, kept straight and in length: a ring in plane strain."""
    effects = [{"pressure": {"to": "-0.45 kPa"}}, {"straight": {"stretch": "held"}}]
    own = {"effects": effects, "model": "section", "mesh": {"section": 2}}
    solver = {"first_step": "0.45 kPa"} if step == COARSE else _steps(step)
    return run(TUBE | own | {"solver": solver})


def tube(step: str, pressure: str, axial: str) -> RunResult:
    """A short tube under vacuum; its weight is the imperfection that rounds the bifurcation."""
    effects = [{"gravity": {"direction": "-y"}}, {"pressure": {"to": pressure}}]
    wall = TUBE["materials"]["wall"] | {"density": "1.1 g/cm^3"}
    own = {"effects": effects, "model": "body", "mesh": {"axial": axial}}
    own |= {"materials": {"wall": wall}}
    return run(TUBE | own | {"solver": _steps(step)})


@pytest.mark.parametrize("step", STEPS)
def test_a_thin_ring_buckles_at_its_exact_pressure(step: str) -> None:
    # within 2 %: the wall is an eighth of the radius, one element thick
    (point,) = ring(step).run["critical_points"]
    assert point["kind"] == "bifurcation"
    assert -point["pressure_kPa"] == pytest.approx(RING, rel=0.02)
    fine = ring(STEPS[-1]).run["critical_points"][0]
    assert point["pressure_kPa"] == pytest.approx(fine["pressure_kPa"], rel=1e-4)


@pytest.mark.parametrize("step", STEPS)
def test_a_ring_collapses_and_rests_whatever_the_step(step: str) -> None:
    result, fine = ring(step), ring(STEPS[-1])
    assert result.status == "converged"
    assert result.last("pressure_kPa") == pytest.approx(-0.45, rel=1e-9)
    assert result.rows[-1]["unstable_modes"] == 0
    chamber = result.rows[0]["chamber_mm3"]
    assert result.last("chamber_mm3") < 0.7 * chamber
    assert result.last("chamber_mm3") == pytest.approx(fine.last("chamber_mm3"), rel=1e-3)


def test_the_line_names_pressure_and_branch() -> None:
    result = ring(COARSE)
    line = next(text for text in result.run["warnings"] if "unstable mode" in text)
    pressure = result.run["critical_points"][0]["pressure_kPa"]
    assert f"from {pressure:.4g} kPa" in line
    assert "the run goes on along it" in line


@pytest.mark.long
def test_a_step_over_a_limit_point_is_taken_back() -> None:
    # before: 'converged' at 98 % of the volume, with an unstable mode, in one step
    coarse, fine = (tube(step, "-0.6 kPa", "12 mm") for step in (COARSE, "0.1 kPa"))
    for result in (coarse, fine):
        assert result.status == "converged"
        assert result.rows[-1]["unstable_modes"] == 0
    assert coarse.last("chamber_mm3") < 0.85 * coarse.rows[0]["chamber_mm3"]
    assert coarse.last("chamber_mm3") == pytest.approx(fine.last("chamber_mm3"), rel=1e-3)


def crown(divisions: int, slack: bool = False) -> RunResult:
    """A vacuum that presses a stiff winding between soft layers, in the section model."""
    winding: dict[str, Any] = {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}
    if slack:
        winding |= {"tension_only": True}
    return run(
        {
            "actuator": {
                "section": "hemicircle",
                "radius": "8 mm",
                "length": "80 mm",
                "wall": "2 mm",
                "floor": "2 mm",
                "sheath": "1 mm",
                "cap": "10 mm",
            },
            "materials": {
                "wall": "elastosil-m4601",
                "floor": "combined-base",
                "sheath": "ecoflex-0030",
            },
            "effects": [{"pressure": {"to": "-14.5 kPa"}}, {"winding": winding}],
            "model": "section",
            "mesh": {"section": divisions},
            "output": QUIET,
        }
    )


@pytest.mark.long
def test_a_wrinkle_that_the_mesh_gives_is_named() -> None:
    # a thread has no stiffness against bending: pressed, it wrinkles from node to node
    result = crown(4)
    point = result.run["critical_points"][0]
    assert point["wrinkle"]
    assert point["pressure_kPa"] == pytest.approx(-14.07, abs=0.05)
    assert any("the mesh gives this load" in text for text in result.run["warnings"])
    # coarser, the same load finds none; nor where the thread goes slack
    assert not crown(2).run["critical_points"]
    assert not crown(4, slack=True).run["critical_points"]


def finger(**mesh: str) -> dict[str, Any]:
    """A finger that stands upright, thin along x: it buckles across its mirror plane."""
    rubber = {"law": "neo-hooke", "mu": "0.22 MPa", "density": "3.83 g/cm^3"}
    return {
        "actuator": {
            "section": "rectangle",
            "width": "2 mm",
            "height": "6 mm",
            "floor": "1 mm",
            "length": "60 mm",
            "wall": "1 mm",
            "cap": "2 mm",
        },
        "materials": {"wall": rubber, "floor": rubber},
        "effects": [{"gravity": {"direction": "-z"}}],
        "model": "body",
        "mesh": {"axial": "20 mm", "section": 1, **mesh},
        "output": QUIET,
    }


@pytest.mark.long
def test_half_a_body_that_cannot_follow_is_solved_whole() -> None:
    result = run(finger())
    assert result.status == "converged"
    assert any("the whole body is solved" in text for text in result.run["warnings"])
    assert result.rows[-1]["unstable_modes"] == 0
    (point,) = result.run["critical_points"]
    assert 0.95 < point["value"] < 1.0
    # it leans to the side, and its weight sinks
    assert abs(result.last("tip_x_mm")) > 0.3


def test_half_a_body_that_is_asked_for_stays_half() -> None:
    result = run(finger(symmetry="half"))
    assert result.status == "failed"
    assert "mesh.symmetry: full" in result.reason


def test_half_a_body_of_tetrahedra_says_what_it_cannot_tell() -> None:
    result = run(finger(element="tetrahedron"))
    assert any("tetrahedra cannot tell" in text for text in result.run["warnings"])


@pytest.mark.hard
def test_a_tube_collapses_to_one_volume_whatever_the_step() -> None:
    # before: 98 % in one step, 21 % in steps of 0.1 kPa
    ends = [tube(step, "-1.2 kPa", "6 mm") for step in (COARSE, "0.3 kPa", "0.1 kPa")]
    for result in ends:
        assert result.status == "converged"
        assert result.rows[-1]["unstable_modes"] == 0
        lost = result.run["critical_points"][0]
        assert lost["pressure_kPa"] == pytest.approx(-0.53, abs=0.01)
        share = result.last("chamber_mm3") / result.rows[0]["chamber_mm3"]
        assert share == pytest.approx(0.21, abs=0.005)
        assert result.last("chamber_mm3") == pytest.approx(ends[0].last("chamber_mm3"), rel=1e-3)
