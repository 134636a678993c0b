"""One sparse factorisation, with the inertia that tells stability.

Long bodies are factorised in blocks of elements (`layers`), everything else by MUMPS; so is a long
body whose solutions the layers do not bring to round-off, from then on.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

from fem.matrix import may_free
from fem.solver.layers import InaccurateError, Layers, UnsuitableError

Floats = npt.NDArray[np.float64]

ROOM, MORE_ROOM = 60, 400
"""Percent of workspace beyond MUMPS's own estimate, and where delayed pivots need more."""
FULL = (-8, -9)
"""INFOG(1) of a workspace that was too small."""
ORDERING_AMD, ORDERING_PORD = 0, 4
SMALL = 10_000
"""Unknowns below which a simple ordering is done sooner than a better one pays."""


LAYERED = 1_500
"""Unknowns from which on a long body is factorised in layers."""


class Mumps:
    """A factorisation K = L D Lᵀ (or L U) by MUMPS that is renewed in place.

    Args:
        matrix: the matrix; its values may change between calls of `renew`.
        symmetric: LDLᵀ; False: LU, for loads without a potential.
        volumetric: owned rows of the multipliers of volume, whose unit is not that of the others;
            without them nothing is balanced.
        free: owned rows of what no constraint fixes.
    """

    def __init__(
        self,
        matrix: PETSc.Mat,
        symmetric: bool = True,
        volumetric: npt.NDArray[np.bool_] | None = None,
        free: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        self._matrix = matrix
        self._symmetric = symmetric
        self._volumetric, self._free = volumetric, free
        self._balance: Floats | None = None
        self._ksp: PETSc.KSP | None = None

    def _balanced(self) -> Floats:
        """Factors of rows and columns that make pressures as stiff as displacements, (owned,).

        K has entries μ h between displacements and h² between them and pressures (h: size of an
        element): MUMPS takes other pivots, many of them late, for a soft or a large body. One power
        of two on all pressures, found once, makes its choice the same and rounds nothing.
        """
        if self._balance is None:
            factors = np.ones(self._matrix.getLocalSize()[0])
            self._balance = factors
            if self._volumetric is None or self._free is None:
                return factors
            sign, other = self._matrix.createVecs()
            first = self._matrix.getOwnershipRange()[0]
            parity = 1.0 - 2.0 * ((first + np.arange(len(factors))) % 2)
            sign.array_w[:] = np.where(self._volumetric, parity, 0.0)
            self._matrix.mult(sign, other)
            shown = self._free & ~self._volumetric
            other.array_w[:] = np.where(shown, other.array_r, 0.0)
            across = other.norm()
            self._matrix.getDiagonal(other)
            other.array_w[:] = np.where(shown, other.array_r, 0.0)
            within = other.norm()
            if across > 0 and within > 0:  # exact: 0 where one of the two has no entry at all
                factors[self._volumetric] = 2.0 ** np.round(np.log2(within / across))
            sign.destroy()
            other.destroy()
        return self._balance

    def _scale(self, factors: Floats) -> None:
        """Multiply rows and columns of the matrix, in place."""
        vector = self._matrix.createVecRight()
        vector.array_w[:] = factors
        self._matrix.diagonalScale(vector, vector)
        vector.destroy()

    def _create(self, room: int) -> PETSc.KSP:
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, self._symmetric)
        ksp = PETSc.KSP().create(self._matrix.getComm())
        ksp.setOperators(self._matrix)
        ksp.setType(PETSc.KSP.Type.PREONLY)
        pc = ksp.getPC()
        pc.setType(PETSc.PC.Type.CHOLESKY if self._symmetric else PETSc.PC.Type.LU)
        pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        pc.setFactorSetUpSolverType()
        factor = pc.getFactorMatrix()
        if self._matrix.getSize()[0] < SMALL:
            factor.setMumpsIcntl(7, ORDERING_AMD)
        else:
            factor.setMumpsIcntl(7, ORDERING_PORD)
            factor.setMumpsIcntl(12, 1)  # else a serial LDLᵀ silently takes another ordering
        factor.setMumpsIcntl(13, 1)  # else the root front hides negative pivots from the count
        factor.setMumpsIcntl(14, room)
        factor.setMumpsIcntl(24, 0)
        return ksp

    def renew(self) -> None:
        """Factorise the matrix as it is now.

        Raises:
            RuntimeError: MUMPS did not take the ordering asked for.
            ZeroDivisionError: the matrix is singular.
        """
        first = self._ksp is None
        balance = self._balanced()
        unequal = self._volumetric is not None
        if unequal:
            self._scale(balance)
        factor = self._set_up(ROOM)
        if factor.getMumpsInfog(1) in FULL:
            self.destroy()
            factor = self._set_up(MORE_ROOM)
        if unequal:
            self._scale(1 / balance)
        large = self._matrix.getSize()[0] >= SMALL
        if first and large and factor.getMumpsInfog(7) != ORDERING_PORD:
            raise RuntimeError(f"MUMPS took ordering {factor.getMumpsInfog(7)} instead of PORD")
        if factor.getMumpsInfog(1) < 0:
            raise ZeroDivisionError(f"MUMPS: INFOG(1) = {factor.getMumpsInfog(1)}")

    def _set_up(self, room: int) -> PETSc.Mat:
        """Factorise, with a workspace for it where there is none yet."""
        if self._ksp is None:
            self._ksp = self._create(room)
        self._ksp.setOperators(self._matrix)
        self._ksp.setUp()
        return self._ksp.getPC().getFactorMatrix()

    @property
    def negative_pivots(self) -> int:
        """Number of negative eigenvalues of the factorised matrix (Sylvester's inertia)."""
        assert self._ksp is not None, "renew first"
        return int(self._ksp.getPC().getFactorMatrix().getMumpsInfog(12))

    @property
    def memory_mb(self) -> float:
        """Memory that MUMPS takes for the factor and to find it, all ranks, MB."""
        assert self._ksp is not None, "renew first"
        return float(self._ksp.getPC().getFactorMatrix().getMumpsInfog(22))

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve K x = b with the last factor."""
        assert self._ksp is not None, "renew first"
        balance = self._balanced()
        b.array_w[:] *= balance
        # not by KSP: it would factorise anew, as the matrix has its own scale again
        self._ksp.getPC().getFactorMatrix().solve(b, x)
        b.array_w[:] /= balance
        x.array_w[:] *= balance

    def __del__(self) -> None:
        if self._ksp is not None and may_free(self._ksp):
            self.destroy()

    def destroy(self) -> None:
        """Free the factor."""
        if self._ksp is not None:
            self._ksp.destroy()
            self._ksp = None

    def solve_many(self, columns: Sequence[Floats]) -> list[Floats]:
        """Solve K x = b for owned parts of several right sides in one pass."""
        assert self._ksp is not None, "renew first"
        own, size = self._matrix.getSizes()[0], len(columns)
        comm = self._matrix.getComm()
        shape = (own, (PETSc.DECIDE, size))
        balance = self._balanced()
        right = (balance * np.array(columns)).T.copy("F")
        b = PETSc.Mat().createDense(shape, array=right, comm=comm)
        x = PETSc.Mat().createDense(shape, comm=comm)
        x.setUp()
        b.assemble()
        x.assemble()
        self._ksp.getPC().getFactorMatrix().matSolve(b, x)
        found: Floats = balance[:, None] * x.getDenseArray()
        b.destroy()
        x.destroy()
        return list(found.T)


class Factor:
    """A factorisation K = L D Lᵀ (or L U) that is renewed in place.

    Args:
        matrix: the matrix; its values may change between calls of `renew`.
        symmetric: LDLᵀ; False: LU, for loads without a potential.
        volumetric: owned rows of the multipliers of volume, whose unit is not that of the others;
            without them nothing is balanced, and MUMPS takes all.
        free: owned rows of what no constraint fixes.

    Attributes:
        seconds: wall time spent in factorisations and solves.
        left: why a long body is left to MUMPS after it was factorised in layers; empty: it is not.
    """

    counts = True
    iterations = 0

    def __init__(
        self,
        matrix: PETSc.Mat,
        symmetric: bool = True,
        volumetric: npt.NDArray[np.bool_] | None = None,
        free: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        self._matrix, self._volumetric = matrix, volumetric
        self._general = Mumps(matrix, symmetric, volumetric, free)
        self._layers: Layers | None = None
        self._try_layers = symmetric and volumetric is not None and matrix.getSize()[0] >= LAYERED
        self.left = ""
        self.seconds = {"factor": 0.0, "solve": 0.0}

    def renew(self) -> None:
        """Factorise the matrix as it is now; collective.

        Raises:
            RuntimeError: MUMPS did not take the ordering asked for.
            ZeroDivisionError: the matrix is singular, or no number.
        """
        start = time.perf_counter()
        if self._try_layers:
            assert self._volumetric is not None, "only with constraints"
            with contextlib.suppress(UnsuitableError):
                self._layers = Layers(self._matrix, self._volumetric)
            self._try_layers = False
        if self._layers is not None:
            try:
                self._layers.renew()
            except ZeroDivisionError as error:
                self._leave(error)
        else:
            self._general.renew()
        self.seconds["factor"] += time.perf_counter() - start

    def _leave(self, error: ArithmeticError) -> None:
        """Go over to MUMPS."""
        self.left, self._layers = str(error), None
        self._general.renew()

    @property
    def negative_pivots(self) -> int:
        """Number of negative eigenvalues of the factorised matrix (Sylvester's inertia)."""
        if self._layers is not None:
            return self._layers.negative_pivots
        return self._general.negative_pivots

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve K x = b with the last factor, with the matrix as it was then."""
        x.array_w[:] = self.solve_many([b.array_r])[0]

    def solve_many(self, columns: Sequence[Floats]) -> list[Floats]:
        """Solve K x = b for owned parts of several right sides in one pass."""
        if not columns:
            return []
        start = time.perf_counter()
        found = self._found(columns)
        self.seconds["solve"] += time.perf_counter() - start
        return found

    def _found(self, columns: Sequence[Floats]) -> list[Floats]:
        if self._layers is not None:
            try:
                return list(self._layers.solve(np.array(columns)))
            except InaccurateError as error:
                self._leave(error)
        if len(columns) > 1:
            return self._general.solve_many(columns)
        b, x = self._matrix.createVecs()
        b.array_w[:] = columns[0]
        self._general.solve(b, x)
        found = x.array_r.copy()
        b.destroy()
        x.destroy()
        return [found]

    def destroy(self) -> None:
        """Free the factor."""
        self._layers = None
        self._general.destroy()
