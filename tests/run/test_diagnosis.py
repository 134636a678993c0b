"""A run that cannot go on says why in the user's terms; one that goes too far is warned about."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from fem.march.records import Critical, Report
from fiberbend import run
from fiberbend.models.result import RunResult
from fiberbend.running import messages
from tests.run.conftest import small

QUIET = {"pictures": False, "fields": False}
SMEARED: dict[str, Any] = {
    "winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"}
}


def section(pressure: dict[str, str], winding: dict[str, Any] = SMEARED) -> RunResult:
    """The section of the paper's actuator."""
    actuator = small()["actuator"] | {"length": "160 mm", "cap": "15 mm"}
    effects = [{"pressure": pressure}, winding]
    return run(small(actuator=actuator, effects=effects, model="section", output=QUIET))


@pytest.fixture(scope="module")
def collapsed() -> RunResult:
    """A vacuum that the crown does not bear: it buckles in at −17 kPa."""
    return section({"to": "-100 kPa"})


@pytest.mark.long
def test_collapse_under_vacuum_is_named(collapsed: RunResult) -> None:
    # before: 'no convergence in 11 iterations'
    assert collapsed.status == "stopped"
    assert "-100 kPa is not reached: limit point at -17.0" in collapsed.reason
    assert "the chamber collapses at falling vacuum" in collapsed.reason
    assert "the chamber collapses under vacuum: 5" in collapsed.reason
    assert collapsed.run["critical_points"][0]["pressure_kPa"] == pytest.approx(-17.0, abs=0.1)


@pytest.mark.long
def test_a_falling_branch_is_not_pursued_at_any_price(collapsed: RunResult) -> None:
    # the folded crown needs ever smaller steps; they only show why the load is not reached.
    # One of them is taken back because Newton strayed from the path
    assert collapsed.run["cutbacks"] <= 10


def test_a_body_that_passes_through_itself_is_warned_about() -> None:
    # caps of 15 mm at the ends of an arc of 160 mm meet at 304°: tests/fem/test_selfcontact.py;
    # under pressure the sections' centroids have moved against the caps'
    result = section({"angle": "360 deg"})
    assert result.status == "converged"
    (text,) = result.run["warnings"]
    assert text.startswith("from 306.0° (152.")
    assert "passes through itself" in text


@pytest.mark.long
def test_a_body_that_bends_less_is_not_warned_about() -> None:
    assert section({"angle": "270 deg"}).run["warnings"] == []


def test_fibers_a_thousand_times_stiffer_are_solved() -> None:
    # forces of 881 kN/mm know their residual to 1e-7 N only; before: no step at all converged
    stiff = {"modulus": "31076000 MPa", "diameter": "0.38 mm", "radius_factor": 0.5}
    winding = {"winding": SMEARED["winding"] | {"fiber": stiff}}
    result = section({"to": "50 kPa"}, winding)
    assert result.status == "converged"
    assert result.run["cutbacks"] == 0
    # kevlar is all but inextensible already: 1 % less bending
    assert result.last("angle_deg") == pytest.approx(
        section({"to": "50 kPa"}).last("angle_deg"), rel=0.02
    )


# --- words --------------------------------------------------------------------------------------


def _point(kind: str, value: float, before: int, after: int) -> Critical:
    return Critical(kind, "pressure", value, 1000.0, 0.5, before, after)


@pytest.mark.parametrize(
    ("side", "text"),
    [
        ("chosen", "to one of two sides that are alike"),
        ("by the loads", "to the side that the loads or the mesh favour"),
        ("", "no state is found along it"),
    ],
)
def test_a_bifurcation_says_whereto_the_run_goes(side: str, text: str) -> None:
    point = dataclasses.replace(_point("bifurcation", 0.1, 0, 1), side=side)
    (line,) = messages.remarks(Report(critical=[point]))
    assert text in line
    (entry,) = messages.critical_points(Report(critical=[point]), symmetry_factor=1)
    assert entry.get("side", "") == side


@pytest.mark.parametrize(
    ("point", "text"),
    [
        (_point("limit", 0.02, 0, 1), "limit point at 20 kPa, 28.6°: beyond it the actuator"),
        (_point("limit", -0.02, 0, 1), "the chamber collapses at falling vacuum"),
        (_point("limit", 0.02, 1, 0), "the pressure rises again from 20 kPa, 28.6° on"),
        (_point("bifurcation", 0.123, 0, 1), "one unstable mode from 123 kPa, 28.6° on"),
        (_point("bifurcation", 0.123, 1, 3), "three unstable modes from 123 kPa"),
        (_point("bifurcation", 0.123, 1, 0), "stable again from 123 kPa"),
    ],
)
def test_a_critical_point_has_its_line(point: Critical, text: str) -> None:
    (line,) = messages.remarks(Report(critical=[point]))
    assert text in line


def test_one_mode_less_of_several_is_no_news() -> None:
    assert messages.remarks(Report(critical=[_point("bifurcation", 0.1, 3, 2)])) == []


def test_critical_points_are_those_of_the_whole_actuator() -> None:
    # half a body has half the chamber
    (entry,) = messages.critical_points(
        Report(critical=[_point("limit", 0.02, 0, 1)]), symmetry_factor=2
    )
    assert entry["chamber_mm3"] == 2000.0
    assert entry["pressure_kPa"] == pytest.approx(20.0)


def test_steps_cut_while_threads_push_are_explained() -> None:
    """The body of cases/extending.yaml: no mode is lost, and two steps are cut."""
    rows = [
        {"pressure_kPa": 0.0, "fiber_min_N": -1.0, "fiber_max_N": 1.0},
        {"pressure_kPa": 40.0, "fiber_min_N": -0.291, "fiber_max_N": 0.465},
    ]
    (line,) = messages.pushed(Report(cutbacks=2), rows)
    assert "push with up to 0.291 N" in line
    assert "tension_only: true" in line
    assert messages.pushed(Report(), rows) == []
    assert (
        messages.pushed(Report(cutbacks=2, critical=[_point("bifurcation", 0.1, 0, 1)]), rows) == []
    )
    taut = [rows[0], {**rows[1], "fiber_min_N": -1e-6}]
    assert messages.pushed(Report(cutbacks=2), taut) == []
