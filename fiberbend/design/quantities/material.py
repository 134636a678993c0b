"""What the rubber bears: its greatest strain."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, ClassVar

from fiberbend.case.case import Case
from fiberbend.design.quantities.bending import Zone
from fiberbend.design.quantities.quantity import Quantity, at_words, zone_problems, zone_words
from fiberbend.design.quantities.seen import Seen, State
from fiberbend.schema import quantities as q
from fiberbend.schema.problems import Problem

Strain = Annotated[float, q.Quantity("strain", "any")]


class StrainAt(Quantity[Strain]):
    """Greatest nominal principal strain of the rubber at a pressure, between the ends."""

    name: ClassVar = "strain"
    kind: ClassVar = "strain"
    small: ClassVar = 1.0

    at: q.SignedPressure
    """Pressure in the chamber."""
    zone: Zone | None = None
    """Number of a zone, counted from 1 at the root; all by default."""

    def states(self) -> tuple[State, ...]:
        """At the pressure."""
        return (State("pressure", self.at),)

    def read(self, seen: Seen) -> float:
        """λ − 1 in percent, of the zone that is strained most."""
        found = seen.at(self.states()[0], self.zone)
        return 100 * math.expm1(max(each.strain for each in found))

    def words(self) -> str:
        """With pressure and zone."""
        return f"greatest strain{zone_words(self.zone)} {at_words(self.at)}"

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """A zone that is not there."""
        yield from zone_problems(path, self.zone, case)
