"""Closed forms and the refusals that the case reader relies on."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import pytest

from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize, Strips, check_size

BASELINE = HemicircleActuator(radius=8, length=160, wall=2, floor=2, sheath=1, cap=15)


def test_baseline_closed_forms() -> None:
    # by hand, so that a slip in one formula is not hidden by the mesh having the same slip
    assert BASELINE.winding_perimeter == pytest.approx(10 * math.pi + 24)
    assert BASELINE.chamber_volume == pytest.approx(32 * math.pi * 160)
    areas = BASELINE.region_areas()
    assert areas["wall"] == pytest.approx(18 * math.pi)
    assert areas["floor"] == pytest.approx(40)
    assert areas["sheath"] == pytest.approx(10.5 * math.pi + 4 + 22)
    assert BASELINE.outer_top - BASELINE.outer_bottom == pytest.approx(14)


def test_regions_add_up_to_the_outline() -> None:
    # catches an overlap or a gap between regions, whatever the dimensions
    actuator = HemicircleActuator(
        radius=7, length=90, wall=1.5, floor=3, sheath=0.8, cap=11, layer=0.4
    )
    outer = actuator.outer_half_width
    base = 2 * outer * (actuator.profile.bottom - actuator.outer_bottom)
    solid = (math.pi * outer**2 / 2 + base) * actuator.total_length
    total = sum(actuator.region_volumes().values()) + actuator.chamber_volume
    assert total == pytest.approx(solid)


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize("name", ["radius", "length", "wall", "floor", "sheath", "cap", "layer"])
def test_dimensions_without_meaning_are_refused(name: str, value: float) -> None:
    change: dict[str, Any] = {name: value}
    with pytest.raises(ValueError, match=name):
        dataclasses.replace(BASELINE, **change)


def test_a_wall_too_thin_for_the_mesh_is_refused_with_the_least_value() -> None:
    thin = dataclasses.replace(BASELINE, wall=0.02)
    with pytest.raises(ValueError, match=r"wall 0\.02 mm is too thin .* at least 0\.06 mm"):
        check_size(thin, MeshSize(axial=1.5))
    check_size(dataclasses.replace(BASELINE, wall=0.07), MeshSize(axial=1.5))


@pytest.mark.parametrize("strips", [Strips(9.0, 2.0), Strips(0.0, 2.0), Strips(2.0, 15.0)])
def test_strips_that_do_not_fit_are_refused(strips: Strips) -> None:
    with pytest.raises(ValueError, match="expected more than 0 and less than"):
        check_size(BASELINE, MeshSize(), strips)
