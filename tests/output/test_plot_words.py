"""Words of a figure: titles, examples of the help, names of axes and curves."""

from __future__ import annotations

import csv
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from fiberbend import columns as col
from fiberbend.api.plot import PAPER, Plot, select
from fiberbend.api.runs import RunData
from fiberbend.cli import app, main
from tests.output.test_curves import contact_rows


def test_examples_of_the_help_can_be_read(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", "--help"]) == 0
    _, _, examples = capsys.readouterr().out.partition("Examples:")
    text = " ".join(examples.split())
    lines = [f"plot{line}" for line in text.split("fiberbend plot")[1:]]
    assert len(lines) >= 4
    for line in lines:
        _, bound, _ = app.parse_args(shlex.split(line), exit_on_error=False, print_error=False)
        assert all(isinstance(run, Path) for run in bound.args)
        assert bound.args


def test_a_long_name_of_an_axis_is_written_smaller() -> None:
    name = "contact_" + 9 * "a_very_long_name_" + "area_mm2"
    rows = [{**row, name: row[col.PRESSURE]} for row in contact_rows()]
    figure: Any = select(RunData("run", {}, rows), y=name).draw(PAPER)
    label = figure.axes[0].yaxis.label
    box = label.get_window_extent(figure.canvas.get_renderer())
    assert 0 < box.y0 < box.y1 < figure.bbox.height
    assert label.get_fontsize() < PAPER.font_size


def test_a_blocked_force_is_named_for_what_it_is(tmp_path: Path) -> None:
    """Forces of a section and of a closed form are never points of one curve."""
    rows = [
        ("a", 1, 4.0, "section kept straight, no caps"),
        ("b", 2, 5.0, "section kept straight, no caps"),
        ("c", 3, 2.5, "body, its tip blocked"),
        ("d", 4, 3.0, "body, its tip blocked"),
    ]

    def table(rows: Sequence[tuple[Any, ...]]) -> Plot:
        with (tmp_path / "sweep.csv").open("w", newline="") as file:
            names = ("point", "wall_mm", "status", "blocked_force_N", "blocked_force_model")
            writer = csv.writer(file)
            writer.writerows([names, *((n, w, "converged", f, m) for n, w, f, m in rows)])
        (tmp_path / "points").mkdir(exist_ok=True)
        return select(tmp_path, x="wall_mm", y="blocked_force_N")

    alone = table(rows[:2])
    assert alone.draw(PAPER).axes[0].get_ylabel() == (
        "blocked force, section kept straight, no caps (N)"
    )
    both = table(rows)
    assert {curve.label: list(curve.up) for curve in both.curves} == {
        "section kept straight, no caps": [4.0, 5.0],
        "body, its tip blocked": [2.5, 3.0],
    }
    assert both.draw(PAPER).axes[0].get_ylabel() == "blocked force (N)"
