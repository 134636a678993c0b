"""Pictures of a sweep: maps where its points fill a grid, curves along each field elsewhere."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import figure, literal, save
from fiberbend.states.snapshot import Target, Write
from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.maps import (
    PANELS,
    axis_label,
    limits_of,
    map_page,
    spread,
)
from fiberbend.sweep.table import ReportedQuantity, TableRow
from fiberbend.sweep.trends import Group, described, groups

_COLORS = ("#1f5a99", "#c0392b", "#2e8b57", "#8e5ea2", "#b8860b", "#444444")
_MARKS = "osD^vP"
_STROKES = ("-", "--", ":", "-.")
_NAMED = 8
"""So many groups at most are named in a panel, the largest."""


def draw(
    title: str,
    columns: Sequence[VariedField],
    rows: Sequence[TableRow],
    quantities: Sequence[ReportedQuantity],
    write: Write,
) -> list[str]:
    """Draw quantities of a sweep.

    Args:
        title: title of the sweep.
        columns: the varied fields.
        rows: the table of the sweep.
        quantities: what to draw.
        write: writes a file, such as `RunFolder.write`.

    Returns:
        The names written.
    """
    varied = [column for column in columns if column.numeric and len({*column.values}) > 1]
    written: list[str] = []
    for quantity in quantities if varied else ():
        if len(varied) > 1 and _full(columns, varied, rows):
            written += _draw_maps(title, columns, varied[:2], rows, quantity, write)
        else:
            write(
                f"{quantity.name}.png",
                functools.partial(_curves, title, columns, varied, rows, quantity),
            )
            written.append(f"{quantity.name}.png")
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
    limits = limits_of(rows, list(quantity.lines.values()))
    captions = list(panels)
    names = []
    for first in range(0, len(captions), PANELS):
        part = {caption: panels[caption] for caption in captions[first : first + PANELS]}
        number = f"_{first // PANELS + 1}" if len(captions) > PANELS else ""
        names.append(f"{quantity.name}{number}.png")
        write(
            names[-1],
            functools.partial(map_page, title, axes, part, quantity.lines, limits, quantity.axis),
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
    width, height = max(520 * len(shown) + 60, 860), 640
    page = figure((width, height))
    page.text(0.5, 1 - 30 / height, literal(title), ha="center", va="center", fontsize=17)
    every = [row[name] for row in rows for name in quantity.lines.values()]
    known = np.array([value for value in every if value is not None], dtype=float)
    step = (width - 60) / len(shown)
    for i, (column, found) in enumerate(shown):
        axis = page.add_axes(
            (
                (78 + i * step) / width,
                112 / height,
                (step - 58) / width,
                (height - 112 - 72) / height,
            )
        )
        _panel(axis, found, quantity, several=len(columns) > 1)
        axis.set_ylim(*spread(known))
        axis.set_xlabel(axis_label(column), fontsize=13)
        if i == 0:
            axis.set_ylabel(quantity.axis, fontsize=13)
    _legend(page, quantity, height)
    save(page, target)


def _legend(page: Any, quantity: ReportedQuantity, height: int) -> None:
    """What full and broken lines are, below the panels."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color="0.25", linestyle=_STROKES[n % len(_STROKES)], label=caption)
        for n, caption in enumerate(quantity.lines)
    ]
    page.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=(0.5, 8 / height),
        ncols=len(handles),
        fontsize=12,
        frameon=False,
    )


def _panel(axis: Any, found: Sequence[Group], quantity: ReportedQuantity, several: bool) -> None:
    from matplotlib.lines import Line2D

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
    if several:
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
        axis.legend(handles=handles, fontsize=11, frameon=False, handletextpad=0.2)
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
