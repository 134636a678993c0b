"""The tangent's storage in PETSc: the upper triangle of a symmetric sparse matrix."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

Ties = tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]
"""Local dofs that follow others, (n,), and those that they follow, (n,); on one rank only."""


def upper_triangle(pattern: PETSc.Mat, ties: Ties) -> PETSc.Mat:
    """An empty symmetric matrix with the sparsity of another, its upper triangle only.

    Inserting a triangle takes half the time of inserting all, and LDLᵀ needs no more.

    Args:
        pattern: an assembled matrix with the full sparsity.
        ties: what is inserted for the following dofs goes to those that they follow, which is TᵀKT
            with the prolongation T.
    """
    starts, columns, _ = pattern.getValuesCSR()
    first, end = pattern.getOwnershipRange()
    rows = np.repeat(np.arange(end - first), np.diff(starts))
    maps = pattern.getLGMap()
    if len(ties[0]):
        target = np.arange(end, dtype=PETSc.IntType)
        target[ties[0]] = target[ties[1]]
        own = ties[0]
        pairs = np.column_stack([np.r_[target[rows], own], np.r_[target[columns], own]])
        rows, columns = np.unique(pairs, axis=0).T
        tied = PETSc.LGMap().create(target, comm=pattern.getComm())
        maps = (tied, tied)
    upper = columns >= rows + first
    here = upper & (columns < end)
    counts = [np.bincount(rows[part], minlength=end - first) for part in (here, upper & ~here)]
    matrix = PETSc.Mat().create(pattern.getComm())
    matrix.setSizes(pattern.getSizes())
    matrix.setType(PETSc.Mat.Type.SBAIJ)
    matrix.setPreallocationNNZ(tuple(count.astype(PETSc.IntType) for count in counts))
    matrix.setLGMap(*maps)
    matrix.setOption(PETSc.Mat.Option.IGNORE_LOWER_TRIANGULAR, True)
    matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, True)
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return matrix


def may_free(item: PETSc.Object) -> bool:
    """Whether a PETSc object that Python drops can be destroyed at once.

    petsc4py keeps what Python drops, for several ranks drop at different times; a process that
    runs case after case would fill up with matrices and factors.
    """
    return not PETSc.Sys.isFinalized() and item.getComm().getSize() == 1
