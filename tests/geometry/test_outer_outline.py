"""The line around a whole section beside its closed forms."""

from __future__ import annotations

import math

import pytest

from geometry.sections.table import make_actuator

BASE = {"length": 100.0, "wall": 2.0, "cap": 10.0}
SECTIONS = (
    {"section": "hemicircle", "radius": 8.0, "floor": 2.0, "layer": 0.5},
    {"section": "rectangle", "width": 12.0, "height": 7.0, "floor": 2.0, "layer": 0.5},
    {"section": "circle", "radius": 8.0, "floor": 1.5},
)


@pytest.mark.parametrize("sheath", [None, 1.5])
@pytest.mark.parametrize("section", SECTIONS)
def test_the_outer_outline_encloses_the_section(
    section: dict[str, float | str], sheath: float | None
) -> None:
    actuator = make_actuator({**BASE, **section, "sheath": sheath})
    points = actuator.outer_outline(0.01)
    pairs = list(zip(points, (*points[1:], points[0]), strict=True))
    cross = [a * d - b * c for (a, b), (c, d) in pairs]
    area = sum(cross) / 2
    # clockwise
    assert -area == pytest.approx(actuator.profile.outer_area, rel=1e-6)
    height = sum(c * (p[1] + q[1]) for c, (p, q) in zip(cross, pairs, strict=True)) / (6 * area)
    assert height == pytest.approx(actuator.profile.outer_centroid, rel=1e-6)
    assert max(y for _, y in points) == pytest.approx(actuator.outer_top)
    assert min(y for _, y in points) == pytest.approx(actuator.outer_bottom)
    assert max(x for x, _ in points) == pytest.approx(actuator.outer_half_width)
    assert len(set(points)) == len(points)
    assert all(math.dist(a, b) > 1e-6 for a, b in pairs)
