"""Fibers on the outer surface of a round tube: smeared hoops, and exact double helices."""

from __future__ import annotations

import math

import numpy as np

from geometry.mesh.data import (
    FACET_VERTICES,
    Floats,
    Ints,
    MeshData,
    reference_nodes,
    vertex_positions,
)
from geometry.mesh.reference import (
    area_vectors,
    facet_rule,
    gauss,
    jacobians,
)
from geometry.sections.blocks import Layout
from geometry.winding.segments import EmbeddedFibers
from tests.exact.solids import prism


def half_tube(
    inner: float, outer: float, length: float, divisions: tuple[int, int, int]
) -> MeshData:
    """Half a tube, y ≥ 0, of two quarters.

    Args:
        inner: inner radius in mm.
        outer: outer radius in mm.
        length: length along z in mm.
        divisions: elements along radius, a quarter of the circumference, and z.

    Returns:
        Mesh with surfaces "inner", "outer", "cut" (y = 0), "bottom", "top"; region "solid".
    """
    layout = Layout()
    rays = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0))
    for k in range(2):
        (c, s), (d, t) = rays[k], rays[k + 1]
        names: dict[int, tuple[str, ...]] = {1: ("inner",), 2: ("outer",), 3 * k: ("cut",)}
        layout.add(
            "solid",
            (
                (inner * c, inner * s),
                (outer * c, outer * s),
                (inner * d, inner * t),
                (outer * d, outer * t),
            ),
            (divisions[0], divisions[1]),
            {1: (0.0, 0.0), 2: (0.0, 0.0)},
            names,
        )
    return prism(layout, length, divisions[2])


def _frames(mesh: MeshData, surface: str) -> tuple[Floats, Floats, Floats, Floats]:
    """Base and edges of facets in their cells, and the same developed to (R φ, z)."""
    pairs = mesh.facets[surface]
    vertices = vertex_positions(mesh.cell_type)
    corners = np.array([f[:3] for f in FACET_VERTICES[mesh.cell_type]])[pairs[:, 1]]
    reference = reference_nodes(mesh.cell_type)[vertices][corners]
    x = mesh.nodes[mesh.cells[pairs[:, :1], vertices[corners]]]
    radius = np.hypot(x[..., 0], x[..., 1])
    developed = np.stack([radius * np.arctan2(np.abs(x[..., 1]), x[..., 0]), x[..., 2]], axis=-1)
    edges = reference[:, 1:] - reference[:, :1]
    axes = (developed[:, 1:] - developed[:, :1]).swapaxes(1, 2)
    return reference[:, 0], edges, developed[:, 0], axes


def _fibers(
    mesh: MeshData, pairs: Ints, points: Floats, tangents: Floats, weights: Floats, share: float
) -> EmbeddedFibers:
    cell = pairs[:, 0]
    speed = np.linalg.norm(
        np.einsum("nqij,nqj->nqi", jacobians(mesh, cell, points)[1], tangents), axis=2
    )
    number = len(cell)
    return EmbeddedFibers(
        cell=cell,
        facet=pairs[:, 1],
        points=points,
        tangents=tangents,
        axial=np.zeros(weights.shape),
        weights=weights,
        length=(speed * weights).sum(axis=1),
        share=np.full(number, share),
        curve=np.zeros(number, dtype=np.int64),
        z=np.zeros(number),
        s=np.zeros(number),
        family=np.zeros(number, dtype=np.int64),
    )


def hoops(mesh: MeshData, surface: str) -> EmbeddedFibers:
    """One mm of hoop per mm² of the surface, a piece at every quadrature point."""
    base, edges, _, axes = _frames(mesh, surface)
    flat = facet_rule(mesh.cell_type)[0]
    points = base[:, None] + flat @ edges
    around = np.linalg.inv(axes)[..., 0]
    direction = np.einsum("nj,nji->ni", around, edges)
    areas = np.linalg.norm(area_vectors(mesh, surface)[1], axis=2).ravel()
    tangents = np.repeat(direction, len(flat), axis=0)[:, None]
    points = points.reshape(-1, 1, 3)
    pairs = np.repeat(mesh.facets[surface], len(flat), axis=0)
    speed = np.einsum("nqij,nqj->nqi", jacobians(mesh, pairs[:, 0], points)[1], tangents)
    tangents *= (areas / np.linalg.norm(speed[:, 0], axis=1))[:, None, None]
    return _fibers(mesh, pairs, points, tangents, np.ones((len(pairs), 1)), 1.0)


def double_helix(
    mesh: MeshData, surface: str, pitch: float, width: float, lines: int = 5
) -> EmbeddedFibers:
    """Both helices z = ± pitch φ / 2π of a half tube, ribbons of parallel lines.

    In the developed plane every line is straight and every facet a rectangle along the axes.
    """
    base, edges, origin, axes = _frames(mesh, surface)
    far = origin + axes.sum(axis=2)
    low, high = np.minimum(origin, far), np.maximum(origin, far)
    perimeter = float(high[:, 0].max()) * 2
    tall = float(high[:, 1].max())
    offsets = (np.arange(lines) - (lines - 1) / 2) * width / lines
    rises = offsets * math.hypot(perimeter, pitch) / perimeter
    t, w = gauss(3)
    rows = []
    for hand in (1, -1):
        slope = hand * pitch / perimeter
        turns = range(-1, int(tall / pitch) + 3)
        for c in (rise + k * pitch for rise in rises for k in turns):
            at = np.sort((np.stack([low[:, 1], high[:, 1]]) - c) / slope, axis=0)
            start, end = np.maximum(low[:, 0], at[0]), np.minimum(high[:, 0], at[1])
            kept = np.flatnonzero(end - start > 1e-9)
            s = np.stack([start[kept], end[kept]], axis=1)
            ends = np.stack([s, slope * s + c], axis=-1) - origin[kept, None]
            local = np.einsum("nij,nkj->nki", np.linalg.inv(axes[kept]), ends)
            step = local[:, 1] - local[:, 0]
            inside = local[:, :1] + t[:, None] * step[:, None]
            rows.append(
                (
                    mesh.facets[surface][kept],
                    base[kept, None] + inside @ edges[kept],
                    np.repeat(step[:, None] @ edges[kept], 3, axis=1),
                )
            )
    pairs, points, tangents = (np.concatenate(column) for column in zip(*rows, strict=True))
    return _fibers(mesh, pairs, points, tangents, np.tile(w, (len(pairs), 1)), 1 / lines)
