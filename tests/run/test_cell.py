"""The cell: mirror planes or tied ends, one hand or the other, and its smeared limit."""

from __future__ import annotations

from typing import Any

import pytest

from fiberbend import run
from fiberbend.models.result import RunResult
from tests.run.conftest import small

COLUMNS = ("angle_deg", "axis_stretch", "crown_stretch", "chamber_mm3", "fiber_max_N", "tip_z_mm")


def cell(pattern: str = "double-helix", **changes: Any) -> RunResult:
    """A cell of the small actuator at 30 kPa."""
    winding = {"pattern": pattern, "pitch": "3 mm", "fiber": "kevlar"} | changes.pop("winding", {})
    mesh = {"section": 1, "axial": "1.5 mm"} | changes.pop("mesh", {})
    effects = [{"pressure": {"to": "30 kPa"}}, {"winding": winding}]
    output = {"pictures": False, "fields": False}
    return run(small(model="cell", effects=effects, mesh=mesh, output=output) | changes)


def test_a_pitch_with_tied_ends_equals_half_of_it_between_mirror_planes() -> None:
    # two different meshes, constraints and matrices for one actuator
    half, full = cell(), cell(mesh={"symmetry": "full"})
    assert full.run["unknowns"] > 3 * half.run["unknowns"]
    for column in COLUMNS:
        assert full.last(column) == pytest.approx(half.last(column), rel=1e-9)
    assert full.last("unstable_modes") == half.last("unstable_modes") == 0


def test_a_single_helix_twists_with_its_hand_and_a_double_one_does_not() -> None:
    right, left = cell("single-helix-right"), cell("single-helix-left")
    assert right.last("angle_deg") == pytest.approx(left.last("angle_deg"), rel=1e-9)
    assert right.last("twist_deg") == pytest.approx(-left.last("twist_deg"), rel=1e-9)
    # a right-handed thread that cannot stretch opens against its own hand: the tip turns back
    assert right.last("twist_deg") < -1
    assert "twist_deg" not in cell().rows[-1]


def test_a_smeared_winding_makes_a_cell_a_section() -> None:
    # one potential on two meshes of different dimension: nothing is left to differ but round-off
    smeared = {"as": "smeared"}
    slab = cell(winding=smeared)
    plane = cell(winding=smeared, model="section")
    for column in COLUMNS:
        assert slab.last(column) == pytest.approx(plane.last(column), rel=1e-8)


def test_under_twist_too_with_its_tip() -> None:
    # a whole pitch between tied ends, beside half a section that half a turn about y completes
    slab, plane = (
        cell("single-helix-left", winding={"as": "smeared"}, model=model)
        for model in ("cell", "section")
    )
    assert plane.last("twist_deg") > 1
    for column in (*COLUMNS, "twist_deg", "floor_stretch", "tip_x_mm", "tip_y_mm"):
        assert slab.last(column) == pytest.approx(plane.last(column), rel=1e-7), column
    assert slab.last("side_angle_deg") == pytest.approx(0, abs=1e-6)
