"""Iterative solver for long bodies: slabs along the axis, each with a factor of its own.

Overlapping slabs are solved for the displacements and pressures within them, all else at rest, and
each slab's answer counts where the slab is not overlapped (restricted additive Schwarz, Cai and
Sarkis 1999, doi 10.1137/S106482759732678X). What slabs do not see, the body's bending and
stretching as a whole, is left to a coarse system: each slab moves as a rigid body, and in the
strips where it meets its neighbours the matrix itself says how what lies between them follows
(Nicolaides 1987, doi 10.1137/0724027; the strips' answer makes it keep all volumes). GMRES takes
both as its preconditioner (Saad and Schultz 1986, doi 10.1137/0907058). No negative pivots of the
whole matrix are known, and so no stability.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

from fem.kinematics.place import Place
from fem.ranks import total
from fem.solver.problem import RefusedError
from fem.solver.slab_parts import Block, Cuts, Gathered

Floats = npt.NDArray[np.float64]

ENOUGH = 1e-8
"""Part of a right side that its solution leaves."""
MOST = 100
"""Iterations of a solve, after which it is refused."""
UNKNOWNS = 20_000
"""Of a slab, about, where there are not more ranks than slabs of this size."""
MOVES = 6
COLOURS = 3
"""Slabs of one colour share no row of the matrix."""


class Slabs:
    """Solves K x = b for a long body by GMRES; see `LinearSolver`.

    Args:
        matrix: its upper triangle.
        volumetric: owned rows of pressures.
        free: owned rows of what no constraint fixes.
        place: where the unknowns lie, at the present state.
        slabs: how many; None: by the number of unknowns and of ranks.

    Attributes:
        slabs: how many, 0 before the first `renew`.
    """

    counts = False
    left = ""

    def __init__(
        self,
        matrix: PETSc.Mat,
        volumetric: npt.NDArray[np.bool_],
        free: npt.NDArray[np.bool_],
        place: Callable[[], Place],
        slabs: int | None = None,
    ) -> None:
        self._matrix, self._volumetric, self._free = matrix, volumetric, free
        self._place, self._asked = place, slabs
        self._comm = matrix.getComm().tompi4py()
        self._x, self._y = matrix.createVecs()
        self.seconds = {"factor": 0.0, "solve": 0.0}
        self.slabs = self.iterations = 0

    # --- what does not change ------------------------------------------------------------------

    def _set_up(self, place: Place) -> None:
        """Cut the body, and find the rows of this rank's slabs."""
        comm, size = self._comm, self._matrix.getSize()[0]
        low, high, volumetric, free = (
            np.concatenate(comm.allgather(a))
            for a in (place.low, place.high, self._volumetric, self._free)
        )
        ends = np.unique(np.concatenate(comm.allgather(place.ends)))
        number = self._asked or max(2, comm.size, size // UNKNOWNS)
        cuts = Cuts(ends, (low + high) / 2, number)
        self.slabs = cuts.slabs
        self._mine = np.flatnonzero(np.arange(cuts.slabs) * comm.size // cuts.slabs == comm.rank)

        def within(begin: float, end: float) -> npt.NDArray[np.bool_]:
            """Displacements between two planes, and pressures of elements between them."""
            own = np.where(volumetric, (low >= begin) & (high <= end), (low > begin) & (high < end))
            return np.asarray(own, dtype=bool)

        inside = [within(cuts.low[k], cuts.high[k]) for k in self._mine]
        self._wanted = wanted = np.flatnonzero(np.any([np.zeros(size, bool), *inside], axis=0))
        own = self._matrix.getOwnershipRanges()
        self._rows = Gathered(self._matrix, wanted, np.asarray(own, dtype=np.int64))
        kinds = volumetric[wanted], free[wanted]

        def block(chosen: npt.NDArray[np.bool_]) -> Block:
            return Block(self._rows, np.flatnonzero(chosen[wanted]), wanted, *kinds)

        self._blocks = [block(chosen) for chosen in inside]
        self._strips = {
            cut: block(within(*cuts.strips[cut]))
            for cut in sorted(
                {c for k in self._mine for c in (k - 1, k) if 0 <= c < self.slabs - 1}
            )
        }
        owner = cuts.owner[wanted]
        self._counted = [
            np.flatnonzero(owner[b.at] == k) for k, b in zip(self._mine, self._blocks, strict=True)
        ]
        index = PETSc.IS().createGeneral(wanted.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
        self._local = PETSc.Vec().createSeq(len(wanted), comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(self._x, index, self._local, None)
        self._weight = self._balance()

    def _balance(self) -> Floats:
        """What volumes count in a norm of forces and volumes: once, by the entries of the matrix.

        K has entries μ h between displacements and h² between them and pressures.
        """
        kinds = self._volumetric
        shown = self._free & ~kinds
        self._matrix.getDiagonal(self._x)
        diagonal = self._x.array_r[shown]
        self._x.array_w[:] = np.where(kinds, np.where(np.arange(len(kinds)) % 2, 1.0, -1.0), 0.0)
        self._matrix.mult(self._x, self._y)
        across = self._y.array_r[shown]
        sums = total(self._comm, np.array([diagonal @ diagonal, across @ across]))
        ratio = float(np.sqrt(sums[0] / sums[1])) if sums.all() else 1.0
        return np.where(kinds, ratio, 1.0)

    # --- between whole vectors and those of this rank's slabs -----------------------------------

    def _gather(self, whole: Floats) -> Floats:
        self._x.array_w[:] = whole
        self._scatter.scatter(self._x, self._local)
        return self._local.array_r.copy()

    def _spread(self, parts: Floats) -> Floats:
        """The sum of all ranks' parts."""
        self._local.array_w[:] = parts
        self._y.set(0.0)
        self._scatter.scatter(
            self._local, self._y, PETSc.InsertMode.ADD_VALUES, PETSc.ScatterMode.REVERSE
        )
        return self._y.array_r.copy()

    def _times(self, x: Floats) -> Floats:
        """K x."""
        self._x.array_w[:] = x
        self._matrix.mult(self._x, self._y)
        return self._y.array_r.copy()

    # --- factors and coarse system -------------------------------------------------------------

    def renew(self) -> None:
        """Factorise the slabs of the matrix as it is now; collective.

        Raises:
            RefusedError: a slab or the coarse system is singular.
        """
        start = time.perf_counter()
        place = self._place()
        if not self.slabs:
            self._set_up(place)
        values = self._rows.values()
        failed = ""
        try:
            for block in (*self._blocks, *self._strips.values()):
                block.renew(values)
        except (ZeroDivisionError, RuntimeError) as error:
            failed = str(error)
        if any(reasons := self._comm.allgather(failed)):
            raise RefusedError(f"a slab by itself has no factor: {max(reasons)}")
        self._coarsen(place, values)
        self.seconds["factor"] += time.perf_counter() - start

    @property
    def memory_mb(self) -> float:
        """Memory of all factors of this rank, MB."""
        return sum(block.memory_mb for block in (*self._blocks, *self._strips.values()))

    def _coarsen(self, place: Place, values: Floats) -> None:
        """How each slab moves as a rigid body, and the matrix of all these motions."""
        rigid = np.array([self._gather(column) for column in place.rigid.T]).T
        rows, self._moves = self._wanted_rows(values), []
        for k, block, counted in zip(self._mine, self._blocks, self._counted, strict=True):
            moved = np.zeros_like(rigid)
            moved[block.at[counted]] = rigid[block.at[counted]]
            strips = [self._strips[c] for c in (k - 1, k) if c in self._strips]
            for strip in strips:
                moved[strip.at] = 0.0
            pull = rows @ moved
            for strip in strips:
                moved[strip.at] = -np.array([strip.solve(b) for b in pull[strip.at].T]).T
            self._moves.append(np.linalg.qr(moved[block.at])[0])
        whole = np.zeros((self.slabs * MOVES,) * 2)
        for colour in range(COLOURS):
            for j in range(MOVES):
                pull = self._gather(self._times(self._spread(self._moved(colour, j))))
                for k, block, moves in zip(self._mine, self._blocks, self._moves, strict=True):
                    # the one neighbour of this colour, or itself
                    other = next(n for n in (k - 1, k, k + 1) if n % COLOURS == colour)
                    if 0 <= other < self.slabs:
                        at = slice(k * MOVES, (k + 1) * MOVES)
                        whole[at, other * MOVES + j] = moves.T @ pull[block.at]
        whole = total(self._comm, whole)
        try:
            self._coarse = np.linalg.inv((whole + whole.T) / 2)
        except np.linalg.LinAlgError as error:
            raise RefusedError("the motions of whole slabs are singular") from error

    def _wanted_rows(self, values: Floats) -> Any:
        """The wanted rows and columns, both triangles."""
        from scipy import sparse

        wanted, rows = self._wanted, self._rows
        local = np.minimum(np.searchsorted(wanted, rows.columns), len(wanted) - 1)
        kept = np.where(wanted[local] == rows.columns, values, 0.0)
        upper = sparse.csr_matrix((kept, local, rows.begin), shape=(len(wanted),) * 2)
        return upper + sparse.triu(upper, 1).T

    def _moved(self, colour: int, j: int) -> Floats:
        """One motion of all slabs of a colour, this rank's part."""
        parts = np.zeros(len(self._wanted))
        for k, block, moves in zip(self._mine, self._blocks, self._moves, strict=True):
            if k % COLOURS == colour:
                parts[block.at] += moves[:, j]
        return parts

    def _precondition(self, r: Floats) -> Floats:
        """About K⁻¹ r."""
        local = self._gather(r)
        parts = np.zeros_like(local)
        for block, counted in zip(self._blocks, self._counted, strict=True):
            parts[block.at[counted]] = block.solve(local[block.at])[counted]
        y = self._spread(parts)
        local = self._gather(r - self._times(y))
        sums = np.zeros((self.slabs, MOVES))
        for k, block, moves in zip(self._mine, self._blocks, self._moves, strict=True):
            sums[k] = moves.T @ local[block.at]
        shares = (self._coarse @ total(self._comm, sums).ravel()).reshape(sums.shape)
        parts[:] = 0.0
        for k, block, moves in zip(self._mine, self._blocks, self._moves, strict=True):
            parts[block.at] += moves @ shares[k]
        return y + self._spread(parts)

    # --- solution ------------------------------------------------------------------------------

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve K x = b."""
        x.array_w[:] = self.solve_many([b.array_r.copy()])[0]

    def solve_many(self, columns: Sequence[Floats]) -> list[Floats]:
        """Solve K x = b for owned parts of several right sides.

        Raises:
            RefusedError: no convergence.
        """
        start = time.perf_counter()
        found = [self._gmres(column) for column in columns]
        self.seconds["solve"] += time.perf_counter() - start
        return found

    def _gmres(self, b: Floats) -> Floats:
        weight, comm = self._weight, self._comm
        r = weight * b
        size = np.sqrt(float(total(comm, r @ r)))
        if size == 0.0:
            return np.zeros_like(b)
        if not np.isfinite(size):
            raise RefusedError("a right side that is no number")
        basis, answers = np.zeros((MOST + 1, len(b))), list[Floats]()
        basis[0] = r / size
        h, left = np.zeros((MOST + 1, MOST)), 1.0
        for j in range(MOST):
            answers.append(self._precondition(basis[j] / weight))
            v = weight * self._times(answers[j])
            for _ in range(2):
                parts = total(comm, basis[: j + 1] @ v)
                v -= parts @ basis[: j + 1]
                h[: j + 1, j] += parts
            h[j + 1, j] = np.sqrt(float(total(comm, v @ v)))
            if not np.isfinite(h[j + 1, j]):
                raise RefusedError("a preconditioner that gives no number")
            side = np.eye(j + 2, 1)[:, 0]
            shares = np.linalg.lstsq(h[: j + 2, : j + 1], side, rcond=None)[0]
            left = float(np.linalg.norm(side - h[: j + 2, : j + 1] @ shares))
            self.iterations += 1
            if left <= ENOUGH:
                return np.asarray(size * sum(s * a for s, a in zip(shares, answers, strict=True)))
            basis[j + 1] = v / h[j + 1, j]
        raise RefusedError(f"no convergence in {MOST} iterations: a residual of {left:.1e}")

    @property
    def negative_pivots(self) -> int:
        """Not known.

        Raises:
            RefusedError: always.
        """
        raise RefusedError("negative pivots are not counted")
