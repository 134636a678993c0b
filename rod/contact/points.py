"""Points of a rod's surface in space: forces on them, springs, and how they move.

A screw is the product of its parts: pieces that are split with the same strains are the same rod.
What a finer `Shape` knows of forces on its frames is exact for any place along a piece.
"""

from __future__ import annotations

import functools

import numpy as np

from rod.contact.skin import Skin
from rod.functions import Floats, Ints, cross_matrix
from rod.layout import Layout
from rod.shape import Shape


class Points:
    """Points of a skin on a rod of a given shape.

    Args:
        skin: where they are.
        shape: the rod.
        which: of the skin's points, in order, (q,).
        x: their places in space, (q, 3), mm.

    Attributes:
        which: as given.
        x: as given.
        areas: of the surface at rest for which each stands, (q,), mm².
    """

    def __init__(self, skin: Skin, shape: Shape, which: Ints, x: Floats) -> None:
        self._skin, self._shape = skin, shape
        self.which, self.x = which, x
        self.areas: Floats = skin.areas[which]

    def only(self, mask: Floats) -> Points:
        """Some of them."""
        return Points(self._skin, self._shape, self.which[mask], self.x[mask])

    @functools.cached_property
    def stations(self) -> Ints:
        """Stations of the skin on which they are."""
        return np.unique(self._skin.station[self.which])

    @functools.cached_property
    def _split(self) -> _Split:
        """The rod split where they are."""
        return _Split(
            self._shape, self._skin.pieces[self.stations], self._skin.parts[self.stations]
        )

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
            return np.zeros(self._shape.layout.shape)
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
            count = self._shape.strains.size
            return np.zeros((count, count))
        fine = self._split.fine
        blocks = np.zeros((len(fine.places), 6, 6))
        arm = cross_matrix(self.x)
        turned = spring @ arm
        np.add.at(blocks[:, :3, :3], self._frame, spring)
        np.add.at(blocks[:, :3, 3:], self._frame, -turned)
        np.add.at(blocks[:, 3:, :3], self._frame, -np.swapaxes(turned, 1, 2))
        np.add.at(blocks[:, 3:, 3:], self._frame, np.swapaxes(arm, 1, 2) @ turned)
        return self._split.matrix(fine.stiffened(blocks) + fine.curved(self._loads(force)))

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


class _Split:
    """The finer shape, and the way back to the strains of the whole pieces.

    Args:
        shape: the rod.
        pieces: of the stations, (s,).
        parts: of these pieces before the stations, above 0 up to 1, (s,).

    Attributes:
        fine: shape whose frames the stations are; `shape` itself where no piece is split.
        frames: frame of each station, (s,).
    """

    def __init__(self, shape: Shape, pieces: Ints, parts: Floats) -> None:
        n = len(shape.layout.lengths)
        at = pieces + parts
        ends = np.union1d(at, np.arange(1.0, n + 1))
        self.frames: Ints = np.searchsorted(ends, at) + 1
        self._shape = shape.layout.shape
        self._owner = np.ceil(ends).astype(np.intp) - 1
        self._starts = np.searchsorted(self._owner, np.arange(n))
        self._whole = len(ends) == n
        if self._whole:
            self.fine = shape
            return
        layout = shape.layout
        lengths = np.diff(ends, prepend=0.0) * layout.lengths[self._owner]
        finer = Layout(lengths, layout.strains, layout.rotation, layout.place)
        self.fine = Shape(finer, self.spread(shape.strains))

    def spread(self, strains: Floats) -> Floats:
        """Of the finer pieces by those of whole ones."""
        return strains if self._whole else strains[self._owner]

    def gathered(self, by_strains: Floats) -> Floats:
        """Derivatives by strains of the whole pieces, (n, m), from those of the finer ones."""
        if self._whole:
            return by_strains
        out: Floats = np.add.reduceat(by_strains, self._starts, axis=0)
        return out

    def matrix(self, second: Floats) -> Floats:
        """The same of second derivatives, (n m, n m)."""
        if self._whole:
            return second
        n, m = self._shape
        count = len(self._owner)
        rows = np.add.reduceat(second.reshape(count, m, count, m), self._starts, axis=0)
        out: Floats = np.add.reduceat(rows, self._starts, axis=2)
        return out.reshape(n * m, n * m)
