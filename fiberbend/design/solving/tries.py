"""Cases that a search tries: their quantities, why they have none, and derivatives."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fiberbend.case.case import Case
from fiberbend.design.fields import Pairs
from fiberbend.design.quantities.seen import Reading, Seen
from fiberbend.design.reading import Design, own_numbers
from fiberbend.design.solving.models import Model, Slopes, States, UnsolvedError
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError

Floats = Any
_STEP = 1e-3
"""Part of the range of a field by which derivatives of what is in closed form are taken."""


@dataclasses.dataclass(frozen=True)
class Try:
    """A case that was tried.

    Attributes:
        number: of the try, from 1.
        chosen: values of its choices.
        x: its numbers, each from 0 (lower end) to 1 (upper end).
        case: the case; None where its values do not fit each other.
        quantities: what is wanted of it, then its goals, in internal units; None where unsolved.
        reason: why it is not solved; empty where it is.
        states: what they were read from.
    """

    number: int
    chosen: Pairs
    x: tuple[float, ...]
    case: Case | None
    quantities: tuple[float, ...] | None
    reason: str
    states: States = dataclasses.field(default_factory=dict, repr=False, compare=False)


@dataclasses.dataclass
class Counted:
    """What a search has cost.

    Attributes:
        solved: cases that were solved.
        beside: of them, those for derivatives alone.
        slopes: derivatives by all fields that came from the model itself.
        failed: cases that have no answer.
        cpu_s: processor time in the model.
    """

    solved: int = 0
    beside: int = 0
    slopes: int = 0
    failed: int = 0
    cpu_s: float = 0.0


class Tries:
    """Solves cases of a design by a model, and remembers them.

    Args:
        design: the design.
        model: the model.
        tell: takes every try.
    """

    def __init__(
        self,
        design: Design,
        model: Model,
        tell: Callable[[Try], None] = lambda _try: None,
    ) -> None:
        self.design, self.model = design, model
        self.all: list[Try] = []
        self.counted = Counted()
        self._known: dict[tuple[Pairs, tuple[float, ...]], Try] = {}
        self._slopes: dict[tuple[Pairs, tuple[float, ...]], Floats | None] = {}
        self._tell = tell
        states = (state for quantity in design.quantities for state in quantity.states())
        self.wanted = tuple(dict.fromkeys(states))

    # --- points ----------------------------------------------------------------------------------

    def pairs(self, chosen: Pairs, x: Sequence[float]) -> Pairs:
        """Paths and values of a point, as a case file has them."""
        fields = self.design.fields.varied
        return (*chosen, *((f.path, f.text(v)) for f, v in zip(fields, self.inner(x), strict=True)))

    def inner(self, x: Sequence[float]) -> tuple[float, ...]:
        """Values of the varied numbers in internal units, rounded as a file has them."""
        fields = self.design.fields.varied
        return tuple(
            field.rounded(field.low + part * (field.high - field.low))
            for field, part in zip(fields, x, strict=True)
        )

    def middle(self) -> tuple[Pairs, tuple[float, ...]]:
        """Some point: the first choices, and the middle of all ranges."""
        return self.design.fields.combinations()[0], (0.5,) * len(self.design.fields.varied)

    def start(self) -> tuple[float, ...]:
        """The base case's own numbers, moved between the ends."""
        found = own_numbers(self.design)
        return tuple(
            0.5 if value is None else min(1.0, max(0.0, (value - f.low) / (f.high - f.low)))
            for f, value in zip(self.design.fields.varied, found, strict=True)
        )

    # --- values ----------------------------------------------------------------------------------

    def at(self, chosen: Pairs, x: Sequence[float]) -> Try:
        """The case of a point, solved unless it was before."""
        key = (_key(chosen), tuple(float(f"{part:.10f}") for part in x))
        if key not in self._known:
            found = self._solve(chosen, key[1])
            self._known[key] = found
            self.all.append(found)
            self._tell(found)
        return self._known[key]

    def _solve(self, chosen: Pairs, x: tuple[float, ...]) -> Try:
        number = len(self.all) + 1
        try:
            case = self.case(chosen, x)
        except CaseError as error:
            self.counted.failed += 1
            return Try(number, chosen, x, None, None, _first_line(error))
        try:
            states = self._states(case)
            values = self._read(case, states)
        except (UnsolvedError, CaseError) as error:
            self.counted.failed += 1
            return Try(number, chosen, x, case, None, _first_line(error))
        return Try(number, chosen, x, case, values, "", states)

    def case(self, chosen: Pairs, x: Sequence[float]) -> Case:
        """The case of a point.

        Raises:
            CaseError: its values do not fit each other.
        """
        return parse_case(self.design.changed(self.pairs(chosen, x)))

    def _states(self, case: Case) -> States:
        if not self.wanted:
            return {}
        begun = time.process_time()
        try:
            return self.model.states(case, self.wanted)
        finally:
            self.counted.solved += 1
            self.counted.cpu_s += time.process_time() - begun

    def _read(self, case: Case, states: States) -> tuple[float, ...]:
        values = tuple(each.read(Seen(case, states)) for each in self.design.quantities)
        if not np.all(np.isfinite(values)):
            raise UnsolvedError("a quantity is not finite")
        return values

    # --- derivatives -----------------------------------------------------------------------------

    def slopes(self, chosen: Pairs, x: Sequence[float]) -> Floats | None:
        """Derivatives of all quantities by the numbers x, (quantities, numbers).

        None where neither the model nor cases beside give them.
        """
        here = self.at(chosen, x)
        key = (_key(chosen), here.x)
        if here.quantities is None or here.case is None:
            return None
        if key not in self._slopes:
            self._slopes[key] = self._differentiate(here)
        return self._slopes[key]

    def _differentiate(self, here: Try) -> Floats | None:
        fields = self.design.fields.varied
        count = (len(self.design.quantities), len(fields))
        if not fields:
            return np.zeros(count)
        assert here.case is not None
        own: Slopes | None = None
        if self.wanted:
            begun = time.process_time()
            own = self.model.slopes(here.case, self.wanted, [field.path for field in fields])
            self.counted.cpu_s += time.process_time() - begun
            self.counted.slopes += own is not None
        columns = [self._column(here, index, own) for index in range(len(fields))]
        if any(column is None for column in columns):
            return None
        return np.array(columns).T

    def _column(self, here: Try, index: int, own: Slopes | None) -> Floats | None:
        """By one number: on both sides where states are known there, else on the free side."""
        field = self.design.fields.varied[index]
        if own is None and self.wanted:
            return self._beside(here, index)
        sides = []
        for sign in (1.0, -1.0):
            x = list(here.x)
            x[index] += sign * _STEP
            change = sign * _STEP * (field.high - field.low)
            states = here.states if own is None else moved(here.states, own[field.path], change)
            try:
                case = parse_case(self.design.changed(self.pairs(here.chosen, x)))
                sides.append((sign * _STEP, np.array(self._read(case, states))))
            except (CaseError, UnsolvedError):
                continue
        if not sides:
            return None
        if len(sides) == 1:
            ((step, values),) = sides
            return (values - np.array(here.quantities)) / step
        (one, above), (other, below) = sides
        return (above - below) / (one - other)

    def _beside(self, here: Try, index: int) -> Floats | None:
        """By solving the case with a little more of one number, or a little less."""
        first = 1.0 if here.x[index] < 0.5 else -1.0
        for sign in (first, -first):
            x = list(here.x)
            x[index] += sign * _STEP
            try:
                case = parse_case(self.design.changed(self.pairs(here.chosen, x)))
                self.counted.beside += 1
                values = np.array(self._read(case, self._states(case)))
            except (CaseError, UnsolvedError):
                continue
            return (values - np.array(here.quantities)) / (sign * _STEP)
        return None


def moved(states: States, slopes: States, change: float) -> States:
    """States after a change of one field, to first order."""
    return {
        state: tuple(
            Reading(*(np.array(one) + change * np.array(slope)))
            for one, slope in zip(each, slopes[state], strict=True)
        )
        for state, each in states.items()
    }


def _key(chosen: Pairs) -> Pairs:
    return tuple((path, repr(value)) for path, value in chosen)


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or ["no reason is known"])[0]
