"""An image in space on a page, and what is written on it: scale, axes, names and forces."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fiberbend.drawing.renderer import Image, View
from geometry.mesh.data import Floats, Ints

STRIP = 62
"""Height in pixels of what `scale` draws."""
_ARM = 30
_AWAY = 0.16
"""Length of an axis in the picture, of 1, under which it points to the viewer or away from him."""
_INK = "#222222"
_FORCE = "#b01818"
_TRIED = 4000
_INSIDE = 0.97
"""Part of a text's box that is grey where the text is within an obstacle."""
_ARROW = 0.06
"""Length of the greatest force's arrow, as a part of the image's width."""


@dataclasses.dataclass(frozen=True)
class Panel:
    """An image that a page shows, with what is needed to write on it.

    Attributes:
        figure: the page, a matplotlib figure.
        overlay: matplotlib axes over the whole page, in its pixels.
        axes: matplotlib axes of the image, in its pixels.
        image: what is shown, (height, width, 3).
        view: from where.
        size: width and height in pixels of the whole image before it was cropped.
        corner: column and row of the shown part's upper left corner in it.
    """

    figure: Any
    overlay: Any
    axes: Any
    image: Image
    view: View
    size: tuple[int, int]
    corner: tuple[int, int]

    def at(self, points: Floats) -> Floats:
        """Where points in mm are in the axes, (n, 2)."""
        places: Floats = self.view.at(points, self.size) - self.corner
        return places

    @property
    def zoom(self) -> float:
        """Pixels of the page per pixel of the image."""
        box = self.axes.get_position()
        width, height = self.figure.get_size_inches() * self.figure.dpi
        shown = self.image.shape
        return float(min(box.width * width / shown[1], box.height * height / shown[0]))

    @property
    def per_mm(self) -> float:
        """Pixels of the page per mm."""
        return self.zoom * self.size[0] / self.view.width

    def scale(self, left: float, bottom: float, length: float) -> None:
        """The axes x, y and z as the viewer sees them, and beside them a bar of some length.

        Args:
            left: of the drawing, pixels of the page.
            bottom: of it; it is `STRIP` high.
            length: of the bar, mm.
        """
        axes = self.overlay
        right, up, toward = self.view.axes
        ends = _ARM * np.column_stack([right, up])
        low = np.minimum(ends.min(axis=0), 0)
        origin = np.array([left + 14, bottom + 14]) - low
        for name, end, depth in zip("xyz", ends, toward, strict=True):
            _axis(axes, name, origin, end, depth > 0)
        start = left + 28 + np.ptp(np.r_[ends[:, 0], 0.0]) + 26
        line = bottom + 26
        bar = [start, start + length * self.per_mm]
        axes.plot(bar, [line, line], color="black", linewidth=3, solid_capstyle="butt")
        axes.text(
            sum(bar) / 2, line - 8, f"{length:g} mm", ha="center", va="top", fontsize=11, color=_INK
        )

    def length(self, text: str, ends: Floats, body: Floats, fontsize: float = 11) -> None:
        """A dimension: a line with two arrow heads, and a text on the side away from the body.

        Args:
            text: one line.
            ends: (2, 3), mm.
            body: middle of the body, (3,), mm.
            fontsize: in points.
        """
        from matplotlib.patheffects import withStroke

        start, end = self.at(ends)
        arrow = {"arrowstyle": "<|-|>", "color": "0.3", "shrinkA": 0, "shrinkB": 0, "lw": 0.9}
        self.axes.annotate("", tuple(start), tuple(end), arrowprops=arrow, annotation_clip=False)
        middle, along = (start + end) / 2, end - start
        across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
        across *= np.sign(across @ (middle - self.at(body[None])[0])) or 1.0
        room = np.abs(across) @ (np.array(self._extent(text, fontsize)) / 2)
        place = middle + room * across
        style = {"ha": "center", "va": "center", "fontsize": fontsize, "color": _INK}
        written = self.axes.text(*place, text, **style)
        # over the edge of an obstacle it can still be read
        written.set_path_effects([withStroke(linewidth=3, foreground="white")])

    def name(self, text: str, point: Floats, fontsize: float = 11, color: str = _INK) -> None:
        """Write a text near a point, where it covers nothing that is drawn.

        Args:
            text: one line.
            point: (3,), mm.
            fontsize: in points.
            color: of the text.
        """
        self._write(text, self.at(point[None])[0], fontsize, color)

    def force(
        self,
        text: str,
        point: Floats,
        force: Floats,
        greatest: float,
        fontsize: float = 11,
    ) -> None:
        """An arrow that ends where a force acts on the body, and its text beyond the other end.

        Args:
            text: one line.
            point: where it acts, (3,), mm.
            force: (3,), N.
            greatest: the force in N whose arrow has the full length, above zero.
            fontsize: in points.
        """
        right, up, _ = self.view.axes
        flat = np.array([force @ right, -(force @ up)])
        size = float(np.linalg.norm(flat))
        along = flat / size if size else np.zeros(2)
        head = self.at(point[None])[0]
        tail = head - _ARROW * self.size[0] * (0.35 + 0.65 * size / greatest) * along
        style = {"arrowstyle": "-|>", "color": _FORCE, "shrinkA": 0, "shrinkB": 0, "lw": 1.8}
        self.axes.annotate("", tuple(head), tuple(tail), arrowprops=style, annotation_clip=False)
        # far enough from its end for the text's own size
        room = np.abs(along) @ (np.array(self._extent(text, fontsize)) / 2 + 2)
        self._write(text, tail - room * along, fontsize, _FORCE, tail)

    def _extent(self, text: str, fontsize: float) -> tuple[float, float]:
        """Width and height of a text in pixels of the image."""
        pixel = fontsize * self.figure.dpi / 72 / self.zoom
        return (0.62 * len(text) + 0.4) * pixel, 1.4 * pixel

    def _write(
        self, text: str, near: Floats, fontsize: float, color: str, of: Floats | None = None
    ) -> None:
        """A text at the nearest place where no body is drawn, with a line to its point if far.

        Args:
            text: one line.
            near: column and row where it would be best, (2,).
            fontsize: in points.
            color: of the text.
            of: its point, (2,); `near` unless given.
        """
        wide, tall = self._extent(text, fontsize)
        place = free_place(_body(self.image), near, (wide, tall), _grey(self.image))
        apart = np.abs(place - near) - [wide / 2, tall / 2]
        if apart.max() > tall / 2:
            ends = zip(
                near if of is None else of,
                place - np.sign(place - near) * [0, tall / 2],
                strict=True,
            )
            self.axes.plot(*ends, color=color, linewidth=0.6)
        style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": fontsize}
        self.axes.text(*place, text, color=color, **style)


def free_place(
    taken: NDArray[np.bool_],
    near: Floats,
    size: tuple[float, float],
    grey: NDArray[np.bool_] | None = None,
) -> Floats:
    """Middle of the nearest box in an image that covers nothing, and is not beyond the body.

    Args:
        taken: pixels that must not be covered, (height, width).
        near: column and row, (2,).
        size: width and height of the box in pixels.
        grey: pixels that are covered all or none, if that can be, (height, width).

    Returns:
        Column and row of the middle; `near`, moved into the image, where no box is free.
    """
    rows, columns = taken.shape
    half = np.array(size) / 2
    low, high = half, np.array([columns, rows]) - half
    if (low > high).any():
        return near
    step = max(4.0, min(size) / 3)
    grid = np.meshgrid(np.arange(low[0], high[0], step), np.arange(low[1], high[1], step))
    places = np.concatenate([np.clip(near, low, high)[None], np.stack(grid, -1).reshape(-1, 2)])
    left, top = np.floor(places - half).astype(int).clip(0).T
    right, below = np.ceil(places + half).astype(int).clip(None, [columns, rows]).T

    def count(mask: NDArray[np.bool_]) -> Ints:
        """Pixels of a mask in every box."""
        sums = np.zeros((rows + 1, columns + 1), dtype=np.int64)
        sums[1:, 1:] = mask.cumsum(axis=0).cumsum(axis=1)
        found: Ints = sums[below, right] - sums[top, right] - sums[below, left] + sums[top, left]
        return found

    uncovered = count(taken) == 0
    free = places[uncovered]
    if not len(free):
        return places[0]
    if grey is not None:
        share = count(grey) / ((below - top) * (right - left))
        even = places[uncovered & ((share == 0) | (share > _INSIDE))]
        free = even if len(even) else free
    free = free[np.argsort(np.linalg.norm(free - near, axis=1), kind="stable")[:_TRIED]]
    # a line from the point to its text that crosses the body would be taken for a part of it
    share = np.linspace(0.0, 1.0, 24)[:, None, None]
    x, y = np.moveaxis((near + share * (free - near)).astype(int), -1, 0)
    on_it = taken[y.clip(0, rows - 1), x.clip(0, columns - 1)]
    crosses = (on_it[1:] & ~on_it[:-1]).any(axis=0)
    best: Floats = free[np.argmin(crosses)]
    return best


def _body(image: Image) -> NDArray[np.bool_]:
    """Pixels that show more than white, an obstacle's grey, or a line."""
    spread = image.max(axis=2) - image.min(axis=2)
    body: NDArray[np.bool_] = (image.min(axis=2) < 200) | (spread > 8)
    for joined in (np.logical_and, np.logical_or):
        # what is thinner than three pixels goes first
        middle = joined(joined(body[1:-1], body[:-2]), body[2:])
        body[1:-1, 1:-1] = joined(joined(middle[:, 1:-1], middle[:, :-2]), middle[:, 2:])
    return body


def _grey(image: Image) -> NDArray[np.bool_]:
    """Pixels that show an obstacle."""
    least, most = image.min(axis=2), image.max(axis=2)
    grey: NDArray[np.bool_] = (least >= 200) & (most < 250) & (most - least <= 8)
    return grey


def _axis(axes: Any, name: str, origin: Floats, end: Floats, is_near: bool) -> None:
    """One axis of a triad; a dot or a cross in a circle where it is along the view."""
    label: dict[str, Any] = {
        "ha": "center",
        "va": "center",
        "fontsize": 11,
        "style": "italic",
        "color": _INK,
    }
    if np.linalg.norm(end) < _AWAY * _ARM:
        axes.plot(*origin, "o", markersize=9, markerfacecolor="white", markeredgecolor="black")
        axes.plot(*origin, "o" if is_near else "x", markersize=3 if is_near else 5, color="black")
        axes.text(origin[0] - 15, origin[1] - 6, name, **label)
        return
    style = {"arrowstyle": "-|>", "color": "black", "shrinkA": 0, "shrinkB": 0, "lw": 1.3}
    axes.annotate("", tuple(origin + end), tuple(origin), arrowprops=style)
    beyond = end * (1 + 9 / np.linalg.norm(end))
    axes.text(*(origin + beyond), name, **label)
