"""Order of elimination of a swept body: block after block from both ends, then the middle plane.

Blocks are a few layers long and a part of the section wide, side by side, then behind each other.
What a block shares with another one is eliminated with the last of them: no front is much larger
than a plane, and each grows by one block only (Irons 1970, A frontal solution program for finite
element analysis, doi 10.1002/nme.1620020104). What lies within a block is halved (`pieces`).
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.solver.order.graph import Graph, UnsuitableError
from fem.solver.order.pieces import WITHIN, Columns, Nodes, Section, front_seconds
from fem.solver.order.swept import Swept

Integers = npt.NDArray[Any]

LENGTHS, STRIPS = (1, 2, 3, 4, 6, 8), (1, 2, 3, 4, 6)
"""Layers of a block, and blocks side by side, that are tried."""
SURE = 1.1
"""More strips are not tried where they took so much more time than fewer."""
FEWEST = 4
"""Layers of a body that is long."""


@dataclasses.dataclass(frozen=True)
class Order:
    """Elements in the order of elimination, and where they are cut from each other.

    Attributes:
        element: at each place.
        depth: of the cut before each place, deeper ones first to be eliminated; `WITHIN`: none.
        block: at each place.
        turn: first block from the other end.
        seconds: that a factorisation is likely to take.
    """

    element: Integers
    depth: Integers
    block: Integers
    turn: int
    seconds: float


@dataclasses.dataclass(frozen=True)
class _Slab:
    """Layers between two planes."""

    first: int
    layers: int
    section: Section
    strips: list[Columns]


def order_blocks(graph: Graph, swept: Swept) -> Order:
    """Elements of a body in blocks.

    Raises:
        UnsuitableError: the body is short.
    """
    layers = int(swept.layer.max()) + 1
    if layers < FEWEST:
        raise UnsuitableError("the body is short")
    sections = _sections(graph, swept)
    middle = layers // 2
    ends = [_slabs(sections, 0, middle), _slabs(sections, middle, layers)[::-1]]
    number = {
        (column, layer): element
        for element, (column, layer) in enumerate(
            zip(swept.column.tolist(), swept.layer.tolist(), strict=True)
        )
    }
    elements, depths, blocks = list[int](), list[int](), list[int]()
    turn = block = 0
    for slabs in ends:
        turn = block
        for slab in slabs:
            for strip in slab.strips:
                cut = slab.section.cut(strip, slab.layers)
                elements += [number[column, slab.first + layer] for column, layer in cut.order]
                depths += [-1, *cut.depths]
                blocks += [block] * len(cut.order)
                block += 1
    seconds = sum(_seconds(slab.section, slab.layers, slab.strips) for end in ends for slab in end)
    return Order(np.array(elements), np.array(depths), np.array(blocks), turn, seconds)


def _sections(graph: Graph, swept: Swept) -> list[Section]:
    """Section of each layer; layers of the same columns have the same one."""
    count = len(graph.weight)
    layer = swept.layer[swept.owners]
    first, last = np.full(count, len(swept.layer)), np.full(count, -1)
    np.minimum.at(first, swept.nodes, layer)
    np.maximum.at(last, swept.nodes, layer)
    here = np.flatnonzero(layer == first[swept.nodes])
    here = here[np.argsort(layer[here], kind="stable")]
    sections, known = list[Section](), dict[Columns, Section]()
    for level in range(int(swept.layer.max()) + 1):
        mine = np.flatnonzero(swept.layer == level)
        columns = frozenset(swept.column[mine].tolist())
        if columns not in known:
            pairs = here[layer[here] == level]
            nodes = dict[int, set[int]]()
            owners = swept.column[swept.owners[pairs]].tolist()
            for node, column in zip(swept.nodes[pairs].tolist(), owners, strict=True):
                nodes.setdefault(node, set()).add(column)
            sizes = dict[Columns, list[int]]()
            for element in mine.tolist():
                own = frozenset([int(swept.column[element])])
                size = sizes.setdefault(own, [0, 0])
                size[0] += int(graph.weight[swept.vertex[element]])
            for node, touched in nodes.items():
                size = sizes.setdefault(frozenset(touched), [0, 0])
                size[int(last[node] > level)] += int(graph.weight[node])
            known[columns] = Section(Nodes(key, *size) for key, size in sizes.items())
        sections.append(known[columns])
    return sections


def _slabs(sections: list[Section], first: int, end: int) -> list[_Slab]:
    """Layers of one half of the body, those of one section in slabs of equal lengths."""
    slabs, start = list[_Slab](), first
    for layer in range(first + 1, end + 1):
        if layer < end and sections[layer] is sections[start]:
            continue
        length, strips = _best(sections[start], layer - start)
        count = -(-(layer - start) // length)
        bounds = np.linspace(start, layer, count + 1).round().astype(int).tolist()
        for lower, upper in itertools.pairwise(bounds):
            slabs.append(_Slab(lower, upper - lower, sections[start], strips))
        start = layer
    return slabs


def _best(section: Section, layers: int) -> tuple[int, list[Columns]]:
    """Layers of the slabs of a section, and their strips, that take the least time."""
    least, found = np.inf, (1, section.strips(1))
    for count in STRIPS:
        strips, before = section.strips(count), np.inf
        for length in LENGTHS:
            if length > layers:
                break
            seconds = _seconds(section, length, strips) / length
            if seconds < least:
                least, found = seconds, (length, strips)
            if seconds > before:
                break
            before = seconds
        if before > least * SURE:
            break
    return found


def _seconds(section: Section, layers: int, strips: list[Columns]) -> float:
    """Time for a slab in a long row of equal ones."""
    of = {column: number for number, strip in enumerate(strips) for column in strip}
    enter, leave = np.zeros((2, len(strips) + 1))
    active = 0.0
    for nodes in section.nodes:
        touched = [of[column] for column in nodes.columns]
        first, last = min(touched), max(touched)
        # the plane behind enters, the one before leaves
        enter[first] += nodes.plane
        leave[last] += nodes.plane
        active += nodes.plane
        if first < last:
            within = nodes.inner * layers + nodes.plane * (layers - 1)
            enter[first] += within
            leave[last] += within
    seconds = 0.0
    for number, strip in enumerate(strips):
        active += enter[number]
        seconds += front_seconds(leave[number], active - leave[number])
        active -= leave[number]
        seconds += section.seconds(strip, layers)
    return seconds


def fronts_of(graph: Graph, swept: Swept, order: Order) -> tuple[list[Integers], list[int]]:
    """Vertices of each front, in the order of elimination, and the fronts that take what it leaves.

    The last front is the middle plane.
    """
    count, places = len(graph.weight), len(order.element)
    place = np.empty(places, dtype=np.int64)
    place[order.element] = np.arange(places)
    first, last = np.full(count, places), np.full(count, -1)
    np.minimum.at(first, swept.nodes, place[swept.owners])
    np.maximum.at(last, swept.nodes, place[swept.owners])
    first[swept.vertex] = last[swept.vertex] = place
    return _gathered(order, first, last)


def _gathered(order: Order, first: Integers, last: Integers) -> tuple[list[Integers], list[int]]:
    """The same, by first and last place of what each vertex belongs to; -1: to nothing."""
    coupled = np.flatnonzero(last >= 0)
    first, last = first[coupled], last[coupled]
    block, places, turn = order.block, len(order.block), order.turn
    shallow = _shallowest(order.depth, first + 1, last)
    depth = np.where(first < last, order.depth[shallow], WITHIN)
    whole, cut = _leaves(order.depth)[:, first], _pieces(order.depth)[:, shallow]
    lower, upper = np.where(depth == WITHIN, whole, cut)
    # between blocks: with the last of them, after all before it at this end of the body
    outer = block[first] != block[last]
    start = np.where(block[last] < turn, 0, np.searchsorted(block, turn))
    lower = np.where(outer, start, lower)
    upper = np.where(outer, np.searchsorted(block, block[last], side="right"), upper)
    middle = outer & (block[first] < turn) & (block[last] >= turn)
    lower, upper = np.where(middle, 0, lower), np.where(middle, places, upper)
    depth = np.where(middle, -2, np.where(outer, -1, depth))
    if not middle.any():
        raise UnsuitableError("there is no middle plane")
    # a front ends where its piece does, after those within it
    sorting = np.lexsort((-depth, upper))
    fresh = (np.diff(upper[sorting]) != 0) | (np.diff(depth[sorting]) != 0)
    starts = np.r_[0, np.flatnonzero(fresh) + 1]
    own = np.split(coupled[sorting], starts[1:])
    return own, _parents(lower[sorting][starts].tolist())


def _leaves(depth: Integers) -> Integers:
    """First place, and that behind the last, of the piece without cuts that each place is in."""
    cuts = np.flatnonzero(depth != WITHIN)
    number = np.searchsorted(cuts, np.arange(len(depth)), side="right")
    return np.array([cuts[number - 1], np.r_[cuts, len(depth)][number]])


def _pieces(depth: Integers) -> Integers:
    """The same of the piece that is cut before each place."""
    found = np.zeros((2, len(depth)), dtype=np.int64)
    for row, step in ((0, 1), (1, -1)):
        open_ = list[tuple[int, int]]()
        values = depth.tolist()
        for place in range(len(depth))[::step]:
            while open_ and open_[-1][0] >= values[place]:
                open_.pop()
            found[row, place] = open_[-1][1] if open_ else (0, len(depth))[row]
            open_.append((values[place], place))
    return found


def _shallowest(depth: Integers, first: Integers, last: Integers) -> Integers:
    """Place of the least depth among places first to last; the last of equal ones."""
    table, reach = [np.arange(len(depth))], 1
    while 2 * reach <= len(depth):
        left, right = table[-1][:-reach], table[-1][reach:]
        table.append(np.where(depth[left] < depth[right], left, right))
        reach *= 2
    result = np.array(last)
    length = np.maximum(last - first + 1, 1)
    for level in range(len(table)):
        mine = np.flatnonzero((length >> level) == 1)
        left = table[level][np.minimum(first[mine], len(table[level]) - 1)]
        right = table[level][last[mine] - (1 << level) + 1]
        result[mine] = np.where(depth[left] < depth[right], left, right)
    return result


def _parents(lower: Iterable[int]) -> list[int]:
    """Parents of fronts in the order of elimination, by the first place of each."""
    parent, open_ = list[int](), list[tuple[int, int]]()
    for front, start in enumerate(lower):
        parent.append(-1)
        while open_ and open_[-1][1] >= start:
            parent[open_.pop()[0]] = front
        open_.append((front, start))
    return parent
