"""What a sweep says first: rows beside what was asked for, and a table in brief."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from fiberbend.models.closed_form import analytic_curves
from fiberbend.sweep.points import Sweep
from fiberbend.sweep.quantities import FORCE_MODEL, quantities
from fiberbend.sweep.store import Store
from fiberbend.sweep.table import aligned, collect, in_brief
from fiberbend.sweep.trends import as_markdown
from tests.cases.test_sweep_ask import ROOT, Read, grid, row_of
from tests.cases.test_sweep_ask import file as file
from tests.cases.test_sweep_ask import read as read


def test_the_line_of_the_paper_is_there_on_request(read: Read) -> None:
    """Its μ̄ is that of another rubber, whatever the case has."""
    report = {"angles": ["45 deg"], "pressures": ["30 kPa"]}
    assert "paper_pressure_45deg_kPa" not in row_of(read(grid(report=report)), "paper_")
    asked = row_of(read(grid(report=report), "compare=[paper]"), "paper_")
    assert {"paper_pressure_45deg_kPa", "paper_angle_30kPa_deg"} <= asked.keys()


def test_angles_of_closed_forms_belong_to_their_pressures(read: Read) -> None:
    sweep = read(grid(report={"pressures": ["30 kPa"]}))
    angle = math.radians(row_of(sweep, "zero_fit_angle")["zero_fit_angle_30kPa_deg"])
    own = analytic_curves(sweep.points[0].case)["zero-fit"]
    assert float(own.pressure(angle)) == pytest.approx(0.03, rel=1e-9)


def test_a_body_that_is_kept_straight_has_no_free_angles_beside_it(read: Read) -> None:
    tip = str(ROOT / "cases" / "blocked_tip.yaml")
    data = {"case": tip, "vary": {"actuator.wall": ["2 mm"]}, "report": {"pressures": ["50 kPa"]}}
    assert row_of(read(data), "zero_fit") == {}


def rows_of(sweep: Sweep, **values: float) -> list[dict[str, Any]]:
    """Rows of a sweep as though it had run."""
    rows = collect(sweep, Store(Path("nowhere")))
    return [
        row
        | {"status": "converged", "solved_by": "section"}
        | {k: v + n for k, v in values.items()}
        for n, row in enumerate(rows)
    ]


def test_what_was_asked_for_comes_first(read: Read) -> None:
    report = {"angles": ["45 deg"], "pressures": ["30 kPa"], "force_at": "10 kPa"}
    sweep = read(grid(report=report | {"history": ["chamber_mm3"]}))
    values = {"pressure_45deg_kPa": 1.0, "angle_30kPa_deg": 2.0, "blocked_force_N": 3.0}
    rows = rows_of(sweep, **values, chamber_mm3=4.0, greatest_stretch=1.0)
    for row in rows:
        row[FORCE_MODEL] = "section kept straight, no caps"
    found = quantities(sweep.report, rows)
    assert [quantity.label for quantity in found] == [
        "pressure at 45°",
        "angle at 30 kPa",
        "blocked force at 10 kPa",
        "chamber at the end",
        "greatest axial stretch λ at 45°",
    ]
    force = found[2]
    assert list(force.lines) == [
        "section kept straight, no caps",
        "closed form, eq. (20)",
        "closed form, pressure acting up to the winding",
    ]
    assert "about twice that of a body" in force.remark
    text = as_markdown("Six", sweep.columns, rows, found, ["a note"])
    assert text.index("## Pressure at 45°") < text.index("## Angle at") < text.index("## Greatest")
    assert (
        "section model: 1 kPa (radius 6 mm, wall 1 mm) to 6 kPa (radius 8 mm, wall 3 mm)." in text
    )
    assert "- wall 1 to 3 mm: rises in both groups; from first to last +50.0 % to +200.0 %." in text
    assert text.endswith("- a note\n")


def test_a_group_without_an_end_has_no_change(read: Read) -> None:
    """From 1 to 2 mm is not from 1 to 3 mm."""
    sweep = read(grid(report={"angles": ["45 deg"]}))
    rows = rows_of(sweep, pressure_45deg_kPa=1.0)
    rows[2]["pressure_45deg_kPa"] = None
    found = quantities(sweep.report, rows)
    text = as_markdown("", sweep.columns, rows, found)
    assert (
        "- wall 1 to 3 mm: rises in both groups; from first to last +50.0 % (1 of 2 groups "
        "without one of the two)." in text
    )
    assert "| wall 1, 2, 3 mm | 2 | ↑ (+50.0 %) |" in text


def test_a_vacuum_that_grows_is_a_pressure_that_falls(read: Read) -> None:
    sweep = read(grid(report={"angles": ["45 deg"]}))
    rows = rows_of(sweep)
    for row in rows:
        row["pressure_45deg_kPa"] = -10.0 * row["wall_mm"]
    text = as_markdown("", sweep.columns, rows, quantities(sweep.report, rows))
    assert "- wall 1 to 3 mm: falls in both groups; from first to last −200.0 %." in text


def test_the_end_of_a_point_that_failed_is_no_answer(read: Read) -> None:
    """It is somewhere else than that of the others, however great the value is there."""
    sweep = read(grid(report={"history": ["chamber_mm3"], "angles": ["45 deg"]}))
    rows = rows_of(sweep, pressure_45deg_kPa=1.0, chamber_mm3=100.0)
    rows[2] |= {"status": "failed", "chamber_mm3": 9e9, "pressure_45deg_kPa": 3.0}
    found = {quantity.label: quantity for quantity in quantities(sweep.report, rows)}
    end, at = found["chamber at the end"], found["pressure at 45°"]
    assert end.value(rows[2]) is None
    assert at.value(rows[2]) == 3.0, "a state that it has reached counts"
    text = as_markdown("", sweep.columns, rows, list(found.values()))
    assert "9e+09" not in text
    assert not any("9e+09" in line for line in in_brief(sweep.columns, rows, [end]))


def test_without_a_question_the_ends_lead(read: Read) -> None:
    sweep = read(grid())
    rows = rows_of(sweep, end_angle_deg=90.0, greatest_stretch=1.0)
    for row in rows:
        row["end_pressure_kPa"] = 60.0
    assert [quantity.label for quantity in quantities(sweep.report, rows)] == [
        "angle at the end",
        "greatest axial stretch λ at the end",
    ]


def test_few_points_are_a_table_and_many_their_ends(read: Read) -> None:
    sweep = read(grid(report={"angles": ["45 deg"]}))
    rows = rows_of(sweep, pressure_45deg_kPa=1.25)
    rows[1] |= {"status": "failed", "pressure_45deg_kPa": None}
    shown = in_brief(sweep.columns, rows, quantities(sweep.report, rows))
    assert [line.split() for line in shown[:4]] == [
        ["radius,", "mm", "wall,", "mm", "pressure"],
        ["at", "45°,", "kPa"],
        ["6", "1", "1.25"],
        ["6", "2", "–", "failed"],
    ]
    # the points need not fill a grid for this
    many = [row | {"radius_mm": float(n)} for n, row in enumerate(rows * 4)]
    assert in_brief(sweep.columns, many, quantities(sweep.report, many)) == [
        "pressure at 45°, section model: 1.25 kPa (radius 0 mm, wall 1 mm) to 6.25 kPa "
        "(radius 5 mm, wall 3 mm)"
    ]


def test_aligned_columns_stand_under_each_other() -> None:
    assert aligned([["a", "bc", "d"], ["efg", "", "h"]]) == ["a    bc  d", "efg      h"]


def test_a_closed_form_never_stands_for_a_run(read: Read) -> None:
    """Where every point failed, the table has no value, though the closed forms have some."""
    sweep = read(grid(report={"angles": ["45 deg"]}))
    rows = [row | {"status": "failed", "solved_by": "section"} for row in rows_of(sweep)]
    found = quantities(sweep.report, rows)
    assert list(found[0].lines) == ["closed form, eq. (19), own rubber"]
    shown = in_brief(sweep.columns, rows, found)
    assert shown[2].split() == ["6", "1", "–", "failed"]
    assert "section model: no point has a value." in as_markdown("", sweep.columns, rows, found)
