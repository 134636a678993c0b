"""A discrete winding: fibers cut at the facets they lie on."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import numpy.typing as npt

from geometry.actuator import Actuator
from geometry.mesh.data import Floats, Ints, MeshData
from geometry.mesh.reference import gauss
from geometry.winding.families import Family
from geometry.winding.places import through_section
from geometry.winding.ribbons import Wound
from geometry.winding.segments import EmbeddedFibers, Facets, develop, push

_SHORTEST = 1e-9
"""Part of the perimeter under which a piece of fiber is none, and a line on a border lies on it:
gmsh's nodes lie within 3e-10 of the body's length of their places."""


@dataclasses.dataclass(frozen=True)
class _Surface:
    """The winding's surface.

    Attributes:
        facets: unrolled.
        ends: least and greatest z, mm; of a section 0 and 1, the length that it stands for.
        perimeter: S, mm.
        half: x ≥ 0 only.
        shortest: distance in mm within which a line is on a border.
    """

    facets: Facets
    ends: tuple[float, float]
    perimeter: float
    half: bool
    shortest: float

    def on_end(self, family: Family, c: Floats) -> npt.NDArray[np.bool_]:
        """Which lines n · X = c lie on an outer border, beyond which the other half of them is."""
        borders = () if family.hand else self.ends if family.angle else ()
        if not family.angle and self.half:
            borders = (0.0, self.perimeter / 2)
        found = np.zeros(len(c), dtype=bool)
        for border in borders:
            found |= np.abs(c - border) < self.shortest
        return found


def _corners(facets: Facets) -> list[Floats]:
    """Developed coordinates of all vertices of the facets."""
    corners = [facets.origin, *(facets.origin + facets.axes[..., i] for i in range(2))]
    if not facets.triangle:
        corners.append(facets.origin + facets.axes.sum(axis=2))
    return corners


def _candidates(facets: Facets, family: Family, offset: float) -> tuple[Ints, Ints]:
    """Facets and numbers k of the lines n · X = offset + k spacing that may cross them."""
    across = np.stack([corner @ np.array(family.normal) for corner in _corners(facets)])
    margin = 1e-6
    first = np.ceil((across.min(axis=0) - offset) / family.spacing - margin).astype(np.int64)
    last = np.floor((across.max(axis=0) - offset) / family.spacing + margin).astype(np.int64)
    count = np.maximum(last - first + 1, 0)
    facet = np.repeat(np.arange(len(count)), count)
    number = np.arange(len(facet)) - np.repeat(np.cumsum(count) - count, count) + first[facet]
    return facet, number


def _clip(surface: _Surface, facet: Ints, family: Family, c: Floats) -> tuple[Floats, Floats]:
    """Ends in τ of the part of each line X = c n + τ t in its facet; empty when reversed.

    With ξ(τ) = A⁻¹ (c n + τ t − X0) the facet is where g_k(τ) = v_k + r_k τ ≥ 0 for each
    of its sides k: g = ξ, 1 − ξ of a square, ξ, 1 − ξ1 − ξ2 of a triangle. The line is inside
    from the greatest root −v_k/r_k with r_k > 0 to the least with r_k < 0; a side with r_k = 0
    admits all of the line or nothing (Cyrus and Beck 1978, doi 10.1016/0097-8493(78)90021-3).

    Args:
        surface: the winding's surface.
        facet: numbers of facets, (n,).
        family: the direction of the lines.
        c: n · X of each, mm, (n,).

    Returns:
        First and last τ in mm, (n,) each.
    """
    facets, shortest = surface.facets, surface.shortest
    normal, tangent = np.array(family.normal), np.array(family.tangent)
    to_local = np.linalg.inv(facets.axes[facet])
    zero = c[:, None] * normal - facets.origin[facet]
    at_zero = np.einsum("nij,nj->ni", to_local, zero)
    rate = to_local @ tangent
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
    # of two facets that share a border along the line, the one on its growing-s side takes it, of
    # a hoop that on its growing-z side; on an outer border there is only one
    beyond = inward @ (normal if normal[0] >= 0 else -normal) < 0
    on_border = np.abs(values) < shortest * size
    outer = surface.on_end(family, c)[:, None]
    refused = along & np.where(on_border, beyond & ~outer, values < 0)
    high = np.where(refused.any(axis=1), -np.inf, high)
    return _within(surface, facet, family, c, low, high)


def _within(
    surface: _Surface, facet: Ints, family: Family, c: Floats, low: Floats, high: Floats
) -> tuple[Floats, Floats]:
    """Ends in τ of the part of a piece that lies where |s| ≤ reach."""
    middle, reach = surface.perimeter / 2, family.reach
    if reach >= middle:
        return low, high
    beside = surface.facets.origin[facet, 0] + surface.facets.axes[facet, 0].mean(axis=1) > middle
    start = np.where(beside, surface.perimeter - reach, 0.0)
    end = np.where(beside, surface.perimeter, reach)
    across = family.tangent[0]
    if not across:
        s = c * family.normal[0]
        out = (s < start - surface.shortest) | (s > end + surface.shortest)
        return low, np.where(out, -np.inf, high)
    ends = np.stack([(limit - c * family.normal[0]) / across for limit in (start, end)])
    return np.maximum(low, ends.min(axis=0)), np.minimum(high, ends.max(axis=0))


def _first(family: Family, offsets: Floats, low: float) -> int:
    """Number k of the first hoop of which a line lies above an end of the surface."""
    return math.ceil((low - float(offsets.max())) / family.spacing - _SHORTEST)


def embed(mesh: MeshData, actuator: Actuator, winding: Wound, q: int = 3) -> EmbeddedFibers:
    """Cut the fibers at the facets they lie on; see `embed_families`."""
    return embed_families(mesh, actuator, winding, q)[0]


def embed_families(
    mesh: MeshData, actuator: Actuator, winding: Wound, q: int = 3
) -> tuple[EmbeddedFibers, Ints]:
    """Cut the fibers at the facets they lie on.

    Args:
        mesh: hexahedra or tetrahedra with the surface "winding"; half, full, or a slice; of a
            section threads along the axis only.
        actuator: dimensions the mesh was built from.
        winding: the threads.
        q: Gauss points per segment.

    Returns:
        One segment per crossing of a curve with a facet, sorted by curve, z and s, and the family
        of each.

    Raises:
        ValueError: threads that rise in a section, which has no z.
    """
    laid = winding.ribbons(actuator)
    if mesh.cell_type == "quadrilateral":
        return through_section(mesh, actuator, laid, _SHORTEST)
    facets = develop(mesh, actuator)
    z = np.stack([corner[:, 1] for corner in _corners(facets)])
    shortest = _SHORTEST * actuator.winding_perimeter
    ends = (float(z.min()), float(z.max())) if z.size else (0.0, 0.0)
    surface = _Surface(facets, ends, actuator.winding_perimeter, mesh.half, shortest)
    n = laid.lines_per_fiber
    rows, base = [], 0
    for number, family in enumerate(laid.families):
        normal, tangent = np.array(family.normal), np.array(family.tangent)
        offsets, beyond = laid.offsets(family), family.threads
        first = _first(family, offsets, ends[0])
        for line, offset in enumerate(offsets):
            facet, k = _candidates(facets, family, offset)
            c = offset + k * family.spacing
            low, high = _clip(surface, facet, family, c)
            kept = high - low > shortest
            facet, k = facet[kept], k[kept]
            c, low, high = c[kept], low[kept], high[kept]
            thread = np.mod(k, family.threads) if family.threads else k - first
            beyond = max(beyond, int(thread.max(initial=-1)) + 1)
            middle = c[:, None] * normal
            part = np.where(surface.on_end(family, c), 0.5, 1.0)
            which = np.full(len(facet), number)
            start, end = middle + low[:, None] * tangent, middle + high[:, None] * tangent
            rows.append((facet, base + thread * n + line, which, part, start, end))
        base += beyond * n
    facet, curve, which, part, start, end = (np.concatenate(c) for c in zip(*rows, strict=True))
    middles = (start + end) / 2
    order = np.lexsort((middles[:, 0], middles[:, 1], curve))
    facet, curve, which, part, start, end, middles = (
        column[order] for column in (facet, curve, which, part, start, end, middles)
    )
    to_local = np.linalg.inv(facets.axes[facet])
    begin = np.einsum("nij,nj->ni", to_local, start - facets.origin[facet])
    step = np.einsum("nij,nj->ni", to_local, end - start)
    t, w = gauss(q)
    local = begin[:, None] + t[:, None] * step[:, None]
    points = facets.base[facet][:, None] + local @ facets.edges[facet]
    tangents = np.repeat((step[:, None] @ facets.edges[facet]), q, axis=1)
    cell = facets.cell[facet]
    speed = np.linalg.norm(push(mesh, cell, points, tangents), axis=2)
    fibers = EmbeddedFibers(
        cell=cell,
        facet=facets.facet[facet],
        points=points,
        tangents=tangents,
        axial=np.zeros((len(cell), q)),
        weights=np.tile(w, (len(cell), 1)),
        length=part * (speed @ w),
        share=np.full(len(cell), 1 / n),
        curve=curve,
        z=middles[:, 1],
        s=middles[:, 0],
        family=which,
    )
    return fibers, which
