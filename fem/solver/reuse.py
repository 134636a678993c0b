"""When the last factor serves for one more step of Newton's method, and what such steps give."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.solver.anderson import Anderson

Floats = npt.NDArray[np.float64]
History = Sequence[tuple[float, float, float]]

NEAR, NEAR_RATIO, CHORD_RATIO = 1e-3, 0.02, 0.1
"""A factor is used again below this residual, after this reduction, and while it reduces so."""
POOR = 0.5
"""One factor is to serve a whole solve while its steps shrink so."""


class Reuse:
    """The factors of one solve, and the steps that are made with each.

    Where a factor costs as much as twenty solves, the first is to serve a whole solve. Where its
    steps hardly shrink it is too far from the solution: a second one follows, and where its steps
    do not either, factors are renewed until Newton's method is near.

    Args:
        comm: communicator.
        allowed: a factor may serve twice.
        spares: the first is to serve the whole solve.

    Attributes:
        fresh: the next step has a factor of its own.
        tangents: number of residuals before each factor.
        solves: linear solves.
        spared: those of them with an old factor in a solve that one is to serve.
    """

    def __init__(self, comm: MPI.Comm, allowed: bool = True, spares: bool = False) -> None:
        self._allowed, self._spares = allowed, allowed and spares
        self._anderson = Anderson(comm)
        self._steps: list[float] = []
        self.fresh = True
        self.tangents: list[int] = []
        self.solves = self.spared = 0

    @property
    def effort(self) -> float:
        """Solves with a factor each that do as much: two with an old one count as one."""
        return self.solves - self.spared / 2

    def renews(self, history: History) -> bool:
        """Whether the next step needs a new factor.

        Args:
            history: residuals of forces, volumes and side conditions so far, relative.
        """
        self.fresh = not (self._allowed and bool(self.tangents) and self._serves(history))
        if self.fresh:
            self.tangents.append(len(history))
            self._anderson.forget()
            self._steps.clear()
        return self.fresh

    def _serves(self, history: History) -> bool:
        if self._spares:
            poor = len(self._steps) > 1 and self._steps[-1] > POOR * self._steps[-2]
            self._spares = not poor or len(self.tangents) < 2
            return not poor
        if len(history) < 2:
            return False
        now, before = max(history[-1]), max(history[-2])
        if self.tangents[-1] == len(history) - 1:
            # the factor is one iterate old: near the solution its error is that of this step
            return now < NEAR and now < NEAR_RATIO * before
        return now < CHORD_RATIO * before

    def next(self, image: Floats, change: Floats) -> Floats:
        """The next iterate; see `Anderson.next`.

        Args:
            image: where the step that was solved for would lead, this rank's part, (n,).
            change: of what tells its size, this rank's part, (l,).
        """
        self.solves += 1
        self.spared += self._spares and not self.fresh
        image, left = self._anderson.next(image, change)
        self._steps.append(left)
        return image
