"""Fibers in tension: linear in the nominal strain e = λ − 1; N and mm."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray


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


FIBERS: dict[str, Fiber] = {
    "kevlar": Fiber(31076.0, 0.38, 0.5, "Polygerinos et al. 2015, section III-C: radius halved"),
}


def _active(strain: NDArray[np.float64], tension_only: bool) -> NDArray[np.float64]:
    return np.maximum(strain, 0.0) if tension_only else strain


def energy(
    strain: NDArray[np.float64], stiffness: float, tension_only: bool
) -> NDArray[np.float64]:
    """Energy per reference length in N (N mm per mm), ½ EA e²; 0 in compression if tension-only."""
    return stiffness / 2 * _active(strain, tension_only) ** 2


def force(strain: NDArray[np.float64], stiffness: float, tension_only: bool) -> NDArray[np.float64]:
    """Axial force in N, the derivative of `energy` by strain."""
    return stiffness * _active(strain, tension_only)


def tangent(
    strain: NDArray[np.float64], stiffness: float, tension_only: bool
) -> NDArray[np.float64]:
    """Derivative of `force` by strain in N; EA at e = 0 so that a fiber at rest is stiff."""
    if not tension_only:
        return np.full_like(strain, stiffness)
    return np.where(strain >= 0, stiffness, 0.0)
