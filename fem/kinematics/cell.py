"""A slice of a body that bends uniformly, with every fiber in it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import ufl

from fem.kinematics.domain import Domain
from fem.kinematics.uniform import Uniform


class Cell(Uniform):
    """A slice that repeats along the axis, with every fiber in it; x' depends on z too.

    Half a section is a slice between mirror planes. A whole section is a full pitch that repeats:
    x' at its end is tied to x' at its start. Half a turn about
    the y axis through a point where a fiber crosses x = 0 maps a helix onto itself, so that
    u = w = 0 there is no constraint, but takes away what rigid motion is left. Where k_y is an
    unknown a turn about z is no more than another frame, and u = w = 0 chooses one.

    Args:
        domain: mesh of a slice from z = 0, with the points "pin" and "crown".
        fields: names of the fields that the effects ask for.
        length: L, mm.
        twisted: no mirror plane z = 0: τ is an unknown.
        sideways: k_y is one; of a whole section alone.

    Raises:
        ValueError: tied ends on several ranks.
    """

    def __init__(
        self,
        domain: Domain,
        fields: Iterable[str],
        length: float,
        twisted: bool = False,
        sideways: bool = False,
    ) -> None:
        data = domain.data
        extent = float(np.ptp(data.nodes[:, 2]))
        tied = not data.half
        super().__init__(domain, fields, length, twisted, sideways, 3, extent, drifts=tied)
        if tied:
            if domain.comm.size > 1:
                raise ValueError("a slice with tied ends is solved on one rank")
            start, end = (data.facet_nodes(name) for name in ("section_root", "section_tip"))
            pairs = np.unique(np.column_stack([end.ravel(), start.ravel()]), axis=0)
            self.ties = (self.node_dofs[pairs[:, 0]].ravel(), self.node_dofs[pairs[:, 1]].ravel())

    def moved(self) -> None:
        """The slice may have another length."""
        super().moved()
        extent = float(np.ptp(self.domain.data.nodes[:, 2]))
        self.symmetry_factor *= self.extent / extent
        self.extent = extent

    def _relative(self) -> tuple[Any, Any]:
        position, u = ufl.SpatialCoordinate(self.domain.mesh), self.u
        x = ufl.as_vector([position[0] + u[0], position[1] + u[1], u[2]])
        plane = ufl.as_matrix([[1, 0, 0], [0, 1, 0], [0, 0, 0]])
        return x, plane + ufl.grad(u)

    def _bulge(self, x: Any, gradient: Any, normal: Any) -> Any:
        return x[0] * ufl.dot(ufl.cofac(gradient), normal)[0]
