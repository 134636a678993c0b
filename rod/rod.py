"""A rod with what acts on it: its potential, residual and tangent."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from rod.functions import Floats, cross_matrix
from rod.law import Law
from rod.layout import Layout
from rod.shape import Shape

NO_LOAD = (0.0, 0.0, 0.0)
Vector = Sequence[float]


@dataclasses.dataclass(frozen=True)
class Level:
    """How much of the loads acts.

    Attributes:
        pressure: P of the chamber, MPa.
        weight: share of the weight.
        tip: share of the tip's load.
    """

    pressure: float = 0.0
    weight: float = 0.0
    tip: float = 0.0

    def toward(self, other: Level, share: float) -> Level:
        """On the way to another: itself at 0, the other at 1."""
        rest = 1 - share
        return Level(
            rest * self.pressure + share * other.pressure,
            rest * self.weight + share * other.weight,
            rest * self.tip + share * other.tip,
        )

    def less(self, other: Level) -> Level:
        """Difference to another."""
        pressure, weight = self.pressure - other.pressure, self.weight - other.weight
        return Level(pressure, weight, self.tip - other.tip)


@dataclasses.dataclass(frozen=True)
class TipLoad:
    """A force and a moment at the tip.

    A dead force has the potential −F·r. A moment has one in the plane alone (the rod bends about x,
    M about x); in space, and where they follow, force and moment do virtual work, and the tangent
    is not symmetric.

    Attributes:
        force: F, N; in space, or in the tip's axes where it follows.
        moment: M, N mm; likewise.
        follows: they turn with the tip.
        arm: where F acts, in the tip's own axes, mm.
    """

    force: Vector = NO_LOAD
    moment: Vector = NO_LOAD
    follows: bool = False
    arm: Vector = NO_LOAD

    def held(self, shape: Shape) -> Floats:
        """The force as a load on the frames, (n + 1, 3, 4); see `Shape.pulled`."""
        force = np.asarray(self.force, dtype=float)
        if self.follows:
            force = shape.rotations[-1] @ force
        out = np.zeros_like(shape.frames)
        out[-1] = np.outer(force, [*self.arm, 1.0])
        return out

    def turning(self, shape: Shape) -> Floats:
        """The moment in space, (3,), N mm."""
        moment = np.asarray(self.moment, dtype=float)
        return shape.rotations[-1] @ moment if self.follows else moment

    def work(self, shape: Shape) -> Floats:
        """Virtual work of moment and following force by each strain, (n, m)."""
        out = np.zeros(shape.layout.shape)
        if self.follows:
            out += shape.pulled(self.held(shape))
        if any(self.moment):
            out += (self.turning(shape) @ shape.jacobian()[1]).reshape(out.shape)
        return out

    def slope(self, shape: Shape) -> Floats:
        """Derivative of `work`, (n m, n m)."""
        count = shape.strains.size
        out = np.zeros((count, count))
        if not (self.follows or any(self.moment)):
            return out
        moved, turned = shape.jacobian()
        if any(self.moment):
            moment = self.turning(shape)
            out += shape.spun(moment)
            if self.follows:
                out -= turned.T @ (cross_matrix(moment) @ turned)
        if self.follows:
            loads = self.held(shape)
            arm = shape.rotations[-1] @ np.asarray(self.arm, dtype=float)
            out += shape.curved(loads)
            out -= (moved - cross_matrix(arm) @ turned).T @ cross_matrix(loads[-1, :, 3]) @ turned
        return out


class Rod:
    """A rod with its law, inertia and loads.

    Args:
        layout: pieces, free strains and root.
        law: energy of the sections.
        inertia: masses on the frames, (n + 1, 4, 4); see `rod.inertia`. None: it weighs nothing.
        gravity: acceleration g in space, mm/s².
        tip: load on the tip.

    Attributes:
        layout: as given.
        law: as given.
        inertia: as given; zero where nothing is given.
        tip: as given.
    """

    def __init__(
        self,
        layout: Layout,
        law: Law,
        inertia: Floats | None = None,
        gravity: Vector = NO_LOAD,
        tip: TipLoad | None = None,
    ) -> None:
        frames = len(layout.lengths) + 1
        if inertia is not None and inertia.shape != (frames, 4, 4):
            raise ValueError(f"inertia: one of (4, 4) for each of {frames} frames expected")
        self.layout, self.law = layout, law
        self.inertia: Floats = np.zeros((frames, 4, 4)) if inertia is None else inertia
        self.tip = TipLoad() if tip is None else tip
        acceleration = np.asarray(gravity, dtype=float)
        self._weight: Floats = acceleration[:, None] * self.inertia[:, None, 3, :]

    def shape(self, strains: Floats) -> Shape:
        """Its line at given strains, (n, m)."""
        return Shape(self.layout, strains)

    def dead(self, level: Level) -> Floats:
        """Loads of constant direction on the frames, (n + 1, 3, 4); see `Shape.pulled`."""
        out: Floats = level.weight * self._weight
        if not self.tip.follows:
            out[-1] += level.tip * np.outer(self.tip.force, [*self.tip.arm, 1.0])
        return out

    def elastic(self, strains: Floats, pressure: float) -> float:
        """∫ Φ ds, N mm; the work of the air is in it."""
        return float(self.layout.lengths @ self.law.value(strains, pressure))

    def potential(self, shape: Shape, level: Level) -> float:
        """∫ Φ ds less the work of dead loads, N mm; what has no potential is left out."""
        dead = float(np.sum(self.dead(level) * shape.frames))
        return self.elastic(shape.strains, level.pressure) - dead

    def residual(self, shape: Shape, level: Level) -> Floats:
        """Its derivative by the strains less the virtual work of other loads, (n, m)."""
        forces = self.law.gradient(shape.strains, level.pressure)
        out: Floats = self.layout.lengths[:, None] * forces - shape.pulled(self.dead(level))
        return out - level.tip * self.tip.work(shape)

    def stiffness(self, strains: Floats, pressure: float) -> Floats:
        """Second derivative of ∫ Φ ds, (n m, n m): a block for each piece."""
        n, m = self.layout.shape
        blocks = self.layout.lengths[:, None, None] * self.law.hessian(strains, pressure)
        out = np.zeros((n, m, n, m))
        place = np.arange(n)
        out[place, :, place] = blocks
        return out.reshape(n * m, n * m)

    def tangent(self, shape: Shape, level: Level) -> Floats:
        """Derivative of the residual by the strains, (n m, n m)."""
        elastic = self.stiffness(shape.strains, level.pressure)
        out: Floats = elastic - shape.curved(self.dead(level))
        if level.tip:
            out -= level.tip * self.tip.slope(shape)
        return out

    def growth(self, shape: Shape, level: Level, change: Level) -> Floats:
        """Derivative of the residual along a change of the level, (n, m)."""
        chamber = self.law.chamber_gradient(shape.strains, level.pressure)
        out: Floats = -change.pressure * self.layout.lengths[:, None] * chamber
        return out - shape.pulled(self.dead(change)) - change.tip * self.tip.work(shape)

    def volume(self, strains: Floats, pressure: float) -> float:
        """Of the chamber, mm³."""
        return float(self.layout.lengths @ self.law.chamber(strains, pressure))
