"""How a block of a swept body is halved: nested dissection of what repeats layer by layer.

A piece is a set of columns by a number of layers. A thin-walled body is a surface, so that a piece
that is about as long as it is wide has short cuts both ways (George 1973, Nested dissection of a
regular finite element mesh, doi 10.1137/0710032). Equal pieces are cut once.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence

Columns = frozenset[int]

LEAF = 60
"""Unknowns of a piece that is not cut any more."""
WEIGHT = 8.0
"""A cut's unknowns count as much, beside those of the larger part."""
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
        seconds: that its fronts are likely to take.
    """

    order: list[tuple[int, int]]
    depths: list[int]
    seconds: float


RATE, MOVED, FRONT = 3e10, 1.5e-9, 4e-6
"""Multiplications and additions in a second; seconds to move an entry of a front, and for a front
at all."""


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
        self._known: dict[tuple[Columns, int], Cut] = {}

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
        return self._piece(columns, layers, self.nodes)

    def _piece(self, columns: Columns, layers: int, around: Sequence[Nodes]) -> Cut:
        key = columns, layers
        if key not in self._known:
            touching = [some for some in around if not some.columns.isdisjoint(columns)]
            self._known[key] = self._new(columns, layers, touching)
        return self._known[key]

    def _new(self, columns: Columns, layers: int, touching: Sequence[Nodes]) -> Cut:
        inside = [some for some in touching if some.columns <= columns]
        total = _between(inside, layers)
        border = sum(some.inner * layers + some.plane * (layers + 1) for some in touching) - total
        best = _whole(columns, layers, front_seconds(total, border))
        if total <= LEAF:
            return best
        for parts in self._halves(columns, layers, inside):
            pieces = [self._piece(part, deep, touching) for part, deep, _ in parts]
            sizes = [_between(_within(inside, part), deep) for part, deep, _ in parts]
            seconds = front_seconds(total - sum(sizes), border)
            seconds += sum(piece.seconds for piece in pieces)
            if seconds < best.seconds:
                best = _joined(pieces, [start for _, _, start in parts], seconds)
        return best

    def _halves(
        self, columns: Columns, layers: int, inside: Sequence[Nodes]
    ) -> Iterator[list[tuple[Columns, int, int]]]:
        """Ways to cut a piece in two: columns, layers and first layer of both parts."""
        if layers > 1:
            half = layers // 2
            yield [(columns, half, 0), (columns, layers - half, half)]
        total = _between(inside, layers)
        for sides in self._sides(columns):
            best, found = float("inf"), None
            for side in sides:
                parts = (side, columns - side)
                sizes = [_between(_within(inside, part), layers) for part in parts]
                worth = max(sizes) + WEIGHT * (total - sum(sizes))
                if worth < best:
                    best, found = worth, side
            if found is not None:
                yield [(found, layers, 0), (columns - found, layers, 0)]

    def _sides(self, columns: Columns) -> Iterator[list[Columns]]:
        """Growing sets of columns, from one end of a piece or from one of its borders."""
        if len(columns) < 2:
            return
        levels = self._levels(columns, {min(columns)})
        if sum(map(len, levels)) < len(columns):
            yield [frozenset().union(*levels)]
            return
        yield _sums(self._levels(columns, {min(levels[-1])}))
        rim = {column for column in columns if not self._near[column] <= columns}
        while rim:
            part = set().union(*self._levels(frozenset(rim), {min(rim)}))
            rim -= part
            yield _sums(self._levels(columns, part))

    def _levels(self, columns: Columns, start: set[int]) -> list[set[int]]:
        seen, level, levels = set(start), start, []
        while level:
            levels.append(level)
            level = set().union(*(self._near[column] for column in level)) & columns
            level -= seen
            seen |= level
        return levels


def _sums(levels: Sequence[set[int]]) -> list[Columns]:
    """The first level, the first two, and so on, but not all."""
    found, before = list[Columns](), frozenset[int]()
    for level in levels[:-1]:
        before = before | level
        found.append(before)
    return found


def _within(nodes: Iterable[Nodes], columns: Columns) -> list[Nodes]:
    return [some for some in nodes if some.columns <= columns]


def _between(inside: Iterable[Nodes], layers: int) -> int:
    """Unknowns of layers and of the planes between them."""
    return sum(some.inner * layers + some.plane * (layers - 1) for some in inside)


def _whole(columns: Columns, layers: int, seconds: float) -> Cut:
    order = [(column, layer) for layer in range(layers) for column in sorted(columns)]
    return Cut(order, [WITHIN] * (len(order) - 1), seconds)


def _joined(pieces: Sequence[Cut], starts: Sequence[int], seconds: float) -> Cut:
    order, depths = list[tuple[int, int]](), list[int]()
    for piece, start in zip(pieces, starts, strict=True):
        if order:
            depths.append(0)
        order += [(column, layer + start) for column, layer in piece.order]
        depths += [depth if depth == WITHIN else depth + 1 for depth in piece.depths]
    return Cut(order, depths, seconds)
