"""Obstacles in a case of model rod."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.choice import MODELS
from fiberbend.outline.sheath import layer_factor, under_strip
from fiberbend.outline.skins import skin
from fiberbend.running.runner import run_case
from fiberbend.slender.actuator import slender
from geometry.sections.size import Strips
from rod.law import Law
from tests.slender.layer import factor
from tests.slender.rods import BASE, RUBBER, STIFFNESS, case, linear
from tests.slender.rods import by_law as by_law

Put = Callable[[Law], None]
PRESSED = {"pressure": {"to": "20 kPa"}}
BEND = float(STIFFNESS[1, 1]) * 1.6 / 100 / 0.02
"""Thrust by which 20 kPa bend 100 mm by 1.6 rad."""
TABLE = {"contact": {"plane": {"point": ["0 mm", "-20 mm", "0 mm"], "normal": [0, 1, 0]}}}
BAR = {"contact": {"cylinder": {"center": ["-30 mm", "70 mm"], "radius": "12 mm"}}}
BLOCKED = {"contact": {"roof": {"width": "4 mm"}, "post": {"length": "2 mm"}}}
STRIPS = {"blocked-tip": {"roof_width": "4 mm", "post_length": "2 mm"}}


def rows_of(given: Case) -> list[dict[str, Any]]:
    result = run_case(given, None)
    assert result.status == "converged", result.reason
    return result.rows


def corner(curvature: float, height: float) -> float:
    """y of the lower edge of the tip's face of a rod that bends freely, mm."""
    angle = 100 * curvature
    arc = -(1 - math.cos(angle)) / curvature
    return height + arc - 10 * math.sin(angle) - height * math.cos(angle)


def test_a_table_is_touched_where_the_free_bend_meets_it(by_law: Put) -> None:
    by_law(linear((0.0, BEND)))
    given = case(PRESSED, TABLE)
    height = float(slender(given).site.layout.place[1])
    touch = brentq(lambda p: corner(0.016 * p / 20, height) + 20, 1.0, 20.0)
    rows = rows_of(given)
    areas = [row[col.contact("plane", "area_mm2")] for row in rows]
    first = next(number for number, area in enumerate(areas) if area)
    # to a thousandth of the step, which is shorter than the whole load
    assert rows[first][col.PRESSURE] == pytest.approx(touch, abs=0.02)
    assert rows[first][col.PRESSURE] > touch
    for row in rows[:first]:
        gap = corner(0.016 * row[col.PRESSURE] / 20 or 1e-12, height) + 20
        assert row[col.contact("plane", "gap_mm")] == pytest.approx(gap, abs=1e-6)
        assert row[col.contact("plane", "y_N")] == 0.0
    last = rows[-1]
    assert last[col.contact("plane", "z_N")] == 0.0
    assert last[col.contact("plane", "y_N")] > 0.01
    assert -0.01 < last[col.contact("plane", "gap_mm")] < 0
    assert last[col.MODES] == 0
    # the force is at the edge of the tip: its moment about x is −z F
    lever = -last[col.contact("plane", "moment_x_Nmm")] / last[col.contact("plane", "y_N")]
    assert last[col.TIP_Z] - 10 < lever < last[col.TIP_Z] + 10


def test_what_is_far_away_changes_nothing(by_law: Put) -> None:
    by_law(linear((0.0, BEND)))
    far = {"contact": {"plane": {"point": ["0 mm", "-1 m", "0 mm"], "normal": [0, 1, 0]}}}
    alone, beside = rows_of(case(PRESSED)), rows_of(case(PRESSED, far))
    assert [row[col.ANGLE] for row in alone] == [row[col.ANGLE] for row in beside]
    assert [row[col.TIP_Y] for row in alone] == [row[col.TIP_Y] for row in beside]


def test_work_and_energy_agree_around_a_bar(by_law: Put) -> None:
    """The penalty's energy is stored; what the pressure does is the law's."""
    by_law(linear((0.0, BEND)))
    rows = rows_of(case(PRESSED, BAR))
    last = rows[-1]
    assert (
        math.hypot(last[col.contact("cylinder", "y_N")], last[col.contact("cylinder", "z_N")])
        > 0.02
    )
    assert last[col.WORK] == pytest.approx(last[col.STORED], rel=2e-3)


@pytest.mark.parametrize("held", [BLOCKED, STRIPS])
def test_a_blocked_tip_balances(held: dict[str, Any], by_law: Put) -> None:
    """Forces of roof and post, and those of the clamp by the strain of the first piece."""
    by_law(linear((0.0, BEND)))
    given = case(PRESSED, held)
    last = rows_of(given)[-1]
    tip, roof = last[col.TIP_FORCE], last[col.ROOF_FORCE]
    # the moment of the straight section, over the lever from the end of the roof to the post
    whole = BEND * 0.02
    assert 0.3 * whole / 9 < tip < 1.1 * whole / 9
    assert roof > tip
    assert 0 < last[col.ANGLE] < 8
    with_sheath = case(
        PRESSED,
        held,
        actuator=BASE["actuator"] | {"sheath": "1 mm"},
        materials=BASE["materials"] | {"sheath": RUBBER | {"mu": "0.02 MPa"}},
    )
    assert rows_of(with_sheath)[-1][col.TIP_FORCE] < 0.9 * tip


def test_skins_have_the_areas_of_surfaces() -> None:
    given = case(PRESSED, BLOCKED)
    actuator = convert.dimensions(given.actuator)
    site = slender_site(given)
    strips = Strips(roof_half_width=2.0, post_length=2.0)
    areas = {
        name: float(skin(site, (name,), strips).areas.sum())
        for name in ("outer", "tip", "roof", "post", "crown", "sole")
    }
    width = 2 * actuator.outer_half_width
    # half a spacing at the root belongs to the clamp
    assert areas["outer"] == pytest.approx(actuator.winding_perimeter * 119.5, rel=2e-3)
    # chords of 2 mm
    assert areas["tip"] == pytest.approx(actuator.profile.outer_area, rel=1e-2)
    assert areas["roof"] == pytest.approx(400.0, rel=1e-2)
    assert areas["crown"] == pytest.approx(400.0)
    assert areas["post"] == pytest.approx(2 * width)
    assert areas["sole"] == pytest.approx(2 * width)


def slender_site(given: Case) -> Any:
    """The site of its effects, with whatever law."""
    from fiberbend.effects.records import RodSite
    from fiberbend.slender.moments import section_of
    from rod.layout import Layout

    height = section_of(given).height
    layout = Layout(np.full(24, 5.0), place=np.array([0.0, height, -10.0]))
    return RodSite(
        convert.dimensions(given.actuator), layout, np.zeros((25, 4, 4)), (0.0, 0.0, 0.0)
    )


def test_a_sheath_yields_as_a_layer_in_plane_strain() -> None:
    given = case(
        PRESSED,
        BLOCKED,
        actuator=BASE["actuator"] | {"sheath": "2 mm"},
        materials=BASE["materials"] | {"sheath": RUBBER | {"mu": "0.05 MPa"}},
    )
    both, part = under_strip(convert.site(given), 4.0, 2, 1e9)
    # f E/h with E = 3 μ and w/h = 2
    assert both == pytest.approx(factor(2.0, 2) * 0.15 / 2, rel=1e-3)
    assert part == pytest.approx(both / 1e9)
    assert under_strip(convert.site(case(PRESSED, BLOCKED)), 4.0, 2, 50.0) == (50.0, 1.0)


@pytest.mark.parametrize("sides", [1, 2])
def test_factors_of_a_layer_are_those_of_elements(sides: int) -> None:
    for width in (0.25, 1.0, 4.0):
        assert layer_factor(width, sides) == pytest.approx(factor(width, sides), rel=1e-3)
    # between two that are known
    assert layer_factor(7.0, sides) == pytest.approx(factor(7.0, sides, 24), rel=0.01)
    # lubrication: the edges are two thicknesses further out at most
    for width in (16.0, 40.0):
        assert (width**2 / 12) < layer_factor(width, sides) < (width + 5.0) ** 2 / 12


def test_plan_says_what_yields() -> None:
    left = dict(MODELS["rod"].leaves_out(case(PRESSED, TABLE)))
    assert "sections keep their outline at rest" in left["effects.1.contact"]
    for held, name in ((BLOCKED, "contact"), (STRIPS, "blocked-tip")):
        left = dict(MODELS["rod"].leaves_out(case(PRESSED, held)))
        assert "tip force up to 11 % too great" in left[f"effects.1.{name}"]
        assert any(
            "tip force up to 11 %" in told for told in MODELS["rod"].errors(case(PRESSED, held))
        )
