"""A strip of fabric along the body on the winding's surface: where it lies, and spread there."""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import Floats, Ints, MeshData
from geometry.mesh.reference import facet_rule, jacobians
from geometry.winding.outline import position
from geometry.winding.segments import EmbeddedFibers, Facets, develop

_HALVINGS = 60
_STEPS = 720
"""Points of an outline among which a ray is sought."""


@dataclasses.dataclass(frozen=True)
class Window:
    """A part of the outline, between the caps all along or from one z to another.

    Attributes:
        middle: arc length s of its middle, from the top toward +x, mm.
        width: along the outline, mm.
        ends: z at rest of its ends, mm.
    """

    middle: float
    width: float
    ends: tuple[float, float] = (-np.inf, np.inf)

    def intervals(self, perimeter: float) -> list[tuple[float, float]]:
        """The parts of 0 ≤ s ≤ S that it covers, mm."""
        low = (self.middle - self.width / 2) % perimeter
        high = low + self.width
        if high <= perimeter:
            return [(low, high)]
        return [(0.0, high - perimeter), (low, perimeter)]


def arc_at(actuator: Actuator, angle: float) -> float:
    """Arc length s where a ray from the middle of the outline's height on x = 0 meets the outline.

    Args:
        actuator: dimensions.
        angle: of the ray, rad, from the top toward +x; π is the bottom.
    """
    perimeter = actuator.winding_perimeter
    middle = (actuator.outline_top + actuator.outline_bottom) / 2
    turned = angle % (2 * np.pi)
    if turned > np.pi:
        return perimeter - arc_at(actuator, 2 * np.pi - turned)

    def ahead(s: Floats) -> Floats:
        """How far a point lies before the ray, rad."""
        x, y = position(actuator, s).T
        beyond: Floats = np.arctan2(np.maximum(x, 0.0), y - middle) - turned
        return beyond

    s = np.linspace(0.0, perimeter / 2, _STEPS + 1)
    first = int(np.argmax(ahead(s) >= 0))
    if first == 0:
        return 0.0 if turned == 0 else perimeter / 2
    low, high = s[first - 1], s[first]
    for _ in range(_HALVINGS):
        half = (low + high) / 2
        if ahead(np.array([half]))[0] < 0:
            low = half
        else:
            high = half
    return float(high)


def lay(mesh: MeshData, actuator: Actuator, window: Window) -> EmbeddedFibers:
    """Spread fabric over a window: bits of warp at points, pieces of weft along lines around.

    A facet that the window's edge crosses is integrated over the part inside, by a rule of its own:
    the area is that of the window, whatever the mesh. Warp runs along the axis, weft around; each
    is a thread for every mm across it, so that a point stands for as many mm of either as it has
    mm² of area (of a section mm² for every mm of z). Points of a facet on one line around are one
    piece of weft with one strain: with a strain each, stiff weft goes slack point by point.

    Args:
        mesh: hexahedra, tetrahedra or quadrilaterals with the surface "winding"; half, full, or a
            slice.
        actuator: dimensions the mesh was built from.
        window: where it lies.

    Returns:
        Pieces; `curve` is 0 of the warp and 1 of the weft. On triangles each point is one.
    """
    facets = develop(mesh, actuator)
    parts = [
        _cut(facets, *facet_rule(mesh.cell_type), low, high)
        for low, high in window.intervals(actuator.winding_perimeter)
    ]
    facet, flat, weight = (np.concatenate([part[i] for part in parts]) for i in range(3))
    # the second part of a window over the top has lines of its own
    starts = np.cumsum([0, *(len(part[0]) for part in parts[:-1])])
    lines = np.concatenate([part[3] + n for part, n in zip(parts, starts, strict=True)])
    edges, cell = facets.edges[facet], facets.cell[facet]
    points = (facets.base[facet] + np.einsum("nk,nkd->nd", flat, edges))[:, None]
    spans = np.einsum("nij,nkj->nki", jacobians(mesh, cell, points)[1][:, 0], edges)
    developed = facets.origin[facet] + np.einsum("nik,nk->ni", facets.axes[facet], flat)
    solid = mesh.nodes.shape[1] == 3
    across = np.cross(spans[:, 0], spans[:, 1]) if solid else spans[:, 0]
    area = weight * np.linalg.norm(across, axis=1)
    pieces = [_grouped(own) for own in lines.T]
    most = max(piece.shape[1] for piece in pieces)
    threads = []
    for number, (piece, direction) in enumerate(zip(pieces, np.eye(2)[::-1], strict=True)):
        local = np.linalg.inv(facets.axes[facet]) @ direction[: 2 if solid else 1]
        rise = 0.0 if solid else direction[1]
        speed = np.hypot(np.linalg.norm(np.einsum("nk,nki->ni", local, spans), axis=1), rise)
        # each point has its own area; of a piece with n points the parameter runs n times as fast
        scale = area / speed * piece.shape[1]
        tangents = np.einsum("nk,nkd->nd", local, edges) * scale[:, None]
        # all pieces have as many points: those with fewer have them again
        again = np.tile(piece, (1, most // piece.shape[1]))
        first = piece[:, 0]
        threads.append(
            {
                "cell": cell[first],
                "facet": facets.facet[facet[first]],
                "points": points[again, 0],
                "tangents": tangents[again],
                "axial": (rise * scale)[again],
                "weights": np.full(again.shape, 1 / most),
                "length": area[piece].sum(axis=1),
                "share": np.ones(len(piece)),
                "curve": np.full(len(piece), number),
                "z": developed[piece, 1].mean(axis=1) if solid else np.zeros(len(piece)),
                "s": developed[piece, 0].mean(axis=1),
                "family": np.full(len(piece), number),
            }
        )
    return EmbeddedFibers(
        **{name: np.concatenate([thread[name] for thread in threads]) for name in threads[0]}
    )


def _grouped(lines: Ints) -> Ints:
    """Numbers of the points of each line, (lines, points); all lines have as many."""
    order = np.argsort(lines, kind="stable")
    return order.reshape(len(np.unique(lines)), -1)


def covered(mesh: MeshData, actuator: Actuator, window: Window, level: int) -> tuple[Ints, Floats]:
    """The edges of a section within a window, or what of them lies within it.

    Args:
        mesh: quadrilaterals with the edges "winding".
        actuator: dimensions the mesh was built from.
        window: on the outline.
        level: pieces along an edge.

    Returns:
        Host cells, (k,), and points along each edge in the reference cell, (k, level + 1, 2).
    """
    facets = develop(mesh, actuator)
    line = np.linspace(0.0, 1.0, level + 1)[:, None]
    parts = [
        _cut(facets, line, np.ones(level + 1), low, high)[:2]
        for low, high in window.intervals(actuator.winding_perimeter)
    ]
    edge, flat = (np.concatenate([part[i] for part in parts]) for i in range(2))
    points = facets.base[edge] + flat * facets.edges[edge][:, 0]
    return facets.cell[edge][:: level + 1], points.reshape(-1, level + 1, 2)


def _cut(
    facets: Facets, flat: Floats, weights: Floats, low: float, high: float
) -> tuple[Ints, Floats, Floats, Ints]:
    """Quadrature of the parts of all facets with low ≤ s ≤ high.

    Args:
        facets: developed.
        flat: points of the rule of a whole facet, (q, k).
        weights: of the rule, (q,).
        low: mm.
        high: mm.

    Returns:
        For each of n points its facet, its coordinates in the reference facet, (n, k), its weight,
        and the numbers of the pieces of warp and of weft that it belongs to, (n, 2).
    """
    along = facets.axes[:, 0, :]
    if facets.triangle:
        return _cut_triangles(facets, flat, weights, low, high)
    axis = np.abs(along).argmax(axis=1)
    row = np.arange(len(axis))
    ends = (np.array([low, high]) - facets.origin[:, :1]) / along[row, axis][:, None]
    ends = np.clip(np.sort(ends, axis=1), 0.0, 1.0)
    share = ends[:, 1] - ends[:, 0]
    here = np.flatnonzero(share > 0)
    points = np.tile(flat, (len(here), 1, 1))
    which = axis[here]
    own = flat[:, which].T
    points[np.arange(len(here))[:, None], np.arange(len(flat)), which[:, None]] = (
        ends[here, :1] + share[here, None] * own
    )
    weight = share[here, None] * weights
    lines = _lines(flat, which)
    return np.repeat(here, len(flat)), points.reshape(-1, flat.shape[1]), weight.ravel(), lines


def _lines(flat: Floats, axis: Ints) -> Ints:
    """Numbers of the pieces of warp and of weft that the points of facets belong to, (n q, 2).

    Args:
        flat: points of a rule that is a product of rules along the axes, (q, k).
        axis: of each of n facets that which runs around.
    """
    levels = np.column_stack([np.unique(c, return_inverse=True)[1] for c in flat.T])
    every = np.arange(len(flat) * len(axis)).reshape(len(axis), len(flat))
    around = levels[:, 1 - axis].T if flat.shape[1] == 2 else np.zeros_like(every)
    # a mean along z would take end effects of fabric over whole elements
    return np.stack([every, every[:, :1] + around], axis=-1).reshape(-1, 2)


def _cut_triangles(
    facets: Facets, flat: Floats, weights: Floats, low: float, high: float
) -> tuple[Ints, Floats, Floats, Ints]:
    """`_cut` of triangles: a part is a polygon, and a fan of triangles."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    s = facets.origin[:, :1] + facets.axes[:, 0, :] @ corners.T
    facet, points, weight = [], [], []
    for i in np.flatnonzero((s.max(axis=1) > low) & (s.min(axis=1) < high)):
        polygon = np.column_stack([corners, s[i]])
        polygon = _clip(_clip(polygon, low, 1.0), high, -1.0)
        for second, third in zip(polygon[1:-1, :2], polygon[2:, :2], strict=True):
            spans = np.array([second, third]) - polygon[0, :2]
            size = abs(float(np.linalg.det(spans)))
            facet.append(np.full(len(flat), i))
            points.append(polygon[0, :2] + flat @ spans)
            weight.append(size * weights)
    if not facet:
        none = np.zeros(0, dtype=np.int64)
        return none, np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2), dtype=np.int64)
    found = np.concatenate(facet)
    alone = np.repeat(np.arange(len(found))[:, None], 2, axis=1)
    return found, np.concatenate(points), np.concatenate(weight), alone


def _clip(polygon: Floats, edge: float, side: float) -> Floats:
    """The part of a polygon of points (ξ, η, s) with side (s − edge) ≥ 0."""
    kept = []
    for here, after in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        a, b = side * (here[2] - edge), side * (after[2] - edge)
        if a >= 0:
            kept.append(here)
        if a * b < 0:
            kept.append(here + a / (a - b) * (after - here))
    return np.array(kept).reshape(-1, 3)
