"""How a block of a swept body is halved: nested dissection of what repeats layer by layer.

A piece is a set of columns by a number of layers. A thin-walled body is a surface, so that a piece
that is about as long as it is wide has short cuts both ways (George 1973, Nested dissection of a
regular finite element mesh, doi 10.1137/0710032). Equal pieces are cut once.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Iterator, Sequence

Columns = frozenset[int]

LEAF = 60
"""Unknowns of a piece that is not cut any more."""
WEIGHT = 4.0
"""A cut's unknowns count as much, beside those of the larger part."""
WAYS = 2
"""Ways to cut a piece that are gone into."""
WITHIN = 1 << 20
"""Depth where a piece is not cut."""


@dataclasses.dataclass(frozen=True)
class Nodes:
    """Nodes of a layer that belong to the same columns.

    Attributes:
        columns: which.
        inner: unknowns within the layer.
        plane: unknowns in the plane behind it.
    """

    columns: Columns
    inner: int
    plane: int


@dataclasses.dataclass(frozen=True)
class Cut:
    """A piece in the order of elimination.

    Attributes:
        order: columns and layers of its elements.
        depths: of the cut between each element and the next one; `WITHIN`: there is none.
    """

    order: list[tuple[int, int]]
    depths: list[int]


Part = tuple[Columns, int, int]
"""Columns, layers and first layer."""


@dataclasses.dataclass(frozen=True)
class _Piece:
    """What is known of a piece: time and unknowns within it, and its halves."""

    seconds: float
    unknowns: int
    parts: tuple[Part, ...]


RATE, MOVED, FRONT = 3.2e10, 1.1e-9, 4e-6
"""Multiplications and additions in a second; seconds to move an entry of a front, and for a front
at all. On one core (AMD EPYC, OpenBLAS kernel Zen), bodies of 8 557 to 369 543 unknowns."""


def front_seconds(own: float, border: float) -> float:
    """Time to eliminate some unknowns of a front."""
    arithmetic = own**3 / 3 + own**2 * border + own * border**2
    return arithmetic / RATE + (own + border) ** 2 * MOVED + FRONT


class Section:
    """What the layers of one section are made of, and how blocks of them are cut.

    Args:
        nodes: of one layer.
    """

    def __init__(self, nodes: Iterable[Nodes]) -> None:
        self.nodes = list(nodes)
        near: dict[int, set[int]] = {}
        for some in self.nodes:
            for column in some.columns:
                near.setdefault(column, set()).update(some.columns)
        self._near = near
        self._known: dict[tuple[Columns, int], _Piece] = {}

    def strips(self, count: int) -> list[Columns]:
        """The columns in so many parts side by side, one end to the other."""
        columns = frozenset(self._near)
        levels = self._levels(columns, {min(columns)})
        levels = self._levels(columns, {min(levels[-1])})
        strips, part, done = list[Columns](), set[int](), 0
        for level in levels:
            part |= level
            done += len(level)
            if done * count >= len(columns) * (len(strips) + 1):
                strips.append(frozenset(part))
                part = set()
        # what is not connected with the rest
        if rest := columns.difference(*strips):
            strips.append(rest)
        return strips

    def cut(self, columns: Columns, layers: int) -> Cut:
        """How a block is cut where its fronts cost least."""
        self._piece(columns, layers, self.nodes)
        return Cut(*self._placed(columns, layers))

    def _placed(self, columns: Columns, layers: int) -> tuple[list[tuple[int, int]], list[int]]:
        """Order and depths of a piece that is known."""
        parts = self._known[columns, layers].parts
        if not parts:
            order = [(column, layer) for layer in range(layers) for column in sorted(columns)]
            return order, [WITHIN] * (len(order) - 1)
        order, depths = list[tuple[int, int]](), list[int]()
        for part, deep, start in parts:
            inner, cuts = self._placed(part, deep)
            depths += [0] if order else []
            order += [(column, layer + start) for column, layer in inner]
            depths += [depth if depth == WITHIN else depth + 1 for depth in cuts]
        return order, depths

    def seconds(self, columns: Columns, layers: int) -> float:
        """Time for what lies within a block."""
        return self._piece(columns, layers, self.nodes).seconds

    def _piece(self, columns: Columns, layers: int, around: Sequence[Nodes]) -> _Piece:
        key = columns, layers
        if key not in self._known:
            touching = [some for some in around if not some.columns.isdisjoint(columns)]
            self._known[key] = self._new(columns, layers, touching)
        return self._known[key]

    def _new(self, columns: Columns, layers: int, touching: Sequence[Nodes]) -> _Piece:
        inside = [some for some in touching if some.columns <= columns]
        total = _between(inside, layers)
        border = sum(some.inner * layers + some.plane * (layers + 1) for some in touching) - total
        best = _Piece(front_seconds(total, border), total, ())
        if total <= LEAF:
            return best
        for parts in self._halves(columns, layers, inside):
            pieces = [self._piece(part, deep, touching) for part, deep, _ in parts]
            own = total - sum(piece.unknowns for piece in pieces)
            seconds = front_seconds(own, border) + sum(piece.seconds for piece in pieces)
            if seconds < best.seconds:
                best = _Piece(seconds, total, parts)
        return best

    def _halves(
        self, columns: Columns, layers: int, inside: Sequence[Nodes]
    ) -> list[tuple[Part, Part]]:
        """Likely ways to cut a piece in two: columns, layers and first layer of both parts."""
        ways = dict[tuple[Part, Part], float]()
        if layers > 1:
            half = layers // 2
            one, other = (columns, half, 0), (columns, layers - half, half)
            sizes = [_between(inside, deep) for deep in (half, layers - half)]
            ways[one, other] = max(sizes) + WEIGHT * (_between(inside, layers) - sum(sizes))
        for levels in self._sides(columns):
            side, worth = _best_side(levels, inside, layers)
            if side:
                ways[(side, layers, 0), (columns - side, layers, 0)] = worth
        return sorted(ways, key=lambda way: ways[way])[:WAYS]

    def _sides(self, columns: Columns) -> Iterator[list[set[int]]]:
        """Columns level by level, from one end of a piece or from one of its borders."""
        if len(columns) < 2:
            return
        levels = self._levels(columns, {min(columns)})
        if sum(map(len, levels)) < len(columns):
            connected = set().union(*levels)
            yield [connected, set(columns - connected)]
            return
        yield self._levels(columns, {min(levels[-1])})
        rim = {column for column in columns if not self._near[column] <= columns}
        while rim:
            part = set().union(*self._levels(frozenset(rim), {min(rim)}))
            rim -= part
            yield self._levels(columns, part)

    def _levels(self, columns: Columns, start: set[int]) -> list[set[int]]:
        seen, level, levels = set(start), start, []
        while level:
            levels.append(level)
            level = set().union(*[self._near[column] for column in level])
            level &= columns
            level -= seen
            seen |= level
        return levels


def _best_side(
    levels: Sequence[set[int]], inside: Sequence[Nodes], layers: int
) -> tuple[Columns, float]:
    """The first levels, as many as have the shortest cut and fair halves, and their worth."""
    if len(levels) < 2:
        return frozenset(), math.inf
    at = {column: number for number, level in enumerate(levels) for column in level}
    count = len(levels)
    # unknowns whose columns lie before each level's end, and behind it
    before, behind = [0] * (count + 1), [0] * (count + 1)
    for some in inside:
        where = [at[column] for column in some.columns]
        unknowns = some.inner * layers + some.plane * (layers - 1)
        before[max(where)] += unknowns
        behind[min(where)] += unknowns
    total = sum(before)
    least, chosen, one, other = math.inf, 0, 0, total
    for number in range(count - 1):
        one += before[number]
        other -= behind[number]
        worth = max(one, other) + WEIGHT * (total - one - other)
        if worth < least:
            least, chosen = worth, number + 1
    return frozenset().union(*levels[:chosen]), least


def _between(inside: Iterable[Nodes], layers: int) -> int:
    """Unknowns of layers and of the planes between them."""
    return sum([some.inner * layers + some.plane * (layers - 1) for some in inside])
