"""Contact of a rod's surface with a rigid obstacle, without friction.

Π = Σ ½ k a d², d the depth of a point of the surface in the obstacle and a the area at rest for
which it stands: the penalty of a body (`fem.effects.contact`) on sections that keep their outline.
Once continuously differentiable, so that touch and lift-off bend the forces and do not break them;
nothing acts at a distance, and a rod that is far away pays for one distance a frame.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from rod.contact.obstacles import Obstacle
from rod.contact.points import Points, placed
from rod.contact.skin import Skin
from rod.functions import Floats
from rod.shape import Shape

ROUND_OFF = 1e-12
"""Obstacles are so much nearer, as a part of the rod: where one lies against it, all of its points
are in the first tangent, not those whose gap of ±1e-16 round-off makes negative."""


@dataclasses.dataclass(frozen=True)
class Touched:
    """What an obstacle does to a rod.

    Attributes:
        force: on the rod, (3,), N.
        moment: on the rod about the origin, (3,), N mm.
        area: at rest of what touches, mm².
        length: of the rod at rest that touches, mm.
        gap: least distance of a point, mm; negative: how deep the rod is.
    """

    force: Floats
    moment: Floats
    area: float
    length: float
    gap: float


class Touch:
    """An obstacle and a rod's surface; a `rod.term.Iterated`.

    The amount is the share of the stiffness; with a `travel` it is a distance in mm by which the
    obstacle has moved along it, and the stiffness is whole.

    Args:
        skin: points of the rod that may touch.
        obstacle: rigid body.
        stiffness: k, MPa/mm: pressure per depth.
        travel: direction in which the obstacle is moved, of any length above zero.
        keeps: the points stick to the surface: they are pulled as well as pushed.

    Attributes:
        conservative: it is the derivative of its potential.

    Raises:
        ValueError: a stiffness that is not positive, a travel without direction.
    """

    conservative = True

    def __init__(
        self,
        skin: Skin,
        obstacle: Obstacle,
        stiffness: float,
        travel: Sequence[float] | None = None,
        keeps: bool = False,
    ) -> None:
        if not stiffness > 0:
            raise ValueError(f"contact stiffness {stiffness} MPa/mm, expected a positive value")
        self._skin, self._obstacle, self._stiffness = skin, obstacle, stiffness
        self._keeps, self._reach = keeps, skin.reach
        self._travel: Floats | None = None
        if travel is not None:
            way = np.asarray(travel, dtype=float)
            size = float(np.linalg.norm(way))
            if way.shape != (3,) or not (math.isfinite(size) and size > 0):
                raise ValueError(f"travel of an obstacle: a direction expected, not {travel}")
            self._travel = way / size

    # --- the term ----------------------------------------------------------------------------------

    def potential(self, shape: Shape, amount: float) -> float:
        """Π, N mm."""
        points, depth = self._deep(shape, amount)
        return self._share(amount) * self._stiffness / 2 * float(points.areas @ depth**2)

    def residual(self, shape: Shape, amount: float) -> Floats:
        """∂Π/∂ε, (n, m)."""
        return self.pressed(*self._deep(shape, amount), amount)

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """∂²Π/∂ε², (n m, n m)."""
        points, depth = self._deep(shape, amount)
        return self.stiffened(points, self._share(amount) * self._stiffness * depth, amount)

    def growth(self, shape: Shape, amount: float) -> Floats:
        """Derivative of the residual by the amount, (n, m)."""
        return self.grown(*self._deep(shape, amount), amount)

    def iterate(self, before: Shape, amount: float) -> Pressed:
        """See `rod.term.Iterated`."""
        points, depth = self._deep(before, amount)
        pressure = np.zeros(len(self._skin.station))
        pressure[points.which] = self._share(amount) * self._stiffness * depth
        return Pressed(self, pressure)

    # --- what it has done --------------------------------------------------------------------------

    def gap(self, shape: Shape, amount: float) -> float:
        """Least distance of a point from the obstacle, mm; negative inside."""
        points = placed(self._skin, shape, np.arange(len(self._skin.pieces)))
        return float(self._obstacle.gap(points.x - self._shift(amount)).min())

    def touched(self, shape: Shape, amount: float) -> Touched:
        """Forces on the rod, and where it touches."""
        points, depth = self._deep(shape, amount)
        push = self._share(amount) * self._stiffness * points.areas * depth
        force = push[:, None] * self._obstacle.near(points.x - self._shift(amount)).normal
        return Touched(
            force.sum(axis=0),
            np.cross(points.x, force).sum(axis=0),
            float(points.areas.sum()),
            float(self._skin.lengths[points.stations].sum()),
            self.gap(shape, amount),
        )

    # --- by points and their depths ----------------------------------------------------------------

    def _shift(self, amount: float) -> Floats:
        """By how much the obstacle has moved, (3,), mm."""
        return np.zeros(3) if self._travel is None else amount * self._travel

    def _share(self, amount: float) -> float:
        """Of the stiffness that acts."""
        return amount if self._travel is None else 1.0

    def close(self, shape: Shape, amount: float) -> tuple[Points, Floats]:
        """Points of pieces that are near enough to touch, and their depths in mm."""
        skin, shift = self._skin, self._shift(amount)
        stations = np.arange(len(skin.pieces))
        if not self._keeps:
            # a point is no further from the nearer end of its piece than half an arc and its arm
            away = self._obstacle.gap(shape.places - shift)
            arm = self._reach + shape.arcs / 2
            close = np.minimum(away[:-1], away[1:]) <= arm * (1 + ROUND_OFF)
            stations = np.flatnonzero(close[skin.pieces])
        points = placed(skin, shape, stations)
        if not len(stations):
            return points, np.zeros(0)
        nearer = ROUND_OFF * float(shape.layout.lengths.sum())
        return points, nearer - self._obstacle.gap(points.x - shift)

    def held(self, points: Points, depth: Floats, pressure: Floats) -> tuple[Points, Floats]:
        """Points that are inside or pressed, and their depths.

        Args:
            points: near ones.
            depth: of them, mm.
            pressure: of them, MPa.
        """
        if self._keeps:
            return points, depth
        touches = (depth > 0) | (pressure > 0)
        return points.only(touches), depth[touches]

    def _deep(self, shape: Shape, amount: float) -> tuple[Points, Floats]:
        """Points that touch, and their depths."""
        points, depth = self.close(shape, amount)
        return self.held(points, depth, np.zeros(len(depth)))

    def pressed(self, points: Points, depth: Floats, amount: float) -> Floats:
        """Residual by depths of points, (n, m)."""
        push = self._share(amount) * self._stiffness * points.areas * depth
        normal = self._obstacle.near(points.x - self._shift(amount)).normal
        return points.pulled(-push[:, None] * normal)

    def stiffened(self, points: Points, pressure: Floats, amount: float) -> Floats:
        """Its derivative by the strains at pressures of the points, (n m, n m)."""
        near = self._obstacle.near(points.x - self._shift(amount))
        stiff = self._share(amount) * self._stiffness * points.areas
        push = points.areas * pressure
        spring = stiff[:, None, None] * near.normal[:, :, None] * near.normal[:, None, :]
        spring -= push[:, None, None] * near.bend
        return points.stiffened(-push[:, None] * near.normal, spring)

    def grown(self, points: Points, depth: Floats, amount: float) -> Floats:
        """Its derivative by the amount, (n, m)."""
        if self._travel is None:
            return self.pressed(points, depth, 1.0)
        near = self._obstacle.near(points.x - self._shift(amount))
        stiff = self._stiffness * points.areas
        change = (stiff * depth)[:, None] * (near.bend @ self._travel)
        change -= (stiff * (near.normal @ self._travel))[:, None] * near.normal
        return points.pulled(change)

    def pressures(
        self, points: Points, depth: Floats, amount: float, change: Floats, grows: float
    ) -> Floats:
        """Pressures of points after a step, by the first order of their depths, (q,), MPa.

        Args:
            points: as of `held`.
            depth: of them, mm.
            amount: before the step.
            change: of the strains, (n, m).
            grows: change of the amount.
        """
        normal = self._obstacle.near(points.x - self._shift(amount)).normal
        way = points.moved(change)
        if self._travel is not None:
            way = way - grows * self._travel
        deeper = depth - np.sum(normal * way, axis=1)
        pressure: Floats = self._share(amount) * self._stiffness * deeper
        return pressure


class Pressed:
    """A `Touch` within Newton's method: pressures of points are unknowns beside the strains.

    With p = k d where something is pressed and p = 0 elsewhere, a step gives p = k (d − ∇g·δε) of
    the points that are held to touch: those that are pressed already, or are inside (the active set
    of Hintermüller, Ito and Kunisch 2002, doi 10.1137/S1052623401383558, for c → 0). What turns
    leaves the straight line of a step by the square of an angle times a lever, many times a depth:
    by depths alone a step would lose what touches, and the next one find nothing there.

    Args:
        touch: the term.
        pressure: p of each point of its skin, MPa.

    Attributes:
        conservative: as the term.
    """

    conservative = True

    def __init__(self, touch: Touch, pressure: Floats) -> None:
        self._touch, self._pressure = touch, pressure

    def _held(self, shape: Shape, amount: float) -> tuple[Points, Floats]:
        points, depth = self._touch.close(shape, amount)
        return self._touch.held(points, depth, self._pressure[points.which])

    def potential(self, shape: Shape, amount: float) -> float:
        """Of the term."""
        return self._touch.potential(shape, amount)

    def residual(self, shape: Shape, amount: float) -> Floats:
        """With the depths, or heights, of the points that are held to touch, (n, m)."""
        return self._touch.pressed(*self._held(shape, amount), amount)

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """With the pressures that are known, (n m, n m)."""
        points, _ = self._held(shape, amount)
        return self._touch.stiffened(points, self._pressure[points.which], amount)

    def growth(self, shape: Shape, amount: float) -> Floats:
        """See `rod.term.Term`."""
        return self._touch.grown(*self._held(shape, amount), amount)

    def stepped(self, shape: Shape, amount: float, change: Floats, grows: float) -> bool:
        """See `rod.term.Iterate`."""
        points, depth = self._held(shape, amount)
        pressure = self._touch.pressures(points, depth, amount, change, grows)
        before = self._pressure > 0
        self._pressure = np.zeros_like(self._pressure)
        self._pressure[points.which] = np.maximum(pressure, 0.0)
        return bool(np.array_equal(before, self._pressure > 0))
