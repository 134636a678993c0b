"""The rows of a symmetric matrix that a rank stores, and what it needs of another rank for them.

Rows have local numbers: those that this rank owns, in order. Only the upper triangle is stored, so
that an entry beside a row of another rank stands with the lower of its two global numbers.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from fem.matrix import outer_rows, stored_rows, stored_values
from fem.solver.fronts import Code, Fronts
from fem.solver.order.constraints import Constraints
from fem.solver.order.graph import Graph

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Bools = npt.NDArray[np.bool_]


def swap(comm: MPI.Comm, given: npt.NDArray[np.float64], count: int) -> Floats:
    """Numbers for the other of two ranks, in exchange for as many of its as are known to come."""
    found = np.empty(count)
    other = 1 - comm.rank
    comm.Sendrecv(np.ascontiguousarray(given), other, recvbuf=found, source=other)
    return found


class StoredRows:
    """The upper triangle that this rank stores.

    Args:
        matrix: as `fem.matrix.upper_triangle` makes it, on any number of ranks.

    Attributes:
        comm: its ranks.
        size: number of rows of all ranks.
        first: number of the first row here.
        end: one more than that of the last.
        begin: where each row starts among the columns of this rank, (owned + 1,), a view.
        columns: those columns, local numbers, rising, the diagonal first, a view.
        outer: rows and columns of the entries beside columns of another rank, global, (2, l); rows
            rise, and columns within a row.
    """

    def __init__(self, matrix: PETSc.Mat) -> None:
        self._matrix = matrix
        self.comm: MPI.Comm = matrix.getComm().tompi4py()
        self.size = matrix.getSize()[0]
        self.first, self.end = matrix.getOwnershipRange()
        self.begin, self.columns = stored_rows(matrix)
        self._outer_rows: list[tuple[int, int]] = []
        rows, columns = [np.zeros(0, np.int32)], [np.zeros(0, np.int32)]
        found = outer_rows(matrix)
        if len(found):
            matrix.setOption(PETSc.Mat.Option.GETROW_UPPERTRIANGULAR, True)
        for row in found.tolist():
            whole = matrix.getRow(self.first + row)[0]
            inside = int(self.begin[row + 1] - self.begin[row])
            self._outer_rows.append((self.first + row, inside))
            columns.append(whole[inside:])
            rows.append(np.full(len(whole) - inside, self.first + row, dtype=np.int32))
        self.outer = np.array([np.concatenate(rows), np.concatenate(columns)])

    def inner_values(self) -> Floats:
        """Entries beside columns of this rank now, a view."""
        return stored_values(self._matrix, len(self.columns))

    def outer_values(self) -> Floats:
        """Entries beside columns of another rank now, (l,)."""
        found = [self._matrix.getRow(row)[1][inside:] for row, inside in self._outer_rows]
        return np.concatenate([np.zeros(0), *found])


class Rows(StoredRows):
    """The same on two ranks at most, with what couples them, and the graph of the whole matrix.

    Args:
        matrix: as `fem.matrix.upper_triangle` makes it.

    Attributes:
        theirs: `outer` of another rank; each entry has a column of this one, (2, l').
    """

    def __init__(self, matrix: PETSc.Mat) -> None:
        super().__init__(matrix)
        self.theirs = self.outer[:, :0]
        if self.comm.size > 1:
            other = 1 - self.comm.rank
            self.theirs = self.comm.sendrecv(self.outer, other, source=other)

    def graph(self, code: Code, negative: Bools) -> Graph:
        """The graph of the whole matrix; collective.

        Args:
            code: compiled.
            negative: constraints, (size,).
        """
        first, end = self.first, self.end
        key = np.random.default_rng(0).integers(1, 2**62, self.size, dtype=np.uint64)
        sums = np.zeros(self.size, dtype=np.uint64)
        own = (self.begin, self.columns, key[first:end], sums[first:end])
        code.lib.sums(end - first, *code.pointers(*own))
        rows, columns = self.outer
        np.add.at(sums, rows, key[columns])
        np.add.at(sums, columns, key[rows])
        if self.comm.size > 1:
            self.comm.Allreduce(MPI.IN_PLACE, sums)
        _, known, group, weight = np.unique(
            2 * sums + negative.astype(np.uint64),
            return_index=True,
            return_inverse=True,
            return_counts=True,
        )
        kept = np.zeros(self.size, dtype=bool)
        kept[known] = True
        return _graph(self._pairs(kept, group), group, weight, negative[known])

    def _pairs(self, kept: Bools, group: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Vertices that are coupled, each pair once, (2, e); collective."""
        here = kept[self.first : self.end]
        rows, places = self._entries(np.flatnonzero(here))
        columns = self.columns[places]
        both = here[columns] & (columns != rows)
        beyond = self.outer[:, kept[self.outer].all(axis=0)]
        pairs = np.array([rows[both], columns[both]]) + self.first
        pairs = group[np.concatenate([pairs, beyond], axis=1)]
        if self.comm.size > 1:
            pairs = np.concatenate(self.comm.allgather(pairs.astype(np.int32)), axis=1)
        return pairs

    def _entries(
        self, rows: npt.NDArray[np.int64]
    ) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Row and place of every entry of some rows beside columns of this rank."""
        starts, counts = self.begin[rows].astype(np.int64), np.diff(self.begin)[rows]
        before = np.cumsum(counts) - counts
        return np.repeat(rows, counts), np.arange(counts.sum()) + np.repeat(starts - before, counts)

    def _beside(self, negative: Bools) -> npt.NDArray[np.int64]:
        """Places of entries in columns of constraints here, not in their rows."""
        places = np.flatnonzero(negative[self.columns])
        return places[~negative[np.searchsorted(self.begin, places, side="right") - 1]]

    def constraints(self, graph: Graph, negative: Bools) -> Constraints:
        """Couplings of all constraints; collective.

        Args:
            graph: of the whole matrix.
            negative: constraints, (size,).

        Raises:
            ZeroDivisionError: couplings that are no numbers, on whatever rank.
        """
        here, first = negative[self.first : self.end], self.first
        rows, places = self._entries(np.flatnonzero(here))
        within = ~here[self.columns[places]]
        beside = self._beside(here)
        others = np.searchsorted(self.begin, beside, side="right") - 1
        # an entry beside the other rank goes to the one that has the constraint
        outer, theirs = self.outer, self.theirs
        kept, gone = np.flatnonzero(negative[outer[0]]), np.flatnonzero(negative[outer[1]])
        found = theirs[:, negative[theirs[1]]]
        row = np.r_[rows[within], self.columns[beside], outer[0, kept] - first, found[1] - first]
        other = np.r_[
            self.columns[places[within]] + first, others + first, outer[1, kept], found[0]
        ]
        places = np.r_[places[within], beside]
        values, outer_values = self.inner_values()[places], self.outer_values()
        received = np.zeros(0)
        if self.comm.size > 1:
            received = swap(self.comm, outer_values[gone], found.shape[1])
        order = np.argsort(row, kind="stable")
        counts = np.bincount(row, minlength=len(here))
        other = other[order].astype(np.int32)
        values = np.r_[values, outer_values[kept], received][order]
        if self.comm.size > 1:
            parts = zip(*self.comm.allgather((counts, other, values)), strict=True)
            counts, other, values = map(np.concatenate, parts)
        if not np.isfinite(values).all():
            raise ZeroDivisionError("couplings of constraints are no numbers")
        starts = np.r_[0, np.cumsum(counts)].astype(np.int32)
        return Constraints((starts, other, values), graph)


def _graph(
    pairs: npt.NDArray[np.int64],
    group: npt.NDArray[np.int64],
    weight: npt.NDArray[np.int64],
    negative: Bools,
) -> Graph:
    from scipy import sparse

    both = np.concatenate([pairs, pairs[::-1]], axis=1)
    shape, ones = (len(weight), len(weight)), np.ones(both.shape[1], dtype=np.int8)
    # by columns and then by rows: those of a row rise
    found = sparse.csc_matrix((ones, both), shape=shape).tocsr()
    starts, others = found.indptr.astype(np.int32), found.indices.astype(np.int32)
    groups, weights = group.astype(np.int32), weight.astype(np.int32)
    return Graph(starts, others, groups, weights, negative)


class Taken:
    """Entries of a matrix that the fronts of this rank take: its own, and those that it is sent.

    Args:
        rows: of this rank.
        front: of every unknown, (size,); an entry goes to the lower of the two of its unknowns.
        mine: fronts of this rank.

    Attributes:
        begin: where rows start that have these entries among others, (local + 1,).
        columns: their columns, local numbers: owned ones, then those of another rank.
        numbers: global numbers of these.
        turn: the first front that takes more than entries beside columns of this rank.
    """

    def __init__(self, rows: Rows, front: Ints, mine: Bools) -> None:
        self._rows = rows
        self.begin, self.columns = rows.begin, rows.columns
        self.numbers = np.arange(rows.first, rows.end)
        self._sent = self._kept = self._order = np.zeros(0, dtype=np.int64)
        if rows.comm.size == 1:
            return
        kept = mine[front[rows.outer].min(axis=0)]
        self._kept, self._passed = np.flatnonzero(kept), np.flatnonzero(~kept)
        self._sent, pairs = self._away(front, mine)
        pairs = np.concatenate([pairs, rows.outer[:, self._passed]], axis=1)
        other = 1 - rows.comm.rank
        found = rows.comm.sendrecv(pairs, other, source=other)
        self._received = found.shape[1]
        self._append(np.concatenate([rows.outer[:, self._kept], found], axis=1))

    def _away(self, front: Ints, mine: Bools) -> tuple[npt.NDArray[np.int64], Ints]:
        """Entries beside columns of this rank that another takes, and their global numbers."""
        rows = self._rows
        own = front[rows.first : rows.end]
        away = ~mine[own]
        some = np.flatnonzero(away[rows.columns] | np.repeat(away, np.diff(rows.begin)))
        row = np.searchsorted(rows.begin, some, side="right") - 1
        column = rows.columns[some]
        theirs = ~mine[np.minimum(own[row], own[column])]
        pairs = np.array([row[theirs], column[theirs]]) + rows.first
        return some[theirs], pairs.astype(np.int32)

    def _append(self, pairs: Ints) -> None:
        """Rows of unknowns of the other rank with further entries."""
        first, end = self._rows.first, self._rows.end
        beyond = (pairs < first) | (pairs >= end)
        pairs = np.where(beyond[0], pairs, pairs[::-1])
        ghosts = np.unique(pairs[(pairs < first) | (pairs >= end)])
        row, column = pairs
        own = (column >= first) & (column < end)
        column = np.where(own, column - first, end - first + np.searchsorted(ghosts, column))
        row = np.searchsorted(ghosts, row)
        self._order = np.argsort(row, kind="stable")
        ends = self.begin[-1] + np.cumsum(np.bincount(row, minlength=len(ghosts)))
        self.begin = np.r_[self.begin, ends].astype(np.int32)
        self.columns = np.r_[self.columns, column[self._order]].astype(np.int32)
        self.numbers = np.r_[self.numbers, ghosts]

    def place(self, fronts: Fronts) -> None:
        """Tell the fronts where their entries are in `values`, and forget the rows.

        Fronts from `turn` on have their entries gathered, so that the others need no copy.
        """
        source, inner = fronts.source, len(self._rows.columns)
        more = np.flatnonzero(source >= inner)
        self.turn, start = fronts.fronts, len(source)
        if len(more):
            self.turn = int(np.searchsorted(fronts.entry_at, more[0], side="right")) - 1
            start = int(fronts.entry_at[self.turn])
        self._last = source[start:].copy()
        source[start:] = np.arange(len(self._last))
        fronts.take(source)
        self.begin = self.columns = self.numbers = np.zeros(0, dtype=np.int32)

    def values(self, outer: Floats) -> tuple[Floats, Floats]:
        """Entries now, for the fronts before `turn` and for the others; collective.

        Args:
            outer: entries beside columns of another rank.
        """
        inner = self._rows.inner_values()
        if self._rows.comm.size == 1:
            return inner, inner
        given = np.r_[inner[self._sent], outer[self._passed]]
        found = swap(self._rows.comm, given, self._received)
        more = np.r_[outer[self._kept], found][self._order]
        last = np.empty(len(self._last))
        here = self._last < len(inner)
        last[here] = inner[self._last[here]]
        last[~here] = more[self._last[~here] - len(inner)]
        return inner, last


class Product:
    """b − K x for rows that ranks share.

    Args:
        code: compiled.
        rows: of this rank.
    """

    def __init__(self, code: Code, rows: Rows) -> None:
        self._code, self._rows = code, rows
        # ghosts: columns of another rank that rows here have, and what it has of ours
        ghosts, row = np.unique(rows.outer[1], return_inverse=True)
        self._order = np.argsort(row, kind="stable")
        self._begin = np.r_[0, np.cumsum(np.bincount(row, minlength=len(ghosts)))].astype(np.int32)
        self._columns = (rows.outer[0] - rows.first)[self._order].astype(np.int32)
        self._sent = np.unique(rows.theirs[1]) - rows.first

    def residual(
        self, values: Floats, outer: Floats, b: Floats, x: Floats
    ) -> tuple[Floats, Floats]:
        """b − K x, and |K| |x| + |b|, owned parts, (columns, owned); collective.

        Args:
            values: entries beside columns of this rank.
            outer: entries beside columns of another rank.
            b: right sides, owned parts.
            x: solutions, owned parts.
        """
        comm, (count, owned) = self._rows.comm, b.shape
        ghosts = len(self._begin) - 1
        more = np.zeros((count, ghosts))
        if comm.size > 1:
            more = swap(comm, x[:, self._sent], more.size).reshape(more.shape)
        r, bound = (np.concatenate([part, 0 * more], axis=1) for part in (b, np.abs(b)))
        outer = outer[self._order]
        for arrays in zip(np.concatenate([x, more], axis=1), r, bound, strict=True):
            self._lose(0, self._rows.begin, self._rows.columns, values, *arrays)
            self._lose(owned, self._begin, self._columns, outer, *arrays)
        if comm.size > 1:
            passed = np.array([r[:, owned:], bound[:, owned:]])
            back = swap(comm, passed, 2 * count * len(self._sent)).reshape(2, count, -1)
            r[:, self._sent] += back[0]
            bound[:, self._sent] += back[1]
        return r[:, :owned], bound[:, :owned]

    def _lose(self, first: int, begin: Ints, columns: Ints, *arrays: Floats) -> None:
        """Take the product of some rows, first, first + 1, ..., off a residual."""
        pointers = self._code.pointers(begin, columns, *arrays)
        self._code.lib.residual(len(begin) - 1, first, *pointers)
