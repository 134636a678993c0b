"""An answer of the section confirmed by the cell and by the whole body.

The section is quick and leaves out ends, turns and a tip that turns. What a finer model makes of
each quantity at the answer corrects the section's (space mapping: Bandler et al. 1994, doi
10.1109/22.339794), and the search goes on from there, until the finer model agrees.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Sequence
from typing import Any

from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.quantities.seen import Reading, Seen, State
from fiberbend.design.reading import Design
from fiberbend.design.search.search import Found, Search
from fiberbend.design.search.wishes import LOOSE, Correction
from fiberbend.design.solving.body import Body
from fiberbend.design.solving.models import Cell, States, UnsolvedError
from fiberbend.design.solving.tries import Tries
from fiberbend.schema.problems import CaseError

CELL, BODY = "cell", "body"
AGREES = 0.01
"""Part of a quantity up to which what is foreseen and what a finer model finds are one."""
_MOST = 5
"""Corrections by one model; each nearly squares what is left."""
Say = Callable[[str], None]


@dataclasses.dataclass(frozen=True)
class Check:
    """A finer model at an answer.

    Attributes:
        model: its name.
        values: of every quantity of the design, in internal units; nan where the model has none.
        foreseen: what the corrected section had said.
        reason: why it has no values; empty where it has.
        cpu_s: processor time.
        warnings: of its runs.
        absent: there is no such model of the case, as no cell without a winding.
    """

    model: str
    values: tuple[float, ...]
    foreseen: tuple[float, ...]
    reason: str = ""
    cpu_s: float = 0.0
    warnings: tuple[str, ...] = ()
    absent: bool = False

    @property
    def whole(self) -> bool:
        """It has values."""
        return not self.reason


@dataclasses.dataclass(frozen=True)
class Confirmed:
    """What has come of an answer.

    Attributes:
        found: the answer, perhaps moved.
        corrections: of every quantity, from the finest model that had values.
        checks: of the finer models, in their order; the last of each model holds.
        searched_cpu_s: processor time of the searches between them.
    """

    found: Found
    corrections: tuple[Correction, ...]
    checks: tuple[Check, ...] = ()
    searched_cpu_s: float = 0.0

    def last(self, model: str) -> Check | None:
        """The last check by a model; None where there is none."""
        return next((each for each in reversed(self.checks) if each.model == model), None)


class Confirmer:
    """Confirms answers of a design.

    Args:
        design: the design.
        search: that has found them.
        body: the whole body.
        tell: takes lines for the user.
    """

    def __init__(self, design: Design, search: Search, body: Body, tell: Say) -> None:
        self.design, self._search, self._body, self._tell = design, search, body, tell
        self._tries: Tries = search.tries

    def confirm(self, start: Confirmed) -> Confirmed:
        """Correct by the cell, then by the body, as far as the design asks for them.

        Args:
            start: an answer of the section.
        """
        done = start
        if not self._tries.wanted or self.design.confirm == "none":
            return done
        done = self._settle(done, CELL)
        if self.design.confirm == BODY:
            first = done.last(CELL)
            done = self._settle(done, BODY)
            if first is None or not first.absent:
                # where the body has moved the answer
                done = self._add(done, self._cell(done.found), correct=False)
        return done

    def _settle(self, done: Confirmed, model: str) -> Confirmed:
        """Correct, search, and check again, until the model agrees or has no values."""
        for number in range(_MOST):
            check = self._cell(done.found) if model == CELL else self._whole(done.found)
            done = self._add(done, check, correct=True)
            self._tell(self._line(check))
            if not check.whole or self._agrees(done, check) or number == _MOST - 1:
                break
            begun = time.process_time()
            moved = self._search.again(done.found, done.corrections)
            spent = done.searched_cpu_s + time.process_time() - begun
            still = moved.chosen == done.found.chosen and moved.x == done.found.x
            done = dataclasses.replace(done, found=moved, searched_cpu_s=spent)
            if still:
                break
        return done

    def _add(self, done: Confirmed, check: Check, correct: bool) -> Confirmed:
        corrections = done.corrections
        if correct and check.whole:
            raw = self._tries.at(done.found.chosen, done.found.x).quantities
            assert raw is not None
            corrections = tuple(
                Correction.between(fine, rough, quantity.small) if _counts(fine, quantity) else old
                for fine, rough, quantity, old in zip(
                    check.values, raw, self.design.quantities, corrections, strict=True
                )
            )
        wishes = dataclasses.replace(done.found.wishes, corrections=corrections)
        found = dataclasses.replace(done.found, wishes=wishes)
        return dataclasses.replace(
            done, found=found, corrections=corrections, checks=(*done.checks, check)
        )

    def _agrees(self, done: Confirmed, check: Check) -> bool:
        """Whether the section, corrected, had foreseen all that models differ in."""
        loose = done.found.wishes.loose
        return all(
            abs(fine - foreseen) <= _near(quantity, fine, loose)
            for fine, foreseen, quantity in zip(
                check.values, check.foreseen, self.design.quantities, strict=True
            )
            if _counts(fine, quantity)
        )

    # --- models ----------------------------------------------------------------------------------

    def _cell(self, found: Found) -> Check:
        case = self._tries.case(found.chosen, found.x)
        return self._checked(CELL, found, lambda: (Cell().states(case, self._tries.wanted), []))

    def _whole(self, found: Found) -> Check:
        data = self.design.changed(self._tries.pairs(found.chosen, found.x))
        zones = len(self.design.base.zones or ())
        self._tell("the whole body is solved")
        wanted = self._tries.wanted
        return self._checked(BODY, found, lambda: self._body.states(data, wanted, zones))

    def _checked(
        self, model: str, found: Found, solve: Callable[[], tuple[States, Sequence[str]]]
    ) -> Check:
        foreseen = found.quantities()
        nothing = (math.nan,) * len(foreseen)
        begun = time.process_time()
        try:
            states, warnings = solve()
        except (UnsolvedError, CaseError) as error:
            reason = str(error).splitlines()[0]
            spent = time.process_time() - begun
            absent = model == CELL and isinstance(error, CaseError)
            return Check(model, nothing, foreseen, reason, spent, absent=absent)
        case = self._tries.case(found.chosen, found.x)
        zones = max(1, len(case.zones or ()))
        values = [
            quantity.read(Seen(case, _filled(states, quantity.states(), zones)))
            for quantity in self.design.quantities
        ]
        spent = time.process_time() - begun
        return Check(model, tuple(values), foreseen, "", spent, tuple(warnings))

    def _line(self, check: Check) -> str:
        """What a model has found, in a line."""
        if not check.whole:
            return f"{check.model}: {check.reason}"
        parts = [
            f"{quantity.words()} {quantity.shown(value)} ({quantity.shown(foreseen)} foreseen)"
            for quantity, value, foreseen in zip(
                self.design.quantities, check.values, check.foreseen, strict=True
            )
            if _counts(value, quantity)
        ]
        return f"{check.model}: {', '.join(parts)}"


def _near(quantity: Quantity[Any], fine: float, loose: bool) -> float:
    """How far a finer model may be from what is foreseen: finer where a target is."""
    near = AGREES * max(quantity.scale, abs(fine))
    if quantity.is_ is not None and loose:
        return min(near, (1 - LOOSE) * quantity.slack)
    return near if quantity.within is None else min(near, quantity.slack / 2)


def _counts(value: float, quantity: Quantity[Any]) -> bool:
    """Whether a model says anything of a quantity in which models differ."""
    return bool(quantity.states()) and math.isfinite(value)


def _filled(states: States, wanted: Sequence[State], zones: int) -> States:
    """States with those that a model has none of as nothing; no quantity that counts reads them."""
    nothing = Reading(*(math.nan,) * len(Reading._fields))
    return {state: states.get(state, (nothing,) * zones) for state in wanted}
