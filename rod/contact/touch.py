"""Contact of a rod's surface with a rigid obstacle, without friction.

The penalty of a body (`fem.effects.contact`) on sections that keep their outline. A rod that is far
away pays for one distance a frame.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Self

import numpy as np

from rod.contact.impact import Impact
from rod.contact.obstacles import Gap, Obstacle, Vector
from rod.contact.penalty import Contacts, Penalty
from rod.contact.points import Points, placed
from rod.contact.skin import Skin
from rod.functions import Bools, Floats, Ints
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


class Touch(Penalty):
    """An obstacle and a rod's surface.

    The amount is the share of the stiffness; with a `travel` it is a distance in mm by which the
    obstacle has moved along it, and the stiffness is whole.

    Args:
        skin: points of the rod that may touch.
        obstacle: rigid body.
        stiffness: k, MPa/mm: pressure per depth.
        travel: direction in which the obstacle is moved, of any length above zero.
        keeps: the points stick to the surface: they are pulled as well as pushed.
        part: of a depth that is in the obstacle, where the surface of the rod yields too.

    Attributes:
        skin: as given.

    Raises:
        ValueError: a stiffness that is not positive, a travel without direction.
    """

    def __init__(
        self,
        skin: Skin,
        obstacle: Obstacle,
        stiffness: float,
        travel: Vector | None = None,
        keeps: bool = False,
        part: float = 1.0,
    ) -> None:
        super().__init__(len(skin.station), stiffness, keeps)
        self._part = part
        self.skin, self._obstacle, self._reach = skin, obstacle, skin.reach
        self._travel: Floats | None = None
        if travel is not None:
            way = np.asarray(travel, dtype=float)
            size = float(np.linalg.norm(way))
            if way.shape != (3,) or not (math.isfinite(size) and size > 0):
                raise ValueError(f"travel of an obstacle: a direction expected, not {travel}")
            self._travel = way / size

    def share(self, amount: float) -> float:
        """See `Penalty`."""
        return amount if self._travel is None else 1.0

    def _shift(self, amount: float) -> Floats:
        """By how much the obstacle has moved, (3,), mm."""
        return np.zeros(3) if self._travel is None else amount * self._travel

    def _rooms(self, shape: Shape, amount: float) -> Floats:
        """Lower bounds of the distances of all points of each piece, (n,), mm."""
        # a point is no further from the nearer end of its piece than half an arc and its arm
        away = self._obstacle.gap(shape.places - self._shift(amount))
        reach = (self._reach + shape.arcs / 2) * (1 + ROUND_OFF)
        out: Floats = np.minimum(away[:-1], away[1:]) - reach
        return out

    def room(self, shape: Shape, amount: float) -> float:
        """See `Penalty`."""
        return float(self._rooms(shape, amount).min())

    def close(self, shape: Shape, amount: float) -> Bools:
        """Stations whose points may touch, (s,)."""
        if self.keeps:
            return np.full(len(self.skin.pieces), True)
        out: Bools = (self._rooms(shape, amount) <= 0)[self.skin.pieces]
        return out

    def leapt(self, before: Shape, after: Shape, amount: float) -> bool:
        """Whether what is near may have passed through the obstacle between two shapes."""
        way = float(np.linalg.norm(after.places - before.places, axis=1).max())
        thin = way > self._obstacle.thickness
        return thin and self.room(before, amount) <= way

    def depth(self, points: Points, amount: float) -> Floats:
        """d of points, (q,), mm; negative apart."""
        if not len(points.x):
            return np.zeros(0)
        out: Floats = self._nearer(points.shape) - self._obstacle.gap(
            points.x - self._shift(amount)
        )
        return out

    @staticmethod
    def _nearer(shape: Shape) -> float:
        return ROUND_OFF * float(shape.layout.lengths.sum())

    def distance(self, x: Floats, amount: float) -> Gap:
        """Distances of points in space from the obstacle, with their derivatives."""
        return self._obstacle.near(x - self._shift(amount))

    def near(self, shape: Shape, amount: float) -> Meeting:
        """See `Penalty`."""
        points = placed(self.skin, shape, np.flatnonzero(self.close(shape, amount)))
        return Meeting(points, self._obstacle, self._shift(amount), self.depth(points, amount))

    def impact(self, before: Shape, amount: float, delay: float) -> Impact:
        """See `rod.term.Struck`."""
        return Impact(self, before, amount, delay)

    def grown(self, contacts: Contacts, amount: float) -> Floats:
        """See `Penalty`."""
        if self._travel is None or not isinstance(contacts, Meeting):
            return super().grown(contacts, amount)
        return contacts.shifted(self.stiffness, self._travel)

    def deeper(self, contacts: Contacts, amount: float, change: Floats, grows: float) -> Floats:
        """See `Penalty`."""
        more = contacts.deeper(change)
        if self._travel is None or not isinstance(contacts, Meeting):
            return more
        out: Floats = more + grows * (contacts.gap.normal @ self._travel)
        return out

    # --- what it has done -------------------------------------------------------------------------

    def clearance(self, shape: Shape, amount: float) -> float:
        """Least distance of a point from the obstacle, mm; negative: how deep it is inside."""
        points = placed(self.skin, shape, np.arange(len(self.skin.pieces)))
        gap = float(self._obstacle.gap(points.x - self._shift(amount)).min())
        return gap if gap > 0 else self._part * gap

    def touched(self, shape: Shape, amount: float) -> Touched:
        """Forces on the rod, and where it touches."""
        contacts = self.near(shape, amount)
        if not self.keeps:
            contacts = contacts.only(contacts.depth > 0)
        push = self.share(amount) * self.stiffness * contacts.areas * contacts.depth
        force = push[:, None] * contacts.gap.normal
        points = contacts.points
        return Touched(
            force.sum(axis=0),
            np.cross(points.x, force).sum(axis=0),
            float(points.areas.sum()),
            float(self.skin.lengths[points.stations].sum()),
            self.clearance(shape, amount),
        )


class Meeting:
    """Points near an obstacle; `rod.contact.penalty.Contacts`.

    Args:
        points: of the rod.
        obstacle: what they are near to.
        shift: by which it has moved, (3,), mm.
        depth: of the points, (q,), mm.

    Attributes:
        points: as given.
        depth: as given.
    """

    def __init__(self, points: Points, obstacle: Obstacle, shift: Floats, depth: Floats) -> None:
        self.points, self.depth = points, depth
        self._obstacle, self._shift = obstacle, shift

    @property
    def which(self) -> Ints:
        """See `Contacts`."""
        return self.points.which

    @property
    def areas(self) -> Floats:
        """See `Contacts`."""
        return self.points.areas

    @functools.cached_property
    def gap(self) -> Gap:
        """Distances with their derivatives."""
        return self._obstacle.near(self.points.x - self._shift)

    def only(self, mask: Bools) -> Self:
        """See `Contacts`."""
        points = self.points.only(mask)
        return type(self)(points, self._obstacle, self._shift, self.depth[mask])

    def pushed(self, push: Floats) -> Floats:
        """See `Contacts`."""
        return self.points.pulled(-push[:, None] * self.gap.normal)

    def stiffened(self, stiff: Floats, push: Floats) -> Floats:
        """See `Contacts`."""
        _, normal, bend = self.gap
        spring = stiff[:, None, None] * normal[:, :, None] * normal[:, None, :]
        spring -= push[:, None, None] * bend
        return self.points.stiffened(-push[:, None] * normal, spring)

    def deeper(self, change: Floats) -> Floats:
        """See `Contacts`."""
        out: Floats = -np.sum(self.gap.normal * self.points.moved(change), axis=1)
        return out

    def shifted(self, stiffness: float, travel: Floats) -> Floats:
        """Derivative of Σ k a d ∂d/∂ε by a way of the obstacle along a unit vector, (n, m)."""
        stiff = stiffness * self.areas
        change = (stiff * self.depth)[:, None] * (self.gap.bend @ travel)
        change -= (stiff * (self.gap.normal @ travel))[:, None] * self.gap.normal
        return self.points.pulled(change)
