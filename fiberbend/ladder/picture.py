"""The picture of a ladder: error against time, with the rungs that no other beats."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from fiberbend.drawing.axes import RED, Room, fit, legend, new_axes
from fiberbend.drawing.page import any_sign, own_style, save
from fiberbend.drawing.style import Style
from fiberbend.ladder.advice import pareto
from fiberbend.ladder.errors import Judged, Judgement
from fiberbend.ladder.rungs import Family
from fiberbend.ladder.words import percent, short, short_mesh, title
from fiberbend.states.snapshot import Target

_COLORS = (
    *("#1f5a99", "#2e7d32", "#a8641a", "#7b4fa3", "#b8860b", "#0b7a75"),
    *("#8c2d5a", "#5a6b2f", "#444444", "#3f8fc0", "#c26a8a", "#6b4226"),
)
_MARKS = ("o", "s", "^", "D", "v", "P", "X", "h", "<", ">", "p", "*")
_FLOOR = 1e-3
"""Percent: the least error that the axis shows; what is less is drawn there."""
PAGE = Style(height=210.0)
"""Higher than other pictures: a legend of many families stands below the axes."""
_ROOM = 1.6
"""Factor of time and error that the axes leave free around the points."""


def draw(judgement: Judgement, heading: str, target: Target, style: Style = PAGE) -> None:
    """Draw every rung with an error; hollow where its mesh error is not known.

    Args:
        judgement: the rungs and their errors.
        heading: title of the page.
        target: a path, or a file open for writing bytes.
        style: of the page.
    """
    shown = [each for each in judgement.rungs if math.isfinite(each.worst())]
    if not shown:
        return
    with own_style(), any_sign():
        page, axes = new_axes(
            style,
            heading,
            None,
            "time of the whole process (s); beside the points mesh.section / mesh.axial",
            "error, mesh and model (%)",
        )
        axes.set_xscale("log")
        axes.set_yscale("log")
        _limits(axes, shown, judgement)
        _plain_numbers(axes)
        _points(axes, shown, style)
        best = pareto(judgement)
        _front(axes, best, style)
        fit(axes, style)
        free = Room(axes, style)
        legend(axes, style, free)
        # names of the front first: they get the best places
        for each in best:
            free.write(short(each.rung), *_place(each), size=11)
        names = {each.record.name for each in best}
        for each in shown:
            if each.record.name not in names:
                # the legend has its family
                free.write(short_mesh(each.rung) or each.rung.family.model, *_place(each), size=8)
        save(page, target, style)


def _place(judged: Judged) -> tuple[float, float]:
    return judged.record.wall_s, max(judged.worst(), _FLOOR)


def _limits(axes: Any, shown: Sequence[Judged], judgement: Judgement) -> None:
    times, errors = zip(*map(_place, shown), strict=True)
    known = judgement.known_to()
    axes.set_xlim(min(times) / _ROOM, max(times) * _ROOM)
    low = min(min(errors), known) if math.isfinite(known) and known > _FLOOR else min(errors)
    axes.set_ylim(low / _ROOM, max(errors) * _ROOM)
    if math.isfinite(known) and known > low / _ROOM:
        text = f"reference known to {percent(known)}: below, rungs cannot be told apart"
        axes.axhspan(low / _ROOM, known, color="0.93", zorder=0, linewidth=0, label=text)


def _plain_numbers(axes: Any) -> None:
    """Ticks as 0.1, 1, 10 and not as powers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(base=10, subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def _points(axes: Any, shown: Sequence[Judged], style: Style) -> None:
    families: dict[Family, list[Judged]] = {}
    for each in shown:
        families.setdefault(each.rung.family, []).append(each)
    kinds = list(dict.fromkeys(family.discretisation for family in families))
    for family, rungs in families.items():
        number = kinds.index(family.discretisation)
        color, mark = _COLORS[number % len(_COLORS)], _MARKS[number % len(_MARKS)]
        whole = family.half is False
        for flaw in dict.fromkeys(each.flaw for each in rungs):
            part = [each for each in rungs if each.flaw == flaw]
            name = title(family) + (f", {flaw}" if flaw else "")
            axes.plot(
                *zip(*map(_place, part), strict=True),
                linestyle="none",
                marker=mark,
                markersize=(9 if whole else 7) * style.scale,
                markerfacecolor=color if not (flaw or whole) else "white",
                markeredgecolor=color,
                markeredgewidth=1.4 * style.scale,
                label=name,
                zorder=3,
            )


def _front(axes: Any, best: Sequence[Judged], style: Style) -> None:
    if not best:
        return
    corners = [_place(best[0])]
    for time, error in map(_place, best[1:]):
        # along the way of steps itself, which texts keep clear of
        corners += [(time, corners[-1][1]), (time, error)]
    axes.plot(
        *zip(*corners, strict=True),
        color=RED,
        linewidth=1.4 * style.scale,
        label="no rung is quicker and more exact",
        zorder=2,
    )
