"""The two-dimensional section: its named point, its edges and the winding smeared over them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from geometry.bodies.extrude import hexahedral_body, hexahedral_slice, section_quadrilaterals
from geometry.checks import chamber_gap, chamber_volume, surface_area
from geometry.mesh.data import MeshData
from geometry.mesh.reference import jacobians
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from geometry.winding.outline import arc_length, tangent
from geometry.winding.segments import EmbeddedFibers
from geometry.winding.smear import smear

BODY = HemicircleActuator(radius=8, length=40, wall=2, floor=2, sheath=1, cap=8, layer=0.5)
DOUBLE = Winding("double-helix", 3, 0.38)


@pytest.mark.parametrize("half", [True, False])
def test_the_pin_is_named_in_every_mesh(half: bool, tmp_path: Path) -> None:
    # uniform bending measures curvature and stretch there; a wrong node would go unnoticed
    size = MeshSize(axial=4, half=half)
    body = hexahedral_body(BODY, size)
    meshes = [
        section_quadrilaterals(BODY, size),
        hexahedral_slice(BODY, size, 1.5, 2),
        body,
        to_tetrahedra(body),
    ]
    for mesh in meshes:
        assert mesh.nodes[mesh.points["pin"]] == pytest.approx(0, abs=1e-15)
    body.save(tmp_path / "mesh.npz")
    assert MeshData.load(tmp_path / "mesh.npz").points == body.points


@pytest.mark.parametrize("half", [True, False])
def test_edges_of_a_section_have_lengths_and_normals(half: bool) -> None:
    # the section's chamber is measured by the same boundary integral as the body's
    mesh = section_quadrilaterals(BODY, MeshSize(section=3, half=half))
    part = 0.5 if half else 1.0
    assert chamber_volume(mesh) == pytest.approx(part * BODY.chamber_area, rel=1e-5)
    assert chamber_gap(mesh) < 1e-12
    winding = surface_area(mesh, "winding")
    assert winding == pytest.approx(part * BODY.winding_perimeter, rel=1e-5)


def material_tangents(mesh: MeshData, fibers: EmbeddedFibers) -> np.ndarray:
    """Derivative of (x, y, z) along each segment, (n, 3), in mm."""
    jacobian = jacobians(mesh, fibers.cell, fibers.points)[1]
    plane = np.einsum("nqij,nqj->nqi", jacobian, fibers.tangents)[:, 0]
    return np.hstack([plane, fibers.axial])


@pytest.mark.parametrize("pattern", ["double-helix", "single-helix-right", "single-helix-left"])
def test_smeared_section_has_the_length_of_its_helices(pattern: str) -> None:
    # per mm of z a helix of pitch p around the perimeter S has √(S² + p²)/p of fiber
    winding = Winding(pattern, 7, 0.38)
    for half in (True, False):
        mesh = section_quadrilaterals(BODY, MeshSize(section=2, half=half))
        fibers = smear(mesh, BODY, winding)
        per_helix = winding.turn_length(BODY) / winding.pitch * (0.5 if half else 1)
        for helix in range(len(winding.hands)):
            of_helix = fibers.curve == helix
            total = fibers.length[of_helix] @ fibers.share[of_helix]
            assert total == pytest.approx(per_helix, rel=1e-5)
        speed = np.linalg.norm(material_tangents(mesh, fibers), axis=1)
        assert speed == pytest.approx(fibers.length, rel=1e-12)


def test_smeared_section_runs_along_the_right_hand() -> None:
    # the sign of the twist of a single helix hangs on this: right-handed is −s while z grows
    mesh = section_quadrilaterals(BODY, MeshSize(section=2, half=False))
    fibers = smear(mesh, BODY, DOUBLE)
    x = jacobians(mesh, fibers.cell, fibers.points)[0][:, 0]
    s = arc_length(BODY, x, x[:, 0] < 0)
    assert fibers.s == pytest.approx(s, abs=0.05)
    around, up = BODY.winding_perimeter, DOUBLE.pitch
    hand = np.array(DOUBLE.hands)[fibers.curve]
    exact = np.column_stack([-hand[:, None] * around * tangent(BODY, s), np.full(len(s), up)])
    exact /= np.hypot(around, up)
    direction = material_tangents(mesh, fibers) / fibers.length[:, None]
    assert (direction * exact).sum(axis=1) == pytest.approx(1, abs=1e-4)
    assert direction[:, 2] == pytest.approx(exact[:, 2], rel=1e-2)


def test_smeared_section_is_the_smeared_slice() -> None:
    # both models integrate the same density: one layer of 1 mm against the section
    size = MeshSize()
    section, thin = section_quadrilaterals(BODY, size), hexahedral_slice(BODY, size, 1.0, 1)
    flat, solid = smear(section, BODY, DOUBLE), smear(thin, BODY, DOUBLE)
    assert flat.length.sum() == pytest.approx(solid.length.sum(), rel=1e-12)
    sums = [
        np.abs(material_tangents(section, flat)).sum(axis=0),
        np.abs(
            np.einsum(
                "nij,nj->ni",
                jacobians(thin, solid.cell, solid.points)[1][:, 0],
                solid.tangents[:, 0],
            )
        ).sum(axis=0),
    ]
    assert sums[0] == pytest.approx(sums[1], rel=1e-12)
    assert not solid.axial.any()


def test_a_section_can_have_no_discrete_fibers() -> None:
    with pytest.raises(ValueError, match="smeared windings only"):
        embed(section_quadrilaterals(BODY, MeshSize()), BODY, DOUBLE)
