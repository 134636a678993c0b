"""Order of elimination of a long body: planes from both ends, and what lies between them first.

Level sets of the matrix's graph from one end of the body (George and Liu 1981, Computer solution
of large sparse positive definite systems, Prentice-Hall, section 4.3). What of a level is coupled
to the next one is its plane, the rest lies between two planes. Planes are eliminated one after the
other from both ends, and meet in the middle; the parts between them, which know nothing of each
other, are halved along their own level sets until they are small.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Longs = npt.NDArray[np.int64]

PART = 60
"""Unknowns of a part between two planes that is not halved any more."""
JOINED = 24
"""Unknowns of a cut through such a part that are eliminated together with the plane beside it."""
REACHED = 1e-2
"""Least singular value, relative, of constraints that can be eliminated within a part."""

OPERATIONS, RATE, GENERAL = 3.3, 2.7e10, 7.5e-8
"""Multiplications and additions of a plane of n unknowns by n³, 7/3 of them for itself; how many
are done in a second; and seconds of a general solver for n unknowns in each of L layers by
L n^1.75. Measured on one core, on the body of cases/free_bending.yaml."""


@dataclasses.dataclass(frozen=True)
class Graph:
    """Vertices are groups of unknowns with the same couplings and the same sign.

    Attributes:
        begin: where the neighbours of each vertex start, (vertices + 1,).
        neighbours: of all vertices, one after the other, without themselves.
        group: vertex of each unknown, (unknowns,).
        weight: unknowns of each vertex, (vertices,).
        negative: whether they are constraints, whose pivots are negative, (vertices,).
    """

    begin: Ints
    neighbours: Ints
    group: Ints
    weight: Ints
    negative: npt.NDArray[np.bool_]


@dataclasses.dataclass(frozen=True)
class Tree:
    """Fronts in the order of elimination.

    Attributes:
        own: vertices that each front eliminates.
        parent: the front that takes what it leaves; -1: none.
    """

    own: list[list[int]]
    parent: list[int]


class UnsuitableError(Exception):
    """The matrix is not that of a long body with constraints inside its layers."""


class Constraints:
    """Couplings of constraints with unknowns of positive sign.

    Args:
        begin: where those of each unknown start, of constraints alone, (unknowns + 1,).
        columns: unknowns of positive sign that they are coupled with.
        values: their entries.
        graph: the matrix's graph.
    """

    def __init__(self, begin: Longs, columns: Ints, values: Floats, graph: Graph) -> None:
        self._begin, self._columns, self._values = begin, columns, values
        self._place = np.full(len(begin) - 1, -1, dtype=np.int32)
        self._members = np.argsort(graph.group, kind="stable")
        self._start = np.r_[0, np.cumsum(graph.weight)]
        self._graph = graph

    def unknowns(self, vertices: Iterable[int]) -> npt.NDArray[np.int64]:
        """Unknowns of some vertices."""
        parts = [self._members[self._start[v] : self._start[v + 1]] for v in vertices]
        return np.concatenate([np.zeros(0, dtype=np.int64), *parts])

    def _block(
        self, rows: npt.NDArray[np.int64], columns: npt.NDArray[np.int64]
    ) -> npt.NDArray[np.float64]:
        """Couplings of some constraints with some unknowns of positive sign."""
        block = np.zeros((len(rows), len(columns)))
        self._place[columns] = np.arange(len(columns))
        for line, row in zip(block, rows.tolist(), strict=True):
            part = slice(self._begin[row], self._begin[row + 1])
            place = self._place[self._columns[part]]
            line[place[place >= 0]] = self._values[part][place >= 0]
        self._place[columns] = -1
        return block

    def unreached(self, part: set[int]) -> list[int]:
        """Vertices of constraints that the unknowns of a part cannot meet by themselves.

        No displacement within a closed part changes its volume: the sum of all volumes is a null
        vector of Bᵀ, with B the couplings of constraints (rows) and displacements (columns).
        """
        graph = self._graph
        pressures = sorted(v for v in part if graph.negative[v])
        left = []
        columns = self.unknowns(v for v in part if not graph.negative[v])
        block = self._block(self.unknowns(pressures), columns)
        block /= np.linalg.norm(block, axis=1)[:, None] + 1e-300
        owner = np.repeat(pressures, graph.weight[pressures])
        while len(owner):
            # squares of singular values, rising: those of BBᵀ, which is small where B is wide
            squares, modes = np.linalg.eigh(block @ block.T)
            if squares[0] > REACHED**2 * squares[-1]:
                break
            vertex = int(owner[np.argmax(np.abs(modes[:, 0]))])
            left.append(vertex)
            block, owner = block[owner != vertex], owner[owner != vertex]
        return left


class _Layers:
    """Builds the tree."""

    def __init__(self, graph: Graph, constraints: Constraints) -> None:
        self.graph, self.constraints = graph, constraints
        self.weight = graph.weight.tolist()
        self.own: list[list[int]] = []
        self.parent: list[int] = []

    def add(self, own: list[int], children: Iterable[int]) -> int:
        front = len(self.own)
        self.own.append(own)
        self.parent.append(-1)
        for child in children:
            self.parent[child] = front
        return front

    def join(self, tree: Tree) -> int:
        """Take the fronts of one end, of which the last one is left."""
        start = len(self.own)
        self.own += tree.own
        self.parent += [-1 if parent < 0 else parent + start for parent in tree.parent]
        return len(self.own) - 1

    def between(self, part: list[int]) -> tuple[list[int], list[int]]:
        """Fronts of what lies between two planes, and the vertices that are left to a plane."""
        graph, inside = self.graph, set(part)
        near = {
            v: inside.intersection(graph.neighbours[graph.begin[v] : graph.begin[v + 1]].tolist())
            for v in part
        }
        left: list[int] = []
        tops: list[int] = []
        for piece in _pieces(near, inside):
            cut = self._cut(near, piece)
            if cut and self._sum(cut) <= JOINED:
                left += cut
                tops += self._fronts(near, piece.difference(cut), left)
            else:
                tops += self._fronts(near, piece, left)
        return tops, left

    def _sum(self, part: Iterable[int]) -> int:
        return sum(self.weight[v] for v in part)

    def _fronts(self, near: dict[int, set[int]], part: set[int], left: list[int]) -> list[int]:
        tops = []
        for piece in _pieces(near, part):
            cut = self._cut(near, piece)
            if cut:
                tops.append(self.add(cut, self._fronts(near, piece.difference(cut), left)))
                continue
            unreached = self.constraints.unreached(piece)
            left += unreached
            if own := sorted(piece.difference(unreached)):
                tops.append(self.add(own, ()))
        return tops

    def _cut(self, near: dict[int, set[int]], part: set[int]) -> list[int]:
        """Vertices that halve a connected part; none where it is small or has no halves."""
        total = self._sum(part)
        if total <= PART:
            return []
        levels = _levels(near, part, min(part))
        levels = _levels(near, part, min(levels[-1]))
        best, cut, before = np.inf, list[int](), 0
        for level, beyond in zip(levels, map(set, levels[1:]), strict=False):
            facing = sorted(v for v in level if not near[v].isdisjoint(beyond))
            before += self._sum(level)
            weight = self._sum(facing)
            sides = (before - weight, total - before)
            if min(sides) > 0 and max(sides) + 2 * weight < best:
                best, cut = max(sides) + 2 * weight, facing
        fair = 2 * self._sum(cut) <= total and not self.graph.negative[cut].any()
        return cut if fair else []


def _levels(near: dict[int, set[int]], part: set[int], start: int) -> list[list[int]]:
    seen, level, levels = {start}, [start], []
    while level:
        levels.append(level)
        beyond = set().union(*(near[v] for v in level)).intersection(part) - seen
        seen |= beyond
        level = sorted(beyond)
    return levels


def _pieces(near: dict[int, set[int]], part: set[int]) -> list[set[int]]:
    """Connected pieces of a part."""
    rest, pieces = set(part), []
    while rest:
        piece = set().union(*_levels(near, rest, min(rest)))
        pieces.append(piece)
        rest -= piece
    return pieces


def body_levels(graph: Graph) -> tuple[list[list[int]], list[list[int]], list[int]]:
    """Planes of a long body, what lies before each of them, and vertices without neighbours.

    Raises:
        UnsuitableError: several bodies, or constraints in a plane.
    """
    begin, neighbours = graph.begin, graph.neighbours
    count = len(begin) - 1
    rows = np.repeat(np.arange(count, dtype=np.int32), np.diff(begin))
    alone = np.flatnonzero(np.diff(begin) == 0)
    coupled = np.flatnonzero(np.diff(begin) > 0)
    degree = np.diff(begin)

    def distances(level: npt.NDArray[np.int64]) -> Ints:
        result = np.full(count, -1, dtype=np.int32)
        distance = 0
        while len(level):
            result[level] = distance
            distance += 1
            counts = degree[level]
            before = np.cumsum(counts) - counts
            near = neighbours[np.arange(counts.sum()) + np.repeat(begin[level] - before, counts)]
            result[near[result[near] < 0]] = distance
            level = np.flatnonzero(result == distance)
        return result

    if not len(coupled):
        raise UnsuitableError("nothing is coupled")
    far = distances(coupled[:1])
    level = distances(np.flatnonzero(far == far.max()))
    if (level[coupled] < 0).any():
        raise UnsuitableError("several bodies")
    # the end itself lies before the first plane
    level[coupled] = np.maximum(level[coupled] - 1, 0)
    facing = np.zeros(count, dtype=bool)
    facing[rows[level[neighbours] > level[rows]]] = True
    if graph.negative[facing].any():
        raise UnsuitableError("constraints couple layers")
    order = np.argsort(level, kind="stable")
    parts = np.split(order, np.searchsorted(level[order], np.arange(level.max() + 1)))[1:]
    planes = [part[facing[part]].tolist() for part in parts]
    between = [part[~facing[part]].tolist() for part in parts]
    return planes, between, alone.tolist()


def _all(ends: Sequence[Callable[[], Tree]]) -> list[Tree]:
    return [end() for end in ends]


def long_body(
    graph: Graph,
    constraints: Constraints,
    share: Callable[[Sequence[Callable[[], Tree]]], list[Tree]] = _all,
) -> Tree:
    """Fronts that eliminate a long body from both ends; the last but one is the middle plane.

    Args:
        graph: of its matrix.
        constraints: couplings of its constraints.
        share: makes the fronts of both ends, as ranks may do between them.

    Raises:
        UnsuitableError: few levels or wide ones, several bodies, or constraints in a plane.
    """
    planes, between, alone = body_levels(graph)
    last = len(planes) - 1
    if last < 3:
        raise UnsuitableError("the body is short")
    unknowns = len(graph.group) / len(planes)
    wide = sum(float(graph.weight[plane].sum()) ** 3 for plane in planes)
    if OPERATIONS * wide / RATE > GENERAL * len(planes) * unknowns**1.75:
        raise UnsuitableError("its planes are wide")
    middle = last // 2

    def chain(order: Iterable[tuple[list[int], list[int]]]) -> Tree:
        layers = _Layers(graph, constraints)
        before: list[int] = []
        for inside, plane in order:
            tops, left = layers.between(inside)
            before = [layers.add([*left, *plane], [*tops, *before])]
        return Tree(layers.own, layers.parent)

    up = [(between[k + 1], planes[k]) for k in range(middle)]
    up[0] = (between[0] + up[0][0], planes[0])
    down = [(between[k], planes[k]) for k in range(last - 1, middle, -1)]
    down[0] = (between[last] + down[0][0], planes[last - 1])
    layers = _Layers(graph, constraints)
    tops = [layers.join(tree) for tree in share([partial(chain, up), partial(chain, down)])]
    layers.add(planes[middle], tops)
    for first in range(0, len(alone), PART):
        layers.add(alone[first : first + PART], ())
    return Tree(layers.own, layers.parent)
