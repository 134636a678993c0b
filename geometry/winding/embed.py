"""A discrete winding: fibers cut at the facets they lie on."""

from __future__ import annotations

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import Floats, Ints, MeshData
from geometry.mesh.reference import gauss
from geometry.winding.helix import Winding
from geometry.winding.segments import EmbeddedFibers, Facets, develop, push

_SHORTEST = 1e-9
"""Part of the perimeter under which a piece of fiber is none, and a line on a border lies on it:
gmsh's nodes lie within 3e-10 of the body's length of their places."""


def _candidates(facets: Facets, slope: float, pitch: float, rise: float) -> tuple[Ints, Floats]:
    """Facets and intercepts c of the lines z = slope s + c that may cross them."""
    corners = [facets.origin, *(facets.origin + facets.axes[..., i] for i in range(2))]
    if not facets.triangle:
        corners.append(facets.origin + facets.axes.sum(axis=2))
    intercepts = np.stack([c[:, 1] - slope * c[:, 0] for c in corners])
    margin = 1e-6
    first = np.ceil((intercepts.min(axis=0) - rise) / pitch - margin).astype(np.int64)
    last = np.floor((intercepts.max(axis=0) - rise) / pitch + margin).astype(np.int64)
    count = np.maximum(last - first + 1, 0)
    facet = np.repeat(np.arange(len(count)), count)
    turn = np.arange(len(facet)) - np.repeat(np.cumsum(count) - count, count) + first[facet]
    return facet, turn * pitch + rise


def _clip(
    facets: Facets, facet: Ints, slope: float, c: Floats, shortest: float
) -> tuple[Floats, Floats]:
    """Ends in s of the part of each line z = slope s + c in its facet; empty when reversed.

    With ξ(s) = A⁻¹ ((s, slope s + c) − X0) the facet is where g_k(s) = v_k + r_k s ≥ 0 for each
    of its sides k: g = ξ, 1 − ξ of a square, ξ, 1 − ξ1 − ξ2 of a triangle. The line is inside
    from the greatest root −v_k/r_k with r_k > 0 to the least with r_k < 0; a side with r_k = 0
    admits all of the line or nothing (Cyrus and Beck 1978, doi 10.1016/0097-8493(78)90021-3).

    Args:
        facets: the winding's facets.
        facet: their numbers, (n,).
        slope: dz/ds of the lines.
        c: z in mm at s = 0, (n,).
        shortest: distance in mm within which a line is on a border.

    Returns:
        First and last s in mm, (n,) each.
    """
    to_local = np.linalg.inv(facets.axes[facet])
    zero = np.stack([np.zeros_like(c), c], axis=1) - facets.origin[facet]
    at_zero = np.einsum("nij,nj->ni", to_local, zero)
    rate = to_local @ np.array([1.0, slope])
    if facets.triangle:
        values = np.column_stack([at_zero, 1 - at_zero.sum(axis=1)])
        rates = np.column_stack([rate, -rate.sum(axis=1)])
        inward = np.concatenate([to_local, -to_local.sum(axis=1, keepdims=True)], axis=1)
    else:
        values = np.column_stack([at_zero, 1 - at_zero])
        rates = np.column_stack([rate, -rate])
        inward = np.concatenate([to_local, -to_local], axis=1)
    size = np.abs(inward).sum(axis=2)
    along = np.abs(rates) < 1e-12 * size
    with np.errstate(divide="ignore", invalid="ignore"):
        root = -values / rates
    low = np.where(along, -np.inf, np.where(rates > 0, root, -np.inf)).max(axis=1)
    high = np.where(along, np.inf, np.where(rates > 0, np.inf, root)).min(axis=1)
    # of two facets that share a border along the line, the one on its growing-s side takes it
    on_border = np.abs(values) < shortest * size
    refused = along & np.where(on_border, inward[..., 0] < 0, values < 0)
    return low, np.where(refused.any(axis=1), -np.inf, high)


def embed(mesh: MeshData, actuator: Actuator, winding: Winding, q: int = 3) -> EmbeddedFibers:
    """Cut the fibers at the facets they lie on.

    Args:
        mesh: hexahedra or tetrahedra with the surface "winding"; half, full, or a slice.
        actuator: dimensions the mesh was built from.
        winding: pattern, pitch and ribbon.
        q: Gauss points per segment.

    Returns:
        One segment per crossing of a curve with a facet, sorted by curve and z.

    Raises:
        ValueError: a section, which has no z for a fiber to rise in.
    """
    if mesh.cell_type == "quadrilateral":
        raise ValueError("a section can have smeared windings only")
    facets = develop(mesh, actuator)
    n = winding.lines_per_fiber
    shortest = _SHORTEST * actuator.winding_perimeter
    rows = []
    for helix, hand in enumerate(winding.hands):
        slope = -hand * winding.pitch / actuator.winding_perimeter
        for line, rise in enumerate(winding.rises(actuator, helix)):
            facet, c = _candidates(facets, slope, winding.pitch, rise)
            low, high = _clip(facets, facet, slope, c, shortest)
            kept = high - low > shortest
            facet, c, low, high = facet[kept], c[kept], low[kept], high[kept]
            start, end = (low, high) if slope > 0 else (high, low)
            curve = np.full(len(facet), helix * n + line)
            rows.append((facet, curve, start, end, slope * start + c, slope * end + c))
    facet, curve, *ends = (np.concatenate(column) for column in zip(*rows, strict=True))
    order = np.lexsort((ends[2] + ends[3], curve))
    facet, curve = facet[order], curve[order]
    s0, s1, z0, z1 = (column[order] for column in ends)

    to_local = np.linalg.inv(facets.axes[facet])
    start = np.einsum("nij,nj->ni", to_local, np.stack([s0, z0], 1) - facets.origin[facet])
    step = np.einsum("nij,nj->ni", to_local, np.stack([s1 - s0, z1 - z0], 1))
    t, w = gauss(q)
    local = start[:, None] + t[:, None] * step[:, None]
    points = facets.base[facet][:, None] + local @ facets.edges[facet]
    tangents = np.repeat((step[:, None] @ facets.edges[facet]), q, axis=1)
    cell = facets.cell[facet]
    speed = np.linalg.norm(push(mesh, cell, points, tangents), axis=2)
    return EmbeddedFibers(
        cell=cell,
        facet=facets.facet[facet],
        points=points,
        tangents=tangents,
        axial=np.zeros((len(cell), q)),
        weights=np.tile(w, (len(cell), 1)),
        length=speed @ w,
        share=np.full(len(cell), 1 / n),
        curve=curve,
        z=(z0 + z1) / 2,
        s=(s0 + s1) / 2,
    )
