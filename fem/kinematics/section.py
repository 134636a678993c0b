"""A section of a body that bends uniformly."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import ufl

from fem.kinematics.domain import Domain
from fem.kinematics.uniform import Uniform


class Section(Uniform):
    """Nothing depends on z; a two-dimensional mesh, and forces per mm of length.

    Args:
        domain: mesh of quadrilaterals with the point "pin".
        fields: names of the fields that the effects ask for.
        length: L, mm.
        twisted: no mirror plane z = 0: τ and w(X, Y) join the unknowns.
        sideways: k_y joins them; a whole section alone.
    """

    def __init__(
        self,
        domain: Domain,
        fields: Iterable[str],
        length: float,
        twisted: bool = False,
        sideways: bool = False,
    ) -> None:
        components = 3 if twisted else 2
        # half a turn about y leaves no shift along z
        drifts = twisted and not domain.data.half
        super().__init__(domain, fields, length, twisted, sideways, components, 1.0, drifts)

    def _relative(self) -> tuple[Any, Any]:
        zero = ufl.constantvalue.Zero()
        position, u = ufl.SpatialCoordinate(self.domain.mesh), self.u
        rest = (position[0], position[1], zero)
        x = [rest[i] + u[i] for i in range(self.components)]
        slopes = [[ufl.grad(u)[i, j] for j in range(2)] for i in range(self.components)]
        for i in range(2):
            slopes[i][i] += 1
        if not self.twisted:
            x.append(zero)
            slopes.append([zero, zero])
        return ufl.as_vector(x), ufl.as_matrix([[*row, zero] for row in slopes])
