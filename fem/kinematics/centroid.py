"""Centroid and axes of a section or slice that goes on alike, as measures of the state."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem.kinematics.kinematics import Kinematics
from fem.ranks import total
from geometry.mesh.centroid import section_fit

Floats = npt.NDArray[np.float64]


class SectionFit:
    """Centroid and axes of all inside the winding in the turning frame, of `section_fit`.

    Args:
        body: kinematics of uniform bending.

    Attributes:
        rest: the centroid of the undeformed section, (3,), mm.
    """

    def __init__(self, body: Kinematics) -> None:
        data = body.domain.data
        self._body = body
        rows, kept, rest = section_fit(data)
        self.rest: Floats = np.array([rest[0], rest[1], 0.0])
        nodes = body.owned_nodes[np.any(rows[:, body.owned_nodes] != 0, axis=0)]
        self._dofs, self._rows = body.node_dofs[nodes], rows[:, nodes]
        self._kept = kept[:, : body.components]

    def read(self, w: Floats) -> tuple[Floats, Floats, Floats]:
        """c in mm and the images of the axes, a_x and a_y, (3,) each; collective.

        Args:
            w: owned coefficients of the fields, (owned,).
        """
        found = np.array([self.rest, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        moved = total(self._body.domain.comm, self._rows @ w[self._dofs])
        found[:, : self._body.components] += moved * self._kept
        return found[0], found[1], found[2]

    def row(self, slopes: Floats) -> Floats:
        """Σ slopes_ki ∂(c, a_x, a_y)_ki/∂w on the owned dofs, (owned,).

        Args:
            slopes: of something in c, a_x and a_y, (3, 3).
        """
        row = np.zeros(self._body.owned)
        by_fit = slopes[:, : self._body.components] * self._kept
        row[self._dofs] = self._rows.T @ by_fit
        follow, lead = self._body.ties
        np.add.at(row, lead, row[follow])
        row[follow] = 0.0
        return row
