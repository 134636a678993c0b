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
from typing import NamedTuple

import numpy as np

from rod.contact.obstacles import Obstacle
from rod.contact.skin import Skin
from rod.contact.split import Split
from rod.functions import Floats, Ints, cross_matrix
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


class _Points(NamedTuple):
    """Points of the skin that may touch."""

    which: Ints
    """In the skin, (q,)."""
    x: Floats
    """Places in space, (q, 3), mm."""


class Touch:
    """An obstacle and a rod's surface; a `rod.term.Term`.

    The amount is the share of the stiffness; with a `travel` it is a distance in mm by which the
    obstacle has moved along it, and the stiffness is whole.

    Args:
        skin: points of the rod that may touch.
        obstacle: rigid body.
        stiffness: k, MPa/mm: pressure per depth.
        travel: direction in which the obstacle is moved, of any length above zero.
        keeps: the points stick to the surface: they are pulled as well as pushed.

    Raises:
        ValueError: a stiffness that is not positive, a travel without direction.
    """

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
        self.skin, self.obstacle, self.stiffness = skin, obstacle, stiffness
        self.keeps = keeps
        self._reach = skin.reach
        self._travel: Floats | None = None
        if travel is not None:
            way = np.asarray(travel, dtype=float)
            size = float(np.linalg.norm(way))
            if way.shape != (3,) or not (math.isfinite(size) and size > 0):
                raise ValueError(f"travel of an obstacle: a direction expected, not {travel}")
            self._travel = way / size

    # --- what touches ------------------------------------------------------------------------------

    def _moved(self, amount: float) -> tuple[Floats | float, float]:
        """By how much the obstacle has moved, mm, and the share of its stiffness."""
        return (0.0, amount) if self._travel is None else (amount * self._travel, 1.0)

    def _points(self, shape: Shape, shift: Floats | float) -> _Points:
        """Those of pieces that are near enough to touch."""
        skin = self.skin
        if self.keeps:
            stations = np.arange(len(skin.pieces))
        else:
            # a point is no further from the nearer end of its piece than half an arc and its arm
            away = self.obstacle.gap(shape.places - shift)
            arm = self._reach + shape.arcs / 2
            close = np.minimum(away[:-1], away[1:]) <= arm * (1 + ROUND_OFF)
            stations = np.flatnonzero(close[skin.pieces])
            if not len(stations):
                return _Points(np.empty(0, dtype=np.intp), np.empty((0, 3)))
        return self._placed(shape, stations)

    def _placed(self, shape: Shape, stations: Ints) -> _Points:
        """Points of stations in space."""
        skin = self.skin
        frames = shape.between(skin.pieces[stations], skin.parts[stations])
        row = np.full(len(skin.pieces), -1, dtype=np.intp)
        row[stations] = np.arange(len(stations))
        row = row[skin.station]
        which = np.flatnonzero(row >= 0)
        at = frames[row[which]]
        x = np.einsum("pij,pj->pi", at[:, :, :2], skin.places[which]) + at[..., 3]
        return _Points(which, x)

    def _depths(self, shape: Shape, shift: Floats | float) -> tuple[_Points, Floats]:
        """Points that touch, and their depths in mm."""
        points = self._points(shape, shift)
        if not len(points.which):
            return points, np.empty(0)
        nearer = ROUND_OFF * shape.layout.lengths.sum()
        depth = nearer - self.obstacle.gap(points.x - shift)
        if self.keeps:
            return points, depth
        deep = depth > 0
        return _Points(points.which[deep], points.x[deep]), depth[deep]

    # --- the term ----------------------------------------------------------------------------------

    @property
    def conservative(self) -> bool:
        """See `rod.term.Term`."""
        return True

    def potential(self, shape: Shape, amount: float) -> float:
        """Π, N mm."""
        shift, share = self._moved(amount)
        points, depth = self._depths(shape, shift)
        return share * self.stiffness / 2 * float(self.skin.areas[points.which] @ depth**2)

    def residual(self, shape: Shape, amount: float) -> Floats:
        """∂Π/∂ε, (n, m)."""
        shift, share = self._moved(amount)
        points, depth = self._depths(shape, shift)
        if not len(depth):
            return np.zeros(shape.layout.shape)
        push = -share * self.stiffness * self.skin.areas[points.which] * depth
        force = push[:, None] * self.obstacle.near(points.x - shift).normal
        split, frame = self._split(shape, points)
        return split.gathered(split.fine.pulled(self._loads(split, frame, points, force)))

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """∂²Π/∂ε², (n m, n m)."""
        shift, share = self._moved(amount)
        points, depth = self._depths(shape, shift)
        count = shape.strains.size
        if not len(depth):
            return np.zeros((count, count))
        near = self.obstacle.near(points.x - shift)
        stiff = share * self.stiffness * self.skin.areas[points.which]
        force = -(stiff * depth)[:, None] * near.normal
        spring = stiff[:, None, None] * _square(near.normal)
        spring = spring - (stiff * depth)[:, None, None] * near.bend
        split, frame = self._split(shape, points)
        arm = cross_matrix(points.x)
        blocks = np.zeros((len(split.fine.places), 6, 6))
        turned = spring @ arm
        np.add.at(blocks[:, :3, :3], frame, spring)
        np.add.at(blocks[:, :3, 3:], frame, -turned)
        np.add.at(blocks[:, 3:, :3], frame, -np.swapaxes(turned, 1, 2))
        np.add.at(blocks[:, 3:, 3:], frame, np.swapaxes(arm, 1, 2) @ turned)
        loads = self._loads(split, frame, points, force)
        return split.matrix(split.fine.stiffened(blocks) + split.fine.curved(loads))

    def growth(self, shape: Shape, amount: float) -> Floats:
        """Derivative of the residual by the amount, (n, m)."""
        if self._travel is None:
            return self.residual(shape, 1.0)
        shift, _ = self._moved(amount)
        points, depth = self._depths(shape, shift)
        if not len(depth):
            return np.zeros(shape.layout.shape)
        near = self.obstacle.near(points.x - shift)
        stiff = self.stiffness * self.skin.areas[points.which]
        along = near.normal @ self._travel
        change = (stiff * depth)[:, None] * (near.bend @ self._travel)
        change -= (stiff * along)[:, None] * near.normal
        split, frame = self._split(shape, points)
        return split.gathered(split.fine.pulled(self._loads(split, frame, points, change)))

    def _split(self, shape: Shape, points: _Points) -> tuple[Split, Ints]:
        """The rod split where points touch, and the frame of each point."""
        skin = self.skin
        stations, back = np.unique(skin.station[points.which], return_inverse=True)
        split = Split(shape, skin.pieces[stations], skin.parts[stations])
        return split, split.frames[back]

    def _loads(self, split: Split, frame: Ints, points: _Points, force: Floats) -> Floats:
        """Forces at points as loads on the frames, (·, 3, 4)."""
        arms = np.zeros((len(frame), 4))
        arms[:, :2], arms[:, 3] = self.skin.places[points.which], 1.0
        out = np.zeros_like(split.fine.frames)
        np.add.at(out, frame, force[:, :, None] * arms[:, None, :])
        return out

    # --- what it has done --------------------------------------------------------------------------

    def gap(self, shape: Shape, amount: float) -> float:
        """Least distance of a point from the obstacle, mm; negative inside."""
        shift, _ = self._moved(amount)
        points = self._placed(shape, np.arange(len(self.skin.pieces)))
        return float(self.obstacle.gap(points.x - shift).min())

    def touched(self, shape: Shape, amount: float) -> Touched:
        """Forces on the rod, and where it touches."""
        shift, share = self._moved(amount)
        points, depth = self._depths(shape, shift)
        push = share * self.stiffness * self.skin.areas[points.which] * depth
        force = push[:, None] * self.obstacle.near(points.x - shift).normal
        stations = np.unique(self.skin.station[points.which])
        return Touched(
            force.sum(axis=0),
            np.cross(points.x, force).sum(axis=0),
            float(self.skin.areas[points.which].sum()),
            float(self.skin.lengths[stations].sum()),
            self.gap(shape, amount),
        )


def _square(vectors: Floats) -> Floats:
    out: Floats = vectors[:, :, None] * vectors[:, None, :]
    return out
