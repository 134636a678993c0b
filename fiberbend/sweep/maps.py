"""Maps of a sweep over its first two fields, the analytical model beside them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import colormap, figure, fit, literal, save
from fiberbend.states.snapshot import Target
from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.quantities import FAILED, ReportedQuantity, TableRow
from fiberbend.sweep.store import NOT_RUN
from fiberbend.sweep.trends import in_words
from geometry.mesh.data import Floats

_REMARK, _LETTER = 18, 7.6
"""Height of a line of a remark, and width of a letter of it, pixels."""
PANELS = 4
"""Most panels side by side on a page."""
_PANEL, _ALONE = 400, 320
"""Width of a panel on a page of several, and of one that has the page's lines beside each other."""
_CELL, _LEAST, _MOST = 68, 160, 300
"""Height of a row of cells, and the least and the greatest height of a panel."""
_LEFT, _BAR = 92, 150
_TOP, _BOTTOM = 92, 44
_HEAD, _FOOT = 66, 66
_MOST_LABELS = 12
"""More values of a field than this are drawn with contours instead of a number in each cell."""
LATER = "failed later"
"""What a map says of a point that failed beyond a state that it has reached."""
_LEVEL = 1e-6
"""A relative spread below which a map is level."""
_EMPTY = {
    FAILED: ("#f6dcd7", "////", "#a5402d"),
    LATER: ("none", "//", "#a5402d"),
    "not reached": ("#e4e4e4", "....", "#808080"),
    NOT_RUN: ("#f4f4f4", "", "#808080"),
}
"""Face, hatch and edge of a point without a value, by what became of it."""


def map_page(
    title: str,
    axes: Sequence[VariedField],
    panels: Mapping[str, Sequence[TableRow]],
    quantity: ReportedQuantity,
    limits: Mapping[str, tuple[float, float]],
    target: Target,
) -> None:
    """A page of maps: a column for each panel, a row with its own colour scale for each line.

    The lines of a single panel are beside each other.

    Args:
        title: text at the top.
        axes: the fields across and up.
        panels: the points of each panel, by its caption; at most `PANELS`.
        quantity: what is drawn; each of its lines is a row of maps.
        limits: values at the ends of the colour scale of each line, by its caption.
        target: a path, or a file open for writing bytes.
    """
    lines, alone = list(quantity.lines.items()), len(panels) == 1
    ups = {row[axes[1].name] for rows in panels.values() for row in rows}
    tall = min(max(_CELL * len(ups), _LEAST), _MOST)
    wide = _ALONE if alone else _PANEL
    across = wide * len(panels)
    step = (across + _BAR, 0) if alone else (0, tall + _HEAD + _FOOT)
    width = max(_LEFT + across + _BAR + step[0] * (len(lines) - 1), 720)
    remark = wrapped(quantity.remark, width)
    foot = _BOTTOM + _REMARK * len(remark)
    height = _TOP + _HEAD + tall + _FOOT + step[1] * (len(lines) - 1) + foot
    page = figure((width, height))
    head(page, title, quantity.label)
    start = _LEFT + (width - _LEFT - across - _BAR - step[0] * (len(lines) - 1)) / 2
    unlike: set[str] = set()
    decimals = _decimals(*next(iter(limits.values())))
    for i, (caption, name) in enumerate(lines):
        left, top, scale = start + i * step[0], height - _TOP - i * step[1], limits[caption]
        bottom = top - _HEAD - tall
        named = page.text(
            left / width,
            (top - 18) / height,
            literal(caption),
            va="center",
            fontsize=14,
            weight="bold",
        )
        fit(named, across + _BAR - 24)
        for j, (panel, rows) in enumerate(panels.items()):
            corner = (left + j * wide, bottom)
            axis = page.add_axes(_box(corner, (wide - 22, tall), (width, height)))
            own = name == quantity.column
            unlike |= _map(axis, axes, rows, name, scale, decimals, own)
            axis.set_title(literal(panel), fontsize=12.5)
            axis.set_xlabel(axis_label(axes[0]), fontsize=13)
            if j == 0 and (i == 0 or not alone):
                axis.set_ylabel(axis_label(axes[1]), fontsize=13)
            else:
                axis.tick_params(labelleft=False)
        box = _box((left + across + 8, bottom), (16, tall), (width, height))
        _color_bar(page, box, scale, quantity.axis)
    _legend(page, sorted(unlike), height)
    for i, line in enumerate(reversed(remark)):
        down = (_BOTTOM + _REMARK * i) / height
        page.text(0.5, down, literal(line), ha="center", va="bottom", fontsize=11)
    save(page, target)


def head(page: Any, title: str, label: str) -> None:
    """The title of a sweep above the name of a quantity, in letters that fit the page.

    Args:
        page: a figure of matplotlib.
        title: of the sweep.
        label: of the quantity.
    """
    width, height = page.get_size_inches() * page.dpi
    for text, down, size in ((title, 30, 17), (label, 62, 15)):
        shown = page.text(
            0.5, 1 - down / height, literal(text), ha="center", va="center", fontsize=size
        )
        fit(shown, 0.96 * width)


def wrapped(text: str, width: int) -> list[str]:
    """A remark in lines for a page of a width in pixels."""
    return textwrap.wrap(text, min(int(width / _LETTER), 110))


def limits_of(rows: Sequence[TableRow], name: str) -> tuple[float, float]:
    """Least and greatest value in a column, never the same."""
    values = [float(row[name]) for row in rows if row.get(name) is not None]
    low, high = min(values), max(values)
    room = 0.05 * abs(low) or 0.5
    return (low, high) if high - low > _LEVEL * abs(high) else (low - room, high + room)


def axis_label(column: VariedField) -> str:
    """A field as the label of an axis."""
    return literal(in_words(column) + (f" ({column.unit})" if column.unit else ""))


def _box(
    corner: tuple[float, float], size: tuple[float, float], page: tuple[int, int]
) -> tuple[float, float, float, float]:
    return corner[0] / page[0], corner[1] / page[1], size[0] / page[0], size[1] / page[1]


def _map(
    axis: Any,
    axes: Sequence[VariedField],
    rows: Sequence[TableRow],
    name: str,
    limits: tuple[float, float],
    decimals: int,
    own: bool,
) -> set[str]:
    """Draw a map; returns what became of the points that have no value, or failed later.

    Args:
        axis: where.
        axes: the fields across and up.
        rows: the points.
        name: column of the values.
        limits: values at the ends of the colour scale.
        decimals: of the numbers in the cells.
        own: the values are the runs' own, which a failure concerns.
    """
    x, y = (np.unique(np.array([row[c.name] for row in rows], dtype=float)) for c in axes)
    values = np.full((len(y), len(x)), np.nan)
    labelled = max(len(x), len(y)) <= _MOST_LABELS
    unlike = set()
    for row in rows:
        place = (
            int(np.searchsorted(y, row[axes[1].name])),
            int(np.searchsorted(x, row[axes[0].name])),
        )
        value = row.get(name)
        what = outcome(row) if value is None else ""
        if value is not None:
            values[place] = value
            what = LATER if own and row["status"] == FAILED else ""
        if what:
            unlike.add(what)
            axis.add_patch(_patch(what, (place[1], place[0])))
        if labelled:
            number = "" if value is None else f"{value:.{decimals}f}"
            share = None if value is None else (value - limits[0]) / (limits[1] - limits[0])
            text = "\n".join(part for part in (number, what) if part)
            _write_in(axis, (place[1] + 0.5, place[0] + 0.5), text, share, boxed=bool(what))
    axis.pcolormesh(
        np.ma.masked_invalid(values),
        cmap=colormap(),
        vmin=limits[0],
        vmax=limits[1],
        edgecolors="white" if labelled else "none",
        linewidth=1.5 if labelled else 0,
    )
    if not labelled:
        _contours(axis, values, limits)
    for marks, ticks in ((x, axis.set_xticks), (y, axis.set_yticks)):
        every = 1 + (len(marks) - 1) // _MOST_LABELS
        ticks(np.arange(len(marks))[::every] + 0.5, [f"{mark:g}" for mark in marks[::every]])
    axis.set(xlim=(0, len(x)), ylim=(0, len(y)))
    axis.tick_params(labelsize=11.5, length=0)
    for spine in axis.spines.values():
        spine.set_visible(False)
    return unlike


def _write_in(
    axis: Any, middle: tuple[float, float], text: str, share: float | None, boxed: bool
) -> None:
    """Write into a cell: black or white on its colour, and on a plain box where it is hatched.

    Args:
        axis: where.
        middle: of the cell.
        text: what.
        share: place of its value on the colour scale, None without one.
        boxed: the cell is hatched.
    """
    face = "white" if share is None else colormap()(float(np.clip(share, 0.0, 1.0)))
    axis.text(
        *middle,
        text,
        ha="center",
        va="center",
        fontsize=10 if boxed else 12.5,
        color="#404040" if share is None else "white" if _dark(share) else "black",
        bbox={"facecolor": face, "edgecolor": "none", "pad": 2} if boxed else None,
    )


def _decimals(low: float, high: float) -> int:
    """So many that values between two have three digits and differ."""
    return max(0, 2 - math.floor(math.log10(min(high - low, max(abs(low), (high - low) / 10)))))


def _contours(axis: Any, values: Floats, limits: tuple[float, float]) -> None:
    """Lines of equal value, none across a point that has no value."""
    from matplotlib.ticker import MaxNLocator

    if min(values.shape) < 2 or np.isnan(values).all():
        return
    middle = (np.arange(values.shape[1]) + 0.5, np.arange(values.shape[0]) + 0.5)
    levels = MaxNLocator(8).tick_values(*limits)
    known = np.ma.masked_invalid(values)
    curves = axis.contour(*middle, known, levels=levels, colors="black", linewidths=0.8)
    axis.clabel(curves, fontsize=10)


def outcome(row: TableRow) -> str:
    """What became of a point that has no value."""
    status = row["status"]
    return status if status in (FAILED, NOT_RUN) else "not reached"


def _patch(what: str, corner: tuple[float, float]) -> Any:
    """A cell without a value."""
    from matplotlib.patches import Rectangle

    face, hatch, edge = _EMPTY[what]
    order = 2 if what == LATER else 0
    return Rectangle(
        corner, 1, 1, facecolor=face, hatch=hatch, edgecolor=edge, linewidth=0, zorder=order
    )


def _legend(page: Any, empty: Sequence[str], height: int) -> None:
    """What hatched cells are, at the foot of the page."""
    if not empty:
        return
    from matplotlib.patches import Patch

    handles = []
    for what in empty:
        face, hatch, edge = _EMPTY[what]
        handles.append(Patch(facecolor=face, hatch=hatch, edgecolor=edge, linewidth=0, label=what))
    page.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=(0.5, 8 / height),
        ncols=len(handles),
        fontsize=12,
        frameon=False,
        handlelength=2.4,
        handleheight=1.4,
    )


def _dark(share: float) -> bool:
    """Whether white is easier to read than black on a colour of the map."""
    red, green, blue, _ = colormap()(float(np.clip(share, 0.0, 1.0)))
    return bool(0.299 * red + 0.587 * green + 0.114 * blue < 0.5)


def _color_bar(
    page: Any, box: tuple[float, float, float, float], limits: tuple[float, float], label: str
) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    axis = page.add_axes(box)
    bar = page.colorbar(ScalarMappable(Normalize(*limits), colormap()), cax=axis)
    bar.ax.tick_params(labelsize=11.5)
    bar.outline.set_visible(False)
    bar.set_label(literal(label), fontsize=12.5)


def spread(values: Floats) -> tuple[float, float]:
    """Limits of an axis that leave room at both ends of some values."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = 0.08 * (high - low) or 0.08 * abs(high) or 1.0
    return low - room, high + room
