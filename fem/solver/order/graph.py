"""A matrix as a graph, and a tree of fronts over it."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int32]


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

    own: Sequence[Sequence[int] | npt.NDArray[Any]]
    parent: list[int]


class UnsuitableError(Exception):
    """The matrix is not that of a long body with constraints inside its layers."""
