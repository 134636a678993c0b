"""Measures of a mesh against the closed forms of the actuator it stands for."""

from __future__ import annotations

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import Floats, Ints, MeshData
from geometry.mesh.errors import MeshError
from geometry.mesh.reference import area_vectors, cell_rule, determinants, gauss, shape_functions
from geometry.winding.embed import embed, embed_families
from geometry.winding.outline import arc_length
from geometry.winding.ribbons import Wound
from geometry.winding.segments import EmbeddedFibers
from geometry.winding.symmetry import mirrored

_JOINT = 1e-7
"""Distance within which pieces of a thread touch, as a part of the mesh's greatest extent."""


def region_volumes(mesh: MeshData) -> dict[str, float]:
    """Volume of each region by quadrature in mm³ (area in mm² of a section)."""
    return _volumes(mesh, determinants(mesh))


def _volumes(mesh: MeshData, jacobian: Floats) -> dict[str, float]:
    weights = cell_rule(mesh.cell_type)[1]
    volumes = jacobian[:, : len(weights)] @ weights
    return {
        name: float(volumes[mesh.cell_region == number].sum())
        for name, number in mesh.regions.items()
    }


def surface_area(mesh: MeshData, name: str) -> float:
    """Area of a named surface in mm² (length in mm of a section's edges)."""
    return float(np.linalg.norm(area_vectors(mesh, name)[1], axis=2).sum())


def chamber_volume(mesh: MeshData) -> float:
    """Volume in mm³ that the surface "chamber" encloses, −∮ x·n dA / d; half of it for a half.

    Of a section the area in mm².
    """
    x, normal = area_vectors(mesh, "chamber")
    return float(-(x * normal).sum() / x.shape[-1])


def chamber_gap(mesh: MeshData) -> float:
    """How far the surface "chamber" is from closed: |∮ n dA| / ∮ dA, without x for a half."""
    normal = area_vectors(mesh, "chamber")[1]
    total = normal.sum(axis=(0, 1))[1 if mesh.half else 0 :]
    return float(np.linalg.norm(total) / np.linalg.norm(normal, axis=2).sum())


def geometry_error(mesh: MeshData) -> float:
    """Relative error to allow for the order-2 interpolation of the arcs.

    An arc of half angle β encloses too little area by β⁴/30 and is too short by β⁴/90 (leading
    terms); three times the former is allowed, with the most curved facet of the winding for β,
    twice the ratio of its rise to its half chord.
    """
    nodes = mesh.nodes[mesh.facet_nodes("winding")][..., :2]
    nodes = nodes - nodes.mean(axis=1, keepdims=True)
    axes = np.linalg.eigh(nodes.swapaxes(1, 2) @ nodes)[1]
    rise, chord = np.moveaxis(np.ptp(nodes @ axes, axis=1), -1, 0)
    return float(3 * (4 * rise / chord).max() ** 4 / 30 + 1e-9)


def loose_ends(mesh: MeshData, fibers: EmbeddedFibers) -> tuple[Floats, Ints]:
    """Where a thread begins or ends: at no corner and at no seam of the outline, if it closes.

    Args:
        mesh: hexahedra or tetrahedra.
        fibers: pieces of threads, sorted by curve and along it.

    Returns:
        Points (n, 3) in mm, and the numbers (n,) of the pieces that end there.
    """
    first = gauss(fibers.points.shape[1])[0][0]
    steps = np.array([0.0, 1.0])[:, None] - first
    local = fibers.points[:, :1] + steps * fibers.tangents[:, :1]
    values = shape_functions(mesh.cell_type, local)[0]
    ends = values @ mesh.nodes[mesh.cells[fibers.cell]]
    joint = _JOINT * np.ptp(mesh.nodes, axis=0).max()
    loose = np.ones((len(ends), 2), dtype=bool)
    for curve in np.unique(fibers.curve):
        own = np.flatnonzero(fibers.curve == curve)
        before = np.roll(own, 1)
        # each piece goes on where the one before ended, of a hoop the first one after the last
        gap = np.linalg.norm(ends[own, 0] - ends[before, 1], axis=1)
        loose[own, 0] = loose[before, 1] = gap > joint
    piece, side = np.nonzero(loose)
    return ends[piece, side], piece


def open_threads(mesh: MeshData, actuator: Actuator, winding: Wound) -> Floats:
    """Points at which threads end though nothing ends them, (n, 3), mm.

    What ends them are both ends of the chamber, the mirror plane of a half, and the end of what is
    wound around.

    Args:
        mesh: hexahedra or tetrahedra of a body, half or full.
        actuator: dimensions it was built from.
        winding: the threads.
    """
    fibers, which = embed_families(mesh, actuator, winding)
    points, piece = loose_ends(mesh, fibers)
    reach = np.array([family.reach for family in winding.ribbons(actuator).families])
    s = arc_length(actuator, points[:, :2], points[:, 0] < 0)
    aside = np.minimum(s, actuator.winding_perimeter - s)
    # arcs of order 2 lie off their circle
    near = 1e-3 * actuator.winding_perimeter
    ended = np.minimum(np.abs(points[:, 2]), np.abs(points[:, 2] - actuator.length)) < 1e-6
    ended |= np.abs(aside - reach[which[piece]]) < near
    if mesh.half:
        ended |= np.abs(points[:, 0]) < 1e-6 * actuator.outline_half_width
    return points[~ended]


def check(
    mesh: MeshData, actuator: Actuator, winding: Wound | None = None
) -> dict[str, dict[str, float]]:
    """Compare the mesh of a whole body with the closed forms.

    Args:
        mesh: hexahedra or tetrahedra of the body, half or full.
        actuator: dimensions it was built from.
        winding: also compare the fibers' length.

    Returns:
        For each quantity "measured", "expected" and "error" (relative): the volume of each region
        in mm³ ("volume wall", …), "chamber volume" in mm³, "winding area" in mm², with a winding
        "winding length" in mm; "chamber gap" and "least Jacobian" (mm³) have "measured" only.

    Raises:
        MeshError: a Jacobian that is not positive, an open chamber, or a quantity off by more than
            the order-2 geometry explains; all violations in one message.
    """
    part = 0.5 if mesh.half else 1.0
    jacobian = determinants(mesh)
    volumes = _volumes(mesh, jacobian)
    pairs = {
        f"volume {name}": (volumes.get(name, 0.0), part * volume)
        for name, volume in actuator.region_volumes().items()
    }
    pairs["chamber volume"] = (chamber_volume(mesh), part * actuator.chamber_volume)
    area = part * actuator.winding_perimeter * actuator.length
    pairs["winding area"] = (surface_area(mesh, "winding"), area)
    if winding is not None:
        fibers, laid = embed(mesh, actuator, winding), winding.ribbons(actuator)
        expected = float(laid.lengths(actuator).sum())
        if not mesh.half or mirrored(laid.families):
            pairs["winding length"] = (float(fibers.length @ fibers.share), part * expected)

    report = {
        name: {"measured": got, "expected": want, "error": got / want - 1}
        for name, (got, want) in pairs.items()
    }
    tolerance = geometry_error(mesh)
    wrong = [
        f"{name} {row['measured']:.6g}: expected {row['expected']:.6g}"
        for name, row in report.items()
        if not abs(row["error"]) <= tolerance
    ]
    gap, least = chamber_gap(mesh), float(jacobian.min())
    report["chamber gap"] = {"measured": gap}
    report["least Jacobian"] = {"measured": least}
    if not gap < 1e-9:
        wrong.append(f"the chamber is open: |∮ n dA| / ∮ dA = {gap:.2g}")
    if not least > 0:
        wrong.append(f"a Jacobian is not positive: {least:.2g} mm³")
    if winding is not None:
        for x, y, z in open_threads(mesh, actuator, winding)[:1]:
            wrong.append(f"a thread does not go on at x = {x:.4g}, y = {y:.4g}, z = {z:.4g} mm")
    if wrong:
        raise MeshError("the mesh is not the actuator: " + "; ".join(wrong))
    return report
