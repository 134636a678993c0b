"""The actuator as arrays that every program can read, and how far its end has turned.

Needs numpy alone: some of the programs live in environments of their own.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
_SIDES = np.array([(0, -1), (1, 0), (0, 1), (-1, 0)])
_SERENDIPITY = 8
"""Nodes of a quadratic quadrilateral without one in its middle."""


@dataclasses.dataclass(frozen=True)
class Body:
    """Half of the actuator, x ≥ 0: nodes and elements in VTK's order, mm and N.

    Attributes:
        points: of the nodes, (n, 3).
        cells: 27-node hexahedra, (m, 27).
        region: number of the rubber of each, (m,): 0 wall, 1 floor, 2 sheath.
        chamber: its walls, (f, 9), counter-clockwise seen from the chamber.
        root: the ring of rubber at z = 0, (f, 9).
        tip: that at z = L, (f, 9).
        clamp: nodes that are held.
        symmetry: nodes that stay in the plane x = 0.
        hoops: nodes of straight pieces of hoop along all nodes of the winding's surface, (k, 2).
        hoop_stiffness: EA of each, N, (k,).
        plain_hoops: the same along the nodes that a 20-node hexahedron has.
        plain_stiffness: of them.
    """

    points: Floats
    cells: Ints
    region: Ints
    chamber: Ints
    root: Ints
    tip: Ints
    clamp: Ints
    symmetry: Ints
    hoops: Ints
    hoop_stiffness: Floats
    plain_hoops: Ints
    plain_stiffness: Floats

    def save(self, path: Path) -> None:
        """Write a file that `load_body` reads."""
        fields = dataclasses.fields(self)
        np.savez_compressed(path, **{field.name: getattr(self, field.name) for field in fields})


def load_body(path: Path) -> Body:
    """A body that was saved."""
    with np.load(path) as data:
        return Body(**{field.name: data[field.name] for field in dataclasses.fields(Body)})


def facet_functions(nodes: int, at: Floats) -> tuple[Floats, Floats]:
    """Shape functions of a quadrilateral of 8 or 9 nodes in VTK's order, and their slopes.

    Args:
        nodes: 8 or 9.
        at: points in [−1, 1]², (q, 2).

    Returns:
        Values (q, nodes) and slopes (q, nodes, 2).
    """
    places = np.vstack([_CORNERS, _SIDES, [(0, 0)]])

    def line(x: Floats, place: int) -> tuple[Floats, Floats]:
        if place == 0:
            return 1 - x**2, -2 * x
        return x * (x + place) / 2, x + place / 2

    values, slopes = np.empty((len(at), 9)), np.empty((len(at), 9, 2))
    for number, (first, second) in enumerate(places):
        (f, df), (g, dg) = line(at[:, 0], first), line(at[:, 1], second)
        values[:, number], slopes[:, number] = f * g, np.column_stack([df * g, f * dg])
    if nodes == _SERENDIPITY:
        # its middle lies where the eight others put it
        share = np.array([-0.25] * 4 + [0.5] * 4)
        values = values[:, :8] + values[:, 8:] * share
        slopes = slopes[:, :8] + slopes[:, 8:] * share[:, None]
    return values, slopes


def section_turn(points: Floats, moved: Floats, facets: Ints) -> float:
    """Angle by which a plane section of half a body has turned toward −y, rad in (−π, π].

    The moved positions are fitted, by least squares over the section's area, with sections that
    deform evenly, x ≈ c + (X − X̄) a_x + (Y − Ȳ) a_y; the mirror image across x = 0 counts too.

    Args:
        points: of all nodes at rest, (n, 3).
        moved: of all nodes, (n, 3).
        facets: of the section, (f, 8 or 9).
    """
    one, weight = np.polynomial.legendre.leggauss(3)
    at = np.column_stack([np.repeat(one, 3), np.tile(one, 3)])
    values, slopes = facet_functions(facets.shape[1], at)
    sides = np.einsum("qna,fni->fqai", slopes, points[facets])
    area = np.linalg.norm(np.cross(sides[:, :, 0], sides[:, :, 1]), axis=2)
    area *= np.outer(weight, weight).ravel()
    rest, now = values @ points[facets], values @ moved[facets]
    y = rest[..., 1] - (area * rest[..., 1]).sum() / area.sum()
    a_y = np.einsum("fq,fqi->i", area * y, now) / (area * y**2).sum()
    return float(np.arctan2(a_y[2], a_y[1]))


def bending_angles(points: Floats, states: list[Floats], root: Ints, tip: Ints) -> Floats:
    """Angle of the section z = L against z = 0 in every state, rad, positive toward −y.

    Args:
        points: of the nodes at rest, (n, 3).
        states: moved nodes, each less than half a turn from the one before it.
        root: facets at z = 0.
        tip: facets at z = L.
    """
    turns = [section_turn(points, x, tip) - section_turn(points, x, root) for x in states]
    return np.unwrap(np.array([0.0, *turns]))[1:]
