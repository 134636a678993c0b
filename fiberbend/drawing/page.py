"""Pages of pictures: images with a title, a colour bar, a legend and a scale, by matplotlib.

matplotlib is imported where it is used, and without its global state.
"""

from __future__ import annotations

import contextlib
import math
import warnings
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fiberbend.drawing.style import DEFAULT, DPI, NO_DATE, SAME_FILE, Style, empty
from fiberbend.states.snapshot import Target

Image = NDArray[np.uint8]
Box = tuple[float, float, float, float]

COLORS = {
    "wall": "#9ecae1",
    "floor": "#e6842a",
    "layer": "#7a4a8c",
    "sheath": "#dcdcd4",
    "fiber": "#1a1a1a",
}
"""Colour of each region and of the fibers."""

NAMES = {"layer": "strain-limiting layer", "fiber": "fibers"}
"""Names in a legend that are not those of the regions."""
_LONGEST = 120
"""Characters of a line of text; the end of a title, which tells pictures apart, is kept."""


@contextlib.contextmanager
def own_style() -> Iterator[None]:
    """What is drawn meanwhile looks as we want it, whatever a file matplotlibrc says."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
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


class Page:
    """One picture under construction.

    Args:
        size: width and height in pixels.
        title: text at the top.
        style: format and pixels per inch of the file; the size is that in pixels at 100 dpi.
    """

    def __init__(self, size: tuple[int, int], title: str, style: Style = DEFAULT) -> None:
        self._size, self._style = size, style
        self._figure = figure(size)
        heading: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 17}
        text = self._figure.text(0.5, 1 - 28 / size[1], literal(title), **heading)
        width = text.get_window_extent().width / (0.96 * size[0])
        if width > 1:  # a long one in smaller letters
            text.set_fontsize(heading["fontsize"] / width)

    @classmethod
    def of_panels(
        cls, width: int, title: str, images: Sequence[Image], captions: Sequence[str]
    ) -> Page:
        """Images of one view in up to four columns, cropped alike, each with its caption.

        Args:
            width: width of the page, pixels.
            title: text at the top.
            images: pixels of each, (height, width, 3).
            captions: text below each.
        """
        filled = np.any([_filled(image) for image in images], axis=0)
        columns = columns_of(len(images))
        rows = math.ceil(len(images) / columns)
        cropped = [_crop(image, filled) for image in images]
        across = width / columns
        tall = 0.94 * across * cropped[0].shape[0] / cropped[0].shape[1] + 46
        height = round(70 + rows * tall + 90)
        page = cls((width, height), title)
        for i, (image, caption) in enumerate(zip(cropped, captions, strict=True)):
            left = (i % columns + 0.03) / columns
            bottom = 1 - (60 + (i // columns + 1) * tall) / height
            box = (left, bottom, 0.94 / columns, (tall - 46) / height)
            page.image(image, box)
            page._figure.text(
                left + box[2] / 2, bottom + box[3] + 18 / height, caption, ha="center", fontsize=13
            )
        return page

    def image(self, image: Image, box: Box, crop: bool = False) -> None:
        """Place an image on the page.

        Args:
            image: pixels, (height, width, 3).
            box: left, bottom, width and height in fractions of the page.
            crop: leave out white margins.
        """
        axes = self._figure.add_axes(box)
        axes.imshow(_crop(image, _filled(image)) if crop else image)
        axes.set_axis_off()

    def color_bar(self, limits: tuple[float, float], label: str, colors: Any = None) -> None:
        """A colour bar below the images.

        Args:
            limits: values at its ends.
            label: what it shows.
            colors: another matplotlib colour map than `colormap`, or its name.
        """
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        height = self._size[1]
        axes = self._figure.add_axes((0.27, 62 / height, 0.46, 16 / height))
        shown = ScalarMappable(Normalize(*limits), colors or colormap())
        extend = "both" if limits[0] < 0 else "max"
        bar = self._figure.colorbar(shown, cax=axes, orientation="horizontal", extend=extend)
        bar.ax.tick_params(labelsize=12)
        bar.set_label(label, fontsize=13)

    def legend(self, names: Sequence[str]) -> None:
        """Names of the colours, below the images."""
        from matplotlib.patches import Patch

        patches = [
            Patch(
                facecolor=COLORS.get(name, "#999999"), edgecolor="0.4", label=NAMES.get(name, name)
            )
            for name in names
        ]
        self._figure.legend(
            handles=patches, loc="lower center", ncols=len(patches), frameon=False, fontsize=13
        )

    def scale_bar(self, width: float) -> None:
        """A bar of a round length and the axes z and y, at the lower left.

        Args:
            width: width in mm of what the page shows.
        """
        length = nice_above(width / 12)
        axes = self._figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(0, self._size[0]), ylim=(0, self._size[1]))
        axes.set_axis_off()
        end = 40 + length / width * self._size[0]
        axes.plot([40, end], [40, 40], color="black", linewidth=3, solid_capstyle="butt")
        axes.text((40 + end) / 2, 22, f"{length:g} mm", ha="center", va="center", fontsize=12)
        for tip, name in (((80, 70), "z"), ((40, 110), "y")):
            axes.annotate(
                "", tip, (40, 70), arrowprops={"arrowstyle": "-|>", "color": "black", "shrinkA": 0}
            )
            axes.text(
                tip[0] + 9 * (name == "z"),
                tip[1] + 9 * (name == "y"),
                name,
                ha="center",
                va="center",
                fontsize=12,
                style="italic",
            )

    def save(self, target: Target) -> None:
        """Write the page to a path or to a file open for writing bytes."""
        save(self._figure, target, self._style)


def columns_of(panels: int) -> int:
    """Columns of so many panels: up to four, with as little left empty as looks well."""
    return 4 if panels == 4 else min(3, panels)


def nice_above(value: float) -> float:
    """The least of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 × 10ⁿ that is not below a value; 1e-3 at least."""
    value = max(value, 1e-3)
    power = 10.0 ** math.floor(math.log10(value))
    steps = (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10)
    return next(step * power for step in steps if step * power >= value * (1 - 1e-9))


def _filled(image: Image) -> NDArray[np.bool_]:
    filled: NDArray[np.bool_] = (image < 250).any(axis=2)
    return filled


def _crop(image: Image, filled: NDArray[np.bool_], margin: int = 6) -> Image:
    if not filled.any():
        return image
    bounds = []
    for axis in (1, 0):
        inside = np.flatnonzero(filled.any(axis=axis))
        bounds.append(slice(max(inside[0] - margin, 0), inside[-1] + margin + 1))
    return image[bounds[0], bounds[1]]
