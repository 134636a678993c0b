"""The picture of a ladder: error against time, with the rungs that no other beats.

A colour is a winding and a mark is a model, the same in every picture; the colours differ in
lightness too, and are told apart by those who see no red or no green (Okabe and Ito 2008,
https://jfly.uni-koeln.de/color/).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from fiberbend.case.shapes import SHAPES
from fiberbend.drawing.axes import Room, fit, legend, new_axes
from fiberbend.drawing.page import any_sign, own_style, save
from fiberbend.drawing.style import Style
from fiberbend.ladder.advice import pareto
from fiberbend.ladder.errors import Judged, Judgement
from fiberbend.ladder.rungs import Family
from fiberbend.ladder.words import WINDINGS, percent, short, short_mesh, title
from fiberbend.models.choice import MODELS
from fiberbend.states.snapshot import Target

_COLORS = ("#56b4e9", "#0072b2", "#e69f00", "#222222", "#cc79a7", "#009e73", "#d55e00")
_MARKS = ("*", "o", "s", "D", "^", "v", "P", "X", "h", "<", ">", "p")
_LARGER = {"*": 1.5, "D": 0.85}
"""Sizes of marks that look smaller or larger than a circle."""
_FRONT = "0.35"
_PALE = 0.3
"""Opacity of rungs that cannot be chosen."""
_FLOOR = 1e-3
"""Percent: the least error that the axis shows; what is less is drawn there."""
PAGE = Style(height=185.0)
"""The legend of the families stands below, and makes the page higher."""
_ROOM = 1.5
"""Factor of time and error that the axes leave free around the points."""
_UNDER = (180, 195, 210, 225, 240, 255, 270, 165, 285, 150, 135, 315, 110, 90, 70, 0, 45)
"""Degrees: to the left of the front and under it there is no other rung."""
_TOUCHING = 18.0
"""Points of paper between two rungs of the front that get one name."""
_NEAR = 16.0
"""Points of paper: what is not on the front is named within them, or not at all."""


def draw(judgement: Judgement, heading: str, target: Target, style: Style = PAGE) -> None:
    """Draw every rung with an error; pale where it cannot be chosen.

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
            "time of the whole run (s); beside the points mesh.section / mesh.axial",
            "error of mesh and model (%)",
        )
        axes.set_xscale("log")
        axes.set_yscale("log")
        _limits(axes, shown, judgement)
        _plain_numbers(axes)
        best = pareto(judgement)
        _points(axes, shown, {each.record.name for each in best}, style)
        _front(axes, best, style)
        fit(axes, style)
        free = Room(axes, style)
        legend(axes, style, free, grow=True, below=True)
        _names(free, shown, best)
        save(page, target, style)


def _names(free: Room, shown: Sequence[Judged], best: Sequence[Judged]) -> None:
    """Name the front, and of the others the meshes where there is a place beside them."""
    names = {each.record.name for each in best}
    for group in reversed(_groups(free, best)):
        text = short(*(each.rung for each in group))
        free.write(text, *_place(group[len(group) // 2]), size=11, ways=_UNDER)
    for each in shown:
        if each.record.name not in names:
            # the legend has its family
            text = short_mesh(each.rung) or short(each.rung)
            free.write(text, *_place(each), size=8, reach=_NEAR)


def _groups(free: Room, best: Sequence[Judged]) -> list[list[Judged]]:
    """The front, with those of a family together whose marks touch: one name for all of them."""
    groups: list[list[Judged]] = []
    for each in best:
        if groups and groups[-1][-1].rung.family == each.rung.family:
            apart = free.between(_place(groups[-1][-1]), _place(each))
            if apart < _TOUCHING:
                groups[-1].append(each)
                continue
        groups.append([each])
    return groups


def _place(judged: Judged) -> tuple[float, float]:
    return judged.record.wall_s, max(judged.worst(), _FLOOR)


def _limits(axes: Any, shown: Sequence[Judged], judgement: Judgement) -> None:
    """Axes around all points and, where it is known, around what the reference is known to."""
    times, errors = zip(*map(_place, shown), strict=True)
    known = judgement.known_to()
    # names stand to the left of their marks
    axes.set_xlim(min(times) / _ROOM**2, max(times) * _ROOM)
    heights = [*errors, *([known] if _FLOOR < known < math.inf else [])]
    low = min(heights) / _ROOM
    axes.set_ylim(low, max(heights) * _ROOM)
    if len(heights) > len(errors):
        text = f"reference known to {percent(known)}"
        axes.axhspan(low, known, color="0.94", zorder=0, linewidth=0, label=text)
        axes.axhline(known, color="0.6", linestyle=(0, (4, 3)), linewidth=1.0, zorder=1)


def _plain_numbers(axes: Any) -> None:
    """Ticks as 0.1, 1, 10 and not as powers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(base=10, subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def _look(family: Family) -> tuple[str, str]:
    """Colour and mark: by the tables of windings, models and shapes, not by what a ladder has."""
    windings = list(WINDINGS)
    number = windings.index(family.winding) if family.winding in windings else len(windings)
    kinds = list(_kinds())
    mark = kinds.index((family.model, family.element))
    return _COLORS[number % len(_COLORS)], _MARKS[mark % len(_MARKS)]


def _kinds() -> Iterator[tuple[str, str]]:
    """Every model with every shape of elements that it leaves a choice of."""
    for name, model in MODELS.items():
        elements = model.elements()
        chosen = elements is not None and elements.takes_mesh_as_given
        yield from ((name, shape) for shape in (SHAPES if chosen else ("",)))


def _points(axes: Any, shown: Sequence[Judged], best: set[str], style: Style) -> None:
    scale = style.scale
    families = dict.fromkeys(each.rung.family.discretisation for each in shown)
    for family in sorted(families, key=_order):
        color, mark = _look(family)
        size = 8 * scale * _LARGER.get(mark, 1.0)
        _legend_only(axes, title(family), mark, size, color, color)
        for each in shown:
            if each.rung.family.discretisation != family:
                continue
            whole = each.rung.family.half is False
            on_front = each.record.name in best
            axes.plot(
                *([value] for value in _place(each)),
                linestyle="none",
                marker=mark,
                markersize=size * (1.25 if on_front else 1.0),
                markerfacecolor="white" if whole else color,
                markeredgecolor=color if whole else "white",
                markeredgewidth=(1.4 if whole else 0.6) * scale,
                alpha=_PALE if each.flaw else None,
                zorder=4 if on_front else 3,
            )
            _once(axes, each, color, scale)
    if any(each.rung.family.half is False for each in shown):
        _legend_only(axes, "hollow: the whole body", "o", 8 * scale, "white", "0.3")
    if any(each.flaw for each in shown):
        _legend_only(axes, "pale: never advised", "o", 8 * scale, "0.8", "0.8")
    if any(each.record.once_s for each in shown):
        text = "thin: calibration, done once"
        axes.plot([], [], color="0.4", linewidth=1.2 * scale, label=text)


def _once(axes: Any, judged: Judged, color: str, scale: float) -> None:
    """A line to the left of a point: what of its time is spent once for many runs."""
    wall, error = _place(judged)
    if judged.record.once_s:
        least = max(wall - judged.record.once_s, axes.get_xlim()[0])
        axes.plot([least, wall], [error, error], color=color, linewidth=1.2 * scale, zorder=2.5)
        axes.plot(
            [least],
            [error],
            linestyle="none",
            marker="|",
            markersize=6 * scale,
            color=color,
            zorder=2.5,
        )


def _legend_only(axes: Any, text: str, mark: str, size: float, face: str, edge: str) -> None:
    axes.plot(
        [],
        [],
        linestyle="none",
        marker=mark,
        markersize=size,
        markerfacecolor=face,
        markeredgecolor=edge,
        label=text,
    )


def _order(family: Family) -> tuple[int, int]:
    """As models and windings stand in their tables."""
    windings = [*WINDINGS, family.winding]
    return list(_kinds()).index((family.model, family.element)), windings.index(family.winding)


def _front(axes: Any, best: Sequence[Judged], style: Style) -> None:
    if not best:
        return
    corners = [_place(best[0])]
    for time, error in map(_place, best[1:]):
        # along the way of steps itself, which texts keep clear of
        corners += [(time, corners[-1][1]), (time, error)]
    axes.plot(
        *zip(*corners, strict=True),
        color=_FRONT,
        linewidth=1.6 * style.scale,
        label="none is quicker and more exact",
        zorder=2,
    )
