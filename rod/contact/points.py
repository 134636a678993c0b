"""Points of a rod's surface in space: forces on them, springs, and how they move."""

from __future__ import annotations

import functools

import numpy as np

from rod.contact.skin import Skin
from rod.contact.split import Split
from rod.functions import Bools, Floats, Ints, cross_matrix
from rod.shape import Shape


class Points:
    """Points of a skin on a rod of a given shape.

    Args:
        skin: where they are.
        shape: the rod.
        which: of the skin's points, in order, (q,).
        x: their places in space, (q, 3), mm.

    Attributes:
        shape: as given.
        which: as given.
        x: as given.
        areas: of the surface at rest for which each stands, (q,), mm².
    """

    def __init__(self, skin: Skin, shape: Shape, which: Ints, x: Floats) -> None:
        self._skin, self.shape = skin, shape
        self.which, self.x = which, x
        self.areas: Floats = skin.areas[which]

    def only(self, mask: Bools) -> Points:
        """Some of them."""
        return Points(self._skin, self.shape, self.which[mask], self.x[mask])

    @functools.cached_property
    def stations(self) -> Ints:
        """Stations of the skin on which they are."""
        return np.unique(self._skin.station[self.which])

    @functools.cached_property
    def _split(self) -> Split:
        """The rod split where they are."""
        return Split(self.shape, self._skin.pieces[self.stations], self._skin.parts[self.stations])

    @functools.cached_property
    def _frame(self) -> Ints:
        """Frame of the finer shape on which each is, (q,)."""
        row = np.searchsorted(self.stations, self._skin.station[self.which])
        frames: Ints = self._split.frames[row]
        return frames

    @functools.cached_property
    def _arms(self) -> Floats:
        """(y, 1) of each in the axes of its section, (q, 4)."""
        arms = np.zeros((len(self.which), 4))
        arms[:, :2], arms[:, 3] = self._skin.places[self.which], 1.0
        return arms

    def pulled(self, force: Floats) -> Floats:
        """Work of forces, (q, 3) in N, by each strain, (n, m)."""
        if not len(self.which):
            return np.zeros(self.shape.layout.shape)
        return self._split.gathered(self._split.fine.pulled(self._loads(force)))

    def stiffened(self, force: Floats, spring: Floats) -> Floats:
        """Second derivative of a potential of the places.

        Args:
            force: its first derivative, (q, 3), N.
            spring: its second derivative, (q, 3, 3), N/mm.

        Returns:
            By the strains, (n m, n m).
        """
        if not len(self.which):
            count = self.shape.strains.size
            return np.zeros((count, count))
        fine = self._split.fine
        blocks = self._blocks(spring, self)
        return self._split.matrix(fine.stiffened(blocks) + fine.curved(self._loads(force)))

    def bent(self, force: Floats) -> Floats:
        """Second derivative of Σ f·x of forces that stay, (n m, n m)."""
        return self._split.matrix(self._split.fine.curved(self._loads(force)))

    def coupled(self, spring: Floats, other: Points) -> Floats:
        """Σ ∂x/∂i · D ∂x'/∂j with the places of the same points on another shape.

        Args:
            spring: D, (q, 3, 3), N/mm.
            other: the points there.

        Returns:
            (n m, n m).
        """
        blocks = self._blocks(spring, other)
        return self._split.matrix(self._split.fine.stiffened(blocks, other._split.fine))

    def _blocks(self, spring: Floats, other: Points) -> Floats:
        """See `Shape.stiffened`."""
        out = np.zeros((len(self._split.fine.places), 6, 6))
        arm, far = cross_matrix(self.x), cross_matrix(other.x)
        np.add.at(out[:, :3, :3], self._frame, spring)
        np.add.at(out[:, :3, 3:], self._frame, -spring @ far)
        np.add.at(out[:, 3:, :3], self._frame, arm @ spring)
        np.add.at(out[:, 3:, 3:], self._frame, -arm @ spring @ far)
        return out

    def moved(self, change: Floats) -> Floats:
        """First order of their way by a change of the strains, (q, 3), mm."""
        if not len(self.which):
            return np.zeros((0, 3))
        rates = self._split.fine.moved(self._split.spread(change))
        out: Floats = np.einsum("qij,qj->qi", rates[self._frame], self._arms)
        return out

    def _loads(self, force: Floats) -> Floats:
        """Forces as loads on the frames, (·, 3, 4)."""
        out = np.zeros_like(self._split.fine.frames)
        np.add.at(out, self._frame, force[:, :, None] * self._arms[:, None, :])
        return out


def placed(skin: Skin, shape: Shape, stations: Ints) -> Points:
    """All points of some stations of a skin."""
    row = np.full(len(skin.pieces), -1, dtype=np.intp)
    row[stations] = np.arange(len(stations))
    row = row[skin.station]
    which = np.flatnonzero(row >= 0)
    if not len(which):
        return Points(skin, shape, which, np.zeros((0, 3)))
    frames = shape.between(skin.pieces[stations], skin.parts[stations])[row[which]]
    across = np.einsum("pij,pj->pi", frames[:, :, :2], skin.places[which])
    return Points(skin, shape, which, across + frames[..., 3])
