"""Maps of a sweep over its first two fields, the analytical model beside them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import colormap, figure, literal, save
from fiberbend.states.snapshot import Target
from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.table import TableRow
from fiberbend.sweep.trends import in_words
from geometry.mesh.data import Floats

PANELS = 4
"""Most panels side by side on a page."""
_PANEL = (400, 300)
_MARGIN = (92, 24)
_TOP, _BOTTOM = 64, 150
_HEAD, _FOOT = 70, 34
_MOST_LABELS = 12
"""More values of a field than this are drawn with contours instead of a number in each cell."""


def map_page(
    title: str,
    axes: Sequence[VariedField],
    panels: Mapping[str, Sequence[TableRow]],
    lines: Mapping[str, str],
    limits: tuple[float, float],
    label: str,
    target: Target,
) -> None:
    """A page of maps: a column for each panel, a row for each line.

    Args:
        title: text at the top.
        axes: the fields across and up.
        panels: the points of each panel, by its caption; at most `PANELS`.
        lines: the column of the table for each row of maps, by its caption.
        limits: values at the ends of the colour map.
        label: name of the quantity, with its unit.
        target: a path, or a file open for writing bytes.
    """
    across = len(panels) * _PANEL[0]
    width = max(sum(_MARGIN) + across, 720)
    height = _TOP + len(lines) * (_PANEL[1] + _HEAD + _FOOT) + _BOTTOM
    page = figure((width, height))
    page.text(0.5, 1 - 34 / height, literal(title), ha="center", va="center", fontsize=17)
    left = (width - across + _MARGIN[0] - _MARGIN[1]) / 2
    for i, (caption, name) in enumerate(lines.items()):
        top = height - _TOP - i * (_PANEL[1] + _HEAD + _FOOT)
        page.text(
            left / width, (top - 18) / height, caption, va="center", fontsize=14, weight="bold"
        )
        for j, (panel, rows) in enumerate(panels.items()):
            corner = (left + j * _PANEL[0], top - _HEAD - _PANEL[1])
            axis = page.add_axes(_box(corner, (_PANEL[0] - 22, _PANEL[1]), (width, height)))
            _map(axis, axes, rows, name, limits)
            axis.set_title(literal(panel), fontsize=12.5)
            if i == len(lines) - 1:
                axis.set_xlabel(axis_label(axes[0]), fontsize=13)
            if j == 0:
                axis.set_ylabel(axis_label(axes[1]), fontsize=13)
            else:
                axis.tick_params(labelleft=False)
    _color_bar(page, (width, height), limits, label)
    save(page, target)


def limits_of(rows: Sequence[TableRow], names: Sequence[str]) -> tuple[float, float]:
    """Least and greatest value in some columns, never the same."""
    values = [float(row[name]) for row in rows for name in names if row.get(name) is not None]
    low, high = min(values), max(values)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


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
) -> None:
    from matplotlib.ticker import MaxNLocator

    x, y = (np.unique(np.array(column.values, dtype=float)) for column in axes)
    values = np.full((len(y), len(x)), np.nan)
    labelled = max(len(x), len(y)) <= _MOST_LABELS
    # three digits of the range, and none of the whole numbers left out
    decimals = max(0, 2 - math.floor(math.log10(limits[1] - limits[0])))
    axis.set_facecolor("#ececec")
    for row in rows:
        place = tuple(
            int(np.searchsorted(marks, row[column.name]))
            for marks, column in ((y, axes[1]), (x, axes[0]))
        )
        if row.get(name) is not None:
            values[place] = row[name]
        if labelled:
            known = np.isfinite(values[place])
            share = (values[place] - limits[0]) / (limits[1] - limits[0]) if known else 1.0
            axis.text(
                place[1] + 0.5,
                place[0] + 0.5,
                f"{values[place]:.{decimals}f}" if known else row["status"],
                ha="center",
                va="center",
                fontsize=12.5 if known else 10,
                color="white" if _dark(share) else "black",
            )
    axis.pcolormesh(
        np.ma.masked_invalid(values),
        cmap=colormap(),
        vmin=limits[0],
        vmax=limits[1],
        edgecolors="white" if labelled else "none",
        linewidth=1.5 if labelled else 0,
    )
    if not labelled and np.isfinite(values).all():
        middle = (np.arange(len(x)) + 0.5, np.arange(len(y)) + 0.5)
        levels = MaxNLocator(8).tick_values(*limits)
        curves = axis.contour(*middle, values, levels=levels, colors="black", linewidths=0.8)
        axis.clabel(curves, fontsize=10)
    for marks, ticks in ((x, axis.set_xticks), (y, axis.set_yticks)):
        every = 1 + (len(marks) - 1) // _MOST_LABELS
        ticks(np.arange(len(marks))[::every] + 0.5, [f"{mark:g}" for mark in marks[::every]])
    axis.tick_params(labelsize=11.5, length=0)
    for spine in axis.spines.values():
        spine.set_visible(False)


def _dark(share: float) -> bool:
    """Whether white is easier to read than black on a colour of the map."""
    red, green, blue, _ = colormap()(float(np.clip(share, 0.0, 1.0)))
    return bool(0.299 * red + 0.587 * green + 0.114 * blue < 0.5)


def _color_bar(page: Any, size: tuple[int, int], limits: tuple[float, float], label: str) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    axis = page.add_axes(_box((0.28 * size[0], 62), (0.44 * size[0], 16), size))
    bar = page.colorbar(
        ScalarMappable(Normalize(*limits), colormap()), cax=axis, orientation="horizontal"
    )
    bar.ax.tick_params(labelsize=12)
    bar.outline.set_visible(False)
    bar.set_label(label, fontsize=13)


def spread(values: Floats) -> tuple[float, float]:
    """Limits of an axis that leave room at both ends of some values."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = 0.08 * (high - low) or 0.08 * abs(high) or 1.0
    return low - room, high + room
