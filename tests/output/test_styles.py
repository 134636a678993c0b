"""Format, size and letters of pictures: what is asked for is what a file has."""

from __future__ import annotations

import dataclasses
import io
import re
import struct
import zlib
from typing import Any
from xml.etree import ElementTree

import pytest

from fiberbend import columns as col
from fiberbend.drawing.curves import draw_plots, plot_pressure_angle
from fiberbend.drawing.overlay import Curve, draw_overlay
from fiberbend.drawing.page import own_style, save
from fiberbend.drawing.space.page import Page
from fiberbend.drawing.style import Style
from fiberbend.states.obstacles import Bar

ROWS = [
    {
        col.PRESSURE: p,
        col.ANGLE: 2 * p,
        col.TWIST: p,
        col.TIP_FORCE: p,
        col.TIP_Y: -p,
        col.TIP_Z: 100 - p,
        "contact_bar_y_N": p,
        "contact_bar_z_N": p / 2,
    }
    for p in (0.0, 10.0, 20.0)
]
POINT = 25.4 / 72
"""mm of a point."""


def picture(style: Style, title: str = "A title") -> bytes:
    content = io.BytesIO()
    with own_style():
        plot_pressure_angle(ROWS, content, [20.0], title, style=style)
    return content.getvalue()


def size_of(content: bytes, kind: str) -> tuple[float, float]:
    """Width and height in mm as the file gives them."""
    if kind == "pdf":
        box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+) ?\]", content)
        assert box is not None
        return float(box[1]) * POINT, float(box[2]) * POINT
    if kind == "svg":
        root = ElementTree.fromstring(content)
        sizes = [root.attrib[name] for name in ("width", "height")]
        assert all(size.endswith("pt") for size in sizes)
        width, height = (float(size.removesuffix("pt")) * POINT for size in sizes)
        return width, height
    pixels = struct.unpack(">II", content[16:24])
    place = content.index(b"pHYs") + 4
    per_metre = struct.unpack(">II", content[place : place + 8])
    across, up = (1e3 * n / per for n, per in zip(pixels, per_metre, strict=True))
    return across, up


@pytest.mark.parametrize("height", [None, 50.0])
@pytest.mark.parametrize("kind", ["pdf", "svg", "png"])
def test_a_figure_has_the_size_that_was_asked_for(kind: Any, height: float | None) -> None:
    style = Style(kind, width=85.0, height=height, dpi=600, font_size=8)
    found = size_of(picture(style), kind)
    # of a PNG to a pixel
    exact = 0.05 if kind == "png" else 1e-4
    assert found == pytest.approx((85.0, height or 0.7 * 85.0), abs=exact)


def test_pixels_per_inch() -> None:
    widths = [
        struct.unpack(">I", picture(Style("png", width=85, dpi=dpi))[16:20])[0]
        for dpi in (100.0, 300.0)
    ]
    assert widths == [334, 1003]


def test_the_default_is_what_runs_always_had() -> None:
    assert struct.unpack(">II", picture(Style())[16:24]) == (1000, 700)


@pytest.mark.parametrize("kind", ["pdf", "svg", "png"])
def test_the_same_picture_is_the_same_file_and_has_no_date(kind: Any) -> None:
    style = Style(kind, width=85)
    first = picture(style)
    assert first == picture(style)
    assert b"CreationDate" not in first
    assert b"<dc:date>" not in first
    assert not re.search(rb"20[23]\d-\d\d-\d\d", first)


def test_text_in_a_svg_is_text_in_the_size_asked_for() -> None:
    root = ElementTree.fromstring(picture(Style("svg", width=85, font_size=8), "Ein Titel & <b>"))
    texts = {
        "".join(element.itertext()): element.attrib.get("style", "")
        for element in root.iter("{http://www.w3.org/2000/svg}text")
    }
    assert {"pressure P (kPa)", "bending angle θ (°)", "Ein Titel & <b>"} <= {*texts}
    assert "20° at 10.0 kPa" in texts
    assert "8px" in texts["pressure P (kPa)"]


def test_letters_in_a_pdf_are_whole_fonts() -> None:
    content = picture(Style("pdf", width=85))
    # FontFile2: TrueType, and not the drawings of letters of a Type 3 font
    assert b"/FontFile2" in content
    assert b"/Type3" not in content
    streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", content, re.DOTALL)
    drawn = b"".join(zlib.decompress(s) for s in streams if s[:1] == b"x")
    assert b"Tj" in drawn or b"TJ" in drawn


@pytest.mark.parametrize("kind", ["pdf", "svg"])
def test_every_plot_of_a_run_in_any_format(kind: Any) -> None:
    files: dict[str, bytes] = {}

    def write(name: str, fill: Any) -> None:
        content = io.BytesIO()
        fill(content)
        files[name] = content.getvalue()

    style = Style(kind, width=85, height=70, font_size=7)
    with own_style():
        names = draw_plots(
            ROWS, write, [20.0], "Title", obstacles={"bar": Bar((0, 50), 10)}, style=style
        )
        turned = [{**row, col.TIP_X: row[col.PRESSURE]} for row in ROWS]
        draw_plots(turned, lambda name, fill: write(f"turned {name}", fill), style=style)
    assert names == [
        f"{name}.{kind}"
        for name in ("pressure_angle", "pressure_twist", "tip_force", "contact_force", "tip_path")
    ]
    assert len(files) == 10
    for content in files.values():
        assert size_of(content, kind) == pytest.approx((85, 70), abs=1e-4)


def test_a_page_of_images_in_any_format() -> None:
    for kind in ("png", "svg", "pdf"):
        page = Page((400, 300), "Title", style=Style(kind))  # type: ignore[arg-type]
        content = io.BytesIO()
        page.save(content)
        found = size_of(content.getvalue(), kind)
        assert found == pytest.approx((4 * 25.4, 3 * 25.4), abs=0.03)


@pytest.mark.parametrize(
    "wrong",
    [{"format": "gif"}, {"width": 0.0}, {"height": -1.0}, {"dpi": float("nan")}, {"font_size": 0}],
    ids=str,
)
def test_sizes_that_are_none_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        dataclasses.replace(Style(), **wrong)


def test_a_long_legend_makes_the_page_higher_where_no_height_is_given() -> None:
    crossing = [Curve(f"curve {i}", [0, 1, 1, 0], [i, 9 - i, i, 9 - i]) for i in range(9)]
    style = Style("svg", width=85, font_size=8)
    figure: Any = draw_overlay(crossing, "x", "y", style)
    width, height = 25.4 * figure.get_size_inches()
    assert width == pytest.approx(85)
    assert height > 0.75 * 85
    axes = figure.axes[0]
    assert axes.get_window_extent().height / figure.dpi * 25.4 > 40
    renderer = figure.canvas.get_renderer()
    legend = axes.get_legend().get_window_extent(renderer)
    assert legend.y1 < axes.get_tightbbox(renderer, bbox_extra_artists=[axes.xaxis]).y0 + 1
    assert legend.y0 > 0
    with pytest.raises(ValueError, match="no room"):
        draw_overlay(crossing, "x", "y", dataclasses.replace(style, height=30.0))
    content = io.BytesIO()
    save(figure, content, style)
    assert size_of(content.getvalue(), "svg") == pytest.approx((width, height), abs=1e-4)


def test_long_names_of_a_legend_stay_apart() -> None:
    """A title and what a column is: the end says which curve it is."""
    title = "An actuator whose title is so long that no legend can have all of it"
    labels = [f"{title}, pressure P", f"{title}, analytic", f"{title}, analytic"]
    figure: Any = draw_overlay(
        [Curve(text, [0, 1], [0, 1]) for text in labels], "x", "y", Style("svg")
    )
    shown = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert len(set(shown)) == 3
    assert shown[0].endswith(", pressure P")
    assert all(text.endswith(", analytic") for text in shown[1:])
    assert all("An actuator" in text for text in shown)
    assert max(map(len, shown)) <= 65
