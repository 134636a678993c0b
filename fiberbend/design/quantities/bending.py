"""How far it bends: angle at a pressure, pressure at an angle, curvature of a zone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from pydantic import Field

from fiberbend.case.case import Case
from fiberbend.case.zones import lengths
from fiberbend.design.quantities.quantity import Quantity, at_words, zone_problems, zone_words
from fiberbend.design.quantities.seen import Seen, State
from fiberbend.schema import quantities as q
from fiberbend.schema.problems import Problem

Curvature = Annotated[float, q.Quantity("curvature", "any")]
AnyPressure = Annotated[float, q.Quantity("pressure", "any")]
Zone = Annotated[int, Field(ge=1)]


class AngleAt(Quantity[q.AngleOrZero]):
    """Bending angle at a pressure, of all or of one zone."""

    name: ClassVar = "angle"
    kind: ClassVar = "angle"
    small: ClassVar = 0.05

    at: q.SignedPressure
    """Pressure in the chamber."""
    zone: Zone | None = None
    """Number of a zone, counted from 1 at the root; the whole length by default."""

    def states(self) -> tuple[State, ...]:
        """At the pressure."""
        return (State("pressure", self.at),)

    def read(self, seen: Seen) -> float:
        """The angles of zones add up."""
        return sum(each.angle for each in seen.at(self.states()[0], self.zone))

    def words(self) -> str:
        """With pressure and zone."""
        return f"angle{zone_words(self.zone)} {at_words(self.at)}"

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """A zone that is not there."""
        yield from zone_problems(path, self.zone, case)


class CurvatureAt(Quantity[Curvature]):
    """Curvature of the centre-line at a pressure, of all or of one zone: the arc of a shape."""

    name: ClassVar = "curvature"
    kind: ClassVar = "curvature"
    small: ClassVar = 5e-4

    at: q.SignedPressure
    """Pressure in the chamber."""
    zone: Zone | None = None
    """Number of a zone, counted from 1 at the root; the mean of the whole length by default."""

    def states(self) -> tuple[State, ...]:
        """At the pressure."""
        return (State("pressure", self.at),)

    def read(self, seen: Seen) -> float:
        """Angle over the length of the arc."""
        all_lengths = lengths(seen.case)
        part = all_lengths if self.zone is None else (all_lengths[self.zone - 1],)
        found = seen.at(self.states()[0], self.zone)
        arc = sum(each.stretch * length for each, length in zip(found, part, strict=True))
        return sum(each.angle for each in found) / arc

    def words(self) -> str:
        """With pressure and zone."""
        return f"curvature{zone_words(self.zone)} {at_words(self.at)}"

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """A zone that is not there."""
        yield from zone_problems(path, self.zone, case)


class PressureAt(Quantity[AnyPressure]):
    """Pressure at which it has an angle."""

    name: ClassVar = "pressure"
    kind: ClassVar = "pressure"
    small: ClassVar = 1e-4

    at: q.Angle
    """Bending angle."""

    def states(self) -> tuple[State, ...]:
        """At the angle."""
        return (State("angle", self.at),)

    def read(self, seen: Seen) -> float:
        """Of the only zone."""
        return seen.at(self.states()[0], None)[0].pressure

    def words(self) -> str:
        """With the angle."""
        return f"pressure {at_words(None, self.at)}"

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """Zones share a pressure, and are not solved by their angle."""
        if case.zones:
            yield Problem(path, "the case has zones, which share a pressure: expected angle at it")
