"""What is drawn beside the curve of a run, and curves of several runs in one figure."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fiberbend.drawing.axes import Room, fit, legend, new_axes
from fiberbend.drawing.page import any_sign, literal
from fiberbend.drawing.style import Style
from geometry.mesh.data import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODELS = ("section", "analytic", "analytic_winding", "analytic_paper")
"""Models that can stand beside a run, as columns of the history and run.json call them."""
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
"""Told apart by all eyes, after M. Okabe and K. Ito."""
_DASHES = ("-", "--", "-.", ":")
_MARKS = "xv+^*"
_DOTTED = 12
"""Load steps of a curve that are still shown as dots."""
_LABEL, _TAIL = 60, 32
"""The most letters of a label, and those of its end."""


@dataclasses.dataclass(frozen=True, eq=False)
class Line:
    """Curve of another model.

    Attributes:
        name: of the model, which always has the same colour; a key of `MODELS`.
        label: what is written beside the curve.
        across: pressures, (n,), kPa.
        up: bending angles in degrees, or tip forces in N, (n,).
    """

    name: str
    label: str
    across: Floats
    up: Floats


@dataclasses.dataclass(frozen=True, eq=False)
class Points:
    """Measured points.

    Attributes:
        label: their name.
        across: pressures, (n,), kPa.
        up: bending angles in degrees, or tip forces in N, (n,).
    """

    label: str
    across: Floats
    up: Floats


@dataclasses.dataclass(frozen=True)
class Overlay:
    """All that is drawn beside one curve.

    Attributes:
        lines: curves of other models.
        points: measured points.
    """

    lines: tuple[Line, ...] = ()
    points: tuple[Points, ...] = ()


@dataclasses.dataclass(frozen=True)
class Curve:
    """A curve of a figure, or measured points.

    Attributes:
        label: its name in the legend.
        across: values along the lower axis.
        up: values along the left axis, as many.
        measured: single points that no line joins.
    """

    label: str
    across: Sequence[float]
    up: Sequence[float]
    measured: bool = False


def draw_overlay(curves: Sequence[Curve], across: str, up: str, style: Style) -> Figure:
    """Several curves in one figure, with a legend where there are two or more.

    Args:
        curves: at least one, each with at least one point.
        across: name of the lower axis, with its unit.
        up: name of the left axis, with its unit.
        style: of the page; one without a height grows where the legend needs it.

    Returns:
        The matplotlib figure.

    Raises:
        NoRoomError: the page is too small for its text.
    """
    with any_sign():
        return _overlay(curves, across, up, style)


def _overlay(curves: Sequence[Curve], across: str, up: str, style: Style) -> Figure:
    scale = style.scale
    page, axes = new_axes(style, "", None, literal(across), literal(up))
    names = _names([curve.label for curve in curves])
    curves = [dataclasses.replace(c, label=name) for c, name in zip(curves, names, strict=True)]
    runs = [curve for curve in curves if not curve.measured]
    points = [curve for curve in curves if curve.measured]
    for index, curve in enumerate(runs):
        look = {"color": _COLORS[index % len(_COLORS)], "linewidth": 1.8 * scale, "zorder": 3}
        # where colours come again, the strokes are others
        dashes = _DASHES[(index % len(_COLORS) + index // len(_COLORS)) % len(_DASHES)]
        dots = {"marker": "o", "markersize": 4 * scale} if len(curve.up) <= _DOTTED else {}
        axes.plot(curve.across, curve.up, dashes, **look, **dots, label=curve.label)
    for index, curve in enumerate(points):
        mark = {"color": "black", "markersize": 7 * scale, "markeredgewidth": 1.2 * scale}
        kind = _MARKS[index % len(_MARKS)]
        axes.plot(curve.across, curve.up, kind, **mark, zorder=4, label=curve.label)
    for change, of in ((axes.set_xlim, "across"), (axes.set_ylim, "up")):
        change(*_span(np.concatenate([getattr(curve, of) for curve in curves])))
    fit(axes, style)
    if len(curves) > 1:
        legend(axes, style, Room(axes, style), grow=style.height is None)
    return page


def _names(labels: Sequence[str]) -> list[str]:
    """Labels of a legend, long ones with their beginning and their end; no two become alike."""
    short = [label if len(label) <= _LABEL else _shortened(label) for label in labels]
    return [
        literal(f"{number}: {text}" if short.count(text) > 1 else text)
        for number, text in enumerate(short, start=1)
    ]


def _shortened(label: str) -> str:
    """The words at both ends of a label: titles begin alike, and columns end it."""
    first = label[: _LABEL - _TAIL]
    last = label[-_TAIL:]
    return f"{first.rsplit(' ', 1)[0]} … {last.split(' ', 1)[-1]}"


def _span(values: Floats) -> tuple[float, float]:
    """Limits of an axis: a little more than the values, and zero where they are not far from it."""
    low, high = float(values.min()), float(values.max())
    if 0 <= low <= 0.3 * high:
        low = 0.0
    if 0.3 * low <= high <= 0:
        high = 0.0
    room = 0.06 * (high - low) or 0.5 * abs(high) or 1.0
    return low - (room if low != 0 else 0), high + (room if high != 0 else 0)
