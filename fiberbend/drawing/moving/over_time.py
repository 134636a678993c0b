"""A motion over time: pressure, bending angle, height of the tip, and where its energy is."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.drawing.axes import BLUE, RED, heading, whole_rows
from fiberbend.drawing.page import figure, literal, save
from fiberbend.drawing.style import DEFAULT
from fiberbend.states.snapshot import Target
from geometry.mesh.data import Floats

SIZE = (1200, 1040)
"""Width and height in pixels."""
_ROWS = ((0.707, 0.144), (0.486, 0.187), (0.288, 0.163), (0.072, 0.183))
"""Bottom and height of pressure, angle, tip and energies on the page."""
_LINES = 3
"""Of names of events, one above the other."""
_GRAY = "0.45"
_ENERGIES = (
    (col.KINETIC, "kinetic", BLUE, "-"),
    (col.ELASTIC, "elastic", "#2e7d32", "-"),
    (col.POTENTIAL, "of weight and loads", "#7b4fa3", "-"),
    (col.AIR_WORK, "work of the air", "#b8860b", "--"),
    (col.LOADS_WORK, "work of other loads", "#444444", "--"),
    (col.DISSIPATED, "taken by damping", RED, "--"),
)
_SEEN = 1e-3
"""Part of the greatest energy below which one is not drawn."""


def plot_over_time(
    rows: Sequence[col.Row],
    target: Target,
    title: str = "",
    reason: str | None = None,
    events: Sequence[tuple[float, str]] = (),
    rest: float | None = None,
) -> None:
    """Draw a motion over time.

    Args:
        rows: of its history.
        target: a path, or a file open for writing bytes.
        title: title of the case.
        reason: why the run ended early, or None.
        events: times in s, and what happens then.
        rest: angle at which it would rest under the last pressure, °, or None.
    """
    page = figure(SIZE)
    heading(page, DEFAULT, textwrap.shorten(title, 90, placeholder=" …"), reason)
    time, pressure, angle, tip, speed = whole_rows(
        rows, (col.TIME, col.PRESSURE, col.ANGLE, col.TIP_Y, col.SPEED)
    )
    panels = [page.add_axes((0.09, low, 0.84, tall)) for low, tall in _ROWS]
    for axes, values, name in zip(
        panels,
        (pressure, angle, tip),
        ("pressure (kPa)", "bending angle (°)", "tip's height y (mm)"),
        strict=False,
    ):
        axes.plot(time, values, color=BLUE, linewidth=1.8)
        axes.set_ylabel(name, fontsize=12)
        axes.margins(y=0.16)
    greatest = int(np.argmax(np.abs(angle)))
    panels[1].plot(time[greatest], angle[greatest], "o", color=RED, markersize=6)
    late = time[greatest] > time[0] + 0.85 * (time[-1] - time[0])
    panels[1].annotate(
        f"{angle[greatest]:.4g}° at {time[greatest]:.4g} s",
        (time[greatest], angle[greatest]),
        xytext=(-8 if late else 8, 3),
        textcoords="offset points",
        ha="right" if late else "left",
        va="bottom",
        fontsize=11,
        color=RED,
    )
    if rest is not None:
        panels[1].axhline(rest, color=_GRAY, linewidth=1.0, linestyle=":")
    other = panels[2].twinx()
    other.plot(time, speed / 1e3, color="#b8860b", linewidth=1.1)
    other.set_ylabel("its speed (m/s)", fontsize=12, color="#b8860b")
    other.tick_params(labelsize=11)
    other.spines[["top", "left"]].set_visible(False)
    _energies(panels[3], rows, time)
    panels[3].set_xlabel("time (s)", fontsize=12)
    for axes in panels:
        for when, _ in events:
            axes.axvline(when, color=_GRAY, linewidth=0.9, linestyle="--")
        axes.set_xlim(time[0], time[-1])
        axes.tick_params(labelsize=11, labelbottom=axes is panels[3])
        axes.grid(color="0.92")
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    _written(panels[0], events)
    save(page, target)


def _energies(axes: Any, rows: Sequence[Mapping[str, Any]], time: Floats) -> None:
    known = [whole_rows(rows, (key,))[0] for key, *_ in _ENERGIES]
    most = max(float(np.abs(values).max()) for values in known)
    for values, (_, name, color, line) in zip(known, _ENERGIES, strict=True):
        if np.abs(values).max() > _SEEN * most:
            axes.plot(time, values, line, color=color, linewidth=1.5, label=name)
    axes.axhline(0.0, color=_GRAY, linewidth=0.8)
    axes.set_ylabel("energy (mJ)", fontsize=12)
    axes.legend(
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=6,
        fontsize=10.5,
        frameon=False,
        handlelength=1.6,
        columnspacing=1.2,
    )


def _written(axes: Any, events: Sequence[tuple[float, str]]) -> None:
    """Names of the events over the first panel, on the lowest line that has room.

    Where none has, an event is counted in the name before it.
    """
    page, free = axes.figure, [-np.inf] * _LINES
    name: Any = None
    first, line, more = "", 0, 0
    for when, text in events:
        place = float(axes.transData.transform((when, 0.0))[0])
        new = axes.annotate(
            _counted(text, 99),
            (when, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(2, 3),
            textcoords="offset points",
            fontsize=9.5,
            color=_GRAY,
        )
        width = new.get_window_extent().width + 0.01 * page.bbox.width
        # on the other side of its dashes where the page ends
        left = place + width > page.bbox.width
        begin = place - width if left else place
        found = next((n for n, end in enumerate(free) if end <= begin), None)
        if found is None:
            new.remove()
            more += 1
        else:
            name, first, line, more = new, text, found, 0
            name.set_ha("right" if left else "left")
            name.set_position((-2 if left else 2, 3 + 12 * line))
        name.set_text(_counted(first, more))
        # a name that is counted on grows
        free[line] = name.get_window_extent().x1 + 0.005 * page.bbox.width


def _counted(text: str, more: int) -> str:
    return literal(text) + (f" and {more} more" if more else "")
