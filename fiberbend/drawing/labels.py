"""Names written beside curves and points of a plot, where they cover nothing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from geometry.mesh.data import Floats

_GAP = 5.0
_MARGIN = 2.0
_EVERY = 3.0
_FRACTIONS = (0.82, 0.74, 0.66, 0.58, 0.5, 0.42, 0.34, 0.9, 0.26)
_AROUND = ((-1, 0.6), (1, -0.6), (-0.6, 1), (0.6, -1), (0, 1), (0, -1), (1, 0), (-1, 0))
_MARK = 6.0
_HIDDEN = 25.0
_OUTSIDE = 200.0


class Labels:
    """Labels of one plot; all in pixels, so the axes have their limits and place already.

    Args:
        axes: matplotlib axes.
    """

    def __init__(self, axes: Any) -> None:
        self._axes = axes
        self._marks: list[tuple[Floats, float]] = []
        self._boxes: list[Floats] = []

    def avoid(self, across: Floats, up: Floats, weight: float = 1.0) -> None:
        """Keep labels off a curve; the more, the greater its weight."""
        self._marks.append((_dense(self._pixels(across, up)), weight))

    def avoid_points(self, across: Floats, up: Floats) -> None:
        """Keep labels off the marks of some points."""
        x, y = np.meshgrid(*2 * [np.linspace(-_MARK, _MARK, 5)])
        mark = np.column_stack([x.ravel(), y.ravel()])
        marks = self._pixels(across, up)[:, None, :] + mark
        self._marks.append((marks.reshape(-1, 2), 1.0))

    def along(self, text: str, across: Floats, up: Floats, color: str, size: int = 11) -> None:
        """Write a name along a curve, on the side and at the place where it covers least."""
        way = _dense(self._pixels(across, up))
        way = way[self._inside(way)]
        label = self._text(text, color, size)
        width, height = self._extent(label)
        if len(way) < 2:
            label.remove()
            return
        options = list(_beside_curve(way, width, height))
        self._place(label, options, width, height)

    def beside(
        self, text: str, across: Floats, up: Floats, color: str = "black", size: int = 12
    ) -> None:
        """Write a name beside one of some points, preferably one of the first, horizontally."""
        label = self._text(text, color, size)
        width, height = self._extent(label)
        shift = np.array([width / 2 + 9, height / 2 + 7])
        centres = self._pixels(across, up)
        options = [(centre + shift * side, 0.0) for centre in centres for side in _AROUND]
        self._place(label, options, width, height)

    def _place(
        self, label: Any, options: list[tuple[Floats, float]], width: float, height: float
    ) -> None:
        costs = [
            self._cost(_box(centre, turn, width, height)) + 0.01 * rank
            for rank, (centre, turn) in enumerate(options)
        ]
        centre, turn = options[int(np.argmin(costs))]
        label.set_position(self._axes.transData.inverted().transform(centre))
        label.set_rotation(np.degrees(turn))
        self._boxes.append(_box(centre, turn, width, height))

    def _cost(self, box: Floats) -> float:
        covered = sum(weight * int(_within(marks, box).sum()) for marks, weight in self._marks)
        hidden = sum(_overlap(box, other) for other in self._boxes)
        outside = int((~self._inside(box)).sum())
        return covered + _HIDDEN * hidden + _OUTSIDE * outside

    def _inside(self, points: Floats) -> Any:
        frame = self._axes.bbox
        low, high = (frame.x0, frame.y0), (frame.x1, frame.y1)
        return np.all((points >= low) & (points <= high), axis=1)

    def _pixels(self, across: Floats, up: Floats) -> Floats:
        pixels: Floats = self._axes.transData.transform(np.column_stack([across, up]))
        return pixels

    def _text(self, text: str, color: str, size: int) -> Any:
        from matplotlib.patheffects import withStroke

        label = self._axes.text(
            0, 0, text, color=color, fontsize=size, ha="center", va="center", rotation_mode="anchor"
        )
        label.set_path_effects([withStroke(linewidth=3, foreground="white")])
        label.set_zorder(5)
        return label

    def _extent(self, label: Any) -> tuple[float, float]:
        box = label.get_window_extent(self._axes.figure.canvas.get_renderer())
        return box.width, box.height


def _beside_curve(way: Floats, width: float, height: float) -> Iterator[tuple[Floats, float]]:
    """Centres and turns of a label that follows a curve, (p, 2) pixels."""
    passed = np.r_[0.0, np.cumsum(np.hypot(*np.diff(way, axis=0).T))]
    for fraction in _FRACTIONS:
        middle = fraction * passed[-1]
        ends = np.clip([middle - width / 2, middle, middle + width / 2], 0.0, passed[-1])
        x, y = (np.interp(ends, passed, way[:, axis]) for axis in (0, 1))
        turn = float(np.arctan2(y[2] - y[0], x[2] - x[0]))
        if abs(turn) > np.pi / 2:
            turn -= np.copysign(np.pi, turn)
        normal = np.array([-np.sin(turn), np.cos(turn)])
        for side in (-1.0, 1.0):
            yield np.array([x[1], y[1]]) + side * (height / 2 + _GAP) * normal, turn


def _dense(points: Floats) -> Floats:
    """A polyline with a point every few pixels."""
    if len(points) < 2:
        return points
    passed = np.r_[0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    fine = np.linspace(0.0, passed[-1], max(2, int(passed[-1] / _EVERY)))
    return np.column_stack([np.interp(fine, passed, points[:, axis]) for axis in (0, 1)])


def _box(centre: Floats, turn: float, width: float, height: float) -> Floats:
    """Corners of a turned rectangle, anticlockwise, (4, 2)."""
    half = np.array([width / 2 + _MARGIN, height / 2 + _MARGIN])
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    cos, sin = np.cos(turn), np.sin(turn)
    return centre + corners @ np.array([[cos, sin], [-sin, cos]])


def _within(points: Floats, box: Floats) -> Any:
    """Which points lie in a turned rectangle."""
    sides = np.roll(box, -1, axis=0) - box
    to = points[:, None, :] - box
    return np.all(sides[:, 0] * to[..., 1] - sides[:, 1] * to[..., 0] >= 0, axis=1)


def _overlap(one: Floats, other: Floats) -> float:
    """Part of a rectangle that another one covers, coarsely."""
    s, t = np.meshgrid(np.linspace(0, 1, 13), np.linspace(0, 1, 5))
    points = one[0] + s[..., None] * (one[1] - one[0]) + t[..., None] * (one[3] - one[0])
    return float(_within(points.reshape(-1, 2), other).mean()) * 10
