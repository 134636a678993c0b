"""One sparse factorisation by MUMPS, with the inertia that tells stability."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

from fem.matrix import may_free

Floats = npt.NDArray[np.float64]

ORDERING_AMD, ORDERING_PORD = 0, 4
SMALL = 10_000
"""Unknowns below which a simple ordering is done sooner than a better one pays."""


class Factor:
    """A factorisation K = L D Lᵀ (or L U) that is renewed in place.

    Args:
        matrix: the matrix; its values may change between calls of `renew`.
        symmetric: LDLᵀ; False: LU, for loads without a potential.

    Attributes:
        seconds: wall time spent in factorisations and solves.
    """

    def __init__(self, matrix: PETSc.Mat, symmetric: bool = True) -> None:
        self._matrix = matrix
        self._symmetric = symmetric
        self._ksp: PETSc.KSP | None = None
        self.seconds = {"factor": 0.0, "solve": 0.0}

    def _create(self) -> PETSc.KSP:
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
        factor.setMumpsIcntl(14, 60)
        factor.setMumpsIcntl(24, 0)
        return ksp

    def renew(self) -> None:
        """Factorise the matrix as it is now.

        Raises:
            RuntimeError: MUMPS did not take the ordering asked for.
            ZeroDivisionError: the matrix is singular.
        """
        start = time.perf_counter()
        first = self._ksp is None
        if self._ksp is None:
            self._ksp = self._create()
        self._ksp.setOperators(self._matrix)
        self._ksp.setUp()
        factor = self._ksp.getPC().getFactorMatrix()
        large = self._matrix.getSize()[0] >= SMALL
        if first and large and factor.getMumpsInfog(7) != ORDERING_PORD:
            raise RuntimeError(f"MUMPS took ordering {factor.getMumpsInfog(7)} instead of PORD")
        if factor.getMumpsInfog(1) < 0:
            raise ZeroDivisionError(f"MUMPS: INFOG(1) = {factor.getMumpsInfog(1)}")
        self.seconds["factor"] += time.perf_counter() - start

    @property
    def negative_pivots(self) -> int:
        """Number of negative eigenvalues of the factorised matrix (Sylvester's inertia)."""
        assert self._ksp is not None, "renew first"
        return int(self._ksp.getPC().getFactorMatrix().getMumpsInfog(12))

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve K x = b with the last factor."""
        assert self._ksp is not None, "renew first"
        start = time.perf_counter()
        self._ksp.solve(b, x)
        self.seconds["solve"] += time.perf_counter() - start

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
        start = time.perf_counter()
        if not columns:
            return []
        own, size = self._matrix.getSizes()[0], len(columns)
        comm = self._matrix.getComm()
        shape = (own, (PETSc.DECIDE, size))
        b = PETSc.Mat().createDense(shape, array=np.array(columns).T.copy("F"), comm=comm)
        x = PETSc.Mat().createDense(shape, comm=comm)
        x.setUp()
        b.assemble()
        x.assemble()
        self._ksp.getPC().getFactorMatrix().matSolve(b, x)
        found: Floats = x.getDenseArray().copy()
        b.destroy()
        x.destroy()
        self.seconds["solve"] += time.perf_counter() - start
        return list(found.T)
