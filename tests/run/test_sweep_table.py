"""The table of a sweep: what its runs say, on lines between steps, with signs of trends."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
import yaml

from fem.libraries import Builder
from fiberbend import run
from fiberbend.sweep.command import run_sweep
from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.points import Point, read_sweep
from fiberbend.sweep.store import Store
from fiberbend.sweep.table import where
from fiberbend.sweep.trends import groups, sign
from tests.run.test_sweep import SWEEP


def test_the_table_says_what_the_run_says(tmp_path: Path) -> None:
    """With the real solver: pressures, stretch and blocked force of the baseline's section.

    94 N mm under 100 kPa kept straight: an independent section model, a cap of 15 mm its lever.
    """
    data = SWEEP | {
        "vary": {"actuator.radius": ["7 mm", "8 mm"]},
        "report": {"angles": ["10 deg", "20 deg"], "force_at": "100 kPa", "history": ["step"]},
    }
    path = tmp_path / "sweep.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    reported: list[str] = []
    assert run_sweep(path, tmp_path / "out", say=reported.append) == 0, reported
    with (tmp_path / "out" / "sweep.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["radius_mm"] for row in rows] == ["7", "8"]
    direct = run(read_sweep(path).points[1].case)
    at = {round(row["angle_deg"], 6): row for row in direct.rows}
    for angle in (10, 20):
        pressure = float(rows[1][f"pressure_{angle}deg_kPa"])
        assert pressure == pytest.approx(at[angle]["pressure_kPa"], rel=1e-8)
    stretch = float(rows[1]["greatest_stretch"])
    assert stretch == pytest.approx(at[20]["crown_stretch"], rel=1e-8)
    assert float(rows[1]["blocked_force_N"]) * 15 == pytest.approx(94.0, rel=0.01)
    assert float(rows[1]["blocked_moment_Nmm"]) == pytest.approx(94.0, rel=0.01)
    # eq. (21): κ(8, 2) = 542.395 mm³ times 0.1 MPa over the cap of 15 mm
    assert float(rows[1]["paper_force_N"]) == pytest.approx(54.2395 / 15, rel=1e-5)
    pictures = {p.name for p in (tmp_path / "out" / "maps").iterdir()}
    assert pictures == {
        "pressure_10deg.png", "pressure_20deg.png", "stretch.png", "blocked_force.png"
    }  # fmt: skip


def test_no_form_is_compiled_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Other dimensions, the same kernels: all numbers are data."""
    path = tmp_path / "sweep.yaml"
    path.write_text(yaml.safe_dump(SWEEP), encoding="utf-8")
    points, store = read_sweep(path).points, Store.open(tmp_path / "out")

    def solved(point: Point) -> bool:
        with store.claim(point) as claim:
            assert claim is not None
            run = store.solve(claim)
        return run is not None and run["status"] == "converged"

    assert solved(points[0])
    compiled: list[str] = []
    # not the files: a test beside this one may compile at the same time
    monkeypatch.setattr(Builder, "compile", lambda *_, **given: compiled.append(str(given)))
    assert solved(points[-1])
    assert compiled == []


def test_a_value_between_steps_is_on_a_line() -> None:
    rows: list[dict[str, float | None]] = [
        {"x": 0.0, "y": 1.0},
        {"x": 10.0, "y": 3.0},
        {"x": 20.0, "y": None},
    ]
    assert where(rows, "x", 10.0, "y") == 3.0
    assert where(rows, "x", 2.5, "y") == 1.5
    assert where(rows, "x", 15.0, "y") is None
    assert where([], "x", 15.0, "y") is None


def test_signs_of_trends() -> None:
    """Groups hold the other fields; a failed point has no value."""
    a = VariedField("a", "a", "mm", (1.0, 2.0, 3.0) * 2)
    b = VariedField("b", "b", "", (1.0,) * 3 + (2.0,) * 3)
    values = [1.0, 2.0, 4.0, 3.0, None, 1.5]
    bowl = [3.0, 1.0, 2.0] * 2
    rows = [
        {"a_mm": x, "b": y, "v": v, "w": 1.0, "u": u}
        for x, y, v, u in zip(a.values, b.values, values, bowl, strict=True)
    ]
    found = groups((a, b), rows, a)
    assert [group.shared for group in found] == ["b 1", "b 2"]
    assert sign(found, "v") == "↑ 1, ↓ 1 (−50.0 % … +300.0 %)"
    assert sign(found, "w") == "— (+0.0 %)"
    assert sign(found, "u").startswith("∪ (")
    assert sign(found, "none") == ""
