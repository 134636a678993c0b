"""Global scalars eliminated from a bordered system with one factor of K."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.ranks import total

Floats = npt.NDArray[np.float64]


class Closure(Protocol):
    """One more equation g(w, q) = 0, in exchange for one global scalar that is found."""

    def value(self) -> float:
        """g at the present state, scaled so that 1 is a large error."""

    def row(self) -> Floats:
        """∂g/∂w on the owned dofs."""

    def slope(self, scalar: str) -> float:
        """∂g/∂q of a global scalar."""


class Border:
    """Rows and columns of the scalars at the present tangent, and their Schur complement.

    Args:
        columns: ∂R/∂q of every unknown scalar, owned part.
        names: names of these scalars.
        closures: as many equations.
        free: owned dofs that no constraint holds.
        solve: K⁻¹ times owned vectors.
        comm: communicator.

    Attributes:
        schur: Schur complement of the scalars, equations by unknowns.
    """

    def __init__(
        self,
        columns: Sequence[Floats],
        names: Sequence[str],
        closures: Sequence[Closure],
        free: npt.NDArray[np.bool_],
        solve: Callable[[Sequence[Floats]], list[Floats]],
        comm: MPI.Comm,
    ) -> None:
        self._comm = comm
        self.rows = [np.where(free, closure.row(), 0.0) for closure in closures]
        self.spread = solve(columns)
        slopes = [[closure.slope(name) for name in names] for closure in closures]
        self.schur = np.array(slopes).reshape(len(closures), len(names))
        for spread, column in zip(self.spread, self.schur.T, strict=True):
            column -= self._dots(spread)

    def _dots(self, a: Floats) -> Floats:
        """Inner products of the rows with a vector, over all ranks."""
        mine = np.array([float(row @ a) for row in self.rows])
        dots: Floats = total(self._comm, mine)
        return dots

    def eliminate(self, a: Floats, r_q: Floats) -> tuple[Floats, Floats]:
        """Solution (w, q) of the bordered system from a = K⁻¹ r and the scalars' right side."""
        if not self.rows:
            return a, np.zeros(0)
        q = np.linalg.solve(self.schur, r_q - self._dots(a))
        for value, spread in zip(q, self.spread, strict=True):
            a = a - value * spread
        return a, q
