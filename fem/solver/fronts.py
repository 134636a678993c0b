"""Sparse L D Lᵀ by dense fronts (Duff and Reid 1983, doi 10.1145/356044.356047).

A front is the dense matrix of its own unknowns and its border. Own unknowns of positive sign are
eliminated first, then constraints: K = [A Bᵀ; B −C] with A positive definite has pivots of known
signs in this order (Vanderbei 1995, Symmetric quasidefinite matrices, doi 10.1137/0805005), so
that two Cholesky factorisations do it. Where a pivot has another sign, as on an unstable branch,
what is left of the front's own unknowns is pivoted (Bunch and Kaufman 1977,
doi 10.1090/S0025-5718-1977-0428694-0). What a front leaves on its border is added to its parent.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from fem import kernels
from fem.solver.order.graph import Graph, Tree, UnsuitableError

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]

KEPT = 64
"""Columns of L that are kept together, with the rows from their first one on; as in fronts.c."""
LARGEST = 2**31 - 1
"""Entries of a front's own columns: tables.c counts them by 32 bits."""
TINY = 1e-14
"""A pivot below this part of the greatest before in its block counts as one of another sign."""

_SOURCES = [Path(__file__).with_name(name) for name in ("tables.c", "fronts.c")]
_BLAS = (
    *("dgemm_", "dsyrk_", "dtrsm_", "dgemv_", "dtrsv_"),
    *("dsytrf_", "dsyconv_"),
)
_TABLES = """const int32_t *positive, *own, *size; const int64_t *panel, *schur, *first, *border_at;
    const int32_t *border; const int64_t *child_at; const int32_t *child; const int64_t *run_at;
    const int32_t *run; const int64_t *entry_at; const int32_t *source, *target;"""
_DECLARATIONS = f"""
typedef struct {{ ...; }} blas_t;
typedef struct {{ int fronts; {_TABLES} }} plan_t;
void bind(blas_t *, const uintptr_t *);
void sums(int32_t, const int32_t *, const int32_t *, const uint64_t *, uint64_t *);
int borders(int32_t, const int32_t *, const int32_t *, const int64_t *, const int32_t *,
            const int32_t *, const int32_t *, const int32_t *, const uint8_t *, int32_t *,
            int64_t *, int32_t *, int64_t);
int64_t runs(const plan_t *, int32_t *, int64_t *, int32_t *);
void entries(const plan_t *, int32_t, const int32_t *, const int32_t *, const int32_t *,
             const int32_t *, const uint8_t *, int32_t *, int64_t *, int32_t *, int32_t *);
void locate(const plan_t *, const int32_t *, int32_t *, int32_t *);
int factorise(const blas_t *, const plan_t *, int, int, const double *, double *, double *,
              double *, double *, int32_t *, double *, double *, double, int *, int *);
void forward(const blas_t *, const plan_t *, int, int, const double *, const int32_t *,
             const double *, const double *, double *, int64_t, int, double *);
void backward(const blas_t *, const plan_t *, int, int, const double *, const int32_t *, double *,
              int64_t, int, double *);
void residual(int32_t, int32_t, const int32_t *, const int32_t *, const double *, const double *,
              double *, double *);
"""


class Code:
    """The compiled tables.c and fronts.c, and the BLAS that PETSc uses; collective."""

    def __init__(self, comm: MPI.Comm) -> None:
        module = kernels.library(comm, _SOURCES, _DECLARATIONS)
        self.ffi, self.lib = module.ffi, module.lib
        library = ctypes.CDLL(PETSc.__file__)
        found = [ctypes.cast(getattr(library, name), ctypes.c_void_p).value for name in _BLAS]
        self.blas = self.ffi.new("blas_t *")
        self.lib.bind(self.blas, self.ffi.new("uintptr_t[]", found))

    def pointer(self, array: npt.NDArray[Any]) -> Any:
        """An array's data for C."""
        kind = "double *" if array.dtype.kind == "f" else f"{array.dtype}_t *"
        return self.ffi.cast(kind, self.ffi.from_buffer(array, require_writable=False))

    def pointers(self, *arrays: npt.NDArray[Any]) -> list[Any]:
        """The same of several."""
        return [self.pointer(array) for array in arrays]


def _cut(array: Ints, size: int) -> Ints:
    """The first entries of an array, the rest of its memory freed."""
    return array if size == len(array) else array[:size].copy()


class Fronts:
    """The fronts of a matrix, their storage, and what this rank does of them.

    Args:
        code: compiled.
        begin: where rows of the matrix start that this rank knows, each entry once.
        columns: their columns, by the numbers of these rows.
        numbers: of these rows in the whole matrix.
        graph: its graph.
        tree: its fronts.
        mine: fronts whose numbers this rank needs.

    Raises:
        UnsuitableError: two fronts are coupled of which none is an ancestor of the other, or one
            is larger than `LARGEST`.

    Attributes:
        unknowns: unknown of every place in the order of elimination.
        source: entries of the matrix that this rank's fronts take, in the order of use; whoever
            renumbers them gives `take` other values.
        entry_at: where those of each front start, (fronts + 1,).
    """

    def __init__(
        self,
        code: Code,
        begin: Ints,
        columns: Ints,
        numbers: npt.NDArray[np.int64],
        graph: Graph,
        tree: Tree,
        mine: npt.NDArray[np.bool_],
    ) -> None:
        self._code = code
        self._plan = code.ffi.new("plan_t *")
        self._kept: list[npt.NDArray[Any]] = []
        self.fronts = self._plan.fronts = len(tree.own)
        self._order(graph, tree)
        self._set_borders(graph, tree)
        self._set_runs()
        self.source = self._set_entries(begin, columns, numbers, mine)
        self._reserve(mine)

    def _set(self, name: str, array: npt.NDArray[Any], kind: str = "int32") -> npt.NDArray[Any]:
        array = np.ascontiguousarray(array, dtype=kind)
        self._kept.append(array)
        setattr(self._plan, name, self._code.pointer(array))
        return array

    def _order(self, graph: Graph, tree: Tree) -> None:
        """Numbers of unknowns, fronts and vertices in the order of elimination."""
        counts = np.array([len(own) for own in tree.own])
        self._vertices = np.concatenate([np.array(own, dtype=np.int32) for own in tree.own])
        self._own_at = np.r_[0, np.cumsum(counts)].astype(np.int32)
        front = np.repeat(np.arange(self.fronts, dtype=np.int32), counts)
        order = np.lexsort((graph.negative[self._vertices], front))
        self._vertices = self._vertices[order]
        weight, negative = graph.weight[self._vertices], graph.negative[self._vertices]
        self._front_of = np.empty(len(graph.weight), dtype=np.int32)
        self._front_of[self._vertices] = front
        self._place = np.empty(len(graph.weight), dtype=np.int64)
        self._place[self._vertices] = np.r_[0, np.cumsum(weight)][:-1]
        own = np.bincount(front, weights=weight, minlength=self.fronts)
        positive = np.bincount(front, weights=weight * ~negative, minlength=self.fronts)
        self.own = self._set("own", own)
        self._set("positive", positive)
        self.first = self._set("first", np.r_[0, np.cumsum(self.own)][:-1], "int64")
        rank = np.empty(len(graph.weight), dtype=np.int64)
        rank[self._vertices] = np.arange(len(rank))
        self.unknowns = np.argsort(rank[graph.group], kind="stable")
        self._position = np.empty(len(self.unknowns), dtype=np.int32)
        self._position[self.unknowns] = np.arange(len(self.unknowns))

    def _set_borders(self, graph: Graph, tree: Tree) -> None:
        parent = np.array(tree.parent)
        children = np.argsort(parent, kind="stable")
        children = self._set("child", np.r_[children[parent[children] >= 0], 0])
        counts = np.bincount(parent[parent >= 0], minlength=self.fronts)
        child_at = self._set("child_at", np.r_[0, np.cumsum(counts)], "int64")
        root = (parent < 0).astype(np.uint8)
        start, room = np.zeros(self.fronts + 1, dtype=np.int64), 16 * len(graph.weight)
        arrays = (self._own_at, self._vertices, child_at, children, graph.begin, graph.neighbours)
        while True:
            mark, found = np.full(len(graph.weight), -1, dtype=np.int32), np.zeros(room, np.int32)
            pointers = self._code.pointers(*arrays, self._front_of, root, mark, start, found)
            failed = self._code.lib.borders(self.fronts, *pointers, room)
            if failed == 2:
                raise UnsuitableError("its planes do not part it")
            if not failed:
                break
            room *= 2
        found = found[: start[-1]]
        front = np.repeat(np.arange(self.fronts), np.diff(start))
        found = found[np.lexsort((self._place[found], front))]
        weight = graph.weight[found].astype(np.int64)
        ends = np.cumsum(weight)
        within = np.arange(int(weight.sum())) - np.repeat(ends - weight, weight)
        self._set("border", np.repeat(self._place[found], weight) + within)
        border = np.bincount(front, weights=weight, minlength=self.fronts).astype(np.int64)
        self._set("border_at", np.r_[0, np.cumsum(border)], "int64")
        self.size = self._set("size", self.own + border)
        if int((self.own.astype(np.int64) * self.size).max()) > LARGEST:
            raise UnsuitableError("a front is too large")
        self._parent, self._children = parent, (child_at, children)

    def _set_runs(self) -> None:
        children = int(self._children[0][-1])
        where = np.zeros(len(self.unknowns), dtype=np.int32)
        at = self._set("run_at", np.zeros(children + 1, dtype=np.int64), "int64")
        pointers = (self._code.pointer(where), self._code.pointer(at))
        count = self._code.lib.runs(self._plan, *pointers, self._code.ffi.NULL)
        run = self._set("run", np.zeros(3 * count, dtype=np.int32))
        self._code.lib.runs(self._plan, *pointers, self._code.pointer(run))

    def _set_entries(
        self,
        begin: Ints,
        columns: Ints,
        numbers: npt.NDArray[np.int64],
        mine: npt.NDArray[np.bool_],
    ) -> Ints:
        front = np.repeat(np.arange(self.fronts, dtype=np.int32), self.own)
        needed = mine.astype(np.uint8)
        source, target, high = (np.zeros(len(columns), dtype=np.int32) for _ in range(3))
        at = np.zeros(self.fronts + 2, dtype=np.int64)
        position = self._position[numbers]
        arrays = (begin, columns, position, front, needed, high, at, source, target)
        size = len(begin) - 1
        self._code.lib.entries(self._plan, size, *self._code.pointers(*arrays))
        self.entry_at = at = self._set("entry_at", at[:-1], "int64")
        source, target = (_cut(array, int(at[-1])) for array in (source, target))
        self._set("target", target)
        where = np.zeros(len(self._position), dtype=np.int32)
        self._code.lib.locate(self._plan, *self._code.pointers(high, where, target))
        return source

    def _reserve(self, mine: npt.NDArray[np.bool_]) -> None:
        """Storage: panels of own unknowns, and what fronts leave, which their parents free."""
        own, size = self.own.astype(np.int64), self.size.astype(np.int64)
        whole, rest = np.divmod(own, KEPT)
        kept = KEPT * (whole * size - KEPT * whole * (whole - 1) // 2)
        panel = np.where(mine, kept + rest * (size - KEPT * whole), 0)
        self._set("panel", np.r_[0, np.cumsum(panel)][:-1], "int64")
        left = (size - own) ** 2
        slots = np.zeros(self.fronts, dtype=np.int64)
        used: list[tuple[int, int]] = []
        top = 0
        child_at, children = self._children
        needed = mine.copy()
        needed[
            [f for f in range(self.fronts) if self._parent[f] >= 0 and mine[self._parent[f]]]
        ] = 1
        for front in np.flatnonzero(needed).tolist():
            at = 0
            for start, end in sorted(used):
                if start - at >= left[front]:
                    break
                at = end
            slots[front] = at
            if left[front]:
                used.append((at, at + int(left[front])))
            top = max(top, at + int(left[front]))
            if mine[front]:
                for child in children[child_at[front] : child_at[front + 1]].tolist():
                    used.remove((int(slots[child]), int(slots[child] + left[child])))
        self._slots = self._set("schur", slots, "int64")
        widest = int(size.max())
        self._panels, self._schurs = np.empty(int(panel.sum())), np.empty(top)
        self._hot, self._work = np.empty(int((own * size).max())), np.empty(widest * (widest + 64))
        self._pivots = np.zeros(len(self.unknowns), dtype=np.int32)
        self._diagonal, self._beside = np.zeros((2, len(self.unknowns)))

    def take(self, source: Ints) -> None:
        """Entries that this rank's fronts take, by their place in the values given."""
        self._set("source", source)

    def left(self, front: int) -> Floats:
        """What a front leaves on its border, a view of its storage."""
        at, size = int(self._slots[front]), int(self.size[front] - self.own[front]) ** 2
        return self._schurs[at : at + size]

    def factorise(self, first: int, end: int, values: Floats) -> tuple[int, int]:
        """Factorise fronts first to end.

        Returns:
            Number of negative pivots, and of fronts that were pivoted.

        Raises:
            ZeroDivisionError: the own unknowns of a front are singular.
        """
        negative, pivoted = self._code.ffi.new("int *"), self._code.ffi.new("int *")
        scratch = (self._panels, self._schurs, self._hot, self._work)
        pivots = (self._pivots, self._diagonal, self._beside)
        pointers = self._code.pointers(values, *scratch, *pivots)
        code, plan = self._code, self._plan
        if code.lib.factorise(code.blas, plan, first, end, *pointers, TINY, negative, pivoted):
            raise ZeroDivisionError("the own unknowns of a front are singular")
        return negative[0], pivoted[0]

    def forward(self, first: int, end: int, x: Floats) -> None:
        """D⁻¹ L⁻¹ by fronts first to end, in place; (columns, unknowns) in elimination order."""
        code = self._code
        arrays = (self._panels, self._pivots, self._diagonal, self._beside, x)
        self._room(len(x))
        code.lib.forward(
            *(code.blas, self._plan, first, end, *code.pointers(*arrays)),
            *(x.shape[1], len(x), code.pointer(self._work)),
        )

    def backward(self, first: int, end: int, x: Floats) -> None:
        """L⁻ᵀ by fronts end to first, in place."""
        code = self._code
        self._room(len(x))
        code.lib.backward(
            *(code.blas, self._plan, first, end),
            *code.pointers(self._panels, self._pivots, x),
            *(x.shape[1], len(x), code.pointer(self._work)),
        )

    def _room(self, columns: int) -> None:
        needed = int(self.size.max()) * columns
        if len(self._work) < needed:
            self._work = np.empty(needed)
