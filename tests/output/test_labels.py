"""Names beside curves cover neither each other nor the curves.

A plot with five curves, measured points and three marks is read only if every name stands free
beside its own curve. The curves are those of the baseline, and bundles that are harder.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fiberbend.drawing.curves import SIZE, plot_pressure_angle, plot_tip_force
from fiberbend.drawing.labels import Labels, _overlap, _within
from fiberbend.drawing.overlay import (
    MODELS,
    Line,
    Overlay,
    Points,
)
from fiberbend.drawing.page import figure
from tests.output.test_pictures import is_drawn

LABELS = ("section model", "analytic (own rubber)", "analytic (area to winding)", "analytic (μ̄)")
ANGLES = np.linspace(0, 360, 37)


class Watched(Labels):
    """Labels that a test can look at after the plot is drawn."""

    last: Watched

    def __init__(self, axes: object) -> None:
        super().__init__(axes)
        Watched.last = self


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch) -> type[Watched]:
    monkeypatch.setattr("fiberbend.drawing.curves.Labels", Watched)
    return Watched


def fan(ends: tuple[float, ...], bend: float = 1.0) -> Overlay:
    """Curves from the origin to pressures at 360°."""
    part = (ANGLES / 360) ** bend
    lines = zip(MODELS, LABELS, ends, strict=True)
    return Overlay(tuple(Line(name, label, end * part, ANGLES) for name, label, end in lines))


def rows(end: float) -> list[dict[str, float | None]]:
    """A straight curve to 360°."""
    return [{"pressure_kPa": end * a / 360, "angle_deg": a} for a in (0, 20, 51, 90, 180, 270, 360)]


@pytest.mark.parametrize(
    "ends",
    [(181.5, 204.6, 108.7, 237.8), (187.0, 187.5, 188.0, 188.5), (181.5, 800, 20, 3000)],
    ids=["baseline", "coincident", "far apart"],
)
def test_names_do_not_cover_each_other(
    ends: tuple[float, ...], watched: type[Watched], tmp_path: Path
) -> None:
    plot_pressure_angle(
        rows(187.6), tmp_path / "plot.png", [90, 180, 360], "Title", None, fan(ends), "body model"
    )
    boxes = watched.last._boxes
    for i, one in enumerate(boxes):
        for other in boxes[i + 1 :]:
            assert _overlap(one, other) == _overlap(other, one) == 0
    assert is_drawn(tmp_path / "plot.png")


def test_names_of_the_baseline_stand_clear_of_the_curves(
    watched: type[Watched], tmp_path: Path
) -> None:
    overlay = fan((181.5, 204.6, 108.7, 237.8), 0.85)
    plot_pressure_angle(rows(187.6), tmp_path / "plot.png", (), "", None, overlay, "body model")
    labels = watched.last
    assert len(labels._boxes) == 5
    for box in labels._boxes:
        assert sum(int(_within(marks, box).sum()) for marks, _ in labels._marks) == 0
        assert labels._inside(box).all()


def test_measured_points_stay_visible(watched: type[Watched], tmp_path: Path) -> None:
    measured = Points("measured (a_file_with_a_long_name_that_is_cut.csv)", 2 * ANGLES, ANGLES)
    overlay = Overlay(fan((181.5, 204.6, 108.7, 237.8)).lines, (measured,))
    plot_pressure_angle(rows(187.6), tmp_path / "plot.png", [90], "", None, overlay, "body model")
    pixels = watched.last._pixels(measured.across, measured.up)
    # far beyond the run, and yet within the axes
    assert watched.last._inside(pixels).all()
    assert len(watched.last._boxes) == 7


def test_forces_and_vacuum(watched: type[Watched], tmp_path: Path) -> None:
    kpa = np.array([0.0, 50.0, 100.0])
    lines = (Line("section", "section model", kpa, 0.067 * kpa),)
    force: list[dict[str, float | None]] = [
        {"pressure_kPa": p, "tip_force_N": 0.036 * p} for p in kpa
    ]
    plot_tip_force(force, tmp_path / "force.png", "", None, Overlay(lines), "body model")
    assert len(watched.last._boxes) == 3
    vacuum: list[dict[str, float | None]] = [{"pressure_kPa": -p, "angle_deg": -2 * p} for p in kpa]
    back = Overlay((Line("section", "section model", -1.1 * kpa, -2.0 * kpa),))
    plot_pressure_angle(vacuum, tmp_path / "vacuum.png", (), "", None, back, "body model")
    assert all(is_drawn(tmp_path / name) for name in ("force.png", "vacuum.png"))


def test_name_of_a_curve_without_length_is_left_out() -> None:
    page = figure(SIZE)
    axes = page.add_axes((0.1, 0.1, 0.8, 0.8))
    labels = Labels(axes)
    labels.along("nothing", np.array([0.5]), np.array([0.5]), "black")
    labels.along("outside", np.array([2.0, 3.0]), np.array([2.0, 3.0]), "black")
    assert len(axes.texts) == 0
