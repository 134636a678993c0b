"""Global scalars eliminated from a bordered system with one factor of K.

    | K  B | | w |   | r |      K = ∂R/∂w, (n, n), factorised
    | C  D | | q | = | s |      B = ∂R/∂q, (n, m); C = ∂g/∂w, (m, n); D = ∂g/∂q, (m, m)

with n fields w, m scalars q and m side conditions g(w, q) = 0. Block elimination:
S = D − C K⁻¹B, q = S⁻¹ (s − C K⁻¹r), w = K⁻¹r − K⁻¹B q. Keller 1977, Numerical
solution of bifurcation and nonlinear eigenvalue problems, in Applications of Bifurcation Theory
(ed. Rabinowitz), Academic Press, pp. 359–384.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.ranks import total

Floats = npt.NDArray[np.float64]


class SideCondition(Protocol):
    """One more equation g(w, q) = 0, in exchange for one global scalar that is found."""

    def value(self) -> float:
        """g at the present state, scaled so that 1 is a large error."""

    def noise(self) -> float:
        """What round-off makes of it: less is none."""

    def lag(self) -> float:
        """What a step with the last tangent lacks of that; see `Problem.lag`."""

    def row(self) -> Floats:
        """∂g/∂w on the owned dofs, (owned,)."""

    def slope(self, scalar: str) -> float:
        """∂g/∂q of a global scalar."""


class BorderedSystem:
    """Rows and columns of the scalars at the present tangent, and their Schur complement.

    Args:
        columns: B, ∂R/∂q of every unknown scalar, owned part, m of (owned,).
        names: names of these scalars.
        conditions: as many equations.
        free: owned dofs that no constraint fixes, (owned,).
        solve: K⁻¹ times owned vectors, all at once.
        comm: communicator.

    Attributes:
        schur: Schur complement S of the scalars, (m, m), conditions by unknowns.
    """

    def __init__(
        self,
        columns: Sequence[Floats],
        names: Sequence[str],
        conditions: Sequence[SideCondition],
        free: npt.NDArray[np.bool_],
        solve: Callable[[Sequence[Floats]], list[Floats]],
        comm: MPI.Comm,
    ) -> None:
        self._comm = comm
        self.rows = [np.where(free, condition.row(), 0.0) for condition in conditions]
        self.spread = solve(columns)
        slopes = [[condition.slope(name) for name in names] for condition in conditions]
        self.schur = np.array(slopes).reshape(len(conditions), len(names))
        for spread, column in zip(self.spread, self.schur.T, strict=True):
            column -= self._dots(spread)

    def _dots(self, a: Floats) -> Floats:
        """Inner products of the rows with a vector, over all ranks."""
        mine = np.array([float(row @ a) for row in self.rows])
        dots: Floats = total(self._comm, mine)
        return dots

    def eliminate(self, a: Floats, r_q: Floats) -> tuple[Floats, Floats]:
        """Solution (w, q) of the bordered system.

        Args:
            a: K⁻¹ r, owned part, (owned,).
            r_q: right side s of the side conditions, (m,).
        """
        if not self.rows:
            return a, np.zeros(0)
        q = np.linalg.solve(self.schur, r_q - self._dots(a))
        for value, spread in zip(q, self.spread, strict=True):
            a = a - value * spread
        return a, q
