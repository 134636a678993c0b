"""How hard it pushes: force of a blocked tip, moment that keeps it straight."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

from fiberbend.case.case import Case
from fiberbend.design.quantities.quantity import Quantity, at_words
from fiberbend.design.quantities.seen import Seen, State
from fiberbend.effects.blocked_tip import BlockedTipEffect
from fiberbend.schema import quantities as q
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show

Force = Annotated[float, q.Quantity("force", "any")]
Moment = Annotated[float, q.Quantity("moment", "any")]


def _zones(path: str, case: Case) -> Iterator[Problem]:
    if case.zones:
        yield Problem(path, "the case has zones, of which each is kept straight by another moment")


class BlockedForceAt(Quantity[Force]):
    """Force of the tip on a post under it, kept straight by a roof, at a pressure."""

    name: ClassVar = "blocked-force"
    kind: ClassVar = "force"
    small: ClassVar = 0.01

    at: q.Pressure
    """Pressure in the chamber."""
    roof_width: q.Length = 4.0
    """Width of the roof along the crown, as of the effect blocked-tip."""
    post_length: q.Length = 2.0
    """Length of the post under the end of the tip cap, as of the effect blocked-tip."""

    def states(self) -> tuple[State, ...]:
        """Kept straight."""
        return (State("straight", self.at),)

    def read(self, seen: Seen) -> float:
        """Of a section its moment over the lever, about twice a body's; of a body its own."""
        found = seen.at(self.states()[0], None)[0]
        lever = seen.case.actuator.cap - self.post_length / 2
        return found.force or found.moment / lever

    def blocked_by(self) -> dict[str, Any]:
        """The effect that blocks a body's tip, as a case file has it."""
        sizes = {"roof_width": self.roof_width, "post_length": self.post_length}
        return {BlockedTipEffect.name: {k: show(v, "length") for k, v in sizes.items()}}

    def words(self) -> str:
        """With the pressure."""
        return f"blocked force {at_words(self.at)}"

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """Zones, and a post that is longer than the cap."""
        yield from _zones(path, case)
        if self.post_length >= case.actuator.cap:
            yield Problem(f"{path}.post_length", "longer than the cap, expected less")


class StraightMomentAt(Quantity[Moment]):
    """Moment that keeps the section straight, at a pressure."""

    name: ClassVar = "straight-moment"
    kind: ClassVar = "moment"
    small: ClassVar = 0.1

    at: q.Pressure
    """Pressure in the chamber."""

    def states(self) -> tuple[State, ...]:
        """Kept straight."""
        return (State("straight", self.at),)

    def read(self, seen: Seen) -> float:
        """The moment itself."""
        return seen.at(self.states()[0], None)[0].moment

    def words(self) -> str:
        """With the pressure."""
        return f"moment kept straight {at_words(self.at)}"

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """Zones."""
        yield from _zones(path, case)
