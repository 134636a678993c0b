"""What it takes of the supply: work and volume of the air at pressure."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from fiberbend.case.case import Case
from fiberbend.design.quantities.quantity import Quantity, at_words
from fiberbend.design.quantities.seen import Seen, State
from fiberbend.schema import quantities as q
from fiberbend.schema.problems import Problem

Energy = Annotated[float, q.Quantity("energy", "any")]
Volume = Annotated[float, q.Quantity("volume", "any")]


class WorkTo(Quantity[Energy]):
    """Pressure-volume work ∫ P dV of the chamber from rest to a pressure or an angle, unloaded."""

    name: ClassVar = "work"
    kind: ClassVar = "energy"
    small: ClassVar = 0.1

    at: q.SignedPressure | None = None
    """Pressure at the end."""
    angle: q.Angle | None = None
    """Bending angle at the end, in place of a pressure."""

    def states(self) -> tuple[State, ...]:
        """At the end; `wrong` refuses one without an end."""
        if self.at is not None:
            return (State("pressure", self.at),)
        return () if self.angle is None else (State("angle", self.angle),)

    def read(self, seen: Seen) -> float:
        """The work of all zones."""
        return sum(each.work for each in seen.at(self.states()[0], None))

    def words(self) -> str:
        """With its end."""
        return f"pressure-volume work {at_words(self.at, self.angle)}"

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """Not one of pressure and angle."""
        if (self.at is None) == (self.angle is None):
            yield Problem(path, "expected one of at (a pressure) and angle")
        elif self.angle is not None and case.zones:
            yield Problem(
                f"{path}.angle", "the case has zones, which share a pressure: expected at"
            )


class VolumeAt(Quantity[Volume]):
    """Volume by which the chamber has grown at a pressure: what a syringe gives."""

    name: ClassVar = "filling"
    kind: ClassVar = "volume"
    small: ClassVar = 10.0

    at: q.SignedPressure
    """Pressure in the chamber."""

    def states(self) -> tuple[State, ...]:
        """At the pressure."""
        return (State("pressure", self.at),)

    def read(self, seen: Seen) -> float:
        """Of all zones."""
        return sum(each.volume - each.rest for each in seen.at(self.states()[0], None))

    def words(self) -> str:
        """With the pressure."""
        return f"filling volume {at_words(self.at)}"
