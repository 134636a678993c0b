"""Strips of fabric on the winding's surface."""

from __future__ import annotations

from collections.abc import Hashable

from fem.effects.effect import Effect
from fem.effects.embedded_fibers import FiberPotential
from fem.kinematics.kinematics import Kinematics
from geometry.winding.segments import EmbeddedFibers


class FabricPotential(FiberPotential):
    """Warp and weft as threads, one for every mm across them: E t in N/mm is EA in N of each."""

    thread = False


class Strip(Effect):
    """Π = ∫ ½ E t (e_warp² + e_weft²) dA, e = λ − 1: a membrane of two families of threads.

    Warp along the axis and weft around each have the stiffness E t; between them there is none
    against shear, and none against bending.

    Args:
        name: of the strip; several may lie on a body.
        segments: warp and weft on the mesh's winding surface.
        stiffness: E t, N/mm.
        tension_only: slack fabric carries nothing.

    Raises:
        ValueError: a stiffness that is not positive.
    """

    def __init__(
        self, name: str, segments: EmbeddedFibers, stiffness: float, tension_only: bool = False
    ) -> None:
        if not stiffness > 0:
            raise ValueError(f"fabric stiffness {stiffness} N/mm, expected a positive value")
        self.name, self.segments, self.stiffness = name, segments, stiffness
        self.tension_only = tension_only

    @property
    def key(self) -> str:
        """Each by its name."""
        return f"Strip[{self.name}]"

    def structure(self) -> Hashable:
        """Whether it goes slack: all else of it is own code."""
        return ("strip", self.tension_only)

    def discrete(self, body: Kinematics) -> FabricPotential:
        """Its potential on this body."""
        return FabricPotential(body, self.segments, self.stiffness, self.tension_only)
