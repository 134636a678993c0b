"""States of a case, as quantities read them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

from fiberbend.case.case import Case

StateKind = Literal["pressure", "angle", "straight"]


class State(NamedTuple):
    """A state that is asked for: bent freely, or kept straight under a pressure."""

    kind: StateKind
    """What is given: a pressure or an angle, or the pressure under which it is kept straight."""
    value: float
    """MPa or rad."""


class Reading(NamedTuple):
    """What is read of a state; all numbers, so that derivatives are of the same form."""

    pressure: float
    """MPa."""
    angle: float
    """Bending angle, rad."""
    stretch: float
    """Of the centre-line, 1."""
    moment: float
    """That keeps it straight, N mm."""
    strain: float
    """Greatest logarithmic principal strain of the rubber, 1."""
    volume: float
    """Of the chamber, mm³."""
    rest: float
    """The same at rest, mm³."""
    work: float
    """∫ P dV since rest, N mm."""
    force: float = 0.0
    """Of a body whose tip is blocked, N; zero where a moment stands for it."""
    tip_y: float = math.nan
    """Of a body the height of its tip, mm; nan where arcs give it."""
    tip_z: float = math.nan
    """The same along the axis, mm."""


@dataclasses.dataclass(frozen=True)
class Seen:
    """A case with its states.

    Attributes:
        case: any case.
        states: of each state one reading for every zone from root to tip; without zones one.
    """

    case: Case
    states: Mapping[State, Sequence[Reading]]

    def at(self, state: State, zone: int | None) -> Sequence[Reading]:
        """Readings of a state: of one zone, counted from 1, or of all."""
        found = self.states[state]
        return found if zone is None else (found[zone - 1],)
