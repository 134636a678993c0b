"""Anderson's acceleration: many steps with one factor point to where they lead together.

A step with a factor K₀ that is not quite the tangent leads from x to g(x). Of the last m + 1 of
them, with changes f = g(x) − x, the next iterate is

    x_{k+1} = g_k − Σ γ_j (g_k − g_j),   γ = argmin ‖f_k − Σ γ_j (f_k − f_j)‖,

a quasi-Newton method whose secants all hold at once. Anderson 1965, J. ACM 12, pp. 547–560,
doi 10.1145/321296.321305; Fang and Saad 2009, Two classes of multisecant methods for nonlinear
acceleration, Numer. Linear Algebra Appl. 16, pp. 197–221, doi 10.1002/nla.617.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.ranks import total

Floats = npt.NDArray[np.float64]

DEPTH = 6
"""Steps that are remembered."""
INDEPENDENT = 1e-12
"""Changes whose part beside the others is smaller than this, squared, say nothing new."""


class Anderson:
    """The last steps with one factor; what is solved for may lie on several ranks.

    Args:
        comm: communicator.
        depth: steps that are remembered.
    """

    def __init__(self, comm: MPI.Comm, depth: int = DEPTH) -> None:
        self._comm, self._depth = comm, depth
        self._images: list[Floats] = []
        self._changes: list[Floats] = []

    def forget(self) -> None:
        """Begin anew: the factor is another one."""
        self._images.clear()
        self._changes.clear()

    def next(self, image: Floats, change: Floats) -> tuple[Floats, float]:
        """The next iterate, and the norm of the change that is left at it.

        Args:
            image: where the present step alone would lead, this rank's part, (n,).
            change: what it changes, in what the norm is taken of, this rank's part, (l,).
        """
        images = [image - old for old in self._images]
        changes = [change - old for old in self._changes]
        self._images = [*self._images, image][-self._depth :]
        self._changes = [*self._changes, change][-self._depth :]
        rows = np.array([*changes, change])
        gram: Floats = np.asarray(total(self._comm, rows @ rows.T))
        if not images:
            return image, float(np.sqrt(gram[0, 0]))
        size = np.sqrt(np.maximum(np.diag(gram)[:-1], 1e-300))
        left = gram[:-1, :-1] / np.outer(size, size)
        share = np.linalg.lstsq(left, gram[:-1, -1] / size, rcond=INDEPENDENT)[0] / size
        weights = np.append(-share, 1.0)
        rest = float(np.sqrt(max(weights @ gram @ weights, 0.0)))
        return image - np.tensordot(share, images, axes=1), rest
