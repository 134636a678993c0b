"""From the frame that turns with the section to space: uniform bending, stretch and twist."""

from __future__ import annotations

import dataclasses

import numpy as np

from analytic.path import screw
from fiberbend.states.snapshot import Snapshot
from geometry.mesh.data import Floats


@dataclasses.dataclass(frozen=True)
class Bend:
    """The axis of a body that bends and twists uniformly.

    In the frame of the station Z the axis advances along z at the rate λ0, and the frame turns at
    the rate ω = (k, 0, τ). It is at rest at Z = 0, in the origin.

    Attributes:
        curvature: k, 1/mm; positive turns z toward −y.
        stretch: λ0 of the axis.
        twist: τ, rad/mm.
    """

    curvature: float
    stretch: float
    twist: float = 0.0

    @classmethod
    def of(cls, state: Snapshot) -> Bend:
        """The bend of a state."""
        return cls(state.curvature, state.stretch, state.twist)

    @property
    def spin(self) -> Floats:
        """ω, (3,), 1/mm."""
        return np.array([self.curvature, 0.0, self.twist])

    @property
    def is_rest(self) -> bool:
        """The turning frame is that of space: neither bent nor stretched nor twisted."""
        return self.stretch == 1.0 and not self.spin.any()

    def advance(self, position: Floats) -> Floats:
        """∂x/∂Z of material that keeps its place in the frame, λ0 e_z + ω × x'.

        Args:
            position: x' in the turning frame, (..., 3), mm.

        Returns:
            In the turning frame, (..., 3).
        """
        along: Floats = np.cross(self.spin, position) + np.array([0.0, 0.0, self.stretch])
        return along

    def frames(self, z: Floats) -> tuple[Floats, Floats]:
        """Rotation R(Z) = exp(Z ω×) and centre c(Z) = ∫ R λ0 e_z dZ of stations.

        Args:
            z: material positions Z along the axis, (n,), mm.

        Returns:
            Rotations (n, 3, 3) and centres (n, 3), mm.
        """
        return screw(z, self.spin, self.stretch)

    def place(self, position: Floats, z: Floats) -> Floats:
        """Positions in space, c(Z) + R(Z) x'.

        Args:
            position: x' in the turning frame, (n, 3), mm.
            z: their stations Z, (n,), mm.

        Returns:
            Array (n, 3), mm.
        """
        rotation, centre = self.frames(z)
        placed: Floats = centre + np.einsum("nij,nj->ni", rotation, position)
        return placed


def in_frame(nodes: Floats, displacement: Floats) -> Floats:
    """Positions x' = (X + u, Y + v, w) in the turning frame.

    Args:
        nodes: (n, 2) or (n, 3), mm; z, if there is one, is no position in the frame.
        displacement: (n, 2), or (n, 3) with w, mm.

    Returns:
        Array (n, 3), mm.
    """
    position = np.zeros((len(nodes), 3))
    position[:, :2] = nodes[:, :2]
    position[:, : displacement.shape[1]] += displacement
    return position
