"""A user's text in pictures is text: no formula, no control character, and never a lost picture."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import fiberbend
from fiberbend import columns as col
from fiberbend.drawing.curves import draw_plots
from fiberbend.drawing.overlay import Overlay, Points
from fiberbend.drawing.page import figure, literal, own_style, save
from fiberbend.reader.yaml_file import load_yaml
from tests.conftest import ROOT

TITLES = [
    r"$\frac{broken$",
    r"cost $5 or $6",
    r"\alpha $ \$ $$ ^_{}",
    "emoji \U0001f40d and 漢字",
    "tab\tnul\0 newline\nbell\x07 end",
    "x" * 5000,
    "%s {0} <b>&amp;",
    " ",
]
ROWS = [
    {col.PRESSURE: p, col.ANGLE: 2 * p, col.TIP_Y: -p, col.TIP_Z: 100 - p, col.TIP_FORCE: p}
    for p in (0.0, 10.0, 20.0)
]


@pytest.mark.parametrize("title", TITLES)
@pytest.mark.filterwarnings("error")
def test_plots_with_any_title(title: str, tmp_path: Path) -> None:
    values = np.array([0.0, 10.0])
    overlay = Overlay(points=(Points(f"measured ({title}.csv)", values, values),))

    def write(name: str, fill: object) -> None:
        with (tmp_path / name).open("wb") as file:
            fill(file)  # type: ignore[operator]

    names = draw_plots(ROWS, write, [20.0], title, f"because {title}", overlay, overlay)
    assert len(names) == 3
    for name in names:
        assert (tmp_path / name).stat().st_size > 5000


@pytest.mark.parametrize("text", ["$x$", r"\$5", "a$b", r"$\alpha$ and \beta"])
def test_dollars_are_drawn_as_they_are(text: str) -> None:
    page = figure((300, 100))
    drawn, is_math = page.text(0.5, 0.5, literal(text))._preprocess_math(literal(text))
    assert not is_math
    assert drawn == text


def test_long_titles_keep_both_ends() -> None:
    shown = literal("a" * 300 + ": cut at x = 0,  θ = 90°")
    assert len(shown) <= 120
    assert shown.startswith("aaa")
    assert shown.endswith(": cut at x = 0, θ = 90°")


def test_a_style_of_the_working_folder_is_not_ours(tmp_path: Path) -> None:
    import matplotlib

    with matplotlib.rc_context({"text.usetex": True, "font.size": 3}):
        with own_style():
            assert not matplotlib.rcParams["text.usetex"]
            page = figure((200, 100))
            page.text(0.5, 0.5, "θ 50 % & more_")
            save(page, tmp_path / "page.png")
        assert matplotlib.rcParams["text.usetex"]


def test_a_run_with_such_a_title_has_its_pictures(tmp_path: Path) -> None:
    """Of the closed form and of the section, whose pictures in space need a graphics card."""
    for model in ("analytic", "section"):
        data = load_yaml(ROOT / "cases" / "section.yaml")
        data |= {"title": r"$\frac{broken$ \U0001f40d", "model": model}
        data["effects"][0] = {"pressure": {"angle": "20 deg"}}
        data["output"] = {"at_angles": ["-0 deg", "10 deg"][1:], "fields": False}
        out = tmp_path / model
        assert fiberbend.run(data, out).status == "converged"
        pictures = os.listdir(out / "pictures")
        assert {"pressure_angle.png", "tip_path.png"} <= {*pictures}
        assert model == "analytic" or {"section_shape.png", "section_strain.png"} <= {*pictures}


def test_what_cannot_be_drawn_costs_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from fiberbend.reader.reader import parse_case
    from fiberbend.running.progress import Progress
    from fiberbend.running.runner import run_case

    def broken(*_arguments: object, **_options: object) -> None:
        raise RuntimeError("Failed to draw\nmore")

    said: list[str] = []
    monkeypatch.setattr("fiberbend.drawing.curves.draw_plots", broken)
    monkeypatch.setattr(Progress, "message", lambda self, text: said.append(text))
    data = load_yaml(ROOT / "cases" / "section.yaml") | {"model": "analytic"}
    data["effects"][0] = {"pressure": {"angle": "20 deg"}}
    data["output"] = {"fields": False}
    result = run_case(parse_case(data), tmp_path / "out")
    assert result.status == "converged"
    assert "no pictures, drawing failed: RuntimeError: Failed to draw" in said
    assert (tmp_path / "out" / "history.csv").stat().st_size
