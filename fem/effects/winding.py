"""The fiber winding: every fiber embedded, or the same fibers smeared over their surface."""

from __future__ import annotations

import dataclasses

import numpy as np

from fem.effect import Effect
from fem.embedded import EmbeddedFibers, Segments
from fem.kinematics import Body


@dataclasses.dataclass
class _Fibers(Effect):
    """Common to both windings.

    Args:
        segments: pieces of fiber on the mesh's winding surface.
        tension_only: slack fibers carry nothing.
    """

    segments: Segments
    tension_only: bool = False

    def discrete(self, body: Body) -> EmbeddedFibers:
        """The fibers' potential on this body."""
        if not np.all(self.segments.length > 0):
            raise ValueError("every fiber segment needs a length above zero")
        return EmbeddedFibers(body, self.segments, self.tension_only)


class Winding(_Fibers):
    """Truss fibers along the exact helices, each a ribbon of parallel lines."""


class SmearedWinding(_Fibers):
    """The same winding as a membrane: a fiber length √(S² + p²)/(S p) per area and helix."""
