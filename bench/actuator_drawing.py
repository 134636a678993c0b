"""Draw the actuator with the names of its dimensions and axes: docs/images/actuator.svg."""

from __future__ import annotations

import io
import math
import re
import sys
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Arc, Polygon, Rectangle, Wedge

PICTURE = Path(__file__).resolve().parent.parent / "docs" / "images" / "actuator.svg"
RADIUS, WALL, FLOOR, SHEATH, CAP, LENGTH, PITCH = 8.0, 2.4, 2.4, 1.4, 12.0, 84.0, 7.0
"""mm; thin parts are drawn thicker than in the shipped cases, the actuator shorter."""
OUTER = RADIUS + WALL
TOP = FLOOR + OUTER
LOAD = "#b45f06"
RUBBER, STIFF, SOFT, AIR, THREAD = "#9cc3e6", "#6d6d6d", "#f6dcb0", "#ffffff", "#b03a2e"
INK = "#222222"
NAMES = {"fontsize": 10, "color": INK}
STYLE = {"svg.hashsalt": "fiberbend", "svg.fonttype": "path", "font.family": "DejaVu Sans"}


def _dimension(ax: Any, start: Any, end: Any, text: str, at: Any, **how: Any) -> None:
    """An arrow with two heads and its name."""
    arrow = {"arrowstyle": "<->", "color": INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", xy=end, xytext=start, arrowprops=arrow)
    ax.text(*at, text, **NAMES | how)


def _leader(ax: Any, point: Any, text: str, at: Any, **how: Any) -> None:
    """A name with a line to what it names."""
    line = {"arrowstyle": "-", "color": INK, "lw": 0.7, "shrinkA": 1, "shrinkB": 0}
    ax.annotate(text, xy=point, xytext=at, arrowprops=line, **NAMES | how)


def _axes(ax: Any, origin: Any, names: str, size: float) -> None:
    """Two axes of coordinates, the first to the right."""
    arrow = {"arrowstyle": "-|>", "color": "#0b5394", "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
    for name, (dx, dy) in zip(names, ((size, 0), (0, size)), strict=True):
        ax.annotate("", xy=(origin[0] + dx, origin[1] + dy), xytext=origin, arrowprops=arrow)
        place = (origin[0] + 1.13 * dx, origin[1] + 1.13 * dy)
        ax.text(
            *place, name, color="#0b5394", fontsize=11, ha="center", va="center", style="italic"
        )


def _load(ax: Any, point: Any, way: Any, name: str, at: Any) -> None:
    """A force with its name, an arrow from a point."""
    arrow = {"arrowstyle": "-|>", "color": LOAD, "lw": 1.8, "shrinkA": 0, "shrinkB": 0}
    end = (point[0] + way[0], point[1] + way[1])
    ax.annotate("", xy=end, xytext=point, arrowprops=arrow)
    ax.text(end[0] + at[0], end[1] + at[1], name, **NAMES | {"color": LOAD})


def _moment(ax: Any, point: Any, size: float, begin: float, end: float) -> None:
    """A moment about x: a bent arrow around a point, from one angle to another in degrees."""
    turn = np.radians(np.linspace(begin, end, 60))
    x, y = point[0] + size * np.cos(turn), point[1] + size * np.sin(turn)
    ax.plot(x[:-4], y[:-4], color=LOAD, lw=1.6)
    arrow = {"arrowstyle": "-|>", "color": LOAD, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", xy=(x[-1], y[-1]), xytext=(x[-8], y[-8]), arrowprops=arrow)


def section(ax: Any) -> None:
    """The cross-section, seen along the axis."""
    s, width = SHEATH, OUTER + SHEATH
    ax.add_patch(Wedge((0, FLOOR), OUTER + s, 0, 180, color=SOFT))
    ax.add_patch(Rectangle((-width, -s), 2 * width, FLOOR + s, color=SOFT))
    ax.add_patch(Wedge((0, FLOOR), OUTER, 0, 180, color=RUBBER))
    ax.add_patch(Rectangle((-OUTER, 0), 2 * OUTER, FLOOR, color=STIFF))
    ax.add_patch(Wedge((0, FLOOR), RADIUS, 0, 180, color=AIR))
    turn = np.linspace(0, math.pi, 90)
    outline_x = np.r_[OUTER * np.cos(turn), -OUTER, OUTER, OUTER]
    outline_y = np.r_[FLOOR + OUTER * np.sin(turn), 0, 0, FLOOR]
    ax.plot(outline_x, outline_y, color=THREAD, lw=1.6, solid_joinstyle="round")
    ax.text(-1, FLOOR + 1.2, "chamber", ha="right", **NAMES)
    slope = math.radians(50)
    along = np.array([math.cos(slope), math.sin(slope)])
    low = np.array([0, FLOOR])
    _dimension(ax, low, low + RADIUS * along, "radius", low + 4.6 * along + (1.1, -0.9))
    other = np.array([-math.cos(slope), math.sin(slope)])
    _dimension(
        ax, low + RADIUS * other, low + OUTER * other, "wall", low + 14.2 * other, ha="right"
    )
    _leader(ax, low + (OUTER + 0.4 * s) * np.array([0.94, 0.34]), "sheath", (15.5, 9), ha="left")
    _leader(ax, (OUTER, 1.2), "fibers (winding)", (15.5, 4.6), ha="left")
    _dimension(
        ax, (-width - 1.6, 0), (-width - 1.6, FLOOR), "floor", (-width - 2.4, 0.5), ha="right"
    )
    for y in (0, FLOOR):
        ax.plot([-width - 2.2, -OUTER], [y, y], color=INK, lw=0.5)
    _axes(ax, (0, 0), "xy", 6.0)
    ax.set_title("cross-section, seen from the tip", fontsize=10, color=INK)
    ax.set_xlim(-22, 31)
    ax.set_ylim(-7, 20)


def _bent(z: np.ndarray, y: np.ndarray | float, radius: float) -> tuple[Any, Any]:
    """Where a point of the side view goes when y = 0 becomes an arc; caps stay straight."""
    inside = np.clip(z, 0, LENGTH)
    turn = inside / radius
    over = z - inside
    return (
        (radius + y) * np.sin(turn) + over * np.cos(turn),
        (radius + y) * np.cos(turn) - radius - over * np.sin(turn),
    )


def _body(ax: Any, place: Any) -> None:
    """Sheath, wall, caps, chamber and threads of a side view; `place` maps z and y."""
    ends = np.linspace(-CAP, LENGTH + CAP, 200)
    hollow = np.linspace(0, LENGTH, 200)

    def band(z: np.ndarray, low: float, high: float, color: str) -> None:
        lower, upper = place(z, low), place(z[::-1], high)
        ax.add_patch(
            Polygon(np.c_[np.r_[lower[0], upper[0]], np.r_[lower[1], upper[1]]], color=color)
        )

    band(ends, -SHEATH, TOP + SHEATH, SOFT)
    band(ends, 0, TOP, RUBBER)
    band(ends, 0, FLOOR, STIFF)
    band(hollow, FLOOR, FLOOR + RADIUS, AIR)
    for turn in range(int(LENGTH / PITCH)):
        for side in (0, PITCH / 2):
            z = np.linspace(turn * PITCH + side, turn * PITCH + side + PITCH / 2, 8)
            y = np.linspace(0, TOP, 8)
            for height in (y, y[::-1]):
                ax.plot(*place(z, height), color=THREAD, lw=0.7, alpha=0.8)


def side(ax: Any) -> None:
    """The side view at rest."""
    _body(ax, lambda z, y: (z, np.broadcast_to(y, np.shape(z))))
    left = -CAP
    ax.add_patch(
        Rectangle((left - 3, -6), 3, TOP + 12, facecolor="none", edgecolor=INK, hatch="////", lw=0)
    )
    ax.plot([left, left], [-6, TOP + 6], color=INK, lw=1.2)
    ax.text(left - 4, TOP / 2, "clamp", rotation=90, ha="right", va="center", **NAMES)
    high = TOP + SHEATH
    for z in (-CAP, 0, LENGTH, LENGTH + CAP):
        ax.plot([z, z], [high, high + 5.5], color=INK, lw=0.5)
    for start, end, name in (
        (-CAP, 0, "cap"),
        (0, LENGTH, "length"),
        (LENGTH, LENGTH + CAP, "cap"),
    ):
        _dimension(
            ax, (start, high + 4), (end, high + 4), name, ((start + end) / 2, high + 5), ha="center"
        )
    first = 4 * PITCH + PITCH / 2
    for z in (first, first + PITCH):
        ax.plot([z, z], [-SHEATH, -6], color=INK, lw=0.5)
    _dimension(ax, (first, -4.8), (first + PITCH, -4.8), "pitch", (first + PITCH + 1.2, -6.2))
    _axes(ax, (0, 0), "zy", 9.0)
    ax.set_title("side view at rest", fontsize=10, color=INK)
    ax.set_xlim(-24, 106)
    ax.set_ylim(-9, 25)


def bent(ax: Any) -> None:
    """The side view under pressure."""
    angle = math.radians(100)
    radius = LENGTH / angle
    _body(ax, lambda z, y: _bent(z, y, radius))
    left = -CAP
    ax.add_patch(
        Rectangle((left - 3, -6), 3, TOP + 12, facecolor="none", edgecolor=INK, hatch="////", lw=0)
    )
    ax.plot([left, left], [-6, TOP + 6], color=INK, lw=1.2)
    # the line through the centroids turns by θ between z = 0 and z = length
    line = np.linspace(0, LENGTH, 90)
    middle = 5.6
    ax.plot(*_bent(line, middle, radius), color="#0b5394", lw=1.2, ls=(0, (5, 3)))
    _leader(ax, _bent(np.array(30.0), middle, radius), "centre-line", (20, 24), ha="left")
    centre = np.array([0.0, -radius])
    for z in (0.0, LENGTH):
        end = np.array(_bent(np.array(z), 0.0, radius))
        ax.plot([centre[0], end[0]], [centre[1], end[1]], color=INK, lw=0.7, ls=":")
    ax.add_patch(
        Arc((0.0, -radius), 30, 30, theta1=90 - math.degrees(angle), theta2=90, color=INK, lw=1.2)
    )
    ax.text(centre[0] + 12.5, centre[1] + 11.5, "θ", fontsize=14, color=INK)
    tip = _bent(np.array(LENGTH + CAP), middle, radius)
    ax.plot(*tip, "o", color="#0b5394", ms=6)
    _leader(ax, tip, "tip", (tip[0] - 14, tip[1] - 1), ha="right")
    _load(ax, tip, (0.0, -13.0), "force along −y", (-2.0, -4.0))
    _moment(ax, tip, 9.0, 75, -60)
    ax.text(tip[0] + 9.5, tip[1] + 5.5, "moment\nabout +x", **NAMES | {"color": LOAD})
    ax.plot(0, 0, "o", color="#0b5394", ms=4)
    _leader(ax, (0, 0), "point of the clamp's\nmoments", (-14, -12), ha="right", va="top")
    _axes(ax, (0, 0), "zy", 9.0)
    ax.text(-6, -26, "P > 0 bends\ntoward −y", va="top", ha="right", **NAMES)
    ax.set_title("side view under pressure", fontsize=10, color=INK)
    ax.set_xlim(-32, 74)
    ax.set_ylim(-88, 28)


def draw(path: Path = PICTURE) -> None:
    """Write the drawing; the same bytes every time, whatever numpy makes of the last digit.

    Args:
        path: an SVG or PNG file.
    """
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(9.2, 5.0), layout="constrained")
        grid = figure.add_gridspec(2, 2, width_ratios=(1.35, 1), height_ratios=(1, 1.25))
        places = (grid[0, 0], grid[1, 0], grid[:, 1])
        for place, view in zip(places, (side, section, bent), strict=True):
            ax = figure.add_subplot(place)
            ax.set_aspect("equal")
            ax.axis("off")
            view(ax)
        if path.suffix == ".svg":
            text = io.StringIO()
            figure.savefig(text, format="svg", metadata={"Date": None}, facecolor="white")
            path.write_text(_numbered(text.getvalue()), encoding="utf-8")
        else:
            figure.savefig(path, dpi=110, facecolor="white")
        plt.close(figure)


def _numbered(svg: str) -> str:
    """An SVG whose names of parts, made from all digits of their sizes, are numbers instead."""
    names = dict.fromkeys(re.findall(r'id="([a-z][0-9a-f]{10})"', svg))
    for number, name in enumerate(names):
        svg = svg.replace(name, f"part{number}")
    return svg


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURE)
