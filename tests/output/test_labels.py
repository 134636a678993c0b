"""Names of curves and texts of points cover neither each other nor the curves.

A plot with five curves, measured points and three marks is read only if every curve is told from
the others and nothing hides it. The curves are those of the baseline, and bundles that are harder.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend.drawing.curves import plot_pressure_angle, plot_tip_force
from fiberbend.drawing.overlay import MODELS, Line, Overlay, Points
from tests.output.test_pictures import is_drawn

LABELS = ("section model", "analytic (own rubber)", "analytic (area to winding)", "analytic (μ̄)")
SHOWN = (*LABELS[:3], r"analytic ($\bar{\mu}$)")
ANGLES = np.linspace(0, 360, 37)
ENDS = {
    "baseline": (181.5, 204.6, 108.7, 237.8),
    "coincident": (187.0, 187.5, 188.0, 188.5),
    "far apart": (181.5, 800.0, 20.0, 3000.0),
}


def fan(ends: tuple[float, ...], bend: float = 1.0) -> Overlay:
    """Curves from the origin to pressures at 360°."""
    part = (ANGLES / 360) ** bend
    lines = zip(MODELS, LABELS, ends, strict=True)
    return Overlay(tuple(Line(name, label, end * part, ANGLES) for name, label, end in lines))


def rows(end: float) -> list[dict[str, float | None]]:
    """A straight curve to 360°."""
    return [{"pressure_kPa": end * a / 360, "angle_deg": a} for a in (0, 20, 51, 90, 180, 270, 360)]


def box(artist: Any) -> Any:
    """Where a text or a legend stands, pixels."""
    return artist.get_window_extent(artist.figure.canvas.get_renderer())


def names(axes: Any) -> list[str]:
    return [text.get_text() for text in axes.get_legend().get_texts()]


def hidden(axes: Any) -> dict[str, int]:
    """How many points of each curve, a pixel apart, the legend covers."""
    frame, found = box(axes.get_legend()), {}
    for line in axes.lines:
        way = axes.transData.transform(line.get_xydata())
        passed = np.r_[0.0, np.cumsum(np.hypot(*np.diff(way, axis=0).T))]
        fine = np.arange(0.0, passed[-1] + 1.0)
        points = np.column_stack([np.interp(fine, passed, way[:, i]) for i in (0, 1)])
        seen = [axes.bbox.contains(*point) and frame.contains(*point) for point in points]
        if any(seen):
            found[line.get_label()] = sum(seen)
    return found


@pytest.mark.parametrize("ends", ENDS.values(), ids=ENDS.keys())
@pytest.mark.parametrize("bend", [1.0, 0.85])
def test_every_curve_is_named_by_its_line_and_none_is_hidden(
    ends: tuple[float, ...], bend: float, drawn: list[Any], tmp_path: Path
) -> None:
    plot_pressure_angle(
        rows(187.6), tmp_path / "plot.png", [], "Title", None, fan(ends, bend), "body model"
    )
    (axes,) = drawn
    assert names(axes) == ["body model", *SHOWN]
    styles = [(line.get_color(), line.get_linestyle()) for line in axes.lines]
    keys = axes.get_legend().get_lines()
    assert [(key.get_color(), key.get_linestyle()) for key in keys] == styles
    assert len(set(styles)) == len(styles)
    assert hidden(axes) == {}
    assert is_drawn(tmp_path / "plot.png")


@pytest.mark.parametrize("ends", ENDS.values(), ids=ENDS.keys())
@pytest.mark.parametrize("angles", [(90, 180, 360), (20, 360)])
def test_texts_of_points_cover_no_other_and_no_legend(
    ends: tuple[float, ...], angles: tuple[float, ...], drawn: list[Any], tmp_path: Path
) -> None:
    plot_pressure_angle(
        rows(187.6), tmp_path / "plot.png", angles, "Title", None, fan(ends), "body model"
    )
    (axes,) = drawn
    boxes = [box(text) for text in axes.texts] + [box(axes.get_legend())]
    assert len(boxes) == len(angles) + 1
    for index, one in enumerate(boxes):
        assert axes.bbox.x0 <= one.x0
        assert one.x1 <= axes.figure.bbox.x1
        assert not any(one.overlaps(other) for other in boxes[index + 1 :])
    run = axes.transData.transform(axes.lines[0].get_xydata())
    for one in boxes[:-1]:
        assert not any(one.contains(*point) for point in run)


def test_measured_points_stay_visible(drawn: list[Any], tmp_path: Path) -> None:
    measured = Points("measured (a_file_with_a_long_name_that_is_cut.csv)", 2 * ANGLES, ANGLES)
    overlay = Overlay(fan(ENDS["baseline"]).lines, (measured,))
    plot_pressure_angle(rows(187.6), tmp_path / "plot.png", [90], "", None, overlay, "body model")
    (axes,) = drawn
    # far beyond the run, and yet within the axes
    pixels = axes.transData.transform(np.column_stack([measured.across, measured.up]))
    assert all(axes.bbox.contains(*point) for point in pixels)
    assert names(axes)[-1] == "measured (a_file_with_a_long_name_that_i…"
    assert hidden(axes) == {}


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["pressure", "vacuum"])
def test_forces_and_vacuum(sign: float, drawn: list[Any], tmp_path: Path) -> None:
    kpa = sign * np.array([0.0, 50.0, 100.0])
    plots: dict[str, tuple[Callable[..., None], float]] = {
        "tip_force_N": (plot_tip_force, 0.036),
        "angle_deg": (plot_pressure_angle, 2.0),
    }
    for column, (plot, slope) in plots.items():
        data: list[dict[str, float | None]] = [{"pressure_kPa": p, column: slope * p} for p in kpa]
        beside = Overlay((Line("section", "section model", kpa, 1.1 * slope * kpa),))
        path = tmp_path / f"{column}.png"
        plot(data, path, title="", reason=None, overlay=beside, name="body model")
        assert names(drawn[-1]) == ["body model", "section model"]
        assert hidden(drawn[-1]) == {}
        assert is_drawn(path)


def test_one_curve_alone_has_no_legend(drawn: list[Any], tmp_path: Path) -> None:
    plot_pressure_angle(rows(187.6), tmp_path / "plot.png", name="body model")
    assert drawn[0].get_legend() is None
