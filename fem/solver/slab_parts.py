"""Parts of a distributed matrix: rows from all ranks, blocks of it with a factor, and cuts."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from fem.matrix import stored_values, upper_triangle
from fem.solver.factor import Mumps
from fem.solver.rows import StoredRows

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

OVERLAP = 0.2
"""Part of its own length by which a slab goes into the next, at least one element."""


class Gathered:
    """Rows of the upper triangle that this rank needs, whoever owns them.

    Args:
        matrix: its upper triangle.
        wanted: global numbers of rows, rising.
        first: the first row of every rank, and the number of all.

    Attributes:
        begin: where each row starts, (rows + 1,).
        columns: their global columns.
    """

    def __init__(self, matrix: PETSc.Mat, wanted: Ints, first: Ints) -> None:
        self._rows = rows = StoredRows(matrix)
        self._comm = comm = rows.comm
        asked = comm.alltoall(np.split(wanted, np.searchsorted(wanted, first[1:-1])))
        # row by row, where they are stored beside columns of this rank and then of others
        within = np.diff(rows.begin)
        row = np.r_[np.repeat(np.arange(len(within)), within), rows.outer[0] - rows.first]
        stored = np.argsort(row, kind="stable")
        lengths = np.bincount(row, minlength=len(within))
        begin = np.cumsum(lengths) - lengths
        asked = [rows_asked - rows.first for rows_asked in asked]
        self._sent = [stored[_ranges(begin[a], lengths[a])] for a in asked]
        counts = np.concatenate(comm.alltoall([lengths[a] for a in asked]))
        self.begin = np.r_[0, np.cumsum(counts)]
        columns = np.r_[rows.columns + rows.first, rows.outer[1]]
        self.columns = np.concatenate(comm.alltoall([columns[sent] for sent in self._sent]))

    def values(self) -> Floats:
        """Their entries now; collective."""
        values, outer = self._rows.inner_values(), self._rows.outer_values()
        if len(outer):
            values = np.concatenate([values, outer])
        return np.concatenate(self._comm.alltoall([values[sent] for sent in self._sent]))


def _ranges(start: npt.NDArray[np.integer], length: npt.NDArray[np.integer]) -> Ints:
    """Numbers from each start on, one range after the other."""
    ends = np.cumsum(length)
    return np.arange(ends[-1] if len(ends) else 0) + np.repeat(start - (ends - length), length)


class Block:
    """Rows and columns of some unknowns, and their factor.

    Args:
        rows: whose these unknowns are among.
        at: their numbers among the wanted rows, rising.
        wanted: global numbers of the wanted rows.
        volumetric: of the wanted rows, whether they are pressures.
        free: of the wanted rows, whether no constraint fixes them.
    """

    def __init__(
        self,
        rows: Gathered,
        at: Ints,
        wanted: Ints,
        volumetric: npt.NDArray[np.bool_],
        free: npt.NDArray[np.bool_],
    ) -> None:
        self.at, chosen = at, wanted[at]
        lengths = np.diff(rows.begin)[at]
        source = _ranges(rows.begin[at], lengths)
        columns = rows.columns[source]
        local = np.minimum(np.searchsorted(chosen, columns), len(chosen) - 1)
        inside = chosen[local] == columns
        row = np.repeat(np.arange(len(at)), lengths)[inside]
        begin = np.r_[0, np.cumsum(np.bincount(row, minlength=len(at)))]
        self._source = source[inside]
        self._matrix = upper_triangle(
            MPI.COMM_SELF, begin.astype(np.int32), local[inside].astype(np.int32)
        )
        self._b, self._x = self._matrix.createVecs()
        self._factor = Mumps(self._matrix, True, volumetric[at], free[at])

    def renew(self, values: Floats) -> None:
        """Take the entries of the wanted rows, and factorise."""
        stored_values(self._matrix, len(self._source))[:] = values[self._source]
        self._matrix.assemble()
        self._factor.renew()

    def solve(self, b: Floats) -> Floats:
        """Its answer, (unknowns,)."""
        self._b.array_w[:] = b
        self._factor.solve(self._b, self._x)
        return self._x.array_r.copy()

    @property
    def memory_mb(self) -> float:
        """Memory of the factor, MB."""
        return self._factor.memory_mb


class Cuts:
    """Where a body is cut.

    Args:
        ends: z at which elements begin or end, rising, (m,).
        z: middle of what each unknown belongs to, (n,).
        slabs: how many are asked for.

    Attributes:
        slabs: how many there are.
        low: where each slab with its overlap begins, (slabs,).
        high: where it ends, (slabs,).
        strips: where the strip on each cut begins and ends, (slabs − 1, 2).
        owner: the slab whose answer counts for each unknown, (n,).
    """

    def __init__(self, ends: Floats, z: Floats, slabs: int) -> None:
        layers = len(ends) - 1
        self.slabs = max(1, min(slabs, layers // 4))
        over = max(1, round(OVERLAP * layers / self.slabs))
        parts = np.linspace(0, 1, self.slabs + 1)[1:-1]
        cuts = np.searchsorted(ends, np.quantile(z, parts))
        # no slab thinner than what overlaps it from both sides, and a layer
        least, before = 2 * over + 1, 0
        for k, cut in enumerate(cuts):
            latest = layers - (len(cuts) - k) * least
            before = cuts[k] = min(max(cut, before + least), latest)
        self.low = np.r_[-np.inf, ends[cuts - over]]
        self.high = np.r_[ends[cuts + over], np.inf]
        self.strips = np.stack([ends[cuts - over], ends[cuts + over]], axis=1)
        self.owner = np.searchsorted(ends[cuts], z)
