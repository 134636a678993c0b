"""The body from the block map: it is the actuator, and its names are where they belong."""

from __future__ import annotations

import math

import numpy as np
import pytest

from geometry.bodies.extrude import hexahedral_body, hexahedral_slice, section_quadrilaterals
from geometry.checks import chamber_gap, check, region_volumes, surface_area
from geometry.mesh.data import MeshData
from geometry.mesh.errors import MeshError
from geometry.mesh.reference import determinants
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize, Strips

BASELINE = HemicircleActuator(radius=8, length=160, wall=2, floor=2, sheath=1, cap=15)
SHAPES = [
    BASELINE,
    HemicircleActuator(radius=6, length=100, wall=1, floor=3, cap=10),
    HemicircleActuator(radius=12, length=80, wall=3, floor=2, sheath=1.5, cap=15, layer=0.3),
]


@pytest.mark.parametrize("actuator", SHAPES)
@pytest.mark.parametrize("half", [True, False])
@pytest.mark.parametrize("section", [1, 2])
@pytest.mark.parametrize("strips", [None, Strips(2.0, 2.0)])
def test_body_is_the_actuator(
    actuator: HemicircleActuator, half: bool, section: int, strips: Strips | None
) -> None:
    # volumes, chamber, closedness and Jacobians at once, for every layout variant
    mesh = hexahedral_body(actuator, MeshSize(axial=4, section=section, half=half), strips)
    report = check(mesh, actuator)
    limit = 1.5e-4 if section == 1 else 1e-5
    assert all(abs(row["error"]) < limit for row in report.values() if "error" in row)


def test_named_facets_have_the_areas_of_their_surfaces() -> None:
    # a facet too many, too few or double would shift a boundary condition silently
    a = BASELINE
    mesh = hexahedral_body(a, MeshSize(axial=4, section=2, half=False), Strips(2.0, 3.0))
    solid = sum(a.region_areas().values())
    radius, outer = a.profile.half_width, a.outer_half_width
    perimeter = math.pi * outer + 2 * (a.profile.bottom - a.outer_bottom) + 2 * outer
    expected = {
        "clamp": solid + a.chamber_area,
        "tip": solid + a.chamber_area,
        "section_root": solid,
        "section_tip": solid,
        "chamber": (math.pi + 2) * radius * a.length + 2 * a.chamber_area,
        "winding": a.winding_perimeter * a.length,
        "outer": perimeter * a.total_length,
        "roof": 2 * outer * math.asin(2.0 / outer) * a.length,
        "post": 2 * outer * 3.0,
    }
    assert {name: surface_area(mesh, name) for name in mesh.facets} == pytest.approx(
        expected, rel=1e-5
    )


def test_half_is_half_of_full() -> None:
    # the solver compares half and full bodies to 1e-6: the meshes must be mirror images
    half = hexahedral_body(BASELINE, MeshSize(axial=8), Strips(2.0, 2.0))
    full = hexahedral_body(BASELINE, MeshSize(axial=8, half=False), Strips(2.0, 2.0))
    assert len(full.cells) == 2 * len(half.cells)
    mirrored = np.vstack([half.nodes, half.nodes * [-1, 1, 1]])
    assert _as_set(mirrored) == _as_set(full.nodes)
    for name in set(half.facets) - {"symmetry"}:
        assert surface_area(full, name) == pytest.approx(2 * surface_area(half, name), rel=1e-12)
    height = BASELINE.outer_top - BASELINE.outer_bottom
    ring = height - BASELINE.profile.half_width
    symmetry = ring * BASELINE.length + height * 2 * BASELINE.cap
    assert surface_area(half, "symmetry") == pytest.approx(symmetry, rel=1e-12)
    assert np.all(half.nodes[half.facet_nodes("symmetry"), 0] == 0)


def test_tetrahedra_conform_and_keep_names() -> None:
    # an edge cut two ways would leave gaps: every inner facet must have exactly two cells
    mesh = hexahedral_body(BASELINE, MeshSize(axial=8, half=False), Strips(2.0, 2.0))
    tets = to_tetrahedra(mesh)
    assert determinants(tets).min() > 0
    assert region_volumes(tets) == pytest.approx(region_volumes(mesh), rel=1e-12)
    assert chamber_gap(tets) < 1e-12
    for name in mesh.facets:
        assert surface_area(tets, name) == pytest.approx(surface_area(mesh, name), rel=1e-6)
    faces = np.sort(tets.cells[:, :4][:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]], axis=2)
    _, count = np.unique(faces.reshape(-1, 3), axis=0, return_counts=True)
    boundary = sum(len(tets.facets[name]) for name in ("clamp", "tip", "outer", "chamber"))
    assert count.max() == 2
    assert np.sum(count == 1) == boundary


def test_section_and_slice_share_the_body_section() -> None:
    # section and cell models are compared with the body: same regions, same areas
    size = MeshSize(section=1)
    section = section_quadrilaterals(BASELINE, size)
    assert len(section.cells) == 18
    assert determinants(section).min() > 0
    areas = {name: area / 2 for name, area in BASELINE.region_areas().items()}
    assert region_volumes(section) == pytest.approx(areas, rel=1e-4)
    thin = hexahedral_slice(BASELINE, size, 1.5, 2)
    volumes = {name: 1.5 * area for name, area in region_volumes(section).items()}
    assert region_volumes(thin) == pytest.approx(volumes)
    assert set(thin.facets) == {
        *("chamber", "winding", "outer", "symmetry", "section_root", "section_tip")
    }


def test_inner_facets_are_listed_from_the_lower_cell() -> None:
    # the host cell of a fiber must not depend on who built the mesh
    mesh = hexahedral_body(BASELINE, MeshSize(axial=8))
    everyone = mesh.cells[:, _VERTICES]
    for name in ("winding", "section_root", "section_tip"):
        pairs = mesh.facets[name]
        assert len(np.unique(pairs, axis=0)) == len(pairs)
        for (cell, _), nodes in zip(pairs[::7], mesh.facet_nodes(name)[::7], strict=True):
            hosts = np.flatnonzero(np.isin(everyone, nodes).sum(axis=1) == 4)
            assert len(hosts) == 2
            assert cell == hosts[0]


def test_a_wrong_mesh_is_reported() -> None:
    # the check must bite: a mesh of another actuator, and one with an inverted cell
    mesh = hexahedral_body(BASELINE, MeshSize(axial=8))
    other = HemicircleActuator(radius=8, length=160, wall=2.01, floor=2, sheath=1, cap=15)
    with pytest.raises(MeshError, match="volume wall"):
        check(mesh, other)
    cells = mesh.cells.copy()
    cells[5] = cells[5].reshape(3, 3, 3)[::-1].ravel()
    flipped = MeshData(
        mesh.cell_type, mesh.nodes, cells, mesh.regions, mesh.cell_region, mesh.facets, mesh.half
    )
    with pytest.raises(MeshError, match="Jacobian"):
        check(flipped, BASELINE)


_VERTICES = [0, 2, 6, 8, 18, 20, 24, 26]


def _as_set(points: np.ndarray) -> set[tuple[float, ...]]:
    return set(map(tuple, (points.round(9) + 0.0).tolist()))


@pytest.mark.parametrize(("post", "longest"), [(2.0, 13 / 3), (1.0, 14 / 5), (4.0, 11 / 2)])
def test_long_elements_are_shorter_beside_a_post_alone(post: float, longest: float) -> None:
    # as long as the rest they bend with its edge, and the tip force comes out too great
    def levels(strips: Strips | None, axial: float) -> np.ndarray:
        mesh = hexahedral_body(BASELINE, MeshSize(axial=axial), strips)
        return np.unique(mesh.nodes[:, 2])[::2]

    strips = Strips(2.0, post)
    made = levels(strips, 8.0)
    end = BASELINE.length + BASELINE.cap - post
    beside = made[(made >= BASELINE.length - 1e-9) & (made <= end + 1e-9)]
    np.testing.assert_allclose(np.diff(beside), longest, rtol=1e-9)
    # everything else is as without a post, and short elements are short enough
    chamber = levels(None, 8.0)
    np.testing.assert_array_equal(
        made[made <= BASELINE.length], chamber[chamber <= BASELINE.length]
    )
    assert np.diff(levels(strips, 1.5)).max() <= 1.5 + 1e-9
