"""The tangent's storage in PETSc: the upper triangle of a symmetric sparse matrix."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

Ties = tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]
"""Local dofs that follow others, (n,), and those that they follow, (n,); on one rank only."""

_petsc = ctypes.CDLL(PETSc.__file__)
_OUTER = "rows with columns of other ranks"


def upper_triangle(
    comm: MPI.Comm, begin: npt.NDArray[np.int32], columns: npt.NDArray[np.int32]
) -> PETSc.Mat:
    """A symmetric matrix of zeros by its upper triangle, all of which is stored.

    Args:
        comm: communicator.
        begin: where each row that this rank owns starts, (owned + 1,).
        columns: global columns of each row, rising, none below the diagonal.
    """
    owned = len(begin) - 1
    matrix = PETSc.Mat().create(comm)
    matrix.setSizes(((owned, PETSc.DETERMINE),) * 2)
    matrix.setType(PETSc.Mat.Type.SBAIJ)
    first = sum(comm.allgather(owned)[: comm.rank])
    beyond = np.flatnonzero(columns >= first + owned)
    rows = np.searchsorted(begin, beyond, side="right") - 1
    outer = np.bincount(rows, minlength=owned)
    counts = (np.diff(begin) - outer, outer)
    matrix.setPreallocationNNZ(tuple(count.astype(PETSc.IntType) for count in counts))
    matrix.setOption(PETSc.Mat.Option.IGNORE_LOWER_TRIANGULAR, True)
    matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, True)
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    given = (np.asarray(array, dtype=PETSc.IntType) for array in (begin, columns))
    matrix.setValuesCSR(*given, np.zeros(len(columns)))
    matrix.assemble()
    matrix.setAttr(_OUTER, np.flatnonzero(outer).astype(np.int32))
    return matrix


def outer_rows(matrix: PETSc.Mat) -> npt.NDArray[np.int32]:
    """Rows on this rank with columns of another, by local number, rising.

    Raises:
        ValueError: a matrix of several ranks that `upper_triangle` has not made.
    """
    rows: npt.NDArray[np.int32] | None = matrix.getAttr(_OUTER)
    if rows is None and matrix.getComm().size > 1:
        raise ValueError("which rows have columns of other ranks is not known")
    return np.zeros(0, dtype=np.int32) if rows is None else rows


def stored_rows(
    matrix: PETSc.Mat,
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    """Where the rows that this rank owns start, and their columns that it owns; views.

    All in local numbers: (owned + 1,), and (entries,), rising within a row.
    """
    handle = ctypes.c_void_p(matrix.getDiagonalBlock().handle)
    count, done = ctypes.c_int(), ctypes.c_int()
    begin, columns = (ctypes.POINTER(ctypes.c_int32)() for _ in range(2))
    found = (ctypes.byref(item) for item in (count, begin, columns, done))
    if _petsc.MatGetRowIJ(handle, 0, 0, 0, *found) or not done:
        raise RuntimeError("PETSc gives no rows of its matrix")
    starts = np.ctypeslib.as_array(begin, (count.value + 1,))
    if not starts[-1]:
        return starts, np.zeros(0, dtype=np.int32)
    return starts, np.ctypeslib.as_array(columns, (int(starts[-1]),))


def stored_values(matrix: PETSc.Mat, count: int) -> npt.NDArray[np.float64]:
    """Entries of the rows and columns that this rank owns, row by row, (count,), a view.

    Whoever writes them calls `assemble` on the matrix, so that its factor is renewed.
    """
    block = matrix.getDiagonalBlock()
    array = ctypes.POINTER(ctypes.c_double)()
    handle = ctypes.c_void_p(block.handle)
    if _petsc.MatSeqSBAIJGetArray(handle, ctypes.byref(array)):
        raise RuntimeError("PETSc gives no values of its matrix")
    if not count:
        return np.zeros(0)
    values: npt.NDArray[np.float64] = np.ctypeslib.as_array(array, (count,))
    _petsc.MatSeqSBAIJRestoreArray(handle, ctypes.byref(array))
    return values


def whole(matrix: PETSc.Mat) -> csc_matrix:
    """All of a symmetric matrix of one rank, for what is solved elsewhere; a copy."""
    from scipy.sparse import csr_matrix, triu

    begin, columns = stored_rows(matrix)
    values = stored_values(matrix, len(columns)).copy()
    size = len(begin) - 1
    upper = csr_matrix((values, columns.copy(), begin.copy()), shape=(size, size))
    return (upper + triu(upper, 1).T).tocsc()


def may_free(item: PETSc.Object) -> bool:
    """Whether a PETSc object that Python drops can be destroyed at once.

    petsc4py keeps what Python drops, for several ranks drop at different times; a process that
    runs case after case would fill up with matrices and factors.
    """
    return not PETSc.Sys.isFinalized() and item.getComm().getSize() == 1
