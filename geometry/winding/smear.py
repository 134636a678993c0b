"""A winding smeared over its surface."""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import MeshData
from geometry.mesh.reference import area_vectors, facet_rule
from geometry.winding.outline import curvature
from geometry.winding.ribbons import Wound
from geometry.winding.segments import SmearedFibers, develop, push

_FIELDS = dataclasses.fields(SmearedFibers)


def smear(mesh: MeshData, actuator: Actuator, winding: Wound) -> SmearedFibers:
    """Spread the winding over its surface: at each quadrature point a bit of every family.

    A point stands for weight × area / spacing of fiber of each family, along the family's
    direction; the area is the mesh's own. On a section, which stands for 1 mm of z, the area is
    the length of the edge and the direction has its z part in `axial`.

    On a cylinder a helix is a geodesic: its curvature is all normal to the surface, and that of
    the outline times sin² of its angle to the axis (Euler's theorem).

    Args:
        mesh: hexahedra, tetrahedra or quadrilaterals with the surface "winding"; half, full, or a
            slice.
        actuator: dimensions the mesh was built from.
        winding: families of threads; the ribbons' width does not matter.

    Returns:
        Segments with one point each; `curve` is the number of the family.

    Raises:
        ValueError: threads that stay at a place of their own, which `embed` takes.
    """
    families = winding.ribbons(actuator).families
    if any(family.place for family in families):
        raise ValueError("a thread at a place of its own is not smeared")
    facets = develop(mesh, actuator)
    flat = facet_rule(mesh.cell_type)[0]
    areas = np.linalg.norm(area_vectors(mesh, "winding")[1], axis=2)
    facet = np.repeat(np.arange(len(facets.cell)), len(flat))
    cell = facets.cell[facet]
    d = mesh.nodes.shape[1]
    points = (facets.base[:, None] + flat @ facets.edges).reshape(-1, 1, d)
    developed = (facets.origin[:, None] + flat @ facets.axes.swapaxes(1, 2)).reshape(-1, d - 1)
    s, z = developed[:, 0], developed[:, 1] if d == 3 else np.zeros(len(cell))
    beside = np.minimum(s, actuator.winding_perimeter - s)
    bent, density = curvature(actuator, s), np.zeros(len(cell))
    for family in families:
        density += np.where(beside <= family.reach, family.density, 0.0)
    parts = []
    for number, family in enumerate(families):
        here = np.flatnonzero(beside <= family.reach)
        rise = family.cosine if d == 2 else 0.0
        direction = np.array(family.tangent)[: d - 1]
        local = np.linalg.inv(facets.axes) @ direction
        tangents = local[facet][:, None] @ facets.edges[facet]
        speed = np.hypot(np.linalg.norm(push(mesh, cell, points, tangents), axis=2), rise)
        length = family.density * areas.ravel()
        scale = length[:, None] / speed
        part = SmearedFibers(
            cell=cell,
            facet=facets.facet[facet],
            points=points,
            tangents=tangents * scale[..., None],
            axial=rise * scale,
            weights=np.ones((len(cell), 1)),
            length=length,
            share=np.ones(len(cell)),
            curve=np.full(len(cell), number),
            z=z,
            s=s,
            family=np.full(len(cell), number),
            curvature=bent * family.sine**2,
            density=density,
        )
        parts.append({field.name: getattr(part, field.name)[here] for field in _FIELDS})
    return SmearedFibers(
        **{field.name: np.concatenate([part[field.name] for part in parts]) for field in _FIELDS}
    )
