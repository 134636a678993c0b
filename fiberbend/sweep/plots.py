"""Pictures of a sweep: maps where its points fill a grid, curves along each field elsewhere."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import figure, literal, save
from fiberbend.states.snapshot import Target, Write
from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.maps import (
    PANELS,
    axis_label,
    head,
    limits_of,
    map_page,
    outcome,
    spread,
    wrapped,
)
from fiberbend.sweep.quantities import ReportedQuantity, TableRow
from fiberbend.sweep.store import NOT_RUN
from fiberbend.sweep.trends import Group, described, groups

_COLORS = ("#1f5a99", "#c0392b", "#2e8b57", "#8e5ea2", "#b8860b", "#444444")
_MARKS = "osD^vPX"
_STROKES = ("-", "--", ":", "-.")
_PANEL = (520, 440)
_LINE = 22
"""Height of a line of a legend, pixels."""
_COLUMN = 4
"""Names in a column before there is a second one."""
_NAMED = 8
"""So many groups at most are named in a panel, the largest."""


def draw(
    title: str,
    columns: Sequence[VariedField],
    rows: Sequence[TableRow],
    quantities: Sequence[ReportedQuantity],
    write: Write,
) -> dict[str, list[str]]:
    """Draw quantities of a sweep.

    Args:
        title: title of the sweep.
        columns: the varied fields.
        rows: the table of the sweep.
        quantities: what to draw.
        write: writes a file, such as `RunFolder.write`.

    Returns:
        The files written of each quantity, by its name.
    """
    varied = [column for column in columns if column.numeric and len({*column.values}) > 1]
    written: dict[str, list[str]] = {}
    for quantity in quantities if varied else ():
        if len(varied) > 1 and _full(columns, varied, rows):
            names = _draw_maps(title, columns, varied[:2], rows, quantity, write)
        else:
            names = [f"{quantity.name}.png"]
            fill = functools.partial(_curves, title, columns, varied, rows, quantity)
            write(names[0], fill)
        written[quantity.name] = names
    return written


def _full(
    columns: Sequence[VariedField], varied: Sequence[VariedField], rows: Sequence[TableRow]
) -> bool:
    """The points fill the grid of the first two fields for every combination of the others."""
    cells = len({*varied[0].values}) * len({*varied[1].values})
    rest = [column for column in columns if column not in varied[:2]]
    return len(rows) == cells * len({tuple(row[column.name] for column in rest) for row in rows})


def _draw_maps(
    title: str,
    columns: Sequence[VariedField],
    axes: Sequence[VariedField],
    rows: Sequence[TableRow],
    quantity: ReportedQuantity,
    write: Write,
) -> list[str]:
    rest = [column for column in columns if column not in axes]
    panels: dict[str, list[TableRow]] = {}
    for row in rows:
        caption = ", ".join(described(column, row[column.name]) for column in rest)
        panels.setdefault(caption, []).append(row)
    limits = {caption: limits_of(rows, name) for caption, name in quantity.lines.items()}
    captions = list(panels)
    names = []
    for first in range(0, len(captions), PANELS):
        part = {caption: panels[caption] for caption in captions[first : first + PANELS]}
        number = f"_{first // PANELS + 1}" if len(captions) > PANELS else ""
        names.append(f"{quantity.name}{number}.png")
        write(
            names[-1],
            functools.partial(map_page, title, axes, part, quantity, limits),
        )
    return names


def _curves(
    title: str,
    columns: Sequence[VariedField],
    varied: Sequence[VariedField],
    rows: Sequence[TableRow],
    quantity: ReportedQuantity,
    target: Target,
) -> None:
    """A panel for each field, a curve for each group of points that differ in it alone."""
    panels = {column.label: (column, groups(columns, rows, column)) for column in varied}
    shown = [(column, found) for column, found in panels.values() if found]
    if not shown:
        shown = [(varied[0], [Group("", *_sorted(rows, varied[0]))])]
    several = len(columns) > 1
    most = max(min(len(found), _NAMED + 1) for _, found in shown) if several else 0
    named = _LINE * math.ceil(most / _columns(most)) + 14
    width = max(_PANEL[0] * len(shown) + 60, 860)
    remark = wrapped(quantity.remark, width)
    legend = _LINE * len(quantity.lines) + 22
    foot = named + legend + _LINE * len(remark)
    height = 92 + _PANEL[1] + 64 + foot
    page = figure((width, height))
    head(page, title, quantity.label)
    every = [row[name] for row in rows for name in quantity.lines.values()]
    known = np.array([value for value in every if value is not None], dtype=float)
    step = (width - 60) / len(shown)
    for i, (column, found) in enumerate(shown):
        left = 84 + i * step
        axis = page.add_axes(
            (
                left / width,
                (foot + 64) / height,
                (step - 58) / width,
                _PANEL[1] / height,
            )
        )
        _panel(axis, found, quantity)
        axis.set_ylim(*spread(known))
        axis.set_xlabel(axis_label(column), fontsize=13)
        if i == 0:
            axis.set_ylabel(literal(quantity.axis), fontsize=13)
        if several:
            _name_groups(page, found, (left / width, (foot + 10) / height))
    for i, line in enumerate(reversed(remark)):
        down = (legend + _LINE * i) / height
        page.text(0.5, down, literal(line), ha="center", va="bottom", fontsize=11)
    _legend(page, quantity, any(_lost(row, quantity) for row in rows), height)
    save(page, target)


def _lost(row: TableRow, quantity: ReportedQuantity) -> bool:
    """Whether a point was run and has no value."""
    return row.get(quantity.column) is None and outcome(row) != NOT_RUN


def _legend(page: Any, quantity: ReportedQuantity, lost: bool, height: int) -> None:
    """What full and broken lines are, below everything else."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color="0.25", linestyle=_STROKES[n % len(_STROKES)], label=literal(caption))
        for n, caption in enumerate(quantity.lines)
    ]
    if lost:
        handles.append(
            Line2D([], [], color="0.25", marker="x", linestyle="", label="failed or not reached")
        )
    page.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=(0.5, 6 / height),
        ncols=2 if len(handles) > 2 else len(handles),
        fontsize=12,
        frameon=False,
    )


def _name_groups(page: Any, found: Sequence[Group], corner: tuple[float, float]) -> None:
    """What the colours of a panel are, below it; `corner` is its upper left."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D(
            [],
            [],
            color=_COLORS[g % len(_COLORS)],
            marker=_MARKS[g % len(_MARKS)],
            linestyle="",
            markersize=7,
            label=literal(group.shared),
        )
        for g, group in enumerate(found[:_NAMED])
    ]
    if len(found) > _NAMED:
        handles.append(Line2D([], [], linestyle="", label=f"and {len(found) - _NAMED} more"))
    page.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=corner,
        ncols=_columns(len(handles)),
        fontsize=11,
        frameon=False,
        handletextpad=0.2,
    )


def _columns(names: int) -> int:
    """Columns of the names below a panel."""
    return 2 if names > _COLUMN else 1


def _panel(axis: Any, found: Sequence[Group], quantity: ReportedQuantity) -> None:
    for g, group in enumerate(found):
        color = _COLORS[g % len(_COLORS)]
        for n, name in enumerate(quantity.lines.values()):
            axis.plot(
                group.x,
                group.values(name),
                linestyle=_STROKES[n % len(_STROKES)],
                marker=_MARKS[g % len(_MARKS)] if n == 0 else None,
                color=color,
                linewidth=1.8,
                markersize=7,
            )
        lost = [x for x, row in zip(group.x, group.rows, strict=True) if _lost(row, quantity)]
        # at the foot of the panel: a point that failed has no height
        axis.plot(
            lost,
            [0.03] * len(lost),
            transform=axis.get_xaxis_transform(),
            linestyle="",
            marker="x",
            color=color,
            markersize=9,
            markeredgewidth=2,
        )
    marks = np.unique(np.concatenate([group.x for group in found]))
    if len(marks) <= 8:
        axis.set_xticks(marks, [f"{mark:g}" for mark in marks])
    axis.set_xlim(*spread(marks))
    axis.tick_params(labelsize=11)
    axis.grid(color="0.9")
    axis.spines[["top", "right"]].set_visible(False)


def _sorted(rows: Sequence[TableRow], column: VariedField) -> tuple[Any, tuple[TableRow, ...]]:
    ordered = sorted(rows, key=lambda row: float(row[column.name]))
    return np.array([row[column.name] for row in ordered], dtype=float), tuple(ordered)
