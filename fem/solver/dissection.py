"""Order of elimination of a long body: in blocks of elements, or plane by plane.

Where every element shows itself by its constraints, blocks of them are eliminated (`order.blocks`).
Elsewhere level sets of the matrix's graph from one end of the body are (George and Liu 1981,
Computer solution of large sparse positive definite systems, Prentice-Hall, section 4.3). What of a
level is coupled to the next one is its plane, the rest lies between two planes. Planes are
eliminated one after the other from both ends, and meet in the middle; the parts between them, which
know nothing of each other, are halved along their own level sets until they are small.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from fem.solver.order.blocks import fronts_of, order_blocks
from fem.solver.order.constraints import Constraints
from fem.solver.order.graph import Graph, Tree, UnsuitableError
from fem.solver.order.pieces import RATE
from fem.solver.order.swept import find_elements

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]

Share = Callable[[Sequence[Callable[[], Tree]]], list[Tree]]
"""Makes the trees that each of some functions returns, all or a part of them on this rank."""

PART = 60
"""Unknowns of a part between two planes that is not halved any more."""
JOINED = 24
"""Unknowns of a cut through such a part that are eliminated together with the plane beside it."""

OPERATIONS, GENERAL = 3.3, 1.15e-7
"""Multiplications and additions of a plane of n unknowns by n³, 7/3 of them for itself; and seconds
of a general solver for n unknowns in each of L layers by L n^1.75. Measured on the core and on the
bodies of `RATE`."""


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
        self.own += [list(own) for own in tree.own]
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


def body_levels(graph: Graph) -> tuple[list[list[int]], list[list[int]]]:
    """Planes of a long body, and what lies before each of them.

    Raises:
        UnsuitableError: several bodies, or constraints in a plane.
    """
    begin, neighbours = graph.begin, graph.neighbours
    count = len(begin) - 1
    rows = np.repeat(np.arange(count, dtype=np.int32), np.diff(begin))
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
    return planes, between


def _all(ends: Sequence[Callable[[], Tree]]) -> list[Tree]:
    return [end() for end in ends]


def long_body(
    graph: Graph,
    constraints: Constraints,
    share: Share = _all,
) -> Tree:
    """Fronts that eliminate a long body from both ends; the middle plane follows them.

    Args:
        graph: of its matrix.
        constraints: couplings of its constraints.
        share: makes the fronts of both ends plane by plane, as ranks may do between them.

    Raises:
        UnsuitableError: few levels or wide ones, several bodies, or constraints in a plane.
    """
    tree = _block_by_block(graph, constraints) or _plane_by_plane(graph, constraints, share)
    alone = np.flatnonzero(np.diff(graph.begin) == 0)
    parts = [alone[first : first + PART] for first in range(0, len(alone), PART)]
    return Tree([*tree.own, *parts], [*tree.parent, *[-1] * len(parts)])


def _block_by_block(graph: Graph, constraints: Constraints) -> Tree | None:
    """Blocks of elements; None where something is coupled beyond them, or an end falls apart."""
    try:
        swept = find_elements(graph)
    except UnsuitableError:
        return None
    order = order_blocks(graph, swept)
    own, parent = fronts_of(graph, swept, order)
    if not _parted(graph, own, parent):
        return None
    _demand(order.seconds, len(graph.group), int(swept.layer.max()) + 1)
    own, parent = constraints.settled(own, parent)
    # on the middle plane, the last front, lies one front of either end
    return Tree(own, parent) if parent.count(len(own) - 1) == 2 else None


def _parted(graph: Graph, own: Sequence[npt.NDArray[np.int64]], parent: Sequence[int]) -> bool:
    """Whether of any two fronts that are coupled one is an ancestor of the other."""
    first = np.arange(len(own))
    for below, above in enumerate(parent):
        if above >= 0:
            first[above] = min(first[above], first[below])
    front = np.full(len(graph.weight), -1, dtype=np.int32)
    front[np.concatenate(own)] = np.repeat(np.arange(len(own)), [len(some) for some in own])
    one = np.repeat(front, np.diff(graph.begin))
    other = front[graph.neighbours]
    return bool((first[np.maximum(one, other)] <= np.minimum(one, other)).all())


def _demand(seconds: float, unknowns: int, layers: int) -> None:
    """Refuse what a general solver is likely to do sooner."""
    if seconds > GENERAL * layers * (unknowns / layers) ** 1.75:
        raise UnsuitableError("its planes are wide")


def _plane_by_plane(
    graph: Graph,
    constraints: Constraints,
    share: Share,
) -> Tree:
    """Every plane by itself, and what lies between two of them."""
    planes, between = body_levels(graph)
    last = len(planes) - 1
    if last < 3:
        raise UnsuitableError("the body is short")
    wide = sum(float(graph.weight[plane].sum()) ** 3 for plane in planes)
    _demand(OPERATIONS * wide / RATE, len(graph.group), len(planes))
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
    return Tree(layers.own, layers.parent)
