"""An image in space on a page, and what is written on it: scale, axes, names and forces."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fiberbend.drawing.page import Image, nice_above
from fiberbend.drawing.renderer import View
from geometry.mesh.data import Floats

STRIP = 62
"""Height in pixels of what `scale` draws."""
_ARM = 30
_AWAY = 0.16
"""Length of an axis in the picture, of 1, under which it points to the viewer or away from him."""
_INK = "#222222"
_FORCE = "#b01818"
_ARROW = 0.09
"""Length of the greatest force's arrow, as a part of the image's width."""


@dataclasses.dataclass(frozen=True)
class Panel:
    """An image that a page shows, with what is needed to write on it.

    Attributes:
        figure: the page, a matplotlib figure.
        axes: matplotlib axes of the image, in its pixels.
        image: what is shown, (height, width, 3).
        view: from where.
        size: width and height in pixels of the whole image before it was cropped.
        corner: column and row of the shown part's upper left corner in it.
    """

    figure: Any
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

    def scale(self, left: float, bottom: float) -> None:
        """The axes x, y and z as the viewer sees them, and beside them a bar of a round length.

        Args:
            left: of the drawing, pixels of the page.
            bottom: of it; it is `STRIP` high.
        """
        width, height = self.figure.get_size_inches() * self.figure.dpi
        axes = self.figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(0, width), ylim=(0, height))
        axes.set_axis_off()
        right, up, toward = self.view.axes
        ends = _ARM * np.column_stack([right, up])
        low = np.minimum(ends.min(axis=0), 0)
        origin = np.array([left + 14, bottom + 14]) - low
        for name, end, depth in zip("xyz", ends, toward, strict=True):
            _axis(axes, name, origin, end, depth > 0)
        start = left + 28 + np.ptp(np.r_[ends[:, 0], 0.0]) + 26
        per_mm = self.zoom * self.size[0] / self.view.width
        length = nice_above(70 / per_mm)
        line = bottom + 26
        bar = [start, start + length * per_mm]
        axes.plot(bar, [line, line], color="black", linewidth=3, solid_capstyle="butt")
        axes.text(
            sum(bar) / 2, line - 8, f"{length:g} mm", ha="center", va="top", fontsize=11, color=_INK
        )

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
        """An arrow that ends where a force acts on the body, and its text at the other end.

        Args:
            text: one line.
            point: where it acts, (3,), mm.
            force: (3,), N.
            greatest: the force in N whose arrow has the full length.
            fontsize: in points.
        """
        right, up, _ = self.view.axes
        flat = np.array([force @ right, -(force @ up)])
        size = float(np.linalg.norm(flat))
        head = self.at(point[None])[0]
        if size <= 1e-6 * greatest or not greatest:
            self._write(text, head, fontsize, _INK)
            return
        length = _ARROW * self.size[0] * (0.35 + 0.65 * size / greatest)
        tail = head - flat / size * length
        style = {"arrowstyle": "-|>", "color": _FORCE, "shrinkA": 0, "shrinkB": 0, "lw": 1.8}
        self.axes.annotate("", tuple(head), tuple(tail), arrowprops=style, annotation_clip=False)
        self._write(text, tail, fontsize, _FORCE)

    def _write(self, text: str, near: Floats, fontsize: float, color: str) -> None:
        """A text at the nearest place where no body is drawn, with a line to its point if far."""
        zoom = self.zoom
        wide = (0.62 * fontsize * len(text) * self.figure.dpi / 72 + 6) / zoom
        tall = (1.5 * fontsize * self.figure.dpi / 72) / zoom
        place = free_place(_body(self.image), near, (wide, tall))
        style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": fontsize}
        if np.linalg.norm(place - near) > 1.2 * max(wide / 2, tall):
            gap = np.abs(place - near) - [wide / 2, tall / 2]
            if gap.max() > 0:
                self.axes.plot(*zip(near, place, strict=True), color="0.6", linewidth=0.7, zorder=1)
                style["backgroundcolor"] = "white"
        self.axes.text(*place, text, color=color, zorder=4, **style)


def free_place(taken: NDArray[np.bool_], near: Floats, size: tuple[float, float]) -> Floats:
    """Middle of the nearest box in an image that covers nothing.

    Args:
        taken: pixels that must not be covered, (height, width).
        near: column and row, (2,).
        size: width and height of the box in pixels.

    Returns:
        Column and row of the middle; `near`, moved into the image, where no box is free.
    """
    rows, columns = taken.shape
    half = np.array(size) / 2
    low, high = half, np.array([columns, rows]) - half
    if (low > high).any():
        return near
    sums = np.zeros((rows + 1, columns + 1), dtype=np.int64)
    sums[1:, 1:] = taken.cumsum(axis=0).cumsum(axis=1)
    step = max(4.0, min(size) / 3)
    x = np.arange(low[0], high[0] + 1, step)
    y = np.arange(low[1], high[1] + 1, step)
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    corner = np.floor(places - half).astype(int).clip(0)
    end = np.ceil(places + half).astype(int).clip(None, [columns, rows])
    covered = (
        sums[end[:, 1], end[:, 0]]
        - sums[corner[:, 1], end[:, 0]]
        - sums[end[:, 1], corner[:, 0]]
        + sums[corner[:, 1], corner[:, 0]]
    )
    free = places[covered == 0]
    if not len(free):
        return np.clip(near, low, high)
    # a little more willing to go up or down than aside, as texts are wide
    distance = np.linalg.norm((free - near) / [1.0, 1.0], axis=1)
    best: Floats = free[distance.argmin()]
    return best


def write_obstacles(
    panel: Panel,
    texts: Mapping[str, str],
    places: Mapping[str, Floats],
    forces: Mapping[str, tuple[float, float, float]],
    greatest: float,
    fontsize: float = 11,
) -> None:
    """Names of obstacles and their forces on the body.

    Args:
        panel: where.
        texts: beside each obstacle.
        places: where the body touches each, or is nearest to it, mm.
        forces: of those that are known, N.
        greatest: the force in N whose arrow has the full length.
        fontsize: in points.
    """
    for name, text in texts.items():
        force = np.array(forces.get(name, (0.0, 0.0, 0.0)))
        panel.force(text, places[name], force, greatest, fontsize)


def _body(image: Image) -> NDArray[np.bool_]:
    """Pixels that show more than white or an obstacle's grey."""
    spread = np.ptp(image.astype(np.int16), axis=2)
    body: NDArray[np.bool_] = (image.min(axis=2) < 200) | (spread > 8)
    return body


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
        axes.text(origin[0] - 12, origin[1] - 6, name, **label)
        return
    style = {"arrowstyle": "-|>", "color": "black", "shrinkA": 0, "shrinkB": 0, "lw": 1.3}
    axes.annotate("", tuple(origin + end), tuple(origin), arrowprops=style)
    beyond = end * (1 + 9 / np.linalg.norm(end))
    axes.text(*(origin + beyond), name, **label)
