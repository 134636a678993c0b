"""The trade-off between two goals: cases of which no other is better in both."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from fiberbend.design.search.search import Found, Search
from fiberbend.design.search.wishes import Cap, Correction

_SAME = 1e-4
"""Part of the width of a front within which two values are one."""


@dataclasses.dataclass(frozen=True)
class Front:
    """Cases of a trade-off, the first goal's best first.

    Attributes:
        found: the cases; none where no case meets all targets.
        knee: index of the one farthest from the line between both ends.
    """

    found: tuple[Found, ...]
    knee: int


def trade_off(
    search: Search, corrections: Sequence[Correction], tell: Callable[[str], None]
) -> Front | Found | None:
    """The front of a design with two goals.

    The best of either goal, then the first at even values of the second that may not be exceeded
    (the ε-constraint method: Haimes et al. 1971), each from the one before.

    Args:
        search: of the design.
        corrections: of every quantity.
        tell: takes lines for the user.

    Returns:
        The front; the case that misses targets least where none meets them; None where no case has
        an answer.
    """
    ends = [search.whole(corrections, goal) for goal in (0, 1)]
    first, second = ends
    if first is None or second is None:
        return None
    if not first.met or not second.met:
        return first if second.met or not second.better(first) else second
    low, high = _signed(second)[1], _signed(first)[1]
    found, loose = [first, second], first.wishes.loose or second.wishes.loose
    count = search.design.search.front
    tell(f"both goals are known at their best: {count - 2} cases between them")
    last: dict[object, Found] = {}
    for part in np.linspace(1.0, 0.0, count)[1:-1]:
        cap = Cap(1, float(low + part * (high - low)))
        for chosen in search.design.fields.combinations():
            key = repr(chosen)
            near = last.get(key) or min(
                (each for each in ends if each is not None),
                key=lambda each: repr(each.chosen) != key,
            )
            new = search.descend(chosen, near.x, corrections, 0, cap, loose)
            if new is not None and new.met:
                found.append(new)
                last[key] = new
    return _front(found)


def _front(found: Sequence[Found]) -> Front:
    """Those that no other beats in both, and their knee."""
    values = np.array([_signed(each) for each in found])
    span = np.maximum(values.max(axis=0) - values.min(axis=0), 1e-12)
    kept: list[int] = []
    for index in sorted(range(len(found)), key=lambda i: tuple(values[i])):
        beaten = any(np.all(values[other] <= values[index] + _SAME * span) for other in kept)
        if not beaten:
            kept.append(index)
    shown = (values[kept] - values[kept].min(axis=0)) / np.maximum(
        np.ptp(values[kept], axis=0), 1e-12
    )
    # both ends lie on the line x + y = 1
    knee = int(np.argmin(shown.sum(axis=1)))
    return Front(tuple(found[index] for index in kept), knee)


def _signed(found: Found) -> tuple[float, float]:
    """Both goals, each so that less is better."""
    design = found.wishes.design
    own = found.quantities()[len(design.targets) :]
    first, second = (goal.sign * value for goal, value in zip(design.goals, own, strict=True))
    return first, second
