"""The fibers as lines, at rest or in the position of a state, with their tension.

pyvista is imported where it is used: a run without output does without it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.mesh.data import Floats, MeshData
from geometry.mesh.reference import gauss, shape_functions
from geometry.winding.segments import EmbeddedFibers

_JOINT = 1e-7
"""Distance within which segments of a curve touch, as a part of the mesh's greatest extent."""


def fiber_lines(
    mesh: MeshData,
    fibers: EmbeddedFibers,
    displacement: Floats | None = None,
    force: Floats | None = None,
    moved: bool = True,
) -> Any:
    """The fibers as a pyvista.PolyData of polylines.

    A polyline follows a curve along z and ends where the curve leaves the mesh. Point data:
    tension_N, the axial force of the line itself, the mean of both sides at a joint;
    fiber_tension_N, the same of a whole fiber, of which a ribbon's line is a part;
    displacement_mm where the lines are not moved: that of the body at the fiber's points. Cell
    data: curve, its number, and family, that of its threads.

    Args:
        mesh: the mesh.
        fibers: segments along curves, sorted by curve and z.
        displacement: by node number, (n, 3), mm; none for the undeformed position.
        force: axial force of each segment, (segments,), N.
        moved: the points lie where the displacement takes them; else they stay at rest.
    """
    import pyvista as pv

    points = rest = _segment_points(mesh, fibers, mesh.nodes)
    joint = _JOINT * np.ptp(mesh.nodes, axis=0).max()
    gap = np.linalg.norm(points[1:, 0] - points[:-1, 2], axis=1)
    fresh = np.r_[True, (fibers.curve[1:] != fibers.curve[:-1]) | (gap > joint)]
    if displacement is not None:
        points = _segment_points(mesh, fibers, mesh.nodes + displacement)
    last = np.r_[fresh[1:], True]
    # start and middle of every segment, and the end of the last one of a polyline
    kept = np.column_stack([np.ones_like(last), np.ones_like(last), last]).ravel()
    sizes = 2 * np.diff(np.r_[np.flatnonzero(fresh), len(fresh)]) + 1
    lines = np.insert(np.arange(kept.sum()), np.cumsum(sizes) - sizes, sizes)
    data = pv.PolyData((points if moved else rest).reshape(-1, 3)[kept], lines=lines)
    if displacement is not None and not moved:
        data.point_data["displacement_mm"] = (points - rest).reshape(-1, 3)[kept]
    data.cell_data["curve"] = fibers.curve[fresh]
    data.cell_data["family"] = fibers.family[fresh]
    if force is not None:
        for name, value in (("tension_N", force), ("fiber_tension_N", force / fibers.share)):
            start = np.where(fresh, value, (value + np.roll(value, 1)) / 2)
            data.point_data[name] = np.column_stack([start, value, value]).ravel()[kept]
    return data


def _segment_points(mesh: MeshData, fibers: EmbeddedFibers, nodes: Floats) -> Floats:
    """Start, middle and end of every segment, (segments, 3, 3)."""
    first = gauss(fibers.points.shape[1])[0][0]
    tangent = fibers.tangents[:, :1]
    steps = np.array([0.0, 0.5, 1.0])[:, None]
    values = shape_functions(mesh.cell_type, fibers.points[:, :1] + (steps - first) * tangent)[0]
    points: Floats = values @ nodes[mesh.cells[fibers.cell]]
    return points
