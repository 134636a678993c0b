"""The tangent's assembly: element matrices straight into the values of the sparse matrix.

Where an entry of an element matrix goes is found once; no search and no insertion is left. The
loops are in assembly.c.
"""

from __future__ import annotations

import dataclasses
import functools
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem import compat, kernels
from fem.matrix import Ties, stored_rows, stored_values, upper_triangle

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]

NO_ROOM = "no memory for an element matrix"
NO_OFFSET = {1: "dofs that no cell couples", 2: "a row of the tangent has more than 65535 entries"}

_SOURCES = [Path(__file__).with_suffix(".c")]
_DECLARATIONS = """
typedef struct { uintptr_t kernel; int32_t count, stride; const int32_t *cell, *facet;
                 const double *values; } integral;
typedef struct { int32_t count, width; const int32_t *dofs; const int16_t *order;
                 const uint16_t *offset; } blocks;
typedef struct { int32_t owned; const int32_t *inner, *outer; double *values, *beyond;
                 const uint8_t *free; } storage;
void pattern(int32_t, int32_t, int32_t, const int32_t *, const int32_t *, const int32_t *, int32_t,
             int32_t *, int32_t *, int32_t *);
int offsets(int32_t, int32_t, int32_t, const int32_t *, const int32_t *, const int32_t *, int32_t,
            const int32_t *, const int32_t *, int32_t *, uint16_t *);
int add_blocks(const double *, const int32_t *, const blocks *, const storage *);
int add_cells(int32_t, const integral *, const double *, const double *, const int32_t *, int32_t,
              const blocks *, const storage *);
"""


@dataclasses.dataclass(frozen=True)
class _Rows:
    """Part of the upper triangle in compressed rows.

    Attributes:
        low: least column of the part.
        high: one more than its greatest column.
        begin: where each row starts, (rows + 1,).
        columns: of each row, rising.
    """

    low: int
    high: int
    begin: Ints
    columns: Ints


class _Slots:
    """Where each dof stands in blocks of dofs.

    Args:
        dofs: of every block, (m, k).
        size: number of local dofs.
    """

    def __init__(self, dofs: Ints, size: int) -> None:
        self.order = np.argsort(dofs, axis=1, kind="stable").astype(np.int16)
        self.dofs = np.ascontiguousarray(np.take_along_axis(dofs, self.order, axis=1))
        flat = self.dofs.ravel()
        self.slots = np.argsort(flat, kind="stable").astype(np.int32)
        self.start = np.r_[0, np.cumsum(np.bincount(flat, minlength=size))].astype(np.int32)


@dataclasses.dataclass(frozen=True)
class Blocks:
    """Where the entries of dense blocks go.

    Attributes:
        map: for C.
        kept: arrays that it points into.
        last: one more than the number of the last values of each block, (m,).
    """

    map: Any
    kept: tuple[npt.NDArray[Any], ...]
    last: Ints


class Assembler:
    """Symmetric storage of a tangent, and where the entries of blocks of dofs go in it.

    Args:
        comm: communicator.
        form: a compiled symmetric bilinear form over cells and boundary facets; of its element
            matrices only the upper triangle is read.
        space: the space of both of its arguments.
        ties: what belongs to the following dofs goes to those that they follow, which is TᵀKT with
            the prolongation T.

    Attributes:
        matrix: the matrix, its upper triangle only: inserting a triangle takes half the time of
            inserting all, and LDLᵀ needs no more.

    Raises:
        NotImplementedError: an integral or an element of another kind.
    """

    def __init__(self, comm: MPI.Comm, form: Any, space: Any, ties: Ties) -> None:
        self._code = kernels.library(comm, _SOURCES, _DECLARATIONS, compat.kernel_type())
        self._form, self._integrals = form, compat.integrals(form, self._code.ffi)
        self._rising = [np.argsort(part.cells, kind="stable") for part in self._integrals]
        self._points, self._corners = compat.coordinates(space.mesh)
        ghosts = compat.ghost_numbers(space)
        self._owned = int(space.dofmap.index_map.size_local)
        self._size = self._owned + len(ghosts)
        self._target = np.arange(self._size, dtype=np.int32)
        self._target[ties[0]] = ties[1]
        self._follow = ties[0]
        slots = _Slots(self._target[compat.cell_dofs(space)], self._size)
        inner = self._pattern(slots, self._owned, 0, self._owned)
        self._outer = self._pattern(slots, self._size, self._owned, self._size)
        self._inner, self.matrix = self._create(comm, inner, ghosts)
        self._beyond = np.zeros(len(self._outer.columns))
        self._cells = self._blocks(slots, np.zeros(0, dtype=np.int32))

    def _pointer(self, kind: str, array: npt.NDArray[Any]) -> Any:
        ffi = self._code.ffi
        return ffi.cast(kind, ffi.from_buffer(array, require_writable=False))

    def _ints(self, array: npt.NDArray[Any]) -> Any:
        return self._pointer("int32_t *", array)

    def _pattern(self, slots: _Slots, rows: int, low: int, high: int) -> _Rows:
        mark = np.full(self._size, -1, dtype=np.int32)
        begin = np.zeros(rows + 1, dtype=np.int32)
        ints = (slots.start, slots.slots, slots.dofs)
        fill = functools.partial(
            self._code.lib.pattern, rows, low, high, *map(self._ints, ints), slots.dofs.shape[1]
        )
        fill(self._ints(mark), self._ints(begin), self._code.ffi.NULL)
        columns = np.zeros(begin[-1], dtype=np.int32)
        mark[:] = -1
        fill(self._ints(mark), self._ints(begin), self._ints(columns))
        return _Rows(low, high, begin, columns)

    def _create(self, comm: MPI.Comm, inner: _Rows, ghosts: npt.NDArray[np.int64]) -> Any:
        """Matrix, and the part of it that this rank owns, which other ranks' cells may add to."""
        if comm.size == 1:
            matrix = upper_triangle(comm, inner.begin, inner.columns)
        else:
            matrix = upper_triangle(comm, *self._owned_rows(comm, inner, ghosts))
        return _Rows(0, self._owned, *stored_rows(matrix)), matrix

    def _owned_rows(
        self, comm: MPI.Comm, inner: _Rows, ghosts: npt.NDArray[np.int64]
    ) -> tuple[Ints, Ints]:
        """Where the rows that this rank owns start, and their global columns; collective."""
        ends = np.cumsum(comm.allgather(self._owned))
        first = int(ends[comm.rank]) - self._owned
        numbers = np.r_[first + np.arange(self._owned), ghosts]
        rows, columns = (_row_numbers(self._outer), self._outer.columns)
        pairs = np.sort(np.column_stack([numbers[rows], numbers[columns]]), axis=1)
        # entries beyond this rank's own, by row, so that a row is inserted at once
        self._order = np.lexsort(pairs.T[::-1])
        pairs = pairs[self._order]
        starts = np.flatnonzero(np.diff(pairs[:, 0], prepend=-1))
        self._sent = [
            (int(part[0, 0]), part[:, 1].astype(np.int32))
            for part in np.split(pairs, starts[1:])
            if len(part)
        ]
        owner = np.searchsorted(ends, pairs[:, 0], side="right")
        theirs = comm.alltoall([pairs[owner == rank] for rank in range(comm.size)])
        # only rows of these entries may have others than the cells of this rank give
        added = np.concatenate(theirs) - [first, 0]
        touched = np.unique(added[:, 0])
        kept, counts = np.ones(len(inner.columns), dtype=bool), np.diff(inner.begin)
        own = []
        for row in touched:
            part = slice(inner.begin[row], inner.begin[row + 1])
            kept[part] = False
            own.append(np.column_stack([np.full(counts[row], row), inner.columns[part] + first]))
        rows, columns = np.divmod(
            np.unique(np.concatenate([*own, added]) @ [ends[-1], 1]), ends[-1]
        )
        counts[touched] = np.bincount(rows, minlength=self._owned)[touched]
        begin = np.r_[0, np.cumsum(counts)].astype(np.int32)
        whole = np.empty(begin[-1], dtype=np.int32)
        fresh = np.zeros(self._owned, dtype=bool)
        fresh[touched] = True
        fresh = np.repeat(fresh, counts)
        whole[fresh] = columns
        whole[~fresh] = inner.columns[kept] + first
        return begin, whole

    def _blocks(self, slots: _Slots, last: Ints) -> Blocks:
        count, width = slots.dofs.shape
        offset = np.zeros((count, width * (width + 1) // 2), dtype=np.uint16)
        place = np.full(self._size, -1, dtype=np.int32)
        ints = [self._ints(array) for array in (slots.start, slots.slots, slots.dofs)]
        for part in (self._inner, self._outer):
            why = self._code.lib.offsets(
                len(part.begin) - 1,
                part.low,
                part.high,
                *ints,
                width,
                self._ints(part.begin),
                self._ints(part.columns),
                self._ints(place),
                self._pointer("uint16_t *", offset),
            )
            if why:
                raise ValueError(NO_OFFSET[why])
        pointers = (
            ints[2],
            self._pointer("int16_t *", slots.order),
            self._pointer("uint16_t *", offset),
        )
        kept = (slots.dofs, slots.order, offset)
        return Blocks(self._code.ffi.new("blocks *", (count, width, *pointers)), kept, last)

    def blocks(self, dofs: Ints) -> Blocks:
        """Where the entries of dense blocks go, for `assemble`.

        Args:
            dofs: local dofs of every block, (n, k), all of a block in one cell; blocks of the same
                dofs that follow each other are summed before they are added.

        Raises:
            ValueError: dofs that share no cell.
        """
        new = np.flatnonzero(np.any(dofs[1:] != dofs[:-1], axis=1)) + 1
        first = np.r_[np.zeros(min(len(dofs), 1), dtype=np.int64), new]
        last = np.r_[new, len(dofs)][: len(first)].astype(np.int32)
        return self._blocks(_Slots(self._target[dofs[first]], self._size), last)

    def assemble(self, free: npt.NDArray[np.bool_], others: list[tuple[Blocks, Floats]]) -> None:
        """Set the matrix to the form at the present state and further blocks; collective.

        Args:
            free: local dofs that no constraint fixes, (local,); the others, and those that follow,
                get a unit diagonal.
            others: blocks as `blocks` returns them, with their values, (n, k, k).
        """
        ffi, lib = self._code.ffi, self._code.lib
        self.matrix.zeroEntries()
        self._beyond[:] = 0.0
        values = stored_values(self.matrix, len(self._inner.columns))
        allowed = np.ascontiguousarray(free, dtype=np.uint8)
        parts = (self._inner.begin, self._outer.begin)
        storage = ffi.new(
            "storage *",
            (
                self._owned,
                *map(self._ints, parts),
                self._pointer("double *", values),
                self._pointer("double *", self._beyond),
                self._pointer("uint8_t *", allowed),
            ),
        )
        self._add_form(storage)
        for blocks, entries in others:
            entries = np.ascontiguousarray(entries)
            last = self._ints(blocks.last)
            if lib.add_blocks(self._pointer("double *", entries), last, blocks.map, storage):
                raise MemoryError(NO_ROOM)
        fixed = ~free[: self._owned]
        fixed[self._follow] = True
        values[self._inner.begin[:-1][fixed]] = 1.0
        if len(self._beyond):
            sent = np.split(
                self._beyond[self._order], np.cumsum([len(row) for _, row in self._sent])[:-1]
            )
            for (row, columns), entries in zip(self._sent, sent, strict=True):
                self.matrix.setValues(row, columns, entries, addv=True)
        self.matrix.assemble()

    def _add_form(self, storage: Any) -> None:
        ffi = self._code.ffi
        constants, packed = compat.coefficients(self._form)
        kept, rows = [], []
        for part, order in zip(self._integrals, self._rising, strict=True):
            table = np.ascontiguousarray(packed[part.key][order])
            ints = [np.ascontiguousarray(array[order]) for array in (part.cells, part.facets)]
            kept += [table, *ints]
            pointers = (*map(self._ints, ints), self._pointer("double *", table))
            rows.append((part.kernel, len(order), table.shape[1], *pointers))
        integrals = ffi.new("integral[]", rows)
        if self._code.lib.add_cells(
            len(self._integrals),
            integrals,
            self._pointer("double *", constants),
            self._pointer("double *", self._points),
            self._ints(self._corners),
            self._corners.shape[1],
            self._cells.map,
            storage,
        ):
            raise MemoryError(NO_ROOM)


def _row_numbers(rows: _Rows) -> Ints:
    """Row of every entry."""
    return np.repeat(np.arange(len(rows.begin) - 1, dtype=np.int32), np.diff(rows.begin))
