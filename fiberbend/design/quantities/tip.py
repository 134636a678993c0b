"""Where the tip is at a pressure: a path is its places at several pressures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import ClassVar

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry
from fiberbend.case.zones import lengths
from fiberbend.design.quantities.quantity import Quantity, at_words
from fiberbend.design.quantities.seen import Reading, Seen, State
from fiberbend.schema import quantities as q
from fiberbend.schema.problems import Problem


class _Tip(Quantity[q.Coordinate]):
    """A coordinate of the centroid of the tip cap's outer face, as history.csv has it."""

    kind: ClassVar = "length"
    small: ClassVar = 1.0

    at: q.SignedPressure
    """Pressure in the chamber."""

    def states(self) -> tuple[State, ...]:
        """At the pressure."""
        return (State("pressure", self.at),)

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """A case that may leave its plane."""
        spread = ((effect.in_cell() or effect).beside() for effect in case.acting)
        if not Symmetry.of([effect for effect in spread if effect is not None]).plane:
            yield Problem(path, "the case may leave its plane, in which alone the tip is known")


class TipY(_Tip):
    """Height y of the tip at a pressure; it falls where the actuator bends."""

    name: ClassVar = "tip-y"

    def read(self, seen: Seen) -> float:
        """Of a body its own; else that of arcs."""
        found = seen.at(self.states()[0], None)
        return _arcs(seen.case, found)[0] if math.isnan(found[0].tip_y) else found[0].tip_y

    def words(self) -> str:
        """With the pressure."""
        return f"y of the tip {at_words(self.at)}"


class TipZ(_Tip):
    """Distance z of the tip along the axis at rest, at a pressure."""

    name: ClassVar = "tip-z"

    def read(self, seen: Seen) -> float:
        """Of a body its own; else that of arcs."""
        found = seen.at(self.states()[0], None)
        return _arcs(seen.case, found)[1] if math.isnan(found[0].tip_z) else found[0].tip_z

    def words(self) -> str:
        """With the pressure."""
        return f"z of the tip {at_words(self.at)}"


def _arcs(case: Case, found: Sequence[Reading]) -> tuple[float, float]:
    """The tip's y and z where the centre-line is an arc in each zone, and the cap straight."""
    from fiberbend.models.choice import meshed
    from geometry.mesh.centroid import section_fit

    actuator = convert.dimensions(case.actuator)
    height = float(section_fit(meshed(_section(case)).mesh(_section(case)))[2][1])
    y = z = angle = 0.0
    for part, length in zip(found, lengths(case), strict=True):
        half = part.angle / 2
        chord = part.stretch * length * (math.sin(half) / half if half else 1.0)
        y -= chord * math.sin(angle + half)
        z += chord * math.cos(angle + half)
        angle += part.angle
    face = actuator.face_height - height
    y += face * math.cos(angle) - actuator.cap * math.sin(angle)
    z += face * math.sin(angle) + actuator.cap * math.cos(angle)
    return height + y, z


def _section(case: Case) -> Case:
    """The case with the mesh of a section alone, for the place of its centroid."""
    return case.model_copy(update={"model": "section", "zones": None, "accuracy": None})
