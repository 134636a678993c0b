"""Direct solver for long bodies: block elimination from both ends.

A body of many layers has a block tridiagonal matrix once what lies between its planes is
eliminated (Varah 1972, On the solution of block-tridiagonal systems, doi
10.1090/S0025-5718-1972-0323087-4). Planes, or parts of them, are dense blocks. With two ranks each
eliminates one end, and the middle plane meets what both leave. The order of elimination is fixed,
pivots are taken within a front only, so that a solution is checked by its residual.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

from fem.matrix import stored_values
from fem.solver.dissection import long_body
from fem.solver.fronts import Code, Fronts, couplings, matrix_graph
from fem.solver.order.constraints import Constraints
from fem.solver.order.graph import UnsuitableError

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]

ENOUGH = 1e-13
"""Residual of a solve, as a part of its terms, that is not improved any more."""
REFINEMENTS = 3
"""Most steps of iterative refinement."""


class InaccurateError(ArithmeticError):
    """No refinement brings a solution to where its residual is round-off."""


class _Rows:
    """The upper triangle that this rank stores, row by row.

    Attributes:
        begin: where each row starts, (owned + 1,).
        columns: their columns, rising, the diagonal first.
    """

    def __init__(self, matrix: PETSc.Mat) -> None:
        self._matrix = matrix
        first, end = matrix.getOwnershipRange()
        begin, columns = matrix.getDiagonalBlock().getRowIJ()
        self._inner, self._outer = len(columns), list[tuple[int, int, int]]()
        if matrix.getComm().size > 1:
            matrix.setOption(PETSc.Mat.Option.GETROW_UPPERTRIANGULAR, True)
            starts, within = np.diff(begin), np.split(columns, begin[1:-1])
            parts = []
            for row, inner in zip(range(first, end), within, strict=True):
                whole = matrix.getRow(row)[0]
                parts += [inner + first, whole[len(inner) :]]
                if len(whole) > len(inner):
                    self._outer.append((row, len(inner), len(whole)))
            columns = np.concatenate([np.zeros(0, dtype=np.int32), *parts])
            for row, _, length in self._outer:
                starts[row - first] = length
            begin = np.r_[0, np.cumsum(starts)]
        self.begin = np.ascontiguousarray(begin, dtype=np.int32)
        self.columns = np.ascontiguousarray(columns, dtype=np.int32)
        self._first = first

    def values(self) -> Floats:
        """Entries now; a view where no row has columns of another rank."""
        inner = stored_values(self._matrix, self._inner)
        if not self._outer:
            return inner
        values = np.empty(len(self.columns))
        taken = done = 0
        for row, here, whole in self._outer:
            start = int(self.begin[row - self._first])
            count = start + here - done
            values[done : start + here] = inner[taken : taken + count]
            values[start + here : start + whole] = self._matrix.getRow(row)[1][here:]
            taken, done = taken + count, start + whole
        values[done:] = inner[taken:]
        return values


class Layers:
    """A factorisation K = L D Lᵀ of a long body.

    Args:
        matrix: its upper triangle.
        negative: owned rows of constraints, without a positive diagonal.

    Attributes:
        negative_pivots: of the last factorisation, over all ranks.
        pivoted: fronts in which pivots had to be looked for, in the last factorisation.

    Raises:
        UnsuitableError: another solver is likely to be faster, or more than two ranks.
    """

    def __init__(self, matrix: PETSc.Mat, negative: npt.NDArray[np.bool_]) -> None:
        self._matrix = matrix
        self._comm = comm = matrix.getComm().tompi4py()
        if comm.size > 2:
            raise UnsuitableError("two ranks at most")
        self._rows = _Rows(matrix)
        values = self._rows.values()
        self._offsets = np.r_[0, np.cumsum(comm.allgather(len(negative)))]
        begin, columns = self._rows.begin, self._rows.columns
        counts = [len(columns)]
        if comm.size > 1:
            counts = comm.allgather(len(columns))
            begin = np.r_[0, np.cumsum(np.concatenate(comm.allgather(np.diff(begin))))]
            begin = begin.astype(np.int32)
            columns = np.concatenate(comm.allgather(columns))
            values = np.concatenate(comm.allgather(values))
            negative = np.concatenate(comm.allgather(negative))
        self._code = code = Code(comm)
        self._negative = negative
        graph = matrix_graph(code, begin, columns, negative)
        rows = couplings(code, begin, columns, negative, values)
        tree = long_body(graph, Constraints(rows, graph))
        # fronts [0, turn) from one end, [turn, middle) from the other, then the middle plane
        roots = [front for front, parent in enumerate(tree.parent) if parent == -1]
        self._middle = roots[0]
        tops = [front for front, parent in enumerate(tree.parent) if parent == self._middle]
        self._turn, self._top = tops[0] + 1, tops[-1]
        fronts = np.arange(len(tree.own))
        far = (fronts >= self._turn) & (fronts < self._middle)
        owner = np.where(far, comm.size - 1, 0)
        self._fronts = Fronts(code, begin, columns, graph, tree, owner == comm.rank)
        self._exchange(counts)
        self.negative_pivots = self.pivoted = 0

    def _exchange(self, counts: list[int]) -> None:
        """Which of the values on other ranks, so many on each, this one needs."""
        source = self._fronts.source
        self._sent = np.zeros(0, dtype=np.int64)
        if self._comm.size == 1:
            self._fronts.take(source)
            return
        starts = np.r_[0, np.cumsum(counts)]
        owner = np.repeat(np.arange(self._comm.size), counts)
        here = owner[source] == self._comm.rank
        wanted = source[~here]
        other = 1 - self._comm.rank
        asked = self._comm.sendrecv(wanted, other, source=other)
        self._sent = asked - starts[self._comm.rank]
        local = np.empty(len(source), dtype=np.int32)
        local[here] = source[here] - starts[self._comm.rank]
        local[~here] = len(self._rows.columns) + np.arange(len(wanted))
        self._fronts.take(local)

    def _values(self) -> Floats:
        values = self._rows.values()
        if self._comm.size == 1:
            return values
        other = 1 - self._comm.rank
        return np.r_[values, self._comm.sendrecv(values[self._sent], other, source=other)]

    def renew(self) -> None:
        """Factorise the matrix as it is now; collective.

        Raises:
            ZeroDivisionError: the own unknowns of a front are singular.
        """
        values = self._values()
        failed, counts = False, np.zeros(2, dtype=np.int64)
        fronts, comm = self._fronts, self._comm

        def do(first: int, end: int) -> None:
            nonlocal failed, counts
            if failed:
                return
            try:
                counts = counts + fronts.factorise(first, end, values)
            except ZeroDivisionError:
                failed = True

        if comm.size == 1:
            do(0, fronts.fronts)
        elif comm.rank == 1:
            do(self._turn, self._middle)
            comm.Send(fronts.left(self._top), 0)
        else:
            do(0, self._turn)
            comm.Recv(fronts.left(self._top), 1)
            do(self._middle, fronts.fronts)
        if comm.allreduce(failed):
            raise ZeroDivisionError("the own unknowns of a front are singular")
        self.negative_pivots, self.pivoted = map(int, comm.allreduce(counts))

    def _solve(self, b: Floats) -> Floats:
        """One solve without refinement, whole vectors on every rank, (columns, unknowns)."""
        comm, fronts = self._comm, self._fronts
        x = np.ascontiguousarray(b[:, fronts.unknowns])
        if comm.size == 1:
            fronts.forward(0, fronts.fronts, x)
            fronts.backward(0, fronts.fronts, x)
        else:
            turn, middle, end = self._turn, self._middle, fronts.fronts
            near, far = (int(fronts.first[front]) for front in (turn, middle))
            if comm.rank == 1:
                x[:, far:] = 0.0
                fronts.forward(turn, middle, x)
                x[:, far:] = comm.sendrecv(x[:, far:], 0, source=0)
                fronts.backward(turn, middle, x)
                x[:, :near] = comm.sendrecv(x[:, near:far], 0, source=0)
            else:
                fronts.forward(0, turn, x)
                x[:, far:] += comm.recv(source=1)
                fronts.forward(middle, end, x)
                fronts.backward(middle, end, x)
                comm.send(x[:, far:], 1)
                fronts.backward(0, turn, x)
                x[:, near:far] = comm.sendrecv(x[:, :near], 1, source=1)
        result = np.empty_like(x)
        result[:, fronts.unknowns] = x
        return result

    def _residual(self, b: Floats, x: Floats) -> tuple[Floats, Floats]:
        """b − K x, and the greatest part of |K| |x| + |b| that it is, (columns,).

        In two parts, forces and volumes, which have units of their own. Oettli and Prager 1964,
        doi 10.1007/BF01386090; norms instead of single rows, which may be zero.
        """
        code, rows = self._code, self._rows
        first = int(self._offsets[self._comm.rank])
        values = rows.values()
        r, bound = np.zeros((2, *b.shape))
        for column, rest, total in zip(x, r, bound, strict=True):
            arrays = (rows.begin, rows.columns, values, column, rest, total)
            code.lib.residual(len(rows.begin) - 1, first, *code.pointers(*arrays))
        if self._comm.size > 1:
            r, bound = self._comm.allreduce(np.array([r, bound]))
        r, bound = r + b, bound + np.abs(b)
        errors = np.zeros(len(b))
        for part in (self._negative, ~self._negative):
            size = np.linalg.norm(bound[:, part], axis=1)
            here = np.linalg.norm(r[:, part], axis=1) / np.where(size > 0, size, 1.0)
            errors = np.maximum(errors, here)
        return r, errors

    def solve(self, b: Floats) -> Floats:
        """K⁻¹ b, owned parts, (columns, owned), refined until its residual is round-off.

        Raises:
            InaccurateError: refinement does not help.
        """
        if self._comm.size > 1:
            b = np.concatenate(self._comm.allgather(b), axis=1)
        x, before = np.zeros_like(b), np.inf
        r = b
        for _ in range(REFINEMENTS + 1):
            x = x + self._solve(r)
            r, errors = self._residual(b, x)
            error = float(errors.max(initial=0.0))
            if error <= ENOUGH:
                first, end = self._offsets[self._comm.rank : self._comm.rank + 2]
                return x[:, first:end]
            if not error < before / 2:
                break
            before = error
        raise InaccurateError(f"a residual of {error:.1e} of its terms")
