"""Curves of a run: bending angle and tip force against pressure, and the path of the tip.

Rows are those of history.csv; what a row does not have is left out.
"""

from __future__ import annotations

import functools
import textwrap
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.drawing.overlay import (
    MODELS,
    Line,
    Overlay,
    Points,
)
from fiberbend.drawing.page import figure, literal, save
from fiberbend.states.snapshot import Target, Write
from geometry.mesh.data import Floats

SIZE = (1000, 700)
"""Width and height of a plot in pixels."""
_BLUE, _RED = "#1f5a99", "#c0392b"
_MEASURED = "#111111"
_STYLES = dict(
    zip(
        MODELS,
        [("#2e7d32", "-"), ("#7b4fa3", "--"), ("#a8641a", "-."), ("#6b6b6b", ":")],
        strict=True,
    )
)
_SAME_ANGLE = 0.05
_LONG = 40
_LEFT = 0.17
"""Part of the width that a point's text takes to its left."""
_ROOM = 2.0
_TINY = 1e-6
_ASIDE = 1e-3
"""Part of the path's extent by which it leaves the plane of bending where it is drawn in space."""
_ANGLE = (col.PRESSURE, col.ANGLE)
_PATH = (col.TIP_Z, col.TIP_Y, col.PRESSURE)
_FORCE = (col.PRESSURE, col.TIP_FORCE)


def plot_pressure_angle(
    rows: Sequence[col.Row],
    target: Target,
    angles: Sequence[float] = (),
    title: str = "",
    reason: str | None = None,
    overlay: Overlay | None = None,
    name: str = "",
) -> None:
    """Bending angle against pressure, with a mark at every requested angle that was reached.

    Args:
        rows: rows of the history with pressure_kPa and angle_deg.
        target: a path, or a file open for writing bytes.
        angles: requested angles in degrees.
        title: title of the case.
        reason: why the run ended early, or None.
        overlay: other models and measured points.
        name: of the run's own curve.

    Raises:
        ValueError: no row has both values.
    """
    data = _columns(rows, _ANGLE)
    page, axes = _axes(title, reason, "pressure P (kPa)", "bending angle θ (°)")
    reached = []
    for angle in angles:
        nearest = int(np.abs(data[1] - angle).argmin())
        if abs(data[1][nearest] - angle) <= _SAME_ANGLE:
            reached.append((data[0][nearest], angle))
    _curves(axes, data, overlay, name)
    for pressure, angle in reached:
        axes.plot(pressure, angle, "o", color=_RED, markersize=9, zorder=4)
        _name_point(axes, f"{angle:g}° at {pressure:.1f} kPa", pressure, angle)
    save(page, target)


def plot_tip_path(
    rows: Sequence[col.Row], target: Target, title: str = "", reason: str | None = None
) -> None:
    """Path of the tip in the plane of bending, z to the right, y up, one scale.

    Where the tip leaves that plane, the path is drawn in space with its shadows on the walls. Dots
    are the steps; the curve through them is a spline.

    Args:
        rows: rows of the history with tip_z_mm, tip_y_mm and pressure_kPa, and with tip_x_mm where
            the tip may leave the plane.
        target: a path, or a file open for writing bytes.
        title: title of the case.
        reason: why the run ended early, or None.

    Raises:
        ValueError: no row has all three values.
    """
    z, y, pressure = _columns(rows, _PATH)
    x = np.array([row.get(col.TIP_X) or 0.0 for row in rows if _complete(row, _PATH)])
    if np.ptp(x) > _ASIDE * max(np.ptp(z), np.ptp(y)):
        _path_in_space(np.column_stack([x, y, z]), pressure, target, title, reason)
        return
    page, axes = _axes(title, reason, "z (mm)", "y (mm)")
    axes.plot(*_smooth(np.column_stack([z, y])).T, "-", color=_BLUE, linewidth=1.8)
    axes.plot(z, y, "o", color=_BLUE, markersize=4)
    for i, name in {0: "start", len(z) - 1: "end"}.items():
        axes.plot(z[i], y[i], "o", color=_RED, markersize=9, zorder=3)
        above = 14 if y[i] >= y.mean() else -24
        _label(axes, f"{name}: {pressure[i]:.1f} kPa", (z[i], y[i]), (0, above), "center")
    reach = 0.62 * max(float(np.ptp(z)), float(np.ptp(y)), 10.0)
    axes.set_aspect("equal")
    axes.set_ylim((y.min() + y.max()) / 2 - reach, (y.min() + y.max()) / 2 + reach)
    reach *= SIZE[0] / SIZE[1]
    axes.set_xlim((z.min() + z.max()) / 2 - reach, (z.min() + z.max()) / 2 + reach)
    save(page, target)


def plot_tip_force(
    rows: Sequence[col.Row],
    target: Target,
    title: str = "",
    reason: str | None = None,
    overlay: Overlay | None = None,
    name: str = "",
) -> None:
    """Tip force of the whole body against pressure.

    Args:
        rows: rows of the history with pressure_kPa and tip_force_N.
        target: a path, or a file open for writing bytes.
        title: title of the case.
        reason: why the run ended early, or None.
        overlay: other models and measured points.
        name: of the run's own curve.

    Raises:
        ValueError: no row has both values.
    """
    data = _columns(rows, _FORCE)
    page, axes = _axes(title, reason, "pressure P (kPa)", "tip force (N)")
    _curves(axes, data, overlay, name)
    pressure, force = data[0][-1], data[1][-1]
    _name_point(axes, f"{force:.3g} N at {pressure:.1f} kPa", pressure, force)
    save(page, target)


def draw_plots(
    rows: Sequence[col.Row],
    write: Write,
    angles: Sequence[float] = (),
    title: str = "",
    reason: str | None = None,
    beside_angles: Overlay | None = None,
    beside_forces: Overlay | None = None,
    name: str = "",
) -> list[str]:
    """Draw pressure_angle.png, tip_path.png and, with a tip force, tip_force.png.

    Args:
        rows: rows of the history; a plot whose columns are empty is not drawn.
        write: writes a file, such as `RunFolder.write`.
        angles: requested angles in degrees.
        title: title of the case.
        reason: why the run ended early, or None.
        beside_angles: what is drawn beside the angle over the pressure.
        beside_forces: what is drawn beside the tip force over the pressure.
        name: of the run's own curve where others are beside it, such as "body model".

    Returns:
        The names written.
    """
    angle = functools.partial(plot_pressure_angle, angles=angles, overlay=beside_angles, name=name)
    force = functools.partial(plot_tip_force, overlay=beside_forces, name=name)
    plots: dict[str, tuple[Callable[..., None], tuple[str, ...]]] = {
        "pressure_angle.png": (angle, _ANGLE),
        "tip_path.png": (plot_tip_path, _PATH),
        "tip_force.png": (force, _FORCE),
    }
    drawn = []
    for name, (plot, columns) in plots.items():
        if any(_complete(row, columns) for row in rows):
            write(name, functools.partial(plot, rows, title=title, reason=reason))
            drawn.append(name)
    return drawn


def _complete(row: col.Row, columns: Sequence[str]) -> bool:
    return all(row.get(name) is not None for name in columns)


def _columns(rows: Sequence[col.Row], names: Sequence[str]) -> list[Floats]:
    full = [[row[name] for name in names] for row in rows if _complete(row, names)]
    if not full:
        raise ValueError(f"no row of the history has {', '.join(names)}")
    return list(np.array(full, dtype=float).T)


def _path_in_space(
    path: Floats, pressure: Floats, target: Target, title: str, reason: str | None
) -> None:
    """Draw a path (n, 3) in mm, z away to the right, y up, one scale, shadows on three walls."""
    page = figure(SIZE)
    axes = page.add_axes((0.04, 0.02, 0.92, 0.9), projection="3d")
    page.text(0.5, 0.95, literal(title), ha="center", fontsize=15)
    if reason:
        text = literal(_note(reason))
        page.text(0.5, 0.91, text, ha="center", color=_RED, fontsize=10)
    # as seen: z to the right, x toward the viewer, y up
    order = [2, 0, 1]
    points, curve = path[:, order], _smooth(path)[:, order]
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    reach = np.maximum(0.6 * np.ptp(points, axis=0), 0.25 * np.ptp(points, axis=0).max())
    limits = np.stack([middle - reach, middle + reach])
    for wall, side in ((0, 0), (1, 1), (2, 0)):
        shadow = curve.copy()
        shadow[:, wall] = limits[side, wall]
        axes.plot(*shadow.T, "-", color="0.75", linewidth=1.2)
    axes.plot(*curve.T, "-", color=_BLUE, linewidth=1.8)
    axes.plot(*points.T, "o", color=_BLUE, markersize=4)
    for i, name in {0: "start", len(points) - 1: "end"}.items():
        axes.plot(*points[i : i + 1].T, "o", color=_RED, markersize=9)
        text = f"  {name}: {pressure[i]:.1f} kPa"
        axes.text(*points[i], text, fontsize=12, verticalalignment="bottom", zorder=10)
    for axis, name, low, high in zip("xyz", "zxy", *limits, strict=True):
        getattr(axes, f"set_{axis}lim")(low, high)
        getattr(axes, f"set_{axis}label")(f"{name} (mm)", fontsize=13, labelpad=8)
        axes.locator_params(axis=axis, nbins=5)
    axes.set_box_aspect(limits[1] - limits[0], zoom=0.85)
    axes.view_init(elev=22, azim=-60)
    save(page, target)


def _smooth(points: Floats) -> Floats:
    """A spline through points (n, d), its parameter their distance along the path."""
    from scipy.interpolate import CubicSpline

    path = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    kept = np.r_[True, np.diff(path) > 1e-9]
    if kept.sum() < 3:
        return points
    fine = np.linspace(0.0, path[-1], 400)
    curve: Floats = CubicSpline(path[kept], points[kept])(fine)
    return curve


def _axes(title: str, reason: str | None, across: str, up: str) -> tuple[Any, Any]:
    page = figure(SIZE)
    axes = page.add_axes((0.1, 0.11, 0.86, 0.77))
    axes.set_title(literal(title), fontsize=15, pad=24 if reason else 10)
    if reason:
        place = {"transform": axes.transAxes, "ha": "center", "color": _RED, "fontsize": 10}
        axes.text(0.5, 1.015, literal(_note(reason)), **place)
    axes.set_xlabel(across, fontsize=13)
    axes.set_ylabel(up, fontsize=13)
    axes.tick_params(labelsize=11)
    axes.grid(color="0.9")
    axes.spines[["top", "right"]].set_visible(False)
    return page, axes


def _note(reason: str) -> str:
    return f"ended early: {textwrap.shorten(reason, 110, placeholder=' …')}"


def _label(
    axes: Any, text: str, point: tuple[float, float], shift: tuple[float, float], side: str
) -> None:
    axes.annotate(text, point, shift, textcoords="offset points", ha=side, fontsize=12)


def _curves(axes: Any, data: Sequence[Floats], overlay: Overlay | None, name: str) -> None:
    """Draw the run's curve and what is beside it, with a legend; set the limits."""
    overlay = overlay or Overlay()
    _range(axes, data, overlay)
    own = {"color": _BLUE, "markersize": 4, "linewidth": 1.8, "clip_on": False, "zorder": 3}
    axes.plot(*data, "o-", **own, label=name or None)
    for line in overlay.lines:
        color, style = _STYLES[line.name]
        label = _shown(line.label)
        axes.plot(line.across, line.up, style, color=color, linewidth=1.1, zorder=2, label=label)
    for points in overlay.points:
        text = points.label if len(points.label) <= _LONG else f"{points.label[:_LONG]}…"
        mark = {"color": _MEASURED, "markersize": 7, "zorder": 3.5}
        axes.plot(points.across, points.up, "x", **mark, label=literal(text))
    if overlay.lines or overlay.points:
        axes.legend(fontsize=11, loc="best", edgecolor="none", framealpha=0.8)


def _name_point(axes: Any, text: str, across: float, up: float) -> None:
    """Write beside a point of a rising curve: over it to the left, or else under it."""
    from matplotlib.patheffects import withStroke

    left = axes.transLimits.transform((across, up))[0] > _LEFT
    shift, side = ((-9, 4), "right") if left else ((9, -13), "left")
    label = axes.annotate(
        text, (across, up), shift, textcoords="offset points", ha=side, fontsize=12, zorder=5
    )
    label.set_path_effects([withStroke(linewidth=3, foreground="white")])


def _shown(label: str) -> str:
    """Signs as matplotlib sets them."""
    return label.replace("μ̄", r"$\bar{\mu}$").replace("L_f", "$L_f$")


def _range(axes: Any, data: Sequence[Floats], overlay: Overlay) -> None:
    """Show the origin, the run, all measured points, and room for labels.

    Other models may go beyond: of the pressures they get as much room again as the run.
    """
    for axis, change in enumerate((axes.set_xlim, axes.set_ylim)):
        own = np.concatenate([[0.0], data[axis], *(p[axis] for p in map(_pair, overlay.points))])
        low, high = float(own.min()), float(own.max())
        others = [_pair(line)[axis] for line in overlay.lines]
        if others:
            beside = np.concatenate(others)
            low, high = (
                min(low, max(float(beside.min()), _ROOM * low)),
                max(high, min(float(beside.max()), _ROOM * high)),
            )
        if low > -_TINY * (high - low):
            low = 0.0
        room = 0.12 * (high - low) or 1.0
        change(low - (room if low < 0 else 0), high + room)


def _pair(curve: Line | Points) -> tuple[Floats, Floats]:
    return curve.across, curve.up
