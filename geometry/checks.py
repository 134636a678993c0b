"""Measures of a mesh against the closed forms of the actuator it stands for."""

from __future__ import annotations

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import Floats, MeshData
from geometry.mesh.errors import MeshError
from geometry.mesh.reference import area_vectors, cell_rule, determinants
from geometry.winding.embed import embed
from geometry.winding.ribbons import Wound
from geometry.winding.symmetry import mirrored


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
    if wrong:
        raise MeshError("the mesh is not the actuator: " + "; ".join(wrong))
    return report
