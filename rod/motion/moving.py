"""A rod in motion at one time, and the energy that has gone into it."""

from __future__ import annotations

import dataclasses

from rod.functions import Floats
from rod.shape import Shape
from rod.term import Push


@dataclasses.dataclass(frozen=True)
class Work:
    """Energy that has gone in and out since the motion began, N mm.

    Attributes:
        air: ∫ P dV that the air has done on the chamber.
        loads: what terms without a potential have done, and changes of the amounts of the others.
        viscous: what the sections' viscosity has taken.
        drag: what drag has taken.
        dropped: what velocities had when they were dropped that are no rates of strains, or that
            what is touched has brought to rest.
        touch: what the viscosity of what touches has taken in the steps.
    """

    air: float = 0.0
    loads: float = 0.0
    viscous: float = 0.0
    drag: float = 0.0
    dropped: float = 0.0
    touch: float = 0.0

    def plus(self, other: Work) -> Work:
        """Both together."""
        pairs = zip(dataclasses.astuple(self), dataclasses.astuple(other), strict=True)
        return Work(*(a + b for a, b in pairs))

    @property
    def lost(self) -> float:
        """What damping has taken, N mm."""
        return self.viscous + self.drag + self.dropped + self.touch

    @property
    def gained(self) -> float:
        """What has come in from outside less what damping has taken, N mm."""
        return self.air + self.loads - self.lost


@dataclasses.dataclass(frozen=True)
class Energy:
    """Where the energy of a moving rod is, N mm.

    Attributes:
        kinetic: of all masses.
        elastic: of the sections, without the work of the air.
        potential: of the terms that have one, such as weight and contact.
        volume: of the chamber, mm³: what its pressure does work on.
    """

    kinetic: float
    elastic: float
    potential: float
    volume: float

    @property
    def total(self) -> float:
        """All of it, N mm: it changes by `Work.gained`."""
        return self.kinetic + self.elastic + self.potential


@dataclasses.dataclass(frozen=True)
class Moving:
    """A rod in motion.

    Attributes:
        time: t, s.
        shape: the rod.
        velocity: V = Ẋ of its frames X, (n + 1, 3, 4); 1/s and mm/s.
        rate: mean ε̇ of the last step, (n, m), 1/s and 1/(mm s).
        ahead: what that of the next step is foreseen to be, likewise.
        pressure: P of the chamber, MPa.
        energy: where it is.
        work: since the motion began.
        iterations: of Newton's method in the last step.
        pushes: mean forces in the last step of the terms that it may run into, in their order.
    """

    time: float
    shape: Shape
    velocity: Floats
    rate: Floats
    ahead: Floats
    pressure: float
    energy: Energy
    work: Work
    iterations: int = 0
    pushes: tuple[Push, ...] = ()

    @property
    def strains(self) -> Floats:
        """ε, (n, m)."""
        return self.shape.strains

    @property
    def frames(self) -> Floats:
        """X, (n + 1, 3, 4); 1 and mm."""
        return self.shape.frames
