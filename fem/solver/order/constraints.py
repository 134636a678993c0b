"""Constraints that can be eliminated with a front, and those that have to wait.

No displacement within a closed part changes its volume: the sum of all volumes is a null vector of
Bᵀ, with B the couplings of constraints (rows) and displacements (columns).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from fem.solver.order.graph import Graph

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Integers = npt.NDArray[Any]

REACHED = 1e-2
"""Least singular value, relative, of constraints that can be eliminated within a part."""


class Constraints:
    """Couplings of constraints with unknowns of positive sign.

    Args:
        rows: starts, columns and entries of rows; empty for unknowns that are no constraints.
        graph: of the matrix.
    """

    def __init__(self, rows: tuple[Ints, Ints, Floats], graph: Graph) -> None:
        starts, columns, entries = rows
        size = len(starts) - 1
        self._rows = sparse.csr_matrix((entries, columns, starts), shape=(size, size))
        self._members = np.argsort(graph.group, kind="stable")
        self._start = np.r_[0, np.cumsum(graph.weight)]
        self._mark = np.zeros(size, dtype=bool)
        self._graph = graph

    def unknowns(self, vertices: Iterable[int]) -> npt.NDArray[np.int64]:
        """Unknowns of some vertices."""
        parts = [self._members[self._start[v] : self._start[v + 1]] for v in vertices]
        return np.concatenate([np.zeros(0, dtype=np.int64), *parts])

    def unreached(self, part: set[int]) -> list[int]:
        """Vertices of constraints that the unknowns of a part cannot meet by themselves.

        No displacement within a closed part changes its volume: the sum of all volumes is a null
        vector of Bᵀ, with B the couplings of constraints (rows) and displacements (columns).
        """
        graph = self._graph
        pressures = self._unknowns_of(sorted(part), negative=True)
        columns = self._unknowns_of(part, negative=False)
        block = self._rows[pressures][:, columns].toarray()
        block /= _sizes(block)[:, None]
        return self._unreached(block, graph.group[pressures])

    @staticmethod
    def _unreached(block: Floats, owner: Integers) -> list[int]:
        left = list[int]()
        while len(owner):
            # squares of singular values, rising: those of BBᵀ, which is small where B is wide
            squares, modes = np.linalg.eigh(block @ block.T)
            if squares[0] > REACHED**2 * squares[-1]:
                break
            vertex = int(owner[np.argmax(np.abs(modes[:, 0]))])
            left.append(vertex)
            block, owner = block[owner != vertex], owner[owner != vertex]
        return left

    def settled(
        self, own: Sequence[Integers], parent: Sequence[int]
    ) -> tuple[list[Integers], list[int]]:
        """Fronts, with constraints that their unknowns cannot meet left to their parents.

        Args:
            own: vertices of each front.
            parent: of each front; -1: none.
        """
        found = [vertices.tolist() for vertices in own]
        carried = dict[int, list[_Unmet]]()
        failing = self._failing(own)
        for front, above in enumerate(parent):
            if front not in carried and front not in failing:
                continue
            inside = self._unknowns_of(found[front], negative=False)
            found[front] += [v for some in carried.get(front, []) for v in some.vertices]
            if front in failing:
                unmet = self._unmet(found[front], inside)
                leaving = unmet.vertices
            else:
                unmet = self._still_unmet(carried[front], inside)
                leaving = unmet.leaving(self._graph.group)
            if above < 0 or not len(leaving):
                continue
            found[front] = [v for v in found[front] if v not in leaving]
            carried.setdefault(above, []).append(dataclasses.replace(unmet, vertices=leaving))
        return _without_empty(found, parent)

    def _unknowns_of(self, vertices: Iterable[int], negative: bool) -> npt.NDArray[np.int64]:
        return self.unknowns(v for v in vertices if self._graph.negative[v] == negative)

    def _failing(self, own: Sequence[Integers]) -> set[int]:
        """Fronts whose unknowns do not meet all their constraints."""
        rows, weight = self._rows, self._graph.weight
        # what is coupled to nothing is in none of them: a last one stands for it
        front = np.full(len(weight), len(own))
        front[np.concatenate(own)] = np.repeat(np.arange(len(own)), [len(some) for some in own])
        front = front[self._graph.group]
        negative = self._graph.negative[self._graph.group]
        counts, place = np.zeros((2, len(own) + 1), dtype=np.int64), np.empty(len(front), np.int64)
        for row, part in enumerate((np.flatnonzero(negative), np.flatnonzero(~negative))):
            counts[row] = np.bincount(front[part], minlength=len(own) + 1)
            part = part[np.argsort(front[part], kind="stable")]
            starts = np.repeat(np.cumsum(counts[row]) - counts[row], counts[row])
            place[part] = np.arange(len(part)) - starts
        owner = np.repeat(np.arange(len(front)), np.diff(rows.indptr))
        kept = np.flatnonzero(front[owner] == front[rows.indices])
        owner, other, values = owner[kept], rows.indices[kept], rows.data[kept]
        of, number = front[owner], np.empty(len(own), dtype=np.int64)
        failing = list[int]()
        heights = counts[0, :-1]
        for height in np.unique(heights[heights > 0]):
            fronts = np.flatnonzero(heights == height)
            number[fronts] = np.arange(len(fronts))
            mine = np.flatnonzero(counts[0][of] == height)
            blocks = np.zeros((len(fronts), height, counts[1][fronts].max()))
            blocks[number[of[mine]], place[owner[mine]], place[other[mine]]] = values[mine]
            blocks /= _sizes(blocks)[:, :, None]
            squares = np.linalg.eigvalsh(blocks @ blocks.transpose(0, 2, 1))
            failing += fronts[squares[:, 0] <= REACHED**2 * squares[:, -1]].tolist()
        return set(failing)

    def _block(self, rows: Integers, inside: Integers | None = None) -> tuple[Integers, Floats]:
        """Unknowns that some constraints are coupled to, and the couplings; only those inside."""
        starts, ends = self._rows.indptr[rows], self._rows.indptr[rows + 1]
        ranges = [np.arange(start, end) for start, end in zip(starts, ends, strict=True)]
        entries = np.concatenate(ranges)
        owner = np.repeat(np.arange(len(rows)), ends - starts)
        if inside is not None:
            self._mark[inside] = True
            kept = self._mark[self._rows.indices[entries]]
            self._mark[inside] = False
            entries, owner = entries[kept], owner[kept]
        columns, place = np.unique(self._rows.indices[entries], return_inverse=True)
        block = np.zeros((len(rows), len(columns)))
        block[owner, place] = self._rows.data[entries]
        return columns, block

    def _unmet(self, vertices: list[int], inside: Integers) -> _Unmet:
        rows = self._unknowns_of(vertices, negative=True)
        _, block = self._block(rows, inside)
        size = _sizes(block)
        block /= size[:, None]
        squares, modes = np.linalg.eigh(block @ block.T)
        null = modes[:, squares <= REACHED**2 * squares[-1]] / size[:, None]
        return _Unmet(rows, null, self._unreached(block, self._graph.group[rows]))

    def _still_unmet(self, parts: Sequence[_Unmet], inside: Integers) -> _Unmet:
        """Combinations of what parts cannot meet that a cut between them cannot meet either."""
        rows = np.concatenate([part.rows for part in parts])
        null = linalg.block_diag(*(part.null for part in parts))
        columns, block = self._block(rows)
        whole = null.T @ block
        size = _sizes(whole)
        self._mark[inside] = True
        met = whole[:, self._mark[columns]] / size[:, None]
        self._mark[inside] = False
        squares, modes = np.linalg.eigh(met @ met.T)
        null = (null / size) @ modes[:, squares <= REACHED**2]
        return _Unmet(rows, null, [v for part in parts for v in part.vertices])


def _sizes(rows: Floats) -> Floats:
    """Norm of each row, by which it can be divided; 1 of an empty one."""
    found = np.linalg.norm(rows, axis=-1)
    return np.where(found > 0, found, 1.0)


@dataclasses.dataclass(frozen=True)
class _Unmet:
    """Combinations of constraints that the unknowns of some fronts do not change.

    Attributes:
        rows: constraints, (n,).
        null: their factors, (n, combinations).
        vertices: constraints that have not been eliminated.
    """

    rows: Integers
    null: Floats
    vertices: list[int]

    def leaving(self, owner: Integers) -> list[int]:
        """Vertices without which the rest can be eliminated: one for each combination at most."""
        of = owner[self.rows]
        left = np.isin(of, self.vertices)
        null, of, leaving = self.null[left], of[left], list[int]()
        while null.shape[1] and len(null):
            pivot = np.unravel_index(np.argmax(np.abs(null)), null.shape)
            vertex = int(of[pivot[0]])
            if not null[pivot]:
                break
            leaving.append(vertex)
            row = null[pivot[0]] / null[pivot]
            rest = np.delete(null - null[:, [pivot[1]]] * row, pivot[1], axis=1)
            null, of = rest[of != vertex], of[of != vertex]
        return leaving


def _without_empty(
    own: Sequence[list[int]], parent: Sequence[int]
) -> tuple[list[Integers], list[int]]:
    """Fronts that have something to eliminate."""
    above = list(parent)
    for front in reversed(range(len(own))):
        if above[front] >= 0 and not own[above[front]]:
            above[front] = above[above[front]]
    kept = [front for front, vertices in enumerate(own) if vertices]
    number = {front: place for place, front in enumerate(kept)} | {-1: -1}
    return [np.array(own[front]) for front in kept], [number[above[front]] for front in kept]
