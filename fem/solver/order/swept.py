"""Elements of a swept body, found in its matrix's graph: in layers along it, and in columns.

An element shows itself by its own constraints: they are coupled to its nodes and to nothing else.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.solver.order.graph import Graph, UnsuitableError

Integers = npt.NDArray[Any]


@dataclasses.dataclass(frozen=True)
class Swept:
    """Elements in layers from one end of a body to the other.

    Attributes:
        vertex: the constraints of each element, (elements,).
        layer: of each element.
        column: of each element; those of one column lie behind one another.
        nodes: vertices of positive sign, as often as they belong to an element, (pairs,).
        owners: the elements.
    """

    vertex: Integers
    layer: Integers
    column: Integers
    nodes: Integers
    owners: Integers


def find_elements(graph: Graph) -> Swept:
    """The elements of a body.

    Args:
        graph: of its matrix.

    Raises:
        UnsuitableError: something does not belong to an element, or there are several bodies.
    """
    from scipy import sparse

    count = len(graph.weight)
    rows = np.repeat(np.arange(count, dtype=np.int32), np.diff(graph.begin))
    negative, coupled = graph.negative, np.diff(graph.begin) > 0
    mixed = negative[graph.neighbours]
    if (mixed & negative[rows]).any():
        raise UnsuitableError("constraints are coupled with each other")
    vertex = np.flatnonzero(negative & coupled)
    number = np.full(count, -1, dtype=np.int32)
    number[vertex] = np.arange(len(vertex))
    nodes, owners = rows[mixed], number[graph.neighbours[mixed]]
    lonely = ~negative & coupled
    lonely[nodes] = False
    if lonely.any() or not len(vertex):
        raise UnsuitableError("something belongs to no element with constraints")
    shape = (count, len(vertex))
    pairs = (nodes, owners)
    belongs = sparse.csr_matrix((np.ones(len(nodes), dtype=np.int32), pairs), shape=shape)
    shares = sparse.csr_matrix((graph.weight[nodes], pairs), shape=shape)
    common = (belongs.T @ shares).tocsr()
    layer = _layers(common)
    return Swept(vertex, layer, _columns(common.tocoo(), layer), nodes, owners)


def _layers(common: Any) -> Integers:
    """Layer of each element, from the nearer end: from a tube, a cap is met at its rim first.

    Args:
        common: what elements share with each other.
    """
    from scipy.sparse.csgraph import dijkstra

    def distances(start: Integers) -> Integers:
        found = dijkstra(common, unweighted=True, indices=start, min_only=True)
        if not np.isfinite(found).all():
            raise UnsuitableError("several bodies")
        return np.asarray(found, dtype=np.int64)

    def last(distance: Integers) -> Integers:
        return np.flatnonzero(distance == distance.max())

    # from one element only: seen from the middle, both ends are as far
    end = last(distances(last(distances(np.array([0])))[:1]))
    here = distances(last(distances(end)))
    there = distances(last(here))
    along = int((here + there).min())
    return np.where(here <= there, here, along - there)


def _columns(common: Any, layer: Integers) -> Integers:
    """Column of each element: on it lies that of the next layer with which it shares most."""
    count = len(layer)
    up = np.flatnonzero(layer[common.col] == layer[common.row] + 1)
    lower, upper, shared = common.row[up], common.col[up], common.data[up]

    def best(of: Integers, among: Integers) -> Integers:
        order = np.lexsort((among, -shared, of))
        first = np.r_[True, np.diff(of[order]) != 0][: len(order)]
        found = np.full(count, -1)
        found[of[order[first]]] = among[order[first]]
        return found

    above, below = best(lower, upper), best(upper, lower)
    under = np.where((below >= 0) & (above[below] == np.arange(count)), below, -1).tolist()
    column, columns = [-1] * count, 0
    for element in np.argsort(layer, kind="stable").tolist():
        if under[element] >= 0:
            column[element] = column[under[element]]
        else:
            column[element] = columns
            columns += 1
    return np.array(column)
