"""What is wanted of a design as functions of its numbers, each of order one."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.design.fields import Pairs
from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.reading import Design
from fiberbend.design.search.minimum import Slopes, Values
from fiberbend.design.solving.tries import Tries

Floats = Any
TOLERANCE = 1e-3
"""Part of a target within which a search has met it."""
LOOSE = 0.9
"""Part of what a value may be off that a search uses up; finer models have the rest."""


@dataclasses.dataclass(frozen=True)
class Correction:
    """What a finer model makes of a quantity of the section: ratio · q + shift.

    Attributes:
        ratio: of both.
        shift: their difference, where the quantity is about zero; in its internal unit.
    """

    ratio: float = 1.0
    shift: float = 0.0

    def of(self, value: float) -> float:
        """The value of the finer model, as far as this knows it."""
        return self.ratio * value + self.shift

    @classmethod
    def between(cls, fine: float, rough: float, small: float) -> Correction:
        """From values of both models at one case.

        Args:
            fine: of the finer model.
            rough: of the section.
            small: a value of no account.
        """
        if abs(rough) > small and fine * rough > 0:
            return cls(ratio=fine / rough)
        return cls(shift=fine - rough)


@dataclasses.dataclass(frozen=True)
class Cap:
    """A goal that is held at or below a value, while another is improved.

    Attributes:
        goal: index of the goal.
        most: its greatest value times its sign.
    """

    goal: int
    most: float


@dataclasses.dataclass(frozen=True)
class Wishes:
    """Functions of the numbers of one combination of choices; see `minimum.Functions`.

    Attributes:
        design: the design.
        tries: solves its cases.
        chosen: the combination.
        corrections: of every quantity of the design.
        goal: index of the goal that is improved; None: nearness to the base case.
        scales: of every goal, internal unit.
        cap: on the other goal; None: on none.
        loose: values that are to be met may be off as far as they still are.
    """

    design: Design
    tries: Tries
    chosen: Pairs
    corrections: tuple[Correction, ...]
    goal: int | None
    scales: tuple[float, ...]
    cap: Cap | None = None
    loose: bool = False

    def bounds(self, target: Quantity[Any]) -> tuple[float, float]:
        """Least and greatest value of a target; one value where it is aimed at."""
        low, high = target.bounds()
        if not self.loose or target.is_ is None:
            return low, high
        return low - LOOSE * target.slack, high + LOOSE * target.slack

    def quantities(self, x: Sequence[float]) -> Floats | None:
        """All quantities as the finer model would have them; None where there is no answer."""
        found = self.tries.at(self.chosen, x).quantities
        if found is None:
            return None
        return np.array([c.of(q) for c, q in zip(self.corrections, found, strict=True)])

    def values(self, x: Floats) -> Values | None:
        """As of `minimum.Functions`."""
        found = self.quantities(x)
        if found is None:
            return None
        below, zero = [], []
        for value, target in zip(found, self.design.targets, strict=False):
            low, high = self.bounds(target)
            if low == high:
                zero.append((value - low) / target.scale)
                continue
            if math.isfinite(high):
                below.append((value - high) / target.scale)
            if math.isfinite(low):
                below.append((low - value) / target.scale)
        if self.cap is not None:
            size, sign, value = self._of_goal(found, self.cap.goal)
            below.append((sign * value - self.cap.most) / size)
        return Values(self._goal(x, found), np.array(below), np.array(zero))

    def slopes(self, x: Floats) -> Slopes | None:
        """As of `minimum.Functions`."""
        raw = self.tries.slopes(self.chosen, x)
        if raw is None:
            return None
        slopes = np.array([c.ratio for c in self.corrections])[:, None] * raw
        below, zero = [], []
        for slope, target in zip(slopes, self.design.targets, strict=False):
            low, high = self.bounds(target)
            if low == high:
                zero.append(slope / target.scale)
                continue
            if math.isfinite(high):
                below.append(slope / target.scale)
            if math.isfinite(low):
                below.append(-slope / target.scale)
        if self.cap is not None:
            size, sign, slope = self._of_goal(slopes, self.cap.goal)
            below.append(sign * slope / size)
        n = len(x)
        return Slopes(
            self._goal_slope(x, slopes),
            np.array(below).reshape(-1, n),
            np.array(zero).reshape(-1, n),
        )

    def conditions(self) -> list[tuple[int, str]]:
        """Index of the target and key of each condition: those below zero, then those at zero."""
        below, zero = [], []
        for index, target in enumerate(self.design.targets):
            low, high = self.bounds(target)
            if low == high:
                zero.append((index, "is"))
                continue
            below += [(index, "most")] * math.isfinite(high)
            below += [(index, "least")] * math.isfinite(low)
        return [*below, *([(-1, "cap")] if self.cap is not None else []), *zero]

    def _of_goal(self, found: Floats, index: int) -> tuple[float, float, Any]:
        goal = self.design.goals[index]
        return self.scales[index], goal.sign, found[len(self.design.targets) + index]

    def _goal(self, x: Floats, found: Floats) -> float:
        if self.goal is None:
            return float(np.sum((np.asarray(x) - self.tries.start()) ** 2))
        size, sign, value = self._of_goal(found, self.goal)
        return float(sign * value / size)

    def _goal_slope(self, x: Floats, slopes: Floats) -> Floats:
        if self.goal is None:
            return 2 * (np.asarray(x) - self.tries.start())
        size, sign, slope = self._of_goal(slopes, self.goal)
        return sign * slope / size
