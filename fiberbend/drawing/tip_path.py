"""Path of the tip in its plane or in space, with the obstacles that are there.

Between two load steps the path is a straight line: how the tip went from one to the other is not
known, and nothing is made up.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.drawing.axes import (
    BLUE,
    RED,
    Room,
    complete,
    fit,
    heading,
    legend,
    new_axes,
    paper,
    whole_rows,
)
from fiberbend.drawing.page import literal, save
from fiberbend.drawing.style import DEFAULT, Style
from fiberbend.states.obstacles import Shape
from fiberbend.states.snapshot import Target
from geometry.mesh.data import Floats

PATH = (col.TIP_Z, col.TIP_Y, col.PRESSURE)
"""Columns that a path needs."""
STILL = 1e-6
"""Length in mm of a path that is none."""
_ASIDE = 1e-3
"""Part of the path's extent by which it leaves the plane of bending where it is drawn in space."""
_LEAST = 5.0
"""Half the height in mm that is shown of a tip that hardly moves."""
_MARGIN = 0.62
_FARTHEST = 2.0
"""An obstacle is brought into sight where the picture becomes at most so many times as great."""
_BESIDE = 30.0
"""The same in mm, for a tip that hardly moves."""
_SHAPES = ("0.55", "#8d6e63", "#607d8b", "#9e9d24")


def moves(rows: Sequence[col.Row]) -> bool:
    """Whether the tip has a path at all."""
    found = [row for row in rows if complete(row, PATH)]
    if len(found) < 2:
        return False
    z, y, _ = whole_rows(found, PATH)
    return max(float(np.ptp(z)), float(np.ptp(y)), float(np.ptp(_aside(found)))) > STILL


def plot_tip_path(
    rows: Sequence[col.Row],
    target: Target,
    title: str = "",
    reason: str | None = None,
    obstacles: Mapping[str, Shape] | None = None,
    style: Style = DEFAULT,
) -> None:
    """Path of the tip in the plane of bending, z to the right, y up, one scale.

    Where the tip leaves that plane, the path is drawn in space with its shadows on the walls. Dots
    are the load steps.

    Args:
        rows: rows of the history with tip_z_mm, tip_y_mm and pressure_kPa, and with tip_x_mm where
            the tip may leave the plane.
        target: a path, or a file open for writing bytes.
        title: title of the case.
        reason: why the run ended early, or None.
        obstacles: rigid bodies by their names; those in sight are drawn.
        style: format, size and letters.

    Raises:
        ValueError: no row has all three values.
    """
    z, y, pressure = whole_rows(rows, PATH)
    x = _aside([row for row in rows if complete(row, PATH)])
    obstacles = obstacles or {}
    if np.ptp(x) > _ASIDE * max(np.ptp(z), np.ptp(y)):
        path = np.column_stack([x, y, z])
        _path_in_space(path, pressure, target, title, reason, obstacles, style)
        return
    page, axes = new_axes(style, title, reason, "z of the tip (mm)", "y of the tip (mm)")
    scale = style.scale
    axes.plot(
        z, y, "o-", color=BLUE, linewidth=1.8 * scale, markersize=4 * scale, clip_on=False, zorder=3
    )
    for i in (0, len(z) - 1):
        axes.plot(z[i], y[i], "o", color=RED, markersize=9 * scale, zorder=4)
    _limits(axes, z, y, obstacles.values())
    fit(axes, style)
    # one scale in the place that the axes have found
    _limits(axes, z, y, obstacles.values())
    names = _draw_shapes(axes, obstacles)
    free = Room(axes, style)
    if names:
        legend(axes, style, free)
    for i, name in {0: "start", len(z) - 1: "end"}.items():
        free.write(f"{name}: {pressure[i]:.1f} kPa", z[i], y[i])
    save(page, target, style)


def _aside(rows: Sequence[col.Row]) -> Floats:
    return np.array([row.get(col.TIP_X) or 0.0 for row in rows], dtype=float)


def _limits(axes: Any, z: Floats, y: Floats, shapes: Collection[Shape]) -> None:
    """One scale; the whole path, and of obstacles what is not far from it."""
    low, high = np.array([z.min(), y.min()]), np.array([z.max(), y.max()])
    most = max(_FARTHEST * max(*(high - low)), _BESIDE)
    for shape in shapes:
        near = shape.nearest(np.column_stack([z, y]))
        if near is not None:
            least, greatest = np.minimum(low, near[0]), np.maximum(high, near[1])
            if max(greatest - least) <= most:
                low, high = least, greatest
    box = axes.get_window_extent()
    ratio = box.width / box.height
    middle = (low + high) / 2
    half = max(_MARGIN * (high - low)[1], _MARGIN * (high - low)[0] / ratio, _LEAST)
    axes.set_xlim(middle[0] - ratio * half, middle[0] + ratio * half)
    axes.set_ylim(middle[1] - half, middle[1] + half)


def _draw_shapes(axes: Any, obstacles: Mapping[str, Shape]) -> list[str]:
    """Draw obstacles as the plane x = 0 cuts them; the names of those in sight."""
    from matplotlib.patches import Polygon

    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    names = []
    for (name, shape), color in zip(obstacles.items(), _SHAPES * len(obstacles), strict=False):
        look = {"facecolor": color, "alpha": 0.35, "edgecolor": color, "zorder": 1}
        corners = shape.cut(np.array([right - left, top - bottom]))
        if corners is None:
            continue
        patch = Polygon(corners, closed=True, **look)
        seen = patch.get_path().transformed(patch.get_patch_transform()).get_extents()
        if seen.x0 < right and seen.x1 > left and seen.y0 < top and seen.y1 > bottom:
            patch.set_label(literal(name))
            axes.add_patch(patch)
            names.append(name)
    return names


def _path_in_space(
    path: Floats,
    pressure: Floats,
    target: Target,
    title: str,
    reason: str | None,
    obstacles: Mapping[str, Shape],
    style: Style,
) -> None:
    """Draw a path (n, 3) in mm, z away to the right, y up, one scale, shadows on three walls."""
    page, scale = style.figure(), style.scale
    axes = page.add_axes((0.04, 0.02, 0.92, 0.88), projection="3d")
    heading(page, style, title, reason)
    # as seen: z to the right, x toward the viewer, y up
    order = [2, 0, 1]
    points = path[:, order]
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    reach = np.maximum(0.6 * np.ptp(points, axis=0), 0.25 * np.ptp(points, axis=0).max())
    limits = np.stack([middle - reach, middle + reach])
    for wall, side in ((0, 0), (1, 1), (2, 0)):
        shadow = points.copy()
        shadow[:, wall] = limits[side, wall]
        axes.plot(*shadow.T, "-", color="0.75", linewidth=1.2 * scale)
    for (name, shape), color in zip(obstacles.items(), _SHAPES * len(obstacles), strict=False):
        label = literal(name)
        for line in shape.wires(limits[:, [1, 2, 0]]):
            line = np.where(
                ((line >= limits[0, [1, 2, 0]]) & (line <= limits[1, [1, 2, 0]])).all(axis=1)[
                    :, None
                ],
                line,
                np.nan,
            )
            if np.isfinite(line).any():
                axes.plot(*line[:, order].T, "-", color=color, linewidth=1.2 * scale, label=label)
                label = "_"
    axes.plot(*points.T, "o-", color=BLUE, linewidth=1.8 * scale, markersize=4 * scale)
    for i in (0, len(points) - 1):
        axes.plot(*points[i : i + 1].T, "o", color=RED, markersize=9 * scale)
    for axis, name, low, high in zip("xyz", "zxy", *limits, strict=True):
        getattr(axes, f"set_{axis}lim")(low, high)
        getattr(axes, f"set_{axis}label")(
            f"{name} (mm)", fontsize=style.font_size, labelpad=8 * scale
        )
        axes.tick_params(axis=axis, labelsize=10 * scale, pad=3 * scale)
        short = high - low < 0.4 * (limits[1] - limits[0]).max()
        axes.locator_params(axis=axis, nbins=3 if short else 5)
    axes.view_init(elev=22, azim=-60)
    _fill(axes, limits[1] - limits[0], bool(title) or reason is not None)
    for i, name in {0: "start", len(points) - 1: "end"}.items():
        _name_end(axes, f"{name}: {pressure[i]:.1f} kPa", points[i], points.mean(axis=0), style)
    if axes.get_legend_handles_labels()[0]:
        page.legend(
            *axes.get_legend_handles_labels(),
            fontsize=11 * scale,
            loc="lower left",
            edgecolor="none",
            borderaxespad=0.3,
        )
    save(page, target, style)


def _name_end(axes: Any, text: str, point: Floats, middle: Floats, style: Style) -> None:
    """Write beside a point (3,) of axes in space, toward the middle of what is drawn."""
    (across, up), (center, _) = _projected(axes, np.stack([point, middle]))
    left = across > center
    axes.annotate(
        text,
        (across, up),
        ((-8 if left else 8) * style.scale, 6 * style.scale),
        textcoords="offset points",
        ha="right" if left else "left",
        fontsize=12 * style.scale,
        zorder=20,
        bbox=paper(style),
    )


def _projected(axes: Any, points: Floats) -> Floats:
    """Points (n, 3) of axes in space as they lie on the page, (n, 2)."""
    seen = np.column_stack([points, np.ones(len(points))]) @ axes.get_proj().T
    projected: Floats = seen[:, :2] / seen[:, 3:]
    return projected


def _fill(axes: Any, extent: Floats, headed: bool) -> None:
    """Let axes in space fill their page under its heading."""
    page = axes.figure
    renderer = page.canvas.get_renderer()
    room = np.array([0.94 * page.bbox.width, (0.86 if headed else 0.94) * page.bbox.height])
    middle, zoom = np.array([0.5, 0.46 if headed else 0.5]) * page.bbox.size, 0.85
    corners = np.array(np.meshgrid(axes.get_xlim(), axes.get_ylim(), axes.get_zlim()))
    for _ in range(3):
        axes.set_box_aspect(extent, zoom=zoom)
        # only now the names of the axes are where they will be
        page.draw_without_rendering()
        texts = [axis.label for axis in (axes.xaxis, axes.yaxis, axes.zaxis)]
        boxes = [text.get_window_extent(renderer) for text in texts]
        points = axes.transData.transform(_projected(axes, corners.reshape(3, -1).T))
        low = np.min([points.min(axis=0), *([box.x0, box.y0] for box in boxes)], axis=0)
        high = np.max([points.max(axis=0), *([box.x1, box.y1] for box in boxes)], axis=0)
        shift = (middle - (low + high) / 2) / page.bbox.size
        x0, y0, width, height = axes.get_position(original=True).bounds
        axes.set_position((x0 + shift[0], y0 + shift[1], width, height))
        zoom *= float(min(room / (high - low)))
