"""What all pictures share: figures, colours, texts and files, by matplotlib.

matplotlib is imported where it is used, and without its global state.
"""

from __future__ import annotations

import contextlib
import math
import textwrap
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from fiberbend.drawing.style import DEFAULT, DPI, NO_DATE, SAME_FILE, Style, empty
from fiberbend.states.snapshot import Target

Box = tuple[float, float, float, float]

COLORS = {
    "wall": "#9ecae1",
    "floor": "#e6842a",
    "layer": "#7a4a8c",
    "sheath": "#dcdcd4",
    "fiber": "#1a1a1a",
    "winding": "#566573",
    "fabric": "#2e7d4f",
}
"""Colour of each region, of the fibers and of fabric."""
FAMILIES = ("#1a1a1a", "#c2185b", "#6a3d9a", "#b8860b", "#8b0000", "#00606b")
"""Colours of the families of threads, in turn; they show on all regions and on strain."""

SMEARED = "winding spread over its surface"
"""Also of a calibrated one: there are no single turns to draw."""
NAMES = {
    "layer": "strain-limiting layer",
    "fiber": "fibers",
    "winding": SMEARED,
    "fabric": "strip of fabric",
}
"""Names in a legend that are not those of the regions."""
_OTHER = "#999999"
"""Colour of a region that has none."""
_SHADES = (0.45, -0.35, 0.2, -0.6)
"""How much lighter or darker a part is in the zones, from the first on, where it has its own."""
WARN = "#b01818"
"""Colour of what has to be said of a state."""
_HEADING = 17
_LONGEST = 120
"""Characters of a line of text; the end of a title, which tells pictures apart, is kept."""


def color_of(region: str) -> str:
    """Colour of a region: that of its part, in a zone lighter or darker, "floor_2"."""
    part, _, zone = region.partition("_")
    color = COLORS.get(part, _OTHER)
    if not zone.isdecimal():
        return COLORS.get(region, _OTHER)
    shade = _SHADES[(int(zone) - 1) % len(_SHADES)]
    parts = (int(color[i : i + 2], 16) for i in (1, 3, 5))
    toward = (round(v + shade * (255 - v) if shade > 0 else v * (1 + shade)) for v in parts)
    return "#" + "".join(f"{value:02x}" for value in toward)


def name_of(region: str) -> str:
    """A region in a legend: "floor, zone 2" where a zone has its own."""
    part, _, zone = region.partition("_")
    name = NAMES.get(part, part)
    return f"{name}, zone {zone}" if zone.isdecimal() else NAMES.get(region, region)


_plain: dict[str, Any] = {}
"""Settings of matplotlib that have been found to be its own; to set them again takes 0.04 s."""


@contextlib.contextmanager
def own_style() -> Iterator[None]:
    """What is drawn meanwhile looks as we want it, whatever a file matplotlibrc says."""
    import matplotlib

    now = dict(matplotlib.rcParams)
    if now == _plain:
        yield
        return
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        if dict(matplotlib.rcParams) == now:
            _plain.update(now)
        yield


@contextlib.contextmanager
def any_sign() -> Iterator[None]:
    """A sign that the font does not have is a box on the page, and no warning."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        yield


def literal(text: str) -> str:
    """A user's text for matplotlib: as it is, in one line, and no formula where it has a $."""
    text = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    if len(text) > _LONGEST:
        text = f"{text[: _LONGEST - 42]} … {text[-39:]}"
    return text.replace("$", r"\$")


def figure(size: tuple[int, int]) -> Any:
    """A matplotlib figure of a size in pixels that needs no display."""
    return empty((size[0] / DPI, size[1] / DPI), DPI)


def heading(page: Any, title: str) -> None:
    """A title at the top of a figure, in smaller letters where it is long."""
    width, height = page.get_size_inches() * page.dpi
    style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": _HEADING}
    fit(page.text(0.5, 1 - 28 / height, literal(title), **style), 0.96 * width)


def fit(text: Any, width: float) -> None:
    """Make the letters of a matplotlib text smaller where it is wider than so many pixels."""
    share = text.get_window_extent().width / width
    if share > 1:
        text.set_fontsize(text.get_fontsize() / share)


def wrap(text: str, width: float, fontsize: float) -> str:
    """A text in lines of a width in pixels."""
    return "\n".join(textwrap.wrap(text, max(12, int(width / (0.55 * fontsize * DPI / 72)))))


def colormap() -> Any:
    """Viridis without its darkest part, on which dark fibers would not show."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps["viridis"](np.linspace(0.2, 1.0, 256)))


def save(page: Any, target: Target, style: Style = DEFAULT) -> None:
    """Write a matplotlib figure to a path or to a file open for writing bytes.

    Args:
        page: the figure; its size is kept.
        target: where.
        style: has the format and the pixels per inch.
    """
    import matplotlib

    quick = {"pil_kwargs": {"compress_level": 4}} if style.format == "png" else {}
    with any_sign(), matplotlib.rc_context(SAME_FILE):
        page.savefig(
            target,
            format=style.format,
            dpi=style.dpi,
            facecolor="white",
            metadata=NO_DATE[style.format],
            **quick,
        )


def columns_of(panels: int) -> int:
    """Columns of so many panels: up to four, with as little left empty as looks well."""
    return 4 if panels == 4 else min(3, panels)


def nice_above(value: float) -> float:
    """The least of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 × 10ⁿ that is not below a value; 1e-3 at least."""
    value = max(value, 1e-3)
    power = 10.0 ** math.floor(math.log10(value))
    steps = (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10)
    return next(step * power for step in steps if step * power >= value * (1 - 1e-9))
