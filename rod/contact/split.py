"""A rod whose pieces are split at stations, for loads and springs between its frames.

A screw is the product of its parts: pieces that are split with the same strains are the same rod.
What a finer `Shape` knows of forces on its frames is exact for any place along a piece.
"""

from __future__ import annotations

import numpy as np

from rod.functions import Floats, Ints
from rod.layout import Layout
from rod.plane import placed
from rod.shape import Shape


class Split:
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
        self.fine = placed(finer, self.spread(shape.strains))

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
