"""The winding on a mesh: discrete segments in host cells, or smeared over the winding's surface."""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.actuator import Actuator
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
from geometry.winding.helix import Winding
from geometry.winding.outline import arc_length

_SHORTEST = 1e-9


@dataclasses.dataclass(frozen=True)
class EmbeddedFibers:
    """Fiber segments, each within one cell; n segments with q points each.

    With J the Jacobian of the cell's geometry, length = Σ_q weights |J tangents|. A section has no
    z of its own: there d = 2 and length = Σ_q weights √(|J tangents|² + axial²), in mm per mm of z.

    Attributes:
        cell: host cell, (n,).
        facet: local facet of the host cell, (n,).
        points: reference coordinates in the host cell, (n, q, d).
        tangents: derivative of the reference coordinates along the segment, parameter in [0, 1],
            (n, q, d).
        axial: derivative of z along the segment in mm where the mesh has no z, else 0, (n, q).
        weights: weights of the points, (n, q); they sum to 1.
        length: length in mm in the mesh's own geometry, (n,); see above for a section.
        share: fraction of the fiber's stiffness, (n,).
        curve: number of the curve (of the helix, when smeared), (n,).
        z: z in mm of the segment's middle, (n,); 0 on a section.
        s: arc length in mm on the outline of the segment's middle, (n,).
    """

    cell: Ints
    facet: Ints
    points: Floats
    tangents: Floats
    axial: Floats
    weights: Floats
    length: Floats
    share: Floats
    curve: Ints
    z: Floats
    s: Floats


@dataclasses.dataclass(frozen=True)
class _Facets:
    """The winding's facets as affine images of their reference interval, square or triangle.

    Attributes:
        cell: host cells, (k,).
        facet: their local facets, (k,).
        origin: developed coordinates (s, z), of a section (s), of the facet's first vertex,
            (k, d - 1).
        axes: developed edge vectors as columns, (k, d - 1, d - 1).
        base: first vertex in the cell's reference coordinates, (k, d).
        edges: reference edge vectors, (k, d - 1, d).
        triangle: True for triangles.
    """

    cell: Ints
    facet: Ints
    origin: Floats
    axes: Floats
    base: Floats
    edges: Floats
    triangle: bool


def _develop(mesh: MeshData, actuator: Actuator) -> _Facets:
    pairs = mesh.facets["winding"]
    d = mesh.nodes.shape[1]
    corners = np.array(FACET_VERTICES[mesh.cell_type])[pairs[:, 1]][:, :d]
    vertices = vertex_positions(mesh.cell_type)
    nodes = mesh.nodes[mesh.cells[pairs[:, :1], vertices[corners]]]
    negative = nodes[..., 0].sum(axis=1) < 0
    s = arc_length(actuator, nodes[..., :2], np.repeat(negative[:, None], d, axis=1))
    developed = np.concatenate([s[..., None], nodes[..., 2:]], axis=-1)
    reference = reference_nodes(mesh.cell_type)[vertices][corners]
    return _Facets(
        cell=pairs[:, 0],
        facet=pairs[:, 1],
        origin=developed[:, 0],
        axes=(developed[:, 1:] - developed[:, :1]).swapaxes(1, 2),
        base=reference[:, 0],
        edges=reference[:, 1:] - reference[:, :1],
        triangle=mesh.cell_type == "tetrahedron",
    )


def _candidates(facets: _Facets, slope: float, pitch: float, rise: float) -> tuple[Ints, Floats]:
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


def _clip(facets: _Facets, facet: Ints, slope: float, c: Floats) -> tuple[Floats, Floats]:
    """Ends in s of the part of each line z = slope s + c in its facet; empty when reversed."""
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
    on_border = np.abs(values) < _SHORTEST * size
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
        raise ValueError("a section holds smeared windings only")
    facets = _develop(mesh, actuator)
    n = winding.lines_per_fiber
    rows = []
    for helix, hand in enumerate(winding.hands):
        slope = -hand * winding.pitch / actuator.winding_perimeter
        for line, rise in enumerate(winding.rises(actuator)):
            facet, c = _candidates(facets, slope, winding.pitch, rise)
            low, high = _clip(facets, facet, slope, c)
            kept = high - low > _SHORTEST
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
    speed = np.linalg.norm(_push(mesh, cell, points, tangents), axis=2)
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


def _push(mesh: MeshData, cell: Ints, points: Floats, tangents: Floats) -> Floats:
    return np.einsum("nqij,nqj->nqi", jacobians(mesh, cell, points)[1], tangents)


def smear(mesh: MeshData, actuator: Actuator, winding: Winding) -> EmbeddedFibers:
    """Spread the winding over its surface: at each quadrature point a bit of every helix.

    A point stands for weight × area × √(S² + pitch²)/(S pitch) of fiber per helix, along the
    helix's direction; the area is the mesh's own. On a section, which stands for 1 mm of z, the
    area is the length of the edge and the direction has its z part in `axial`.

    Args:
        mesh: hexahedra, tetrahedra or quadrilaterals with the surface "winding"; half, full, or a
            slice.
        actuator: dimensions the mesh was built from.
        winding: pattern and pitch; the ribbon's width does not matter.

    Returns:
        Segments with one point each.
    """
    facets = _develop(mesh, actuator)
    flat = facet_rule(mesh.cell_type)[0]
    areas = np.linalg.norm(area_vectors(mesh, "winding")[1], axis=2)
    facet = np.repeat(np.arange(len(facets.cell)), len(flat))
    cell = facets.cell[facet]
    d = mesh.nodes.shape[1]
    points = (facets.base[:, None] + flat @ facets.edges).reshape(-1, 1, d)
    developed = (facets.origin[:, None] + flat @ facets.axes.swapaxes(1, 2)).reshape(-1, d - 1)
    rise = winding.pitch if d == 2 else 0.0
    length = winding.density(actuator) * areas.ravel()
    parts, axial = [], []
    for hand in winding.hands:
        direction = np.array([-hand * actuator.winding_perimeter, winding.pitch])[: d - 1]
        tangents = (np.linalg.inv(facets.axes) @ direction)[facet][:, None] @ facets.edges[facet]
        speed = np.hypot(np.linalg.norm(_push(mesh, cell, points, tangents), axis=2), rise)
        scale = length[:, None] / speed
        parts.append(tangents * scale[..., None])
        axial.append(rise * scale)
    helices, n = len(winding.hands), len(cell)
    z = developed[:, 1] if d == 3 else np.zeros(n)
    return EmbeddedFibers(
        cell=np.tile(cell, helices),
        facet=np.tile(facets.facet[facet], helices),
        points=np.tile(points, (helices, 1, 1)),
        tangents=np.concatenate(parts),
        axial=np.concatenate(axial),
        weights=np.ones((helices * n, 1)),
        length=np.tile(length, helices),
        share=np.ones(helices * n),
        curve=np.repeat(np.arange(helices), n),
        z=np.tile(z, helices),
        s=np.tile(developed[:, 0], helices),
    )
