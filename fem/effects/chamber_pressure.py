"""Pressure in a closed chamber, following the deformed wall."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, ClassVar

from fem.effects.effect import Effect
from fem.kinematics.kinematics import Kinematics


class ChamberPressure(Effect):
    """Π = −P V with V the enclosed volume: an exact follower load with a symmetric tangent.

    P is the global scalar 'pressure' in MPa. Whether it is given or found so that V (or an angle)
    takes a given value is the march's affair.

    Args:
        surface: named closed surface of the cavity.
    """

    scalar = "pressure"
    units: ClassVar = {scalar: ("MPa", "mm3")}

    def __init__(self, surface: str = "chamber") -> None:
        self.surface = surface

    def structure(self) -> Hashable:
        """The surface on which it acts."""
        return (self.surface,)

    def potential(self, body: Kinematics) -> Any:
        """−P V as a form over the cavity's surface."""
        pressure = body.scalar(self.scalar)
        return -pressure * body.volume_density(self.surface) * body.ds(self.surface)
