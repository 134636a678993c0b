"""A chain's matrix on two ranks, whichever rows they have: solutions and inertia against dense.

What is told of rows that other ranks own, too.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from fem.matrix import upper_triangle
from fem.solver.layers import Layers
from fem.solver.slab_parts import Gathered
from tests.fem.test_layers import chain, inertia

Floats = npt.NDArray[np.float64]


def shared(comm: MPI.Comm, matrix: Floats, first: int, end: int) -> PETSc.Mat:
    """A matrix of which this rank has some rows."""
    size = len(matrix)
    upper = np.triu(matrix != 0) | np.eye(size, dtype=bool)
    rows, columns = np.nonzero(upper[first:end])
    begin = np.r_[0, np.cumsum(np.bincount(rows, minlength=end - first))].astype(np.int32)
    result = upper_triangle(comm, begin, columns.astype(np.int32))
    for row, column in zip((rows + first).tolist(), columns.tolist(), strict=True):
        result.setValue(row, column, matrix[row, column])
    result.assemble()
    return result


def measure(comm: MPI.Comm, order: str, definite: bool) -> dict[str, float]:
    """What is wrong with solutions, and pivots beyond those of the inertia.

    Args:
        comm: two ranks.
        order: of the unknowns: by chance, along the chain, from its other end, or by chance and
            all on the last rank.
        definite: no pivot has another sign than expected.
    """
    matrix, negative = chain(11, definite, shuffled=order in ("by chance", "none"))
    if order == "from the other end":
        matrix, negative = matrix[::-1, ::-1].copy(), negative[::-1].copy()
    size = len(matrix)
    cut = {"by chance": size // 3, "none": 0}.get(order, size // 2 - 5)
    first, end = ((0, cut), (cut, size))[comm.rank]
    layers = Layers(shared(comm, matrix, first, end), negative[first:end])
    b = np.random.default_rng(2).standard_normal((3, size))
    error = 0.0
    for _ in range(2):
        layers.renew()
        x = np.concatenate(comm.allgather(layers.solve(b[:, first:end])), axis=1)
        error = max(
            error, float(np.abs(x - np.linalg.solve(matrix, b.T).T).max() / np.abs(x).max())
        )
    return {"error": error, "pivots": layers.negative_pivots - inertia(matrix)}


def gathered(comm: MPI.Comm, part: float) -> float:
    """What is wrong with every third row of the upper triangle, of which ranks own parts."""
    matrix, _ = chain(11)
    size = len(matrix)
    cut = int(part * size)
    first, end = ((0, cut), (cut, size))[comm.rank]
    wanted = np.arange(comm.rank, size, 3)
    rows = Gathered(shared(comm, matrix, first, end), wanted, np.array([0, cut, size]))
    found = np.zeros((len(wanted), size))
    found[np.repeat(np.arange(len(wanted)), np.diff(rows.begin)), rows.columns] = rows.values()
    error = np.abs(found - np.triu(matrix)[wanted]).max()
    return float(comm.allreduce(error, MPI.MAX))


def unknown(comm: MPI.Comm) -> str:
    """What a matrix is refused with that another has made."""
    matrix = PETSc.Mat().createSBAIJ(4, 1, csr=None, comm=comm)
    matrix.setUp()
    matrix.assemble()
    try:
        Layers(matrix, np.zeros(2, dtype=bool))
    except ValueError as error:
        return str(error)
    return ""


if __name__ == "__main__":
    found: dict[str, Any] = {"unknown": unknown(MPI.COMM_WORLD)}
    found["gathered"] = [gathered(MPI.COMM_WORLD, part) for part in (0.0, 0.4, 1.0)]
    found |= {
        f"{order}, {definite}": measure(MPI.COMM_WORLD, order, definite)
        for order in ("by chance", "along", "from the other end", "none")
        for definite in (True, False)
    }
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(found))
