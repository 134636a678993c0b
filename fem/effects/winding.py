"""The fiber winding: every fiber embedded, or smeared over a surface that may bulge."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fem.effects.bedded_fibers import BeddedPotential, Run
from fem.effects.bulging_fibers import BulgingPotential
from fem.effects.effect import Effect
from fem.effects.embedded_fibers import FiberPotential
from fem.kinematics.kinematics import Kinematics
from geometry.mesh.data import Floats
from geometry.winding.segments import EmbeddedFibers, SmearedFibers
from materials.bedding import Bedding
from materials.bulging import Bulging


class _Fibers(Effect):
    """Common to all windings.

    Args:
        segments: pieces of fiber on the mesh's winding surface.
        stiffness: axial stiffness EA of a fiber, N; of several the one of every segment, (n,).
        tension_only: slack fibers carry nothing.

    Raises:
        ValueError: a stiffness that is not positive.
    """

    def __init__(
        self, segments: EmbeddedFibers, stiffness: float | Floats, tension_only: bool = False
    ) -> None:
        if not np.all(np.asarray(stiffness) > 0):
            raise ValueError(f"fiber stiffness {stiffness} N, expected a positive value")
        self.segments = segments
        self.stiffness = stiffness
        self.tension_only = tension_only

    def structure(self) -> Hashable:
        """Whether its fibers go slack: all else of it is own code."""
        return type(self).__name__, self.tension_only

    def discrete(self, body: Kinematics) -> FiberPotential:
        """The fibers' potential on this body."""
        return FiberPotential(body, self.segments, self.stiffness, self.tension_only)


class Winding(_Fibers):
    """Truss fibers along the exact helices, each a ribbon of parallel lines."""


class SmearedWinding(_Fibers):
    """The same winding as a membrane: a fiber length 1/spacing per area and family."""


class CalibratedWinding(_Fibers):
    """The membrane in series with the rubber that bulges between the turns of the same winding.

    Args:
        segments: smeared pieces of fiber on the mesh's winding surface.
        stiffness: axial stiffness EA of a fiber, N.
        bulging: stiffness against the bulge, fitted to a model that has the turns.
        tension_only: slack fibers carry nothing.

    Raises:
        ValueError: a stiffness that is not positive; an outline without arcs, on which no rubber
            bulges by this law: it is the smeared winding.
    """

    segments: SmearedFibers

    def __init__(
        self,
        segments: SmearedFibers,
        stiffness: float,
        bulging: Bulging,
        tension_only: bool = False,
    ) -> None:
        super().__init__(segments, stiffness, tension_only)
        self.whole = stiffness
        if not np.any(segments.curvature):
            raise ValueError(
                "the winding is nowhere curved: a stiffness against bulges has no effect, expected "
                "a smeared winding"
            )
        self.bulging = bulging

    def discrete(self, body: Kinematics) -> BulgingPotential:
        """The potential of fibers and bulge on this body."""
        return BulgingPotential(body, self.segments, self.whole, self.bulging, self.tension_only)


class BeddedWinding(_Fibers):
    """Families of fibers as membranes, each on rubber that yields under it.

    Args:
        segments: smeared pieces of fiber on the winding's outline of a section.
        stiffness: axial stiffness EA of a fiber, N; of several the one of every segment, (n,).
        bedding: stiffness of the rubber.
        run: how they run.

    Raises:
        ValueError: a stiffness that is not positive.
    """

    segments: SmearedFibers

    def __init__(
        self, segments: SmearedFibers, stiffness: float | Floats, bedding: Bedding, run: Run
    ) -> None:
        super().__init__(segments, stiffness)
        self.bedding = bedding
        self.run = run

    def discrete(self, body: Kinematics) -> BeddedPotential:
        """The potential of fibers, bulges and slip on this body."""
        return BeddedPotential(body, self.segments, self.stiffness, self.bedding, self.run)
