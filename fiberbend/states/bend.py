"""From the frame that turns with the section to space: uniform bending, stretch and twist."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from analytic.path import CentreLine
from fiberbend.states.snapshot import Snapshot
from geometry.mesh.centroid import section_fit
from geometry.mesh.data import Floats, MeshData

_ORIGIN = (0.0, 0.0, 0.0)


@dataclasses.dataclass(frozen=True)
class Bend:
    """A body that bends and twists uniformly from a clamped root.

    In the frame of the station Z the frame's origin advances along z at the rate λ0, and the frame
    turns at the rate ω = (k_x, k_y, τ). The clamp holds the first section across z, its centroid
    where it is at rest. Under twist and bend a section is not across the line of the centroids:
    the line leaves the clamp as far from z as the body is sheared.

    Attributes:
        curvature: k_x, 1/mm; positive turns z toward −y.
        stretch: λ0 of the frame's origin.
        twist: τ, rad/mm.
        centre: the section's centroid in the turning frame, mm.
        height: y of the centroid at rest, mm.
        a_x: what has become of the section's axis x, in the turning frame.
        a_y: of its axis y.
        side_curvature: k_y, 1/mm; positive turns z toward x.
    """

    curvature: float
    stretch: float
    twist: float = 0.0
    centre: tuple[float, float, float] = _ORIGIN
    height: float = 0.0
    a_x: tuple[float, float, float] = (1.0, 0.0, 0.0)
    a_y: tuple[float, float, float] = (0.0, 1.0, 0.0)
    side_curvature: float = 0.0

    @classmethod
    def of(cls, state: Snapshot, mesh: MeshData) -> Bend:
        """The bend of a state of a section or a slice."""
        rows, kept, rest = section_fit(mesh)
        fit = rows @ in_frame(mesh.nodes, state.displacement) * kept
        centre, a_x, a_y = ((float(x), float(y), float(z)) for x, y, z in fit)
        how = (state.curvature, state.stretch, state.twist)
        return cls(*how, centre, float(rest[1]), a_x, a_y, state.side_curvature)

    @functools.cached_property
    def line(self) -> CentreLine:
        """The line of the centroids."""
        spin = np.array([self.curvature, self.side_curvature, self.twist])
        centre, a_x, a_y = (np.array(vector) for vector in (self.centre, self.a_x, self.a_y))
        return CentreLine.of(spin, self.stretch, centre, a_x, a_y)

    @property
    def rates(self) -> Floats:
        """Turn of the centre-line about the section's own x and y, and twist, (3,), rad/mm."""
        centre, a_x, a_y = (np.array(vector) for vector in (self.centre, self.a_x, self.a_y))
        turned = self.side_curvature != 0
        line = CentreLine.of(self.line.spin, self.stretch, centre, a_x, a_y, turned)
        return line.rates

    @property
    def is_rest(self) -> bool:
        """The turning frame is that of space: neither bent nor stretched nor twisted."""
        return self.stretch == 1.0 and not self.line.spin.any()

    def rotations(self, z: Floats) -> Floats:
        """Rotations from the turning frame to space of stations.

        Args:
            z: material positions Z along the axis, (n,), mm.

        Returns:
            Array (n, 3, 3).
        """
        return self._turning(z)[0]

    def place(self, position: Floats, z: Floats) -> Floats:
        """Positions in space.

        Args:
            position: x' in the turning frame, (n, 3), mm.
            z: their stations Z, (n,), mm.

        Returns:
            Array (n, 3), mm.
        """
        rotation, place = self._turning(z)
        placed: Floats = place + np.einsum("nij,nj->ni", rotation, position - self.line.centre)
        placed[:, 1] += self.height
        return placed

    def _turning(self, z: Floats) -> tuple[Floats, Floats]:
        """Rotations and places of stations, of which a body of layers has few."""
        levels, level = np.unique(z, return_inverse=True)
        rotation, place = self.line.turning(levels)
        return rotation[level], place[level]


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
