"""Weight of the solid."""

from __future__ import annotations

from typing import Any, ClassVar

import ufl

from fem.effects.effect import Effect
from fem.kinematics.kinematics import Kinematics


class Gravity(Effect):
    """Π = −∫ ρ g · u dX, scaled by the global scalar 'gravity' (0: none, 1: all of it).

    Args:
        density: ρ in t/mm³ for each region.
        acceleration: g in mm/s² as a vector of three.
    """

    scalar = "gravity"
    units: ClassVar = {scalar: ("", "mJ")}

    def __init__(self, density: dict[str, float], acceleration: tuple[float, float, float]) -> None:
        self.density = density
        self.acceleration = acceleration

    def potential(self, body: Kinematics) -> Any:
        """The load's potential as a form; the direction is a coefficient, not code."""
        load = ufl.as_vector(
            [
                body.coefficient({r: rho * g for r, rho in self.density.items()})
                for g in self.acceleration
            ]
        )
        return -body.scalar(self.scalar) * ufl.dot(load, body.u) * body.dx()
