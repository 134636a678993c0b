"""A trial gives what a run of the same case gives."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.integrate import simpson

import fiberbend
from fiberbend import columns as col
from fiberbend.columns import Row
from fiberbend.schema.problems import CaseError
from fiberbend.trial.solve import blocked_force, solve
from fiberbend.trial.wanted import Point, Wanted
from tests.trial.cases import Data, checked, radians, run, shipped, under, wound

FAMILIES = [
    {"angle_from_axis": "60 deg", "hand": "left", "starts": 6},
    {"angle_from_axis": "75 deg", "hand": "right", "starts": 4},
]
"""Threads that are not balanced: what they wind twists, and bends to the side."""

BENT: dict[str, Data] = {
    "hemicircle": shipped("section"),
    "cell": shipped("cell"),
    "circle": shipped("circle"),
    "rectangle": shipped("rectangle"),
    "single helix": shipped("single_helix"),
    "families": wound(shipped("circle"), families=FAMILIES, fiber="kevlar"),
    "calibrated": wound(
        shipped("section"),
        **{"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "calibrated"},
        bulging={"stiffness": "0.6 MPa/mm", "linear": 1.0, "quadratic": 5.0},
    ),
}


def agree(point: Point, row: Row, rel: float = 1e-9) -> None:
    """A point is a row of a history."""
    zero = 1e-3 * rel
    told = {
        col.PRESSURE: 1e3 * point.pressure,
        col.ANGLE: math.degrees(point.angle),
        col.SIDE_ANGLE: math.degrees(point.side_angle),
        col.TWIST: math.degrees(point.twist),
        col.AXIS_STRETCH: point.stretch,
        col.VOLUME: point.volume,
        col.STORED: point.work,
        col.FIBER_MIN: point.fiber_low,
        col.FIBER_MAX: point.fiber_high,
        col.TIP_FORCE: point.tip_force,
        col.MOMENT: point.moment,
    }
    for name, value in told.items():
        size = point.fiber_high if name == col.FIBER_MIN else 1.0
        assert value == pytest.approx(row.get(name, 0.0), rel=rel, abs=rel * size + zero), name


def nearest(rows: Sequence[Row], column: str, value: float) -> Row:
    """The row whose value of a column is nearest."""
    return min(rows, key=lambda row: abs(row[column] - value))


@pytest.mark.parametrize("name", BENT)
def test_bent_to_angles(name: str) -> None:
    data = under(BENT[name], angle="100 deg")
    answer = solve(checked(data), Wanted(angles=radians(100, 40)))
    assert answer.converged, answer.reason
    assert [point.angle for point in answer.free] == pytest.approx(radians(100, 40), rel=1e-9)
    result = run(data, at_angles=["40 deg", "100 deg"])
    assert result.status == "converged", result.reason
    for point in answer.free:
        agree(point, nearest(result.rows, col.ANGLE, math.degrees(point.angle)))
        rest = result.rows[0][col.VOLUME]
        assert point.volume_at_rest == pytest.approx(rest, rel=1e-12)


@pytest.mark.parametrize("name", ["hemicircle", "cell", "families"])
def test_under_pressures_and_kept_straight(name: str) -> None:
    data = under(BENT[name], to="60 kPa")
    answer = solve(checked(data), Wanted(pressures=(0.03, 0.06), straight=(0.06,)))
    rows = run(data, at_pressures=["30 kPa", "60 kPa"]).rows
    for point in answer.free:
        agree(point, nearest(rows, col.PRESSURE, 1e3 * point.pressure))
    if name == "families":
        assert not answer.converged
        assert "hand" in answer.reason
        assert answer.straight == ()
        return
    assert answer.converged, answer.reason
    kept = run(under(data, {"straight": {}}, to="60 kPa")).rows
    agree(answer.straight[0], kept[-1])
    assert answer.straight[0].moment > 0


def test_strain_is_that_of_run_json(tmp_path: Path) -> None:
    data = under(BENT["hemicircle"], angle="100 deg")
    (point,) = solve(checked(data), Wanted(angles=radians(100))).free
    found = run(data, states=tmp_path).run["greatest_strain"]["logarithmic"]
    assert point.strain == pytest.approx(found, rel=1e-9)


def test_a_body_is_refused() -> None:
    data = under(BENT["hemicircle"], to="60 kPa") | {"model": "body", "mesh": {}}
    with pytest.raises(CaseError, match="expected section or cell"):
        solve(checked(data), Wanted(angles=(1.0,)))


def test_what_is_beyond_reach_is_said() -> None:
    """The angle turns back before; beyond its limiting pressure rubber balloons."""
    data = under(BENT["hemicircle"], angle="100 deg")
    gent = {"wall": {"law": "gent", "mu": "0.3 MPa", "jm": 0.3}}
    stiff = checked(data | {"materials": data["materials"] | gent})
    answer = solve(stiff, Wanted(angles=radians(40, 4000)))
    assert not answer.converged
    furthest = re.fullmatch(r"it bends no further than (.+)°, at .+ kPa", answer.reason)
    assert furthest is not None
    assert 40 < float(furthest[1]) < 4000
    assert [point.angle for point in answer.free] == pytest.approx(radians(40), rel=1e-9)
    soft = data["materials"] | {"wall": "ecoflex-0030"}
    bare = data | {"effects": data["effects"][:1], "materials": soft}
    answer = solve(checked(bare), Wanted(pressures=(0.001, 0.1)))
    assert not answer.converged
    assert "ballooning" in answer.reason or "no pressure beyond" in answer.reason
    assert [point.pressure for point in answer.free] == pytest.approx([0.001], rel=1e-9)


def test_at_rest() -> None:
    """Zero is asked for like any other value."""
    case = checked(under(BENT["hemicircle"], angle="100 deg"))
    answer = solve(case, Wanted((0.0, 0.5), (0.0,), (0.0,)))
    assert answer.converged
    for point in (answer.free[0], answer.free[2], answer.straight[0]):
        assert (point.pressure, point.angle, point.stretch) == (0.0, 0.0, 1.0)
        assert point.volume == point.volume_at_rest
        assert point.work == pytest.approx(0.0, abs=1e-12)
        assert point.strain == pytest.approx(0.0, abs=1e-12)


def test_work_is_that_of_the_pressure() -> None:
    """∫ p dV by Simpson's rule through 33 states; of what is kept straight too."""
    case = checked(under(BENT["hemicircle"], angle="100 deg"))
    parts = [i / 32 for i in range(1, 33)]
    answer = solve(case, Wanted(tuple(1.5 * x for x in parts), (), tuple(0.05 * x for x in parts)))
    for points in (answer.free, answer.straight):
        p = np.array([0.0, *(point.pressure for point in points)])
        v = np.array([points[0].volume_at_rest, *(point.volume for point in points)])
        work = simpson(p * np.gradient(v, edge_order=2), dx=1.0)
        assert points[-1].work == pytest.approx(work, rel=2e-4)


def test_the_blocked_force_of_a_sweep(tmp_path: Path) -> None:
    """One point of a sweep that reports it, and the case of that point."""
    data = under(BENT["hemicircle"], to="60 kPa")
    case = tmp_path / "case.yaml"
    case.write_text(yaml.safe_dump(data), encoding="utf-8")
    sweep = {"case": "case.yaml", "vary": {"actuator.wall": ["2.5 mm"]}}
    file = tmp_path / "sweep.yaml"
    report = {"force_at": "50 kPa"}
    file.write_text(yaml.safe_dump(sweep | {"report": report}), encoding="utf-8")
    (row,) = fiberbend.sweep(file, tmp_path / "out").rows
    data["actuator"] = data["actuator"] | {"wall": "2.5 mm"}
    found = blocked_force(checked(data), 0.05)
    assert found.force == pytest.approx(row["blocked_force_N"], rel=1e-6)
    assert found.named == row["blocked_force_model"]
    assert "twice" in found.remark
    twisting = blocked_force(checked(under(BENT["single helix"], to="60 kPa")), 0.05)
    assert twisting.force is None
    assert twisting.reason
