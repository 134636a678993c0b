"""A winding smeared over its surface."""

from __future__ import annotations

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import MeshData
from geometry.mesh.reference import area_vectors, facet_rule
from geometry.winding.helix import Winding
from geometry.winding.outline import curvature
from geometry.winding.segments import SmearedFibers, develop, push


def smear(mesh: MeshData, actuator: Actuator, winding: Winding) -> SmearedFibers:
    """Spread the winding over its surface: at each quadrature point a bit of every helix.

    A point stands for weight × area × √(S² + pitch²)/(S pitch) of fiber per helix, along the
    helix's direction; the area is the mesh's own. On a section, which stands for 1 mm of z, the
    area is the length of the edge and the direction has its z part in `axial`.

    On a cylinder a helix is a geodesic: its curvature is all normal to the surface, and that of
    the outline times sin² of its angle to the axis, S²/(S² + pitch²) (Euler's theorem).

    Args:
        mesh: hexahedra, tetrahedra or quadrilaterals with the surface "winding"; half, full, or a
            slice.
        actuator: dimensions the mesh was built from.
        winding: pattern and pitch; the ribbon's width does not matter.

    Returns:
        Segments with one point each.
    """
    facets = develop(mesh, actuator)
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
        speed = np.hypot(np.linalg.norm(push(mesh, cell, points, tangents), axis=2), rise)
        scale = length[:, None] / speed
        parts.append(tangents * scale[..., None])
        axial.append(rise * scale)
    helices, n = len(winding.hands), len(cell)
    z = developed[:, 1] if d == 3 else np.zeros(n)
    bent = curvature(actuator, developed[:, 0])
    bent *= (actuator.winding_perimeter / winding.turn_length(actuator)) ** 2
    return SmearedFibers(
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
        curvature=np.tile(bent, helices),
        density=np.full(helices * n, helices * winding.density(actuator)),
    )
