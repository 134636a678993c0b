"""Loads as terms of a rod: its weight, and forces and moments on a frame."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Sequence

import numpy as np

from rod.functions import Floats, cross_matrix
from rod.shape import Shape

NO_LOAD = (0.0, 0.0, 0.0)
Vector = Sequence[float] | Floats


@dataclasses.dataclass(frozen=True)
class Weight:
    """−Σ m g·r of all masses on the frames.

    Attributes:
        inertia: masses, (n + 1, 4, 4); see `rod.inertia`.
        gravity: acceleration g in space, mm/s².
    """

    inertia: Floats
    gravity: Vector

    @property
    def conservative(self) -> bool:
        """See `Term`."""
        return True

    @functools.cached_property
    def loads(self) -> Floats:
        """On the frames, (n + 1, 3, 4); see `Shape.pulled`."""
        acceleration = np.asarray(self.gravity, dtype=float)
        out: Floats = acceleration[:, None] * self.inertia[:, None, 3, :]
        return out

    def potential(self, shape: Shape, amount: float) -> float:
        """See `Term`; zero where all masses are at the origin."""
        return -amount * float(np.sum(self.loads * shape.frames))

    def residual(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return -shape.pulled(amount * self.loads)

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return -shape.curved(amount * self.loads)

    def growth(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return self.residual(shape, 1.0)


@dataclasses.dataclass(frozen=True)
class TipForce:
    """A force at the tip.

    A dead one has the potential −F·r. One that follows does virtual work, and its tangent is not
    symmetric.

    Attributes:
        force: F, N; in space, or in the tip's axes where it follows.
        follows: it turns with the tip.
        arm: where it acts, in the tip's own axes, mm.
    """

    force: Vector
    follows: bool = False
    arm: Vector = NO_LOAD

    @property
    def conservative(self) -> bool:
        """See `Term`."""
        return not self.follows

    def _loads(self, shape: Shape) -> Floats:
        """On the frames, (n + 1, 3, 4); see `Shape.pulled`."""
        force = np.asarray(self.force, dtype=float)
        if self.follows:
            force = shape.rotations[-1] @ force
        out = np.zeros_like(shape.frames)
        out[-1] = np.outer(force, [*self.arm, 1.0])
        return out

    def potential(self, shape: Shape, amount: float) -> float:
        """See `Term`."""
        if self.follows:
            return 0.0
        return -amount * float(np.sum(self._loads(shape)[-1] * shape.frames[-1]))

    def residual(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return -amount * shape.pulled(self._loads(shape))

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        loads = self._loads(shape)
        out = shape.curved(loads)
        if self.follows:
            moved, turned = shape.jacobian()
            arm = shape.rotations[-1] @ np.asarray(self.arm, dtype=float)
            out -= (moved - cross_matrix(arm) @ turned).T @ cross_matrix(loads[-1, :, 3]) @ turned
        return -amount * out

    def growth(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return self.residual(shape, 1.0)


@dataclasses.dataclass(frozen=True)
class TipMoment:
    """A moment at the tip.

    In space it has no potential: it does virtual work, and its tangent is not symmetric in general.
    In a plane there is `PlaneMoment`.

    Attributes:
        moment: M, N mm; in space, or in the tip's axes where it follows.
        follows: it turns with the tip.
    """

    moment: Vector
    follows: bool = False

    @property
    def conservative(self) -> bool:
        """See `Term`."""
        return False

    def _turning(self, shape: Shape) -> Floats:
        """The moment in space, (3,), N mm."""
        moment = np.asarray(self.moment, dtype=float)
        return shape.rotations[-1] @ moment if self.follows else moment

    def potential(self, shape: Shape, amount: float) -> float:
        """See `Term`."""
        return 0.0

    def residual(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        work = self._turning(shape) @ shape.jacobian()[1]
        out: Floats = -amount * work.reshape(shape.strains.shape)
        return out

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        moment = self._turning(shape)
        out = shape.spun(moment)
        if self.follows:
            turned = shape.jacobian()[1]
            out -= turned.T @ (cross_matrix(moment) @ turned)
        return -amount * out

    def growth(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return self.residual(shape, 1.0)


@dataclasses.dataclass(frozen=True)
class PlaneMoment:
    """−M θ: a moment about x at the tip of a rod that bends in the plane of y and z.

    Attributes:
        moment: M, N mm; it bends toward −y where it is positive.
    """

    moment: float

    @property
    def conservative(self) -> bool:
        """See `Term`."""
        return True

    def potential(self, shape: Shape, amount: float) -> float:
        """See `Term`; zero where the rod is straight."""
        return float(np.sum(self.residual(shape, amount) * shape.strains))

    def residual(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return -amount * self.moment * shape.layout.weights("curvature")

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return np.zeros((shape.strains.size, shape.strains.size))

    def growth(self, shape: Shape, amount: float) -> Floats:
        """See `Term`."""
        return self.residual(shape, 1.0)
