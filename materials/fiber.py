"""Fibers in tension: linear in the nominal strain e = λ − 1; N and mm."""

from __future__ import annotations

import dataclasses
import math


@dataclasses.dataclass(frozen=True)
class Fiber:
    """A fiber of the winding.

    Attributes:
        modulus: Young's modulus in MPa.
        diameter: diameter in mm.
        radius_factor: share of the radius that carries load; Polygerinos et al. 2015 halve it.
        source: where the numbers come from.

    Raises:
        ValueError: a number that is not positive and finite.
    """

    modulus: float
    diameter: float
    radius_factor: float = 0.5
    source: str = ""

    def __post_init__(self) -> None:
        for name, unit in (("modulus", " MPa"), ("diameter", " mm"), ("radius_factor", "")):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} {value}{unit}: expected a positive number")

    @property
    def stiffness(self) -> float:
        """Axial stiffness EA in N, E π (factor · diameter / 2)²."""
        return self.modulus * math.pi * (self.radius_factor * self.diameter / 2) ** 2
