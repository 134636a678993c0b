"""How large it is at rest: from dimensions alone, the same in every model."""

from __future__ import annotations

from typing import Annotated, ClassVar

from fiberbend.case import convert
from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.quantities.seen import Seen
from fiberbend.schema import quantities as q

AnyLength = Annotated[float, q.Quantity("length", "zero or above")]
AnyVolume = Annotated[float, q.Quantity("volume")]
_NO_RUBBER = ("layer",)


class Width(Quantity[AnyLength]):
    """Outer width of the section, sheath included, at rest."""

    name: ClassVar = "width"
    kind: ClassVar = "length"
    small: ClassVar = 0.1

    def read(self, seen: Seen) -> float:
        """Twice the outer half width."""
        return 2 * convert.dimensions(seen.case.actuator).outer_half_width

    def words(self) -> str:
        """Of the outside."""
        return "outer width"


class Height(Quantity[AnyLength]):
    """Outer height of the section, sheath included, at rest."""

    name: ClassVar = "height"
    kind: ClassVar = "length"
    small: ClassVar = 0.1

    def read(self, seen: Seen) -> float:
        """From the lowest line to the top."""
        actuator = convert.dimensions(seen.case.actuator)
        return actuator.outer_top - actuator.outer_bottom

    def words(self) -> str:
        """Of the outside."""
        return "outer height"


class WholeLength(Quantity[AnyLength]):
    """Length with both caps, at rest."""

    name: ClassVar = "length"
    kind: ClassVar = "length"
    small: ClassVar = 0.1

    def read(self, seen: Seen) -> float:
        """Chamber and caps."""
        return convert.dimensions(seen.case.actuator).total_length

    def words(self) -> str:
        """Of the outside."""
        return "length with caps"


class Rubber(Quantity[AnyVolume]):
    """Volume of all that is cast: wall, floor, sheath and caps, without a separate layer."""

    name: ClassVar = "rubber"
    kind: ClassVar = "volume"
    small: ClassVar = 10.0

    def read(self, seen: Seen) -> float:
        """Of all regions but the layer."""
        volumes = convert.dimensions(seen.case.actuator).region_volumes()
        return sum(volume for part, volume in volumes.items() if part not in _NO_RUBBER)

    def words(self) -> str:
        """It is a volume."""
        return "volume of rubber"
