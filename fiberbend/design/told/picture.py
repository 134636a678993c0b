"""Pictures of a design: curves of its answer with the targets on them, and the trade-off."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.quantities.seen import Seen, State
from fiberbend.design.search.confirm import BODY, CELL
from fiberbend.design.solving.models import UnsolvedError
from fiberbend.design.told.outcome import Outcome
from fiberbend.design.told.values import SECTION, Told
from fiberbend.drawing.axes import BLUE, RED, Room, fit, legend, new_axes
from fiberbend.drawing.page import any_sign, own_style, save
from fiberbend.drawing.style import Style
from fiberbend.results.folder import RunFolder
from fiberbend.schema.problems import CaseError
from fiberbend.schema.units import KINDS

FRONT = "design_front.png"
PAGE = Style(height=150.0)
_PARTS = (0.0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0)
_COLORS = (BLUE, "#e69f00", "#009e73", "#7a4a8c")
_UNITS = {"deg": "°", "N*mm": "N mm"}
_MARKS = {CELL: ("s", 9.0), BODY: ("o", 9.0)}
_NAMES = {SECTION: "section", CELL: "cell", BODY: "body"}


def draw(folder: RunFolder, made: Outcome) -> list[str]:
    """Draw what a design has; names of the pictures."""
    names = []
    with own_style(), any_sign():
        for kind, group in _groups(made).items():
            name = f"design_{kind}.png"
            page = _curves(made, kind, group)
            if page is not None:
                folder.write(name, lambda file, page=page: save(page, file, PAGE))  # type: ignore[misc]
                names.append(name)
        if made.front is not None and len(made.front.found) > 1:
            page = _front(made)
            folder.write(FRONT, lambda file: save(page, file, PAGE))
            names.append(FRONT)
    return names


def _groups(made: Outcome) -> dict[str, list[Told]]:
    """Targets at a pressure, by the kind of their values: a page each."""
    found: dict[str, list[Told]] = {}
    for each in made.told:
        states = each.quantity.states()
        if not each.goal and states and states[0].kind in ("pressure", "straight"):
            found.setdefault(each.quantity.kind, []).append(each)
    return found


def _curves(made: Outcome, kind: str, group: Sequence[Told]) -> Any | None:
    """Quantities over pressure by the section, and at their targets by every model."""
    assert made.done is not None
    unit = KINDS[kind].shown
    up = f"{KINDS[kind].name.split(' ', 1)[1]} ({_UNITS.get(unit, unit)})"
    title = made.design.title if made.done.found.met else f"{made.design.title} (not met)"
    page, axes = new_axes(PAGE, title, None, "pressure P (kPa)", up)
    scale = PAGE.scale
    drawn: set[str] = set()
    for number, each in enumerate(group):
        color = _COLORS[number % len(_COLORS)]
        at = 1e3 * each.quantity.states()[0].value
        name = each.quantity.words()
        curve = list(_curve(made, each.quantity))
        if not curve:
            return None
        axes.plot(
            *zip(*curve, strict=True),
            color=color,
            linewidth=2 * scale,
            label=f"{name.split(' at ')[0]}, section",
        )
        for model, (mark, size) in _MARKS.items():
            if model in each.by:
                label = None if model in drawn else _NAMES[model]
                drawn.add(model)
                axes.plot(
                    [at],
                    [each.quantity.plain(each.by[model])],
                    mark,
                    markersize=size * scale,
                    markerfacecolor="white",
                    markeredgecolor="0.15",
                    label=label,
                    zorder=4,
                )
        for mark, name, bound in _wanted(each.quantity):
            label = None if name in drawn else name
            drawn.add(name)
            axes.plot(
                [at],
                [each.quantity.plain(bound)],
                mark,
                markersize=13 * scale,
                markeredgewidth=2 * scale,
                markerfacecolor="none",
                color=RED,
                label=label,
                zorder=5,
            )
    axes.margins(0.06)
    fit(axes, PAGE)
    legend(axes, PAGE, Room(axes, PAGE))
    return page


def _wanted(quantity: Quantity[Any]) -> Iterator[tuple[str, str, float]]:
    """Mark, name in the legend, and value of what is wanted of a quantity."""
    low, high = quantity.bounds()
    if low == high:
        yield "+", "wanted", low
        return
    if math.isfinite(high):
        yield "v", "at most", high
    if math.isfinite(low):
        yield "^", "at least", low


def _curve(made: Outcome, quantity: Quantity[Any]) -> Iterator[tuple[float, float]]:
    """Pressures in kPa and values of the section from rest to a target."""
    assert made.done is not None
    found, tries = made.done.found, made.tries
    case = tries.case(found.chosen, found.x)
    (kind, end) = quantity.states()[0]
    ways = [quantity.model_copy(update={"at": part * end}) for part in _PARTS]
    try:
        states = tries.model.states(case, [State(kind, part * end) for part in _PARTS])
        for way in ways:
            value = way.read(Seen(case, states))
            yield 1e3 * way.states()[0].value, quantity.plain(value)
    except (UnsolvedError, CaseError):
        return


def _front(made: Outcome) -> Any:
    """The trade-off: both goals of every case, with its knee and numbers of its fields."""
    assert made.front is not None
    design, count = made.design, len(made.design.targets)
    first, second = design.goals
    across, up = (
        f"{goal.quantity.words()} ({_UNITS.get(goal.quantity.unit, goal.quantity.unit)})"
        for goal in (first, second)
    )
    page, axes = new_axes(PAGE, design.title, None, across, up)
    scale = PAGE.scale
    points: list[tuple[float, float]] = []
    for found in made.front.found:
        values = found.quantities()[count:]
        one, other = (g.quantity.plain(v) for g, v in zip(design.goals, values, strict=True))
        points.append((one, other))
    axes.plot(
        *zip(*points, strict=True),
        "o-",
        color=BLUE,
        linewidth=1.6 * scale,
        markersize=7 * scale,
        label="no case is better in both",
    )
    axes.plot(*points[made.front.knee], "o", color=RED, markersize=10 * scale, label="knee")
    axes.margins(0.12)
    fit(axes, PAGE)
    free = Room(axes, PAGE)
    legend(axes, PAGE, free)
    for found, (x, y) in zip(made.front.found, points, strict=True):
        free.write(_fields(made, found), x, y, size=9)
    return page


def _fields(made: Outcome, found: Any) -> str:
    """Numbers of a case in few letters."""
    parts = [str(value) for _, value in found.chosen]
    inner = made.tries.inner(found.x)
    for field, value in zip(made.design.fields.varied, inner, strict=True):
        parts.append(f"{field.label} {value / field.factor:.3g}")
    return ", ".join(parts)
