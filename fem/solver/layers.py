"""Direct solver for long bodies: block elimination from both ends.

A body of many layers has a block tridiagonal matrix once what lies between its planes is
eliminated (Varah 1972, On the solution of block-tridiagonal systems, doi
10.1090/S0025-5718-1972-0323087-4). Planes, or parts of them, are dense blocks. With two ranks each
eliminates one end, and the middle plane meets what both leave. The order of elimination is fixed,
pivots are taken within a front only, so that a solution is checked by its residual.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

from fem.ranks import total
from fem.solver.dissection import long_body
from fem.solver.fronts import Code, Fronts
from fem.solver.order.graph import Tree, UnsuitableError
from fem.solver.rows import Product, Rows, Taken, swap

Floats = npt.NDArray[np.float64]

ENOUGH = 1e-13
"""Residual of a solve, as a part of its terms, that is not improved any more."""
REFINEMENTS = 3
"""Most steps of iterative refinement."""


class InaccurateError(ArithmeticError):
    """No refinement brings a solution to where its residual is round-off."""


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
        ZeroDivisionError: couplings of constraints that are no numbers.
    """

    def __init__(self, matrix: PETSc.Mat, negative: npt.NDArray[np.bool_]) -> None:
        self._comm = comm = matrix.getComm().tompi4py()
        if comm.size > 2:
            raise UnsuitableError("two ranks at most")
        self._rows = rows = Rows(matrix)
        self._code = code = Code(comm)
        self._negative = negative
        if comm.size > 1:
            negative = np.concatenate(comm.allgather(negative))
        graph = rows.graph(code, negative)
        tree = long_body(graph, rows.constraints(graph, negative), self._ends)
        if comm.size > 1:  # where processors differ, so may what they round and choose
            tree = comm.bcast(tree)
        # fronts [0, turn) from one end, [turn, middle) from the other, then the middle plane
        roots = [front for front, parent in enumerate(tree.parent) if parent == -1]
        self._middle = roots[0]
        tops = [front for front, parent in enumerate(tree.parent) if parent == self._middle]
        self._turn, self._top = tops[0] + 1, tops[-1]
        front_of = np.empty(len(graph.weight), dtype=np.int32)
        for front, own in enumerate(tree.own):
            front_of[own] = front
        eliminated = front_of[graph.group]
        far = np.zeros(len(tree.own), dtype=bool)
        far[self._turn : self._middle] = True
        self._last = self._at_last(far[eliminated])
        mine = self._mine(far)
        self._taken = taken = Taken(rows, eliminated, mine)
        self._fronts = Fronts(code, taken.begin, taken.columns, taken.numbers, graph, tree, mine)
        taken.place(self._fronts)
        self._product = Product(code, rows)
        self._outer = np.zeros(0)
        self._share(far[eliminated])
        self.negative_pivots = self.pivoted = 0

    def _ends(self, ends: Sequence[Callable[[], Tree]]) -> list[Tree]:
        """Trees of both ends, one made by each of two ranks."""
        if self._comm.size == 1:
            return [end() for end in ends]
        found: list[Tree] = self._comm.allgather(ends[self._comm.rank]())
        return found

    def _at_last(self, far: npt.NDArray[np.bool_]) -> bool:
        """Whether this rank takes the first end and the middle plane: by whose rows they are."""
        if self._comm.size == 1:
            return True
        here = far[: self._rows.first] if self._comm.rank else far[: self._rows.end]
        first = 2 * int((~here).sum()) >= len(here)
        return first == (self._comm.rank == 0)

    def _mine(self, far: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
        """What of all is eliminated here, by what is eliminated from the second end; a copy."""
        if self._comm.size == 1:
            return np.ones_like(far)
        return ~far if self._last else far.copy()

    def _share(self, far: npt.NDArray[np.bool_]) -> None:
        """Places of unknowns in the order of elimination, by who has their rows.

        Args:
            far: whether an unknown is eliminated from the second end, (size,).
        """
        rows = self._rows
        place = np.empty(rows.size, dtype=np.int64)
        place[self._fronts.unknowns] = np.arange(rows.size)
        mine = self._mine(far)
        own, self._here = slice(rows.first, rows.end), mine[rows.first : rows.end].copy()
        self._own_place = place[own][self._here]
        mine[own] = False
        self._other_place = place[mine]

    def renew(self) -> None:
        """Factorise the matrix as it is now; collective.

        Raises:
            ZeroDivisionError: the own unknowns of a front are singular.
        """
        self._outer = self._rows.outer_values()
        values = self._taken.values(self._outer)
        failed, counts = False, np.zeros(2, dtype=np.int64)
        fronts, comm = self._fronts, self._comm

        def do(first: int, end: int) -> None:
            nonlocal failed, counts
            turn = min(max(self._taken.turn, first), end)
            for start, stop, given in zip((first, turn), (turn, end), values, strict=True):
                if failed or start == stop:
                    continue
                try:
                    counts = counts + fronts.factorise(start, stop, given)
                except ZeroDivisionError:
                    failed = True

        if comm.size == 1:
            do(0, fronts.fronts)
        elif not self._last:
            do(self._turn, self._middle)
            comm.Send(fronts.left(self._top), 1 - comm.rank)
        else:
            do(0, self._turn)
            comm.Recv(fronts.left(self._top), 1 - comm.rank)
            do(self._middle, fronts.fronts)
        if total(comm, int(failed)):
            raise ZeroDivisionError("the own unknowns of a front are singular")
        self.negative_pivots, self.pivoted = map(int, total(comm, counts))

    def _solve(self, b: Floats) -> Floats:
        """One solve without refinement, owned parts, (columns, owned)."""
        comm, fronts, here = self._comm, self._fronts, self._here
        count = len(b)
        x = np.zeros((count, self._rows.size))
        x[:, self._own_place] = b[:, here]
        if comm.size == 1:
            fronts.forward(0, fronts.fronts, x)
            fronts.backward(0, fronts.fronts, x)
            return np.ascontiguousarray(x[:, self._own_place])
        others = self._other_place
        x[:, others] = swap(comm, b[:, ~here], count * len(others)).reshape(count, -1)
        turn, middle, end = self._turn, self._middle, fronts.fronts
        other, far = 1 - comm.rank, int(fronts.first[middle])
        beyond = np.empty((count, x.shape[1] - far))
        if not self._last:
            fronts.forward(turn, middle, x)
            comm.Send(np.ascontiguousarray(x[:, far:]), other)
            comm.Recv(beyond, other)
            x[:, far:] = beyond
            fronts.backward(turn, middle, x)
        else:
            fronts.forward(0, turn, x)
            comm.Recv(beyond, other)
            x[:, far:] += beyond
            fronts.forward(middle, end, x)
            fronts.backward(middle, end, x)
            comm.Send(np.ascontiguousarray(x[:, far:]), other)
            fronts.backward(0, turn, x)
        found = np.empty_like(b)
        found[:, here] = x[:, self._own_place]
        away = count * int((~here).sum())
        found[:, ~here] = swap(comm, x[:, others], away).reshape(count, -1)
        return found

    def _residual(self, b: Floats, x: Floats) -> tuple[Floats, Floats]:
        """b − K x, owned part, and the greatest part of |K| |x| + |b| that it is, (columns,).

        In two parts, forces and volumes, which have units of their own. Oettli and Prager 1964,
        doi 10.1007/BF01386090; norms instead of single rows, which may be zero.
        """
        r, bound = self._product.residual(self._rows.inner_values(), self._outer, b, x)
        parts = (self._negative, ~self._negative)
        squares = [[(v[:, part] ** 2).sum(axis=1) for part in parts] for v in (r, bound)]
        here, size = np.sqrt(total(self._comm, np.array(squares)))
        return r, (here / np.where(size > 0, size, 1.0)).max(axis=0)

    def solve(self, b: Floats) -> Floats:
        """K⁻¹ b, owned parts, (columns, owned), refined until its residual is round-off.

        Raises:
            InaccurateError: refinement does not help.
        """
        x, before = np.zeros_like(b), np.inf
        r = b
        for _ in range(REFINEMENTS + 1):
            x = x + self._solve(r)
            r, errors = self._residual(b, x)
            error = float(errors.max(initial=0.0))
            if error <= ENOUGH:
                return x
            if not error < before / 2:
                break
            before = error
        raise InaccurateError(f"a residual of {error:.1e} of its terms")
