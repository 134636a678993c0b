"""Two rods that may touch each other, without friction."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from rod.contact.tube import Pressing, Tube, gap
from rod.functions import Floats, cross
from rod.shape import Shape

DEEPEST = 0.1
"""Greatest depth, as a part of the hull's size: what is deeper may come out on the far side."""

Pair = tuple[Floats, Floats]


class Meeting:
    """Contact of two rods: the corners of each press on the tube of the other.

    Each corner stands for half of the area, so that the two surfaces together yield as one.

    Args:
        rods: their places in the system.
        tubes: their surfaces.
        stiffness: κ with which they yield, MPa/mm.

    Attributes:
        rods: as given.
        tubes: as given.

    Raises:
        ValueError: a rod with itself, or a stiffness that is not positive.
    """

    def __init__(self, rods: tuple[int, int], tubes: tuple[Tube, Tube], stiffness: float) -> None:
        if rods[0] == rods[1]:
            raise ValueError("two rods expected, not one with itself")
        if not stiffness > 0:
            raise ValueError(f"stiffness of a contact {stiffness} MPa/mm: more than zero expected")
        self.rods, self.tubes, self._stiffness = rods, tubes, stiffness
        self._last: tuple[Sequence[Shape], tuple[Pressing, Pressing]] | None = None

    def acts(self, shapes: Sequence[Shape]) -> bool:
        """See `Coupling`."""
        return any(len(pressing.points) for pressing in self._pressings(shapes))

    def potential(self, shapes: Sequence[Shape], amount: float) -> float:
        """See `Coupling`."""
        return amount * sum(pressing.potential for pressing in self._pressings(shapes))

    def residual(self, shapes: Sequence[Shape], amount: float) -> Floats:
        """See `Coupling`."""
        forth, back = (pressing.residual() for pressing in self._pressings(shapes))
        parts = [(forth[0] + back[1]).ravel(), (forth[1] + back[0]).ravel()]
        out: Floats = amount * np.concatenate(parts)
        return out

    def tangent(self, shapes: Sequence[Shape], amount: float) -> Floats:
        """See `Coupling`."""
        (a, ab, b), (c, cd, d) = (pressing.tangent() for pressing in self._pressings(shapes))
        out: Floats = amount * np.block([[a + d, ab + cd.T], [ab.T + cd, b + c]])
        return out

    def growth(self, shapes: Sequence[Shape], amount: float) -> Floats:
        """See `Coupling`."""
        return self.residual(shapes, 1.0)

    def outside(self, shapes: Sequence[Shape]) -> str:
        """See `Coupling`."""
        deepest = max(pressing.deepest for pressing in self._pressings(shapes))
        if deepest > DEEPEST * min(tube.hull.size for tube in self.tubes):
            first, second = (place + 1 for place in self.rods)
            return f"rods {first} and {second} are {deepest:.3g} mm in each other"
        return ""

    def leapt(self, before: Sequence[Shape], after: Sequence[Shape]) -> str:
        """See `Coupling`: no two frames may come nearer by more than half of what is between."""
        apart, changed = (one.places[:, None] - two.places for one, two in (before, after))
        moved = np.linalg.norm(changed - apart, axis=2)
        if np.any(moved > np.linalg.norm(apart, axis=2) / 2):
            first, second = (place + 1 for place in self.rods)
            return f"rods {first} and {second} move so far that they may pass through each other"
        return ""

    def iterate(self, before: Sequence[Shape]) -> Met:
        """See `Coupling`."""
        forth, back = self._pressings(before)
        return Met(self.rods, self.tubes, self._stiffness, (forth.pressures, back.pressures))

    def gap(self, shapes: Sequence[Shape]) -> float:
        """Least distance of the two surfaces, mm; below zero where they touch."""
        deepest = max(pressing.deepest for pressing in self._pressings(shapes))
        if deepest > 0:
            return -deepest
        one, two = shapes
        a, b = self.tubes
        found = min(gap((a, b), (one, two)), gap((b, a), (two, one)))
        if found < math.inf:
            return found
        # past each other: no nearer than their lines
        away = np.linalg.norm(one.places[:, None] - two.places, axis=2).min()
        arcs = one.arcs.max() + two.arcs.max()
        return max(float(away) - a.hull.reach - b.hull.reach - float(arcs) / 2, 0.0)

    def clearance(self, shapes: Sequence[Shape]) -> float:
        """Least distance of the two surfaces as far as their corners tell, mm; see `gap`."""
        room = self.gap(shapes)
        if room <= 0:
            return room
        one, two = (
            tube.points(shape).reshape(-1, 3)
            for tube, shape in zip(self.tubes, shapes, strict=True)
        )
        beside = float(cKDTree(one).query(two)[0].min())
        a, b = self.tubes
        pairs = [gap((a, b), (shapes[0], shapes[1])), gap((b, a), (shapes[1], shapes[0]))]
        return min(beside, *pairs)

    def force(self, shapes: Sequence[Shape], about: Floats) -> tuple[Floats, Floats]:
        """Of the second rod on the first, and its moment about a place, (3,), N and N mm."""
        forth, back = self._pressings(shapes)
        forces = np.concatenate([forth.forces, -back.forces])
        points = np.concatenate([forth.points, back.points])
        return forces.sum(axis=0), cross(points - about, forces).sum(axis=0)

    def _pressings(self, shapes: Sequence[Shape]) -> tuple[Pressing, Pressing]:
        """Corners of the first in the second, and of the second in the first."""
        known = self._last
        if known is None or any(a is not b for a, b in zip(known[0], shapes, strict=True)):
            known = self._last = (tuple(shapes), self._pressed(shapes))
        return known[1]

    def _pressed(self, shapes: Sequence[Shape]) -> tuple[Pressing, Pressing]:
        (one, two), (a, b), half = shapes, self.tubes, self._stiffness / 2
        return Pressing((a, b), (one, two), half), Pressing((b, a), (two, one), half)


class Met(Meeting):
    """A meeting within Newton's method: pressures of corners are unknowns beside the strains.

    Args:
        rods: as of `Meeting`.
        tubes: likewise.
        stiffness: likewise.
        pressures: of the corners of both rods, (n + 1, k) each, MPa.
    """

    def __init__(
        self, rods: tuple[int, int], tubes: tuple[Tube, Tube], stiffness: float, pressures: Pair
    ) -> None:
        super().__init__(rods, tubes, stiffness)
        self._pressures = pressures

    def _pressed(self, shapes: Sequence[Shape]) -> tuple[Pressing, Pressing]:
        (one, two), (a, b), half = shapes, self.tubes, self._stiffness / 2
        first, second = self._pressures
        forth = Pressing((a, b), (one, two), half, first)
        return forth, Pressing((b, a), (two, one), half, second)

    def stepped(self, shapes: Sequence[Shape], changes: Sequence[Floats]) -> bool:
        """See `rod.several.system.CouplingIterate`."""
        (one, two), before = changes, self._pressures
        forth, back = self._pressings(shapes)
        after = forth.stepped((one, two)), back.stepped((two, one))
        self._pressures, self._last = after, None
        pairs = zip(before, after, strict=True)
        return all(np.array_equal(old > 0, new > 0) for old, new in pairs)
