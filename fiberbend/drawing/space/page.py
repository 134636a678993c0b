"""Pages of panels in space: images with a title, captions, a colour bar, a legend and a scale.

matplotlib is imported where it is used.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fiberbend.drawing.page import (
    WARN,
    Box,
    color_of,
    colormap,
    columns_of,
    figure,
    fit,
    heading,
    name_of,
    nice_above,
    save,
    wrap,
)
from fiberbend.drawing.renderer import Image, View
from fiberbend.drawing.space.panel import STRIP, Panel
from fiberbend.drawing.style import DEFAULT, Style
from fiberbend.states.snapshot import Target

_REMARK = 11.5
_NARROW = 1200
_IN_A_ROW = 4
"""Names in a legend beside a scale."""
_FLAT = 0.5
"""Height over width of images that stand in two columns at most."""


class Page:
    """One picture under construction.

    Args:
        size: width and height in pixels.
        title: text at the top.
        caption: of the state that it shows, below the title.
        remark: what has to be said of the state, below the caption.
        style: format and pixels per inch of the file; the size is that in pixels at 100 dpi.

    Attributes:
        panels: the images on it.
    """

    def __init__(
        self,
        size: tuple[int, int],
        title: str,
        caption: str = "",
        remark: str = "",
        style: Style = DEFAULT,
    ) -> None:
        self._size, self._style = size, style
        self.panels: list[Panel] = []
        self._figure = figure(size)
        heading(self._figure, title)
        middle: dict[str, Any] = {"ha": "center", "va": "center"}
        self._caption = self._figure.text(0.5, 1 - 58 / size[1], caption, fontsize=14, **middle)
        self._remark = self._figure.text(
            0.5, 1 - 82 / size[1], remark, fontsize=12, color=WARN, **middle
        )

    @classmethod
    def of_panels(
        cls,
        width: int,
        title: str,
        images: Sequence[Image],
        captions: Sequence[str],
        views: Sequence[View],
        remarks: Sequence[str] = (),
        margins: tuple[int, int] = (6, 6),
    ) -> Page:
        """Images of one scale in up to four columns, cropped alike, each with caption and scale.

        Args:
            width: width of the page, pixels.
            title: text at the top.
            images: pixels of each, (height, width, 3).
            captions: text above each panel.
            views: from where each is seen.
            remarks: what has to be said of each, in red below its caption.
            margins: pixels of the images to be shown above and below, and beside what is drawn.
        """
        box = _bounds(np.any([_filled(image) for image in images], axis=0), margins)
        shown = images[0][box].shape
        columns = columns_of(len(images))
        if shown[0] < _FLAT * shown[1]:
            columns = min(columns, 2)
        rows = math.ceil(len(images) / columns)
        across = width / columns
        wrapped = [wrap(remark, 0.96 * across, _REMARK) for remark in remarks]
        wrapped = wrapped or [""] * len(images)
        lines = max(text.count("\n") + 1 for text in captions)
        noted = max(text.count("\n") + 1 if text else 0 for text in wrapped)
        head = 12 + 24 * lines + 19 * noted
        room = 0.94 * across * shown[0] / shown[1]
        tall = head + room + STRIP + 8
        height = round(56 + rows * tall + 84)
        page = cls((width, height), title)
        for i, (image, caption, remark, view) in enumerate(
            zip(images, captions, wrapped, views, strict=True)
        ):
            row, column = divmod(i, columns)
            left, top = (column + 0.03) * across, height - 56 - row * tall
            middle = (left + 0.47 * across) / width
            below: dict[str, Any] = {"ha": "center", "va": "top"}
            words = page._figure.text(middle, (top - 10) / height, caption, fontsize=13, **below)
            fit(words, 0.96 * across)
            page._figure.text(
                middle,
                (top - 12 - 24 * lines) / height,
                remark,
                fontsize=_REMARK,
                color=WARN,
                **below,
            )
            low = top - head - room
            place = (left / width, low / height, 0.94 * across / width, room / height)
            page.scale(page._place(image, place, box, view), left, low - STRIP)
        return page

    @classmethod
    def stacked(cls, width: int, title: str, parts: Sequence[tuple[Image, View, float]]) -> Page:
        """Images below each other, without their white margins, each with its own scale.

        Args:
            width: width of the page, pixels.
            title: text at the top.
            parts: pixels, view, and greatest height on the page, of each.
        """
        boxes = [_bounds(_filled(image)) for image, _, _ in parts]
        heights = []
        for (image, _, most), box in zip(parts, boxes, strict=True):
            shown = image[box].shape
            heights.append(min(most, 0.96 * width * shown[0] / shown[1]))
        height = round(56 + sum(heights) + (STRIP + 10) * len(parts) + 40)
        page, top = cls((width, height), title), height - 56.0
        for (image, view, _), box, tall in zip(parts, boxes, heights, strict=True):
            place = (0.02, (top - tall) / height, 0.96, tall / height)
            page.scale(page._place(image, place, box, view), bottom=top - tall - STRIP)
            top -= tall + STRIP + 10
        return page

    @functools.cached_property
    def _overlay(self) -> Any:
        """Axes over the whole page, in its pixels."""
        axes = self._figure.add_axes((0, 0, 1, 1), zorder=2)
        axes.set(xlim=(0, self._size[0]), ylim=(0, self._size[1]), autoscale_on=False)
        axes.set_axis_off()
        return axes

    def image(self, image: Image, box: Box, view: View, crop: bool = False) -> Panel:
        """Place an image on the page.

        Args:
            image: pixels, (height, width, 3).
            box: left, bottom, width and height in fractions of the page.
            view: from where it is seen.
            crop: leave out white margins.

        Returns:
            What can be written on.
        """
        whole = (slice(None), slice(None))
        return self._place(image, box, _bounds(_filled(image)) if crop else whole, view)

    def _place(self, image: Image, box: Box, shown: tuple[slice, slice], view: View) -> Panel:
        axes = self._figure.add_axes(box)
        axes.imshow(image[shown])
        axes.set_axis_off()
        # lines that are drawn on it later leave it as it is
        axes.autoscale(False)
        corner = (shown[1].start or 0, shown[0].start or 0)
        size = (image.shape[1], image.shape[0])
        self.panels.append(
            Panel(self._figure, self._overlay, axes, image[shown], view, size, corner)
        )
        return self.panels[-1]

    def renew(self, image: Image, caption: str, remark: str) -> Panel:
        """Show another state in place of the first panel's, from the same view.

        Args:
            image: pixels, as large as those it replaces.
            caption: of the state.
            remark: what has to be said of it.

        Returns:
            What can be written on; what was written is gone.
        """
        axes = self.panels[0].axes
        for written in (*axes.texts, *axes.lines):
            written.remove()
        axes.images[0].set_data(image)
        self._caption.set_text(caption)
        self._remark.set_text(remark)
        self.panels[0] = dataclasses.replace(self.panels[0], image=image)
        return self.panels[0]

    def scale(self, panel: Panel, left: float = 24, bottom: float = 24) -> None:
        """A bar of a round length and the axes of a panel, at a place of the page in pixels."""
        panel.scale(left, bottom, nice_above(70 / panel.per_mm))

    def color_bar(self, limits: tuple[float, float], label: str, colors: Any = None) -> None:
        """A colour bar below the images.

        Args:
            limits: values at its ends.
            label: what it shows.
            colors: another matplotlib colour map than `colormap`, or its name.
        """
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        width, height = self._size
        # a narrow page has its scale beside the bar
        left = 0.27 if width > _NARROW else 0.36
        axes = self._figure.add_axes((left, 62 / height, 0.46, 16 / height))
        shown = ScalarMappable(Normalize(*limits), colors or colormap())
        extend = "both" if limits[0] < 0 else "max"
        bar = self._figure.colorbar(shown, cax=axes, orientation="horizontal", extend=extend)
        bar.ax.tick_params(labelsize=12)
        bar.set_label(label, fontsize=13)

    def legend(
        self,
        names: Sequence[str],
        more: Mapping[str, str] | None = None,
        colors: Mapping[str, str] | None = None,
    ) -> None:
        """Names of the colours, below the images.

        Args:
            names: regions, "fiber" or "winding".
            more: what is added to a name.
            colors: of names that have none of their own.
        """
        from matplotlib.patches import Patch

        labels = {name: f"{name_of(name)} {(more or {}).get(name, '')}" for name in names}
        own = colors or {}
        patches = [
            Patch(facecolor=own.get(name) or color_of(name), edgecolor="0.4", label=label.strip())
            for name, label in labels.items()
        ]
        # beside the scale there is room for so many in a row
        columns = len(patches) if len(patches) <= _IN_A_ROW else math.ceil(len(patches) / 2)
        self._figure.legend(
            handles=patches, loc="lower center", ncols=columns, frameon=False, fontsize=13
        )

    def pixels(self) -> Image:
        """The page as pixels, (height, width, 3)."""
        canvas = self._figure.canvas
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()

    def save(self, target: Target) -> None:
        """Write the page as PNG to a path or to a file open for writing bytes."""
        save(self._figure, target, self._style)


def _filled(image: Image) -> NDArray[np.bool_]:
    filled: NDArray[np.bool_] = (image < 250).any(axis=2)
    return filled


def _bounds(filled: NDArray[np.bool_], margins: tuple[int, int] = (6, 6)) -> tuple[slice, slice]:
    """Rows and columns of an image outside which it is white, with margins."""
    if not filled.any():
        return slice(None), slice(None)
    rows, columns = (np.flatnonzero(filled.any(axis=axis)) for axis in (1, 0))
    first, second = (
        slice(max(int(inside[0]) - margin, 0), int(inside[-1]) + margin + 1)
        for inside, margin in zip((rows, columns), margins, strict=True)
    )
    return first, second
