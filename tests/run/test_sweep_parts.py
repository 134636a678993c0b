"""A sweep in parts, and its pictures: what has no value is shown as such."""

from __future__ import annotations

import io
import json
import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.maps import limits_of, map_page
from fiberbend.sweep.plots import draw
from fiberbend.sweep.quantities import ReportedQuantity
from tests.run.test_sweep import NAMES, Lab

FAILED_FACE = (0xF6, 0xDC, 0xD7)
"""Colour behind the hatch of a failed point."""


@pytest.fixture
def lab(tmp_path: Path) -> Lab:
    return Lab(tmp_path)


@pytest.mark.long
def test_a_part_is_solved_and_the_rest_is_not_run(lab: Lab) -> None:
    """The same folder, the same table; the part is all that counts for the exit code."""
    code, out, err = lab.run("--only", "wall=2mm")
    assert (code, err) == (0, "")
    chosen = [NAMES[1], NAMES[4]]
    assert lab.starts() == Counter(chosen)
    assert "2 of 6 points, 0 finished before" in out
    assert "2 points: 2 converged" in out
    states = {row["point"]: row["status"] for row in lab.table()}
    assert states == {n: "converged" if n in chosen else "not run" for n in NAMES}
    about = json.loads((lab.out / "sweep.json").read_text(encoding="utf-8"))
    assert about["status"] == {"not run": 4, "converged": 2}
    code, out, _ = lab.run()
    assert (code, lab.starts()) == (0, Counter(NAMES))
    assert "6 points, 2 finished before" in out


def test_a_dry_run_tells_what_is_done(lab: Lab) -> None:
    lab.run("--only", "wall=2mm", **{NAMES[4]: "fail"})
    before = {path: path.stat().st_mtime_ns for path in lab.out.rglob("*")}
    code, out, err = lab.run("--dry-run")
    assert (code, err) == (0, "")
    assert {path: path.stat().st_mtime_ns for path in lab.out.rglob("*")} == before
    ends = [line.split()[3:] for line in out.splitlines()[1:7]]
    assert ends[1][:2] == ["converged", "before,"]
    assert ends[4][:2] == ["failed", "before,"]
    assert all(end[0] == "about" for n, end in enumerate(ends) if n not in (1, 4))
    assert "6 points: 2 finished before, 4 to solve" in out


def test_the_end_says_what_was_asked_and_where_it_is(lab: Lab) -> None:
    code, out, _ = lab.run(**{NAMES[0]: "fail"})
    assert code == 2
    lines = out.splitlines()
    heads = next(n for n, line in enumerate(lines) if line.startswith("radius, mm"))
    assert lines[heads].split() == ["radius,", "mm", "wall,", "mm", "pressure", "pressure"]
    assert lines[heads + 1].split() == ["at", "10°,", "kPa", "at", "20°,", "kPa"]
    p = 2.0 / 7.0
    assert lines[heads + 3].split() == ["7", "2", f"{p:.4g}", f"{2 * p:.4g}"]
    files = {"table": "sweep.csv", "trends": "trends.md", "report": "report.html"}
    assert lines[-3:] == [f"{name}: {lab.out / file}" for name, file in files.items()]


def test_warnings_with_other_figures_are_one(lab: Lab) -> None:
    """Thirty-six lines of one sentence would hide the others."""
    from fiberbend.sweep.command import _say_warnings

    runs = [{"warnings": [f"from {n}.5° on it touches itself"]} for n in (301, 288)]
    said: list[str] = []
    _say_warnings([*runs, {"warnings": ["cold"]}, {"warnings": ["cold"]}, {}], said.append)
    assert said == [
        "warning, 2 of 5 points, such as: from 301.5° on it touches itself",
        "warning, 2 of 5 points: cold",
    ]


def picture(
    xs: list[float], ys: list[float], lost: dict[tuple[float, float], str], skip: Any = None
) -> Any:
    """The pixels of the one picture of a sweep, some of whose points have no value."""
    points = [(x, y) for x in xs for y in ys if (x, y) != skip]
    columns = tuple(
        VariedField(f"actuator.{name}", name, "mm", tuple(point[n] for point in points))
        for n, name in enumerate(("radius", "wall"))
    )
    rows = []
    for x, y in points:
        status = lost.get((x, y), "converged")
        value = None if (x, y) in lost else 100 + 20 * math.sin(x) * y
        rows.append({"radius_mm": x, "wall_mm": y, "status": status, "v": value})
    quantity = ReportedQuantity("pressure", "p", "pressure", "kPa", {"section model": "v"})
    drawn: list[Any] = []

    def write(_name: str, fill: Any) -> None:
        file = io.BytesIO()
        fill(file)
        drawn.append(np.asarray(Image.open(file).convert("RGB"), dtype=int))

    assert draw("A sweep", columns, rows, [quantity], write) == {"p": ["p.png"]}
    return drawn[0]


@pytest.mark.parametrize("count", [3, 16])
def test_a_failed_point_is_hatched_and_no_contour_crosses_it(count: int) -> None:
    xs, ys = ([float(n) for n in range(1, k + 1)] for k in (count, count))
    failed = {(2.0, 2.0): "failed"}

    def faces(pixels: Any) -> int:
        return int((np.abs(pixels - FAILED_FACE).max(axis=2) < 3).sum())

    # of a cell's pixels the hatch covers less than half
    width, height = 298 / count, min(68 * count, 300) / count
    assert faces(picture(xs, ys, failed)) > 0.4 * width * height
    assert faces(picture(xs, ys, {})) == 0
    assert faces(picture(xs, ys, {(2.0, 2.0): "not run"})) == 0


def test_lines_of_a_single_map_are_beside_each_other() -> None:
    axes = [VariedField(f"actuator.{n}", n, "mm", (1.0, 2.0)) for n in ("radius", "wall")]
    rows = [
        {"radius_mm": x, "wall_mm": y, "status": "converged", "own": x + y, "form": 2 * x + y}
        for x in (1.0, 2.0)
        for y in (1.0, 2.0)
    ]

    def size(panels: dict[str, Any], lines: dict[str, str]) -> tuple[int, int]:
        quantity = ReportedQuantity("angle", "a", "angle", "°", lines)
        file = io.BytesIO()
        map_page("A sweep", axes, panels, quantity, dict.fromkeys(lines, (0.0, 6.0)), file)
        return Image.open(file).size

    one, both = {"section model": "own"}, {"section model": "own", "closed form": "form"}
    assert size({"": rows}, both)[0] > size({"": rows}, one)[0]
    assert size({"": rows}, both)[1] == size({"": rows}, one)[1]
    several = {"wall 1 mm": rows, "wall 2 mm": rows}
    assert size(several, both)[0] == size(several, one)[0]
    assert size(several, both)[1] > size(several, one)[1] + 200


def test_a_curve_has_a_gap_where_a_point_failed() -> None:
    """The blue of the only curve crosses three columns of pixels more where nothing failed."""
    xs = [1.0, 2.0, 3.0, 4.0]

    def blue(lost: dict[tuple[float, float], str]) -> int:
        pixels = picture(xs, [1.0], lost)
        return int((np.abs(pixels - (0x1F, 0x5A, 0x99)).max(axis=2) < 40).any(axis=0).sum())

    assert blue({(2.0, 1.0): "failed"}) < 0.5 * blue({})


def test_each_line_has_its_own_limits() -> None:
    rows: list[dict[str, Any]] = [
        {"v": 1.0, "u": 100.0},
        {"v": 3.0, "u": 200.0},
        {"v": None, "u": 200.0},
    ]
    assert limits_of(rows, "v") == (1.0, 3.0)
    assert limits_of(rows, "u") == (100.0, 200.0)
    low, high = limits_of([{"v": 2.0}, {"v": 2.0 + 1e-12}], "v")
    assert low < 2.0 < high
