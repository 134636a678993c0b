"""What an answer leans on: ends of ranges and targets that hold it, in words."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

from fiberbend.design.fields import Varied
from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.reading import Design
from fiberbend.design.search.minimum import BOUNDS
from fiberbend.design.search.search import Found

_COUNTS = 1e-4
"""A multiplier, of functions of order one over ranges of one, that is more than round-off."""
_OF_MOST = 0.01
"""Part of the strongest below which a limit is not told."""
_MISSED = 1e-3
"""Part of a target by which it is missed."""
_PART = 0.01
"""Part of a target by which it is thought to give way."""


@dataclasses.dataclass(frozen=True)
class Limit:
    """Something that holds an answer where it is.

    Attributes:
        name: path of a field, or name of a quantity.
        text: a sentence: what it is, and what it would give if it gave way.
        weight: its multiplier, all ranges and functions scaled to order one.
    """

    name: str
    text: str
    weight: float


def limits(design: Design, found: Found) -> list[Limit]:
    """What holds an answer, the strongest first; none where nothing would be better elsewhere."""
    known = found.minimum.multipliers
    if known is None or (found.met and found.wishes.goal is None):
        # nothing would be better
        return []
    gains = _Gains(design, found)
    lines: list[Limit] = []
    for field, low, high in zip(design.fields.varied, known.low, known.high, strict=True):
        for weight, end, side, way in (
            (low, field.low, "lower", "less"),
            (high, field.high, "upper", "more"),
        ):
            if weight > _COUNTS:
                lines.append(_of_end(field, float(weight), end, side, way, gains))
    values = found.minimum.values
    missed = [*(values.below > _MISSED), *(abs(values.zero) > _MISSED)]
    weights = [*known.below, *known.zero]
    for (index, key), weight, off in zip(found.wishes.conditions(), weights, missed, strict=True):
        # what is missed is what the others stop
        if index >= 0 and abs(weight) > _COUNTS and not off:
            target = design.targets[index]
            bounds = found.wishes.bounds(target)
            lines.append(_of_target(target, bounds, key, float(weight), gains))
    most = max((abs(line.weight) for line in lines), default=0.0)
    told = [line for line in lines if abs(line.weight) > _OF_MOST * most]
    return sorted(told, key=lambda line: -abs(line.weight))


def _of_end(field: Varied, weight: float, end: float, side: str, way: str, gains: _Gains) -> Limit:
    step = _nice(field)
    gain = gains.of(weight * step / (field.high - field.low))
    text = f"{field.label} is at its {side} limit {field.shown(end)}"
    text += f"; {field.shown(step)} {way} would {gain}"
    return Limit(field.path, text, weight)


def _of_target(
    target: Quantity[Any], bounds: tuple[float, float], key: str, weight: float, gains: _Gains
) -> Limit:
    """A target is held exactly, or leans on its bound."""
    step = _PART * target.scale
    gain = gains.of(abs(weight) * _PART)
    if key == "is":
        # L = f + μ (q − t): f falls by μ where t grows
        way = "more" if weight > 0 else "less"
        text = f"{target.words()} is held at {target.wanted()}"
    else:
        way = "more" if key == "most" else "less"
        low, high = bounds
        bound = target.shown(high if key == "most" else low)
        text = f"{target.words()} is at its limit, at {key} {bound}"
    text += f"; {target.shown(abs(step))} {way} would {gain}"
    return Limit(target.name, text, weight)


def _nice(field: Varied) -> float:
    """A step that a maker would take: 0.1 mm, or 1, 2 or 5 times a power of ten of the unit."""
    size = field.step / field.factor
    power = 10 ** math.floor(math.log10(size))
    return field.factor * power * max(m for m in (1, 2, 5) if m * power <= size * (1 + 1e-9))


class _Gains:
    """What is won where something gives way, in words.

    Args:
        design: the design.
        found: the answer.
    """

    def __init__(self, design: Design, found: Found) -> None:
        self._design, self._found = design, found

    def of(self, amount: float) -> str:
        """Words for a fall of what was minimised, of order one."""
        if not self._found.met:
            return self._nearer(amount)
        goal = self._found.wishes.goal
        assert goal is not None
        wanted = self._design.goals[goal]
        value = wanted.quantity.shown(amount * self._found.wishes.scales[goal])
        verb = "save" if wanted.sign > 0 else "give"
        more = "" if wanted.sign > 0 else " more"
        return f"{verb} {value}{more} ({wanted.quantity.words()})"

    def _nearer(self, amount: float) -> str:
        missed = list(missed_targets(self._design, self._found))
        if len(missed) != 1:
            return "miss less"
        ((target, _),) = missed
        low, high = target.bounds()
        size = target.scale if low == high else target.scale / BOUNDS
        return f"bring {target.words()} {target.shown(amount * size)} nearer"


def missed_targets(design: Design, found: Found) -> Iterator[tuple[Quantity[Any], float]]:
    """Targets that an answer misses in the search, with their values."""
    for target, value in zip(design.targets, found.quantities(), strict=False):
        low, high = target.bounds()
        off = max(0.0, value - high, low - value)
        if off > _MISSED * target.scale:
            yield target, value
