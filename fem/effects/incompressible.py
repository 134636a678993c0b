"""Incompressibility by a pressure field, exact or with a bulk modulus."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, ClassVar

import ufl

from fem.effects.effect import Effect
from fem.kinematics.kinematics import Kinematics


class Incompressible(Effect):
    """Π = ∫ p (J − 1) − p²/(2κ) dX; without a bulk modulus κ the last term does not exist.

    Args:
        bulk: bulk modulus κ in MPa of the regions that are slightly compressible (perturbed
            Lagrangian); the others stay exactly incompressible.
    """

    fields: ClassVar[tuple[str, ...]] = ("u", "p")

    def __init__(self, bulk: dict[str, float] | None = None) -> None:
        if bulk and min(bulk.values()) <= 0:
            raise ValueError("a bulk modulus must be positive")
        self.bulk = bulk

    def structure(self) -> Hashable:
        """Whether anything is compressible."""
        return ("compressible",) if self.bulk else ("exact",)

    def potential(self, body: Kinematics) -> Any:
        """The constraint's Lagrangian as a form."""
        density = body.p * (ufl.det(body.F) - 1)
        if self.bulk:
            compliance = body.coefficient({region: 1 / k for region, k in self.bulk.items()})
            density -= compliance * body.p**2 / 2
        return density * body.dx()
