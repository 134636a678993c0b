"""Quantities of an answer: what is wanted, what each model gives, which of them holds."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.reading import Design
from fiberbend.design.search.confirm import BODY, CELL, Confirmed

SECTION, SIZES = "section", "dimensions"
_ROUND = 1e-9


@dataclasses.dataclass(frozen=True)
class Told:
    """A quantity of an answer.

    Attributes:
        quantity: the quantity.
        goal: in words, "least" or "greatest", where it is one; empty of a target.
        by: values by the names of the models that have one, in internal units.
        foreseen: the section's, corrected.
    """

    quantity: Quantity[Any]
    goal: str
    by: dict[str, float]
    foreseen: float

    @property
    def model(self) -> str:
        """The finest model that has it."""
        return next(name for name in (BODY, CELL, SECTION, SIZES) if name in self.by)

    @property
    def value(self) -> float:
        """Of that model."""
        return self.by[self.model]

    @property
    def off(self) -> float:
        """How far beyond what is wanted it is, in its internal unit; negative: short of it."""
        low, high = self.quantity.bounds()
        return max(0.0, self.value - high) + min(0.0, self.value - low)

    @property
    def met(self) -> bool:
        """Whether it is what is wanted; a goal is."""
        return (
            bool(self.goal) or abs(self.off) <= self.quantity.slack + _ROUND * self.quantity.scale
        )


def told(design: Design, done: Confirmed) -> list[Told]:
    """All quantities of an answer, what is wanted first."""
    tries = done.found.wishes.tries
    raw = tries.at(done.found.chosen, done.found.x).quantities
    assert raw is not None
    checks = {name: done.last(name) for name in (BODY, CELL)}
    found = []
    for index, quantity in enumerate(design.quantities):
        by: dict[str, float] = {}
        for name, check in checks.items():
            if quantity.states() and check is not None and math.isfinite(check.values[index]):
                by[name] = check.values[index]
        by[SECTION if quantity.states() else SIZES] = raw[index]
        place = index - len(design.targets)
        goal = "" if place < 0 else ("least" if design.goals[place].sign > 0 else "greatest")
        foreseen = done.corrections[index].of(raw[index])
        found.append(Told(quantity, goal, by, foreseen))
    return found
