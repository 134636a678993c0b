"""Axes of a plot, and places for legend and texts where they cover no curve and no other text."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fiberbend import columns as col
from fiberbend.drawing.page import literal
from fiberbend.drawing.style import Style
from geometry.mesh.data import Floats

BLUE, RED = "#1f5a99", "#c0392b"
"""Colours of a run and of what is marked on it."""
_STEP = 1.5
"""Pixels between the points of a curve that texts keep clear of."""
_PAD = 3.0
"""Points of paper between a text and a curve."""
_GAP = 1.5
"""Points of paper between two texts: the paper behind the one covers no letter of the other."""
_NEAR = 22.0
"""A text farther from its point, in points of paper, is joined to it by a thin line."""
_CROSSED = 8.0
"""Points of paper that a text goes farther away for each point of its line that would cross."""
_DISTANCES = (9.0, 15.0, 22.0, 36.0, 54.0, 76.0, 100.0, 130.0, 170.0, 220.0)
_DIRECTIONS = (135, 315, 155, 115, 335, 295, 180, 90, 0, 270, 45, 225, 60, 30, 15, 75)
"""Degrees; over a rising curve to its left, and under it to its right, come first."""
_GRID = (25, 19)
_LEAST = 0.4
"""Part of the page that is left to the axes at least where a legend stands below them."""


class NoRoomError(ValueError):
    """A page is too small for its legend."""


def complete(row: col.Row, columns: Sequence[str]) -> bool:
    """Whether a row has a value in every one of some columns."""
    return all(row.get(name) is not None for name in columns)


def whole_rows(rows: Sequence[col.Row], names: Sequence[str]) -> list[Floats]:
    """Some columns of the rows that have values in all of them, (n,) each.

    Raises:
        ValueError: there is no such row.
    """
    full = [[row[name] for name in names] for row in rows if complete(row, names)]
    if not full:
        raise ValueError(f"no row of the history has {', '.join(names)}")
    return list(np.array(full, dtype=float).T)


def new_axes(style: Style, title: str, reason: str | None, across: str, up: str) -> tuple[Any, Any]:
    """A page with axes for a plot.

    Args:
        style: of the page.
        title: of the case.
        reason: why the run ended early, or None.
        across: name of the lower axis, with its unit.
        up: name of the left axis, with its unit.

    Returns:
        The page and the axes, which `fit` puts in place.
    """
    page = style.figure()
    axes = page.add_axes((0.1, 0.11, 0.86, 0.77))
    scale, width = style.scale, style.inches[0] * 72
    if title:
        # so many letters of 0.55 of their height fill the width
        size = min(15 * scale, width / (0.55 * max(len(literal(title)), 1)))
        axes.set_title(literal(title), fontsize=size, pad=(24 if reason else 10) * scale)
    if reason:
        axes.text(
            0.5, 1.015, literal(_note(reason)), transform=axes.transAxes, **_red(style)
        ).set_in_layout(bool(not title))
    axes.set_xlabel(across, fontsize=style.font_size)
    axes.set_ylabel(up, fontsize=style.font_size)
    axes.tick_params(labelsize=11 * scale, width=0.8 * scale, length=3.5 * scale)
    axes.grid(color="0.9", linewidth=0.8 * scale)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_linewidth(0.8 * scale)
    return page, axes


def paper(style: Style) -> dict[str, Any]:
    """White behind a text; a white rim around its letters would make them drawings in a PDF."""
    return {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.5 * style.scale}


def heading(page: Any, style: Style, title: str, reason: str | None) -> None:
    """Write a title at the top of a page, and under it why the run ended early."""
    page.text(0.5, 0.95, literal(title), ha="center", fontsize=15 * style.scale)
    if reason:
        page.text(0.5, 0.91, literal(_note(reason)), **_red(style))


def _note(reason: str) -> str:
    return f"ended early: {textwrap.shorten(reason, 110, placeholder=' …')}"


def _red(style: Style) -> dict[str, Any]:
    return {"ha": "center", "color": RED, "fontsize": 10 * style.scale}


def fit(axes: Any, style: Style, below: float = 0.0) -> None:
    """Let axes fill their page up to what their texts need.

    Args:
        axes: with its ticks, names and title, and without other texts.
        style: of the page.
        below: pixels that are kept free at the bottom of the page.

    Raises:
        NoRoomError: hardly anything is left to the axes.
    """
    page = axes.figure
    renderer = page.canvas.get_renderer()
    width, height = page.bbox.width, page.bbox.height
    pad = 0.7 * _pixels(style.font_size, page)
    for axis, room in ((axes.xaxis, width), (axes.yaxis, height)):
        box = axis.label.get_window_extent(renderer)
        # the middle of the axes is not that of the page
        part = max(box.width, box.height) / (0.8 * room)
        if part > 1:
            axis.label.set_fontsize(axis.label.get_fontsize() / part)
    # other sizes may have other ticks, whose texts may be wider
    for _ in range(2):
        outer, inner = axes.get_tightbbox(renderer), axes.get_window_extent(renderer)
        left, right = pad + inner.x0 - outer.x0, width - pad - max(outer.x1 - inner.x1, pad)
        bottom, top = pad + below + inner.y0 - outer.y0, height - pad - (outer.y1 - inner.y1)
        if top - bottom < _LEAST * height or right - left < _LEAST * width:
            raise NoRoomError("no room for axes beside all their text")
        axes.set_position(
            (left / width, bottom / height, (right - left) / width, (top - bottom) / height)
        )


def legend(axes: Any, style: Style, free: Room, grow: bool = False, below: bool = False) -> None:
    """Name the curves where no curve is; below the axes where there is no such place.

    Args:
        axes: fitted, with their limits set.
        style: of the page.
        free: what is free; the legend is taken from it.
        grow: for a legend below the page grows; else the axes shrink.
        below: it stands below the axes though there may be a place within them.

    Raises:
        NoRoomError: there is no room below either.
    """
    frame = _legend(axes, style, loc="lower left", bbox_to_anchor=(0.0, 0.0))
    box = frame.get_window_extent(axes.figure.canvas.get_renderer())
    place = None if below else free.corner(box.width, box.height)
    if place is not None:
        frame.set_bbox_to_anchor(place, transform=axes.figure.dpi_scale_trans)
        scale = axes.figure.dpi
        x, y = place[0] * scale, place[1] * scale
        free.take((x, y, x + box.width, y + box.height))
        return
    count = len(frame.get_texts())
    pad = 0.5 * _pixels(style.font_size, axes.figure)
    for columns in range(min(count, 4), 0, -1):
        frame = _legend(
            axes,
            style,
            loc="lower center",
            bbox_to_anchor=(axes.figure.bbox.width / 2 / axes.figure.dpi, pad / axes.figure.dpi),
            ncols=columns,
        )
        box = frame.get_window_extent(axes.figure.canvas.get_renderer())
        if box.width < axes.figure.bbox.width - 2 * pad or columns == 1:
            break
    frame.set_visible(False)
    frame.set_in_layout(False)
    if grow:
        width, height = axes.figure.get_size_inches()
        axes.figure.set_size_inches(width, height + (box.height + pad) / axes.figure.dpi)
    fit(axes, style, below=box.height + pad)
    frame.set_visible(True)
    free.look()


def _legend(axes: Any, style: Style, **where: Any) -> Any:
    transform = axes.figure.dpi_scale_trans
    how = {"fontsize": 11 * style.scale, "edgecolor": "none", "framealpha": 0.8}
    return axes.legend(bbox_transform=transform, borderaxespad=0.0, **how, **where)


class Room:
    """What is free on axes whose curves and limits are set.

    Args:
        axes: the axes.
        style: of their page.
    """

    def __init__(self, axes: Any, style: Style) -> None:
        self._axes, self._style = axes, style
        self._taken: list[Floats] = []
        self._joints: list[Floats] = []
        self._gap = _pixels(_GAP * style.scale, axes.figure)
        self._pad = _pixels(_PAD * style.scale, axes.figure)
        self.look()

    def look(self) -> None:
        """Find again where the curves are, after the axes have changed their place."""
        box = self._axes.get_window_extent()
        lines = [_fine(self._axes, line) for line in self._axes.lines]
        lines += [_outline(patch) for patch in self._axes.patches]
        points = np.concatenate([np.empty((0, 2)), *lines])
        inside = (points >= [box.x0, box.y0]) & (points <= [box.x1, box.y1])
        self._points = points[inside.all(axis=1)]
        self._box = (box.x0, box.y0, box.x1, box.y1)

    def take(self, box: tuple[float, float, float, float]) -> None:
        """Let nothing else stand in a box x0, y0, x1, y1 in pixels."""
        self._taken.append(np.array(box))

    def corner(self, width: float, height: float) -> tuple[float, float] | None:
        """Lower left corner, in inches, of a free place for a box in pixels; None without one."""
        x0, y0, x1, y1 = self._box
        across = np.linspace(x0 + self._pad, x1 - width - self._pad, _GRID[0])
        up = np.linspace(y0 + self._pad, y1 - height - self._pad, _GRID[1])
        if across[-1] < across[0] or up[-1] < up[0]:
            return None
        # corners first, then what is near to one
        away = [(min(i, _GRID[0] - 1 - i), i > 0) for i in range(_GRID[0])]
        apart = [(min(j, _GRID[1] - 1 - j), j < _GRID[1] - 1) for j in range(_GRID[1])]
        order = sorted(
            (away[i][0] + apart[j][0], apart[j][1], away[i][1], i, j)
            for i in range(_GRID[0])
            for j in range(_GRID[1])
        )
        for *_, i, j in order:
            box = (across[i], up[j], across[i] + width, up[j] + height)
            if self._cost(box) == 0:
                dpi = self._axes.figure.dpi
                return float(across[i]) / dpi, float(up[j]) / dpi
        return None

    def write(
        self,
        text: str,
        across: float,
        up: float,
        size: float = 12.0,
        reach: float = math.inf,
        ways: Sequence[int] = _DIRECTIONS,
    ) -> None:
        """Write beside a point where nothing else is, as near to it as possible.

        Args:
            text: what is written.
            across: the point, as the axes count.
            up: its other coordinate.
            size: of the letters, pt; in proportion to those of the style.
            reach: points of paper; where nothing is free so near, nothing is written.
            ways: degrees, the best first: where the text may stand as seen from the point.
        """
        figure, scale = self._axes.figure, self._style.scale
        at = self._axes.transData.transform((across, up))
        note = self._axes.annotate(
            literal(text),
            (across, up),
            (0, 0),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=size * scale,
            zorder=5,
            bbox=paper(self._style),
        )
        extent = note.get_window_extent(figure.canvas.get_renderer())
        half = np.array([extent.width, extent.height]) / 2
        around = _around(at, half, _pixels(scale, figure), ways)
        places = [place for place in around if place[0] <= reach]
        costs = []
        for distance, middle in places:
            covered = self._cost((*(middle - half), *(middle + half)))
            crossed = self._crossed(at, middle, half) if distance > _NEAR else 0.0
            costs.append((covered, _CROSSED * crossed + distance))
            if covered == crossed == 0:
                # all that follow are farther away
                break
        best = min(range(len(costs)), key=costs.__getitem__)
        if costs[best][0] > 0 and reach < math.inf:
            note.remove()
            return
        distance, middle = places[best]
        self.take((*(middle - half), *(middle + half)))
        shift = (middle - at) * 72 / figure.dpi
        note.set_position(tuple(shift))
        if distance > _NEAR:
            from matplotlib.collections import LineCollection

            line = _joined(at, middle, half)
            self._joints.append(line)
            self._points = np.concatenate([self._points, line])
            way = self._axes.transData.inverted().transform(line[[0, -1]])
            thin = LineCollection([way], colors="0.45", linewidths=0.8 * scale, zorder=2.5)
            self._axes.add_collection(thin, autolim=False)

    def _crossed(self, at: Floats, middle: Floats, half: Floats) -> float:
        """How many points of the line that joins a text would lie under texts and on such lines."""
        way = _joined(at, middle, half)
        under = sum(_within(way, box[:2], box[2:]) for box in self._taken)
        apart = (np.abs(way[:, None] - other).max(axis=2) < _STEP for other in self._joints)
        return float(under + sum(int(near.any(axis=1).sum()) for near in apart))

    def between(self, one: tuple[float, float], other: tuple[float, float]) -> float:
        """Distance of two points of the axes on the page, in points of paper."""
        ends = self._axes.transData.transform([one, other])
        return float(np.hypot(*(ends[1] - ends[0]))) * 72 / float(self._axes.figure.dpi)

    def _cost(self, box: Sequence[float]) -> float:
        """How much a box x0, y0, x1, y1 in pixels covers."""
        x0, y0, x1, y1 = self._box
        low, high = np.array(box[:2]), np.array(box[2:])
        beyond = max(x0 - low[0], y0 - low[1], high[0] - x1, high[1] - y1, 0.0)
        covered = _within(self._points, low - self._pad, high + self._pad)
        overlaps = sum(
            bool(((low - self._gap < b[2:]) & (high + self._gap > b[:2])).all())
            for b in self._taken
        )
        return float(covered) + 1e4 * overlaps + 10 * beyond


def _within(points: Floats, low: Floats, high: Floats) -> int:
    inside: NDArray[np.bool_] = ((points > low) & (points < high)).all(axis=1)
    return int(inside.sum())


def _joined(at: Floats, middle: Floats, half: Floats) -> Floats:
    """Points of the line from a point to the nearest side of its text."""
    return _densely(np.stack([at, np.clip(at, middle - half, middle + half)]))


def _around(
    at: Floats, half: Floats, point: float, ways: Sequence[int]
) -> Iterator[tuple[float, Floats]]:
    """Distances in points of paper and middles of boxes around a point, the nearest first."""
    for distance in _DISTANCES:
        for degrees in ways:
            way = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
            yield distance, at + way * (distance * point + half)


def _fine(axes: Any, line: Any) -> Floats:
    """Points of a curve and the rims of its marks in pixels, close to each other."""
    points: Floats = np.asarray(line.get_xydata(), dtype=float)
    points = line.get_transform().transform(points[np.isfinite(points).all(axis=1)])
    found = [points]
    if line.get_marker() not in ("None", "", " ", None):
        turn = np.linspace(0, 2 * math.pi, 8, endpoint=False)
        rim = _pixels(line.get_markersize() / 2, axes.figure) * np.stack(
            [np.cos(turn), np.sin(turn)], axis=1
        )
        found.append((points[:, None] + rim).reshape(-1, 2))
    if line.get_linestyle() not in ("None", "", " "):
        found.append(_densely(points))
    return np.concatenate(found)


def _outline(patch: Any) -> Floats:
    outline = patch.get_transform().transform_path(patch.get_path())
    polygons = outline.to_polygons(closed_only=False)
    return np.concatenate([np.empty((0, 2)), *map(_densely, polygons)])


def _densely(points: Floats) -> Floats:
    if len(points) < 2:
        return points
    passed = np.r_[0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    # far outside of a page there may be very much of a curve
    count = int(min(passed[-1] / _STEP + 2, 20000))
    fine = np.linspace(0.0, passed[-1], count)
    return np.column_stack([np.interp(fine, passed, points[:, i]) for i in (0, 1)])


def _pixels(points: float, figure: Any) -> float:
    return points * float(figure.dpi) / 72
