"""Curves of a run over the pressure: bending angle, twist, tip force and forces of contact.

Rows are those of history.csv; what a row does not have is left out. Axes are those of the run's own
data and of measured points: the curve of another model ends where the axes do.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.drawing import tip_path
from fiberbend.drawing.axes import BLUE, RED, Room, complete, fit, legend, new_axes, whole_rows
from fiberbend.drawing.overlay import MODELS, Overlay
from fiberbend.drawing.page import any_sign, literal, save
from fiberbend.drawing.style import DEFAULT, Style
from fiberbend.states.obstacles import Shape
from fiberbend.states.snapshot import Target, Write
from geometry.mesh.data import Floats

SMALL_ANGLE = 0.05
"""Degrees; a run that bends or twists less draws no picture of it."""
_MEASURED = "#111111"
_STYLES = dict(
    zip(
        MODELS,
        [("#2e7d32", "-"), ("#7b4fa3", "--"), ("#a8641a", "-."), ("#6b6b6b", ":")],
        strict=True,
    )
)
_CONTACTS = (BLUE, "#b8860b", "#2e7d32", "#7b4fa3", "#444444")
_SAME_ANGLE = 0.05
_LONG = 40
_TINY = 1e-6
_ALONG = 0.999
"""A force whose component is this part of it is one along that axis."""
_ANGLE = (col.PRESSURE, col.ANGLE)
_TWIST = (col.PRESSURE, col.TWIST)
_FORCE = (col.PRESSURE, col.TIP_FORCE)


@dataclasses.dataclass(frozen=True, eq=False)
class ContactForce:
    """Force of one obstacle on the body over the pressure.

    Attributes:
        name: of the obstacle.
        direction: along which axis it acts, such as " along −y"; empty for several axes.
        pressure: pressures, (n,), kPa.
        force: its magnitude in the plane of bending, (n,), N.
        parts: its components along y and z, (2, n), N.
        touch: index of the first state in touch; None where the body touches from the first state
            on, or never.
    """

    name: str
    direction: str
    pressure: Floats
    force: Floats
    parts: Floats
    touch: int | None

    @property
    def acts(self) -> bool:
        """The body touches the obstacle at all."""
        return bool((self.force > 0).any())


def contact_forces(rows: Sequence[col.Row]) -> list[ContactForce]:
    """Forces of all obstacles, and of strips that are kept in place, by the columns of a history.

    A roof and a tip that are kept in place by their strips have a force and no obstacle.
    """
    names, found = col.obstacles(rows), []
    for name in names:
        columns = (col.PRESSURE, col.contact(name, "y_N"), col.contact(name, "z_N"))
        if any(complete(row, columns) for row in rows):
            pressure, along_y, along_z = whole_rows(rows, columns)
            found.append(_contact(name, pressure, np.stack([along_y, along_z])))
    roof = (col.PRESSURE, col.ROOF_FORCE)
    if "roof" not in names and any(complete(row, roof) for row in rows):
        for name, column, sign in (("roof", col.ROOF_FORCE, -1.0), ("post", col.TIP_FORCE, 1.0)):
            pair = (col.PRESSURE, column)
            if any(complete(row, pair) for row in rows):
                pressure, force = whole_rows(rows, pair)
                kept = _contact(name, pressure, np.stack([sign * force, 0 * force]))
                # what is kept in place meets nothing
                found.append(dataclasses.replace(kept, touch=None))
    return found


def _contact(name: str, pressure: Floats, parts: Floats) -> ContactForce:
    force = np.hypot(*parts)
    direction = ""
    for part, axis in zip(parts, "yz", strict=True):
        sign = np.sign(part[np.abs(part).argmax()])
        if force.max() > 0 and (sign * part >= _ALONG * force).all():
            direction = f" along {'+' if sign > 0 else '−'}{axis}"
    touching = np.flatnonzero(force > 0)
    touch = int(touching[0]) if len(touching) and touching[0] > 0 else None
    return ContactForce(name, direction, pressure, force, parts, touch)


def plot_pressure_angle(
    rows: Sequence[col.Row],
    target: Target,
    angles: Sequence[float] = (),
    title: str = "",
    reason: str | None = None,
    overlay: Overlay | None = None,
    name: str = "",
    style: Style = DEFAULT,
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
        style: format, size and letters.

    Raises:
        ValueError: no row has both values.
    """
    data, across, shown = _along(rows, _ANGLE)
    marks = []
    for angle in angles:
        nearest = int(np.abs(data[1] - angle).argmin())
        if abs(data[1][nearest] - angle) <= _SAME_ANGLE:
            place = data[0][nearest]
            marks.append((f"{angle:g}° at {shown.format(place)}", place, angle))
    page, axes = new_axes(style, title, reason, across, "bending angle θ (°)")
    _curves(axes, data, overlay, name, marks, style)
    save(page, target, style)


def plot_twist(
    rows: Sequence[col.Row],
    target: Target,
    title: str = "",
    reason: str | None = None,
    style: Style = DEFAULT,
) -> None:
    """Twist of the sections about the centre-line against pressure; see `plot_pressure_angle`."""
    data, across, shown = _along(rows, _TWIST)
    page, axes = new_axes(style, title, reason, across, "twist (°)")
    end = (f"{data[1][-1]:.3g}° at {shown.format(data[0][-1])}", data[0][-1], data[1][-1])
    _curves(axes, data, None, "", [end], style)
    save(page, target, style)


def plot_tip_force(
    rows: Sequence[col.Row],
    target: Target,
    title: str = "",
    reason: str | None = None,
    overlay: Overlay | None = None,
    name: str = "",
    style: Style = DEFAULT,
) -> None:
    """Tip force of the whole body against pressure.

    Args:
        rows: rows of the history with pressure_kPa and tip_force_N.
        target: a path, or a file open for writing bytes.
        title: title of the case.
        reason: why the run ended early, or None.
        overlay: other models and measured points.
        name: of the run's own curve.
        style: format, size and letters.

    Raises:
        ValueError: no row has both values.
    """
    data = whole_rows(rows, _FORCE)
    page, axes = new_axes(style, title, reason, "pressure P (kPa)", "tip force (N)")
    pressure, force = data[0][-1], data[1][-1]
    end = (f"{force:.3g} N at {pressure:.1f} kPa", pressure, force)
    _curves(axes, data, overlay, name, [end], style)
    save(page, target, style)


def plot_contact_force(
    rows: Sequence[col.Row],
    target: Target,
    title: str = "",
    reason: str | None = None,
    style: Style = DEFAULT,
) -> None:
    """Force of every obstacle on the body against pressure, with the first step in touch marked.

    Args:
        rows: rows of the history with pressure_kPa and forces of obstacles.
        target: a path, or a file open for writing bytes.
        title: title of the case.
        reason: why the run ended early, or None.
        style: format, size and letters.

    Raises:
        ValueError: no obstacle has a force in any row.
    """
    forces = contact_forces(rows)
    if not forces:
        raise ValueError("no row of the history has the force of an obstacle")
    scale = style.scale
    page, axes = new_axes(style, title, reason, "pressure P (kPa)", "force on the actuator (N)")
    values = [0.0]
    for index, contact in enumerate(forces):
        color = _CONTACTS[index % len(_CONTACTS)]
        own = {"color": color, "linewidth": 1.8 * scale, "markersize": 4 * scale, "zorder": 3}
        several = "" if contact.direction or not contact.acts else ", whole force"
        never = "" if contact.acts else " (no touch)"
        label = literal(f"{contact.name}{contact.direction}{several}{never}")
        axes.plot(contact.pressure, contact.force, "o-", **own, clip_on=False, label=label)
        values.extend(contact.force)
        if several:
            for part, axis, dashes in zip(contact.parts, "yz", ("--", ":"), strict=True):
                text = literal(f"{contact.name} along {axis}")
                thin = {"color": color, "linewidth": 1.2 * scale, "zorder": 2}
                axes.plot(contact.pressure, part, dashes, **thin, label=text)
                values.extend(part)
    _limits(axes, np.concatenate([f.pressure for f in forces]), np.array(values))
    touches = [(f, f.touch) for f in forces if f.touch is not None]
    for contact, touch in touches:
        axes.plot(contact.pressure[touch], contact.force[touch], "o", color=RED, **_mark(style))
    fit(axes, style)
    free = Room(axes, style)
    legend(axes, style, free)
    for contact, touch in touches:
        text = f"{contact.name}: touches by {contact.pressure[touch]:.3g} kPa"
        free.write(text, contact.pressure[touch], contact.force[touch])
    for contact in forces:
        if contact.acts:
            text = f"{contact.force[-1]:.3g} N"
            free.write(text, contact.pressure[-1], contact.force[-1])
    save(page, target, style)


def draw_plots(
    rows: Sequence[col.Row],
    write: Write,
    angles: Sequence[float] = (),
    title: str = "",
    reason: str | None = None,
    beside_angles: Overlay | None = None,
    beside_forces: Overlay | None = None,
    name: str = "",
    obstacles: Mapping[str, Shape] | None = None,
    blocked: bool = False,
    style: Style = DEFAULT,
) -> list[str]:
    """Draw the curves that a run has: what it was made for comes first.

    They are pressure_angle.png, pressure_twist.png, tip_path.png, tip_force.png and
    contact_force.png, with another ending in another format.

    Args:
        rows: rows of the history; a plot whose columns are empty is not drawn, nor is one of an
            angle below `SMALL_ANGLE` or of a tip that does not move.
        write: writes a file, such as `RunFolder.write`.
        angles: requested angles in degrees.
        title: title of the case.
        reason: why the run ended early, or None.
        beside_angles: what is drawn beside the angle over the pressure.
        beside_forces: what is drawn beside the tip force over the pressure.
        name: of the run's own curve where others are beside it, such as "body model".
        obstacles: rigid bodies by their names, drawn beside the path of the tip.
        blocked: the actuator is kept straight, so that forces lead.
        style: format, size and letters.

    Returns:
        The names written, in order of importance.
    """
    angle = functools.partial(plot_pressure_angle, angles=angles, overlay=beside_angles, name=name)
    force = functools.partial(plot_tip_force, overlay=beside_forces, name=name)
    path = functools.partial(tip_path.plot_tip_path, obstacles=obstacles)
    plots: dict[str, tuple[Callable[..., None], bool]] = {
        "pressure_angle": (angle, _turns(rows, _ANGLE)),
        "pressure_twist": (plot_twist, _turns(rows, _TWIST)),
        "tip_force": (force, sum(complete(row, _FORCE) for row in rows) > 0),
        "contact_force": (plot_contact_force, any(f.acts for f in contact_forces(rows))),
        "tip_path": (path, tip_path.moves(rows)),
    }
    order = sorted(plots, key=lambda plot: blocked and not plot.endswith("force"))
    drawn = []
    for plot in order:
        draw, wanted = plots[plot]
        if wanted:
            file = f"{plot}.{style.format}"
            with any_sign():
                write(file, functools.partial(draw, rows, title=title, reason=reason, style=style))
            drawn.append(file)
    return drawn


def _turns(rows: Sequence[col.Row], columns: tuple[str, str]) -> bool:
    """Whether an angle is more than nothing anywhere."""
    found = [row for row in rows if complete(row, columns)]
    return any(abs(row[columns[1]]) > SMALL_ANGLE for row in found)


def _along(rows: Sequence[col.Row], columns: tuple[str, str]) -> tuple[list[Floats], str, str]:
    """A column over the pressure; over the load steps where other loads act at one pressure.

    Returns:
        Both columns, the name of the lower axis, and how a value of it is written.
    """
    data = whole_rows(rows, columns)
    steps = (col.STEP, columns[1])
    if np.ptp(data[0]) == 0 and all(complete(row, steps) for row in rows):
        return whole_rows(rows, steps), "load step", "step {:.0f}"
    return data, "pressure P (kPa)", "{:.1f} kPa"


def _curves(
    axes: Any,
    data: Sequence[Floats],
    overlay: Overlay | None,
    name: str,
    marks: Sequence[tuple[str, float, float]],
    style: Style,
) -> None:
    """Draw the run's curve, marks on it and what is beside it, with a legend; set the limits."""
    overlay, scale = overlay or Overlay(), style.scale
    own = {"color": BLUE, "markersize": 4 * scale, "linewidth": 1.8 * scale, "zorder": 3}
    axes.plot(*data, "o-", **own, clip_on=False, label=name or None)
    for line in overlay.lines:
        color, dashes = _STYLES[line.name]
        look = {"color": color, "linewidth": 1.1 * scale, "zorder": 2}
        axes.plot(line.across, line.up, dashes, **look, label=_shown(line.label))
    for points in overlay.points:
        text = points.label if len(points.label) <= _LONG else f"{points.label[:_LONG]}…"
        mark = {"color": _MEASURED, "markersize": 7 * scale, "zorder": 3.5}
        axes.plot(points.across, points.up, "x", **mark, label=literal(text))
    _limits(
        axes,
        np.concatenate([data[0], *(points.across for points in overlay.points)]),
        np.concatenate([data[1], *(points.up for points in overlay.points)]),
    )
    for _, across, up in marks:
        axes.plot(across, up, "o", color=RED, **_mark(style))
    fit(axes, style)
    free = Room(axes, style)
    if overlay.lines or overlay.points:
        legend(axes, style, free)
    for text, across, up in marks:
        free.write(text, across, up)


def _mark(style: Style) -> dict[str, Any]:
    return {"markersize": 9 * style.scale, "zorder": 4, "clip_on": False}


def _shown(label: str) -> str:
    """Signs as matplotlib sets them."""
    return label.replace("μ̄", r"$\bar{\mu}$").replace("L_f", "$L_f$")


def _limits(axes: Any, across: Floats, up: Floats) -> None:
    """Show the origin, all of these values, and room for labels."""
    for values, change in ((across, axes.set_xlim), (up, axes.set_ylim)):
        low, high = min(0.0, float(values.min())), max(0.0, float(values.max()))
        if low > -_TINY * (high - low):
            low = 0.0
        room = 0.12 * (high - low) or 1.0
        change(low - (room if low < 0 else 0), high + (room if high > 0 else 0))
