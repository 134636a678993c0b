"""Threads along the axis where they pass through a section."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import Ints, MeshData
from geometry.winding.families import Family
from geometry.winding.ribbons import Ribbons
from geometry.winding.segments import EmbeddedFibers, develop


def through_section(
    mesh: MeshData, actuator: Actuator, laid: Ribbons, shortest: float
) -> tuple[EmbeddedFibers, Ints]:
    """Points of the outline at which threads along the axis lie, with a length of 1 mm of z each.

    Args:
        mesh: quadrilaterals with the surface "winding"; half or full.
        actuator: dimensions the mesh was built from.
        laid: families along the axis.
        shortest: part of the perimeter within which a point lies between two edges.

    Returns:
        The points as segments, and the family of each.

    Raises:
        ValueError: threads that rise, for which a section has no z.
    """
    if any(family.angle for family in laid.families):
        raise ValueError("a section can have smeared windings only")
    facets, perimeter = develop(mesh, actuator), actuator.winding_perimeter
    start, across = facets.origin[:, 0], facets.axes[:, 0, 0]
    near, n = shortest * perimeter, laid.lines_per_fiber
    ends = (0.0, perimeter / 2, perimeter) if mesh.half else ()
    numbers, places, parts = [], [], []
    base = 0
    for number, family in enumerate(laid.families):
        for thread, line, s in _lines(laid, family, perimeter, near):
            local = (s - start) / across
            # the edge on its growing-s side takes a point between two; half a section has half of
            # what lies in its mirror plane
            ahead, border = np.where(across > 0, local, 1 - local), near / np.abs(across)
            halved = any(abs(s - end) < near for end in ends)
            upper = 1 + border if halved else 1 - border
            for edge in np.flatnonzero((ahead > -border) & (ahead < upper)).tolist():
                numbers.append((edge, base + thread * n + line, number))
                places.append((local[edge], s))
                parts.append(0.5 if halved else 1.0)
        base += family.threads * n
    edge, curve, which = np.array(numbers, dtype=np.int64).reshape(-1, 3).T
    position, at = np.array(places, dtype=float).reshape(-1, 2).T
    count = len(edge)
    points = facets.base[edge] + position[:, None] * facets.edges[edge, 0]
    fibers = EmbeddedFibers(
        cell=facets.cell[edge],
        facet=facets.facet[edge],
        points=points[:, None],
        tangents=np.zeros((count, 1, 2)),
        axial=np.ones((count, 1)),
        weights=np.ones((count, 1)),
        length=np.array(parts, dtype=float),
        share=np.full(count, 1 / n),
        curve=curve,
        z=np.zeros(count),
        s=at,
        family=which,
    )
    return fibers, which


def _lines(
    laid: Ribbons, family: Family, perimeter: float, near: float
) -> Iterator[tuple[int, int, float]]:
    """Thread, line of its ribbon and s of every line of a family along the axis."""
    for line, offset in enumerate(laid.offsets(family).tolist()):
        for thread in range(family.threads):
            s = (offset + thread * family.spacing) % perimeter
            if min(s, perimeter - s) <= family.reach + near:
                yield thread, line, s
