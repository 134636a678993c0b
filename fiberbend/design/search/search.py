"""Where a search looks: first cases all over the ranges, then descents from the best of them."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fiberbend.design.fields import Pairs
from fiberbend.design.reading import Design
from fiberbend.design.search.minimum import Minimum, Values, descend
from fiberbend.design.search.wishes import TOLERANCE, Cap, Correction, Wishes
from fiberbend.design.solving.tries import Tries

Floats = Any
Say = Callable[[str], None]
_PENALTY = 10.0
"""Of what is missed beside the goal, where first cases are compared."""
_APART = 0.1
"""Distance of two first cases that are not the same."""
_FRESH = 1.0


@dataclasses.dataclass(frozen=True)
class Found:
    """A case that a search has ended at.

    Attributes:
        chosen: its choices.
        minimum: its numbers, and what they lean on.
        wishes: what was minimised.
        met: every target is met.
    """

    chosen: Pairs
    minimum: Minimum
    wishes: Wishes
    met: bool

    @property
    def x(self) -> tuple[float, ...]:
        """Its numbers, from 0 to 1."""
        return tuple(float(part) for part in self.minimum.x)

    def quantities(self) -> tuple[float, ...]:
        """All quantities, corrected."""
        found = self.wishes.quantities(self.minimum.x)
        assert found is not None
        return tuple(float(value) for value in found)

    def better(self, other: Found | None) -> bool:
        """Whether it is the better of two."""
        return other is None or self.minimum.better(other.minimum, TOLERANCE)


class Search:
    """Searches the cases of a design.

    Args:
        design: the design.
        tries: solves them.
        tell: takes a line where something better is found.
    """

    def __init__(self, design: Design, tries: Tries, tell: Say = lambda _line: None) -> None:
        self.design, self.tries, self._tell = design, tries, tell
        self._scales: tuple[float, ...] | None = None
        self.best: Found | None = None

    def whole(self, corrections: Sequence[Correction], goal: int | None) -> Found | None:
        """The best case of all combinations, from first cases all over the ranges.

        Args:
            corrections: of every quantity.
            goal: index of the goal; None: nearness to the base case.

        Returns:
            The best case, which may miss targets; None where no first case has an answer.
        """
        best: Found | None = None
        for chosen in self.design.fields.combinations():
            for start in self._starts(chosen, corrections, goal):
                found = self.descend(chosen, start, corrections, goal)
                if found is not None and found.better(best):
                    best = self.best = found
                    self._tell(self._line(found))
        return self._nearest(best, corrections)

    def again(self, found: Found, corrections: Sequence[Correction]) -> Found:
        """The best case from one that is known, with other corrections; its choices stay."""
        wishes = found.wishes
        new = self.descend(
            found.chosen, found.x, corrections, wishes.goal, wishes.cap, wishes.loose
        )
        if new is None:
            return found
        return self._nearest(new, corrections) or found

    def descend(
        self,
        chosen: Pairs,
        start: Sequence[float],
        corrections: Sequence[Correction],
        goal: int | None,
        cap: Cap | None = None,
        loose: bool = False,
    ) -> Found | None:
        """Go down from a case."""
        wishes = self._wishes(chosen, corrections, goal, cap)
        wishes = dataclasses.replace(wishes, loose=loose)
        minimum = self._minimum(wishes, start, True)
        return None if minimum is None else Found(chosen, minimum, wishes, _met(minimum))

    def _minimum(self, wishes: Wishes, start: Sequence[float], goal: bool) -> Minimum | None:
        if not self.design.fields.varied:
            # nothing but choices
            values = wishes.values(np.zeros(0))
            return None if values is None else Minimum(np.zeros(0), values, None, None, 1, True)
        return descend(wishes, np.asarray(start, dtype=float), goal)

    def _nearest(self, best: Found | None, corrections: Sequence[Correction]) -> Found | None:
        """Where targets are missed, the case that misses least: the goal does not count there."""
        if best is None or best.met:
            return best
        if not best.wishes.loose and len(best.minimum.values.zero):
            # not all values can be had exactly, but perhaps as nearly as they are asked for
            goal, cap = best.wishes.goal, best.wishes.cap
            near = self.descend(best.chosen, best.x, corrections, goal, cap, loose=True)
            if near is not None and near.met:
                return near
        minimum = self._minimum(best.wishes, best.x, False)
        if minimum is None:
            return best
        return dataclasses.replace(best, minimum=minimum, met=_met(minimum))

    # --- first cases -----------------------------------------------------------------------------

    def _starts(
        self, chosen: Pairs, corrections: Sequence[Correction], goal: int | None
    ) -> list[tuple[float, ...]]:
        """The best of the first cases that have an answer, apart from each other."""
        points = self._samples()
        for x in points:
            # the first that has an answer gives the size of the goals
            self._scale(chosen, x)
        ranked: list[tuple[float, tuple[float, ...]]] = []
        wishes = self._wishes(chosen, corrections, goal, None)
        for x in points:
            values = wishes.values(np.array(x))
            if values is not None:
                ranked.append((_merit(values), x))
        kept: list[tuple[float, ...]] = []
        for _, x in sorted(ranked):
            if all(np.abs(np.subtract(x, other)).max(initial=1.0) > _APART for other in kept):
                kept.append(x)
        return kept[: self.design.search.descents]

    def _samples(self) -> list[tuple[float, ...]]:
        """The base case, and places of a Sobol sequence of the design's seed."""
        from scipy.stats import qmc

        count = len(self.design.fields.varied)
        if not count:
            return [()]
        with warnings.catch_warnings():
            # any number of places will do, not powers of two alone
            warnings.simplefilter("ignore", UserWarning)
            places = qmc.Sobol(count, seed=self.design.search.seed).random(
                max(1, self.design.search.starts - 1)
            )
        inner = [tuple(float(v) for v in row) for row in np.round(places, 6)]
        return [self.tries.start(), *inner][: max(1, self.design.search.starts)]

    def _scale(self, chosen: Pairs, x: Sequence[float]) -> None:
        if self._scales is not None:
            return
        found = self.tries.at(chosen, x).quantities
        if found is None:
            return
        own = found[len(self.design.targets) :]
        self._scales = tuple(
            max(goal.quantity.small, abs(value))
            for goal, value in zip(self.design.goals, own, strict=True)
        )

    def _wishes(
        self,
        chosen: Pairs,
        corrections: Sequence[Correction],
        goal: int | None,
        cap: Cap | None,
    ) -> Wishes:
        scales = self._scales or (_FRESH,) * len(self.design.goals)
        return Wishes(self.design, self.tries, chosen, tuple(corrections), goal, scales, cap)

    def _line(self, found: Found) -> str:
        """What has been found, in a line."""
        parts = [
            f"{quantity.words()} {quantity.shown(value)}"
            for quantity, value in zip(self.design.quantities, found.quantities(), strict=True)
        ]
        state = "meets all targets" if found.met else "nearest so far"
        if not self.design.targets:
            state = "best so far"
        return f"after {len(self.tries.all)} cases, {state}: {', '.join(parts)}"


def _met(minimum: Minimum) -> bool:
    values = minimum.values
    worst = max([0.0, *values.below, *np.abs(values.zero)])
    return bool(worst <= TOLERANCE)


def _merit(values: Values) -> float:
    return values.goal + _PENALTY * values.miss
