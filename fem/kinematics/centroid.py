"""The centroid of a section or slice that goes on alike, as a measure of the state."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem.kinematics.kinematics import Kinematics
from fem.ranks import total
from geometry.mesh.centroid import winding_weights

Floats = npt.NDArray[np.float64]


class Centroid:
    """c of all inside the winding, `geometry.mesh.centroid`, in the turning frame.

    Half a section is completed by its image, in a mirror plane x = 0 or by half a turn about y:
    either way c lies on the axis y. c of a slice is its mean along z.

    Args:
        body: kinematics of uniform bending.

    Attributes:
        rest: c of the undeformed section, (3,), mm.
    """

    def __init__(self, body: Kinematics) -> None:
        data = body.domain.data
        self._body = body
        weights, rest = winding_weights(data)
        self.rest: Floats = np.array([rest[0], rest[1], 0.0])
        nodes = body.owned_nodes[weights[body.owned_nodes] != 0]
        share = weights[nodes] / weights.sum()
        self._dofs = body.node_dofs[nodes]
        known = [0.0, 1.0, 0.0] if data.half else [1.0, 1.0, 1.0]
        self._factors = share[:, None] * known[: body.components]

    def position(self, w: Floats) -> Floats:
        """c at owned coefficients of the fields, (owned,): (3,), mm; collective."""
        moved = np.zeros(3)
        here = np.sum(self._factors * w[self._dofs], axis=0)
        moved[: self._body.components] = total(self._body.domain.comm, here)
        return self.rest + moved

    def row(self, slopes: Floats) -> Floats:
        """Σ slopes_i ∂c_i/∂w on the owned dofs, (owned,).

        Args:
            slopes: of something in c, (3,).
        """
        row = np.zeros(self._body.owned)
        row[self._dofs] = self._factors * slopes[: self._body.components]
        follow, lead = self._body.ties
        np.add.at(row, lead, row[follow])
        row[follow] = 0.0
        return row
