"""The body in space."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import ufl

from fem.kinematics.domain import Domain
from fem.kinematics.kinematics import Kinematics


class Body(Kinematics):
    """The 3-D body: F = I + ∂u/∂X, x = X + u."""

    def __init__(self, domain: Domain, fields: Iterable[str]) -> None:
        super().__init__(domain, fields, components=3)

    @property
    def x(self) -> Any:
        """Deformed position, a UFL vector in mm."""
        return ufl.SpatialCoordinate(self.domain.mesh) + self.u

    @property
    def F(self) -> Any:
        """Deformation gradient, a UFL 3×3 tensor."""
        return ufl.Identity(3) + ufl.grad(self.u)

    def volume_density(self, surface: str) -> Any:
        """Density per reference area of the volume a closed cavity surface encloses.

        V = −∮ x_x (cof F · N)_x dS with N out of the solid: x e_x has no flux through planes
        y = const or z = const that close the cavity, nor through x = 0.
        """
        normal = ufl.FacetNormal(self.domain.mesh)
        return -self.x[0] * ufl.dot(ufl.cofac(self.F), normal)[0]
