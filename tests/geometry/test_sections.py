"""Rectangle and circle beside the hemicircle: closed forms, meshes, windings, refusals."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, get_args

import numpy as np
import pytest
from scipy.spatial import cKDTree

from analytic.equal_area import EqualArea, Shape
from fiberbend.case import case
from geometry.bodies.extrude import hexahedral_body, hexahedral_slice, section_quadrilaterals
from geometry.bodies.gmsh_body import build_body
from geometry.checks import (
    chamber_volume,
    check,
    determinants,
    geometry_error,
    region_volumes,
    surface_area,
)
from geometry.mesh.data import MeshData
from geometry.mesh.reference import area_vectors, cell_rule, jacobians
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.circle import CircleActuator
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips, check_size
from geometry.sections.table import SECTIONS, make_actuator
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from geometry.winding.outline import (
    arc_length,
    position,
    tangent,
)
from geometry.winding.smear import smear
from tests.geometry.lengths import curve_length

HEMICIRCLE = HemicircleActuator(radius=8, length=40, wall=2, floor=2, sheath=1, cap=8, layer=0.5)
RECTANGLE = RectangleActuator(width=15, height=7, length=40, wall=2, floor=3, sheath=1, cap=8)
TUBE = CircleActuator(radius=6, length=40, wall=2, cap=8)
CIRCLE = dataclasses.replace(TUBE, floor=2.0, sheath=1.0)
INLAY = dataclasses.replace(TUBE, floor=0.8, sheath=1.0)
BODIES: dict[str, ShapedActuator] = {
    "hemicircle": HEMICIRCLE,
    "rectangle": RECTANGLE,
    "tall rectangle": dataclasses.replace(
        RECTANGLE, width=5.0, height=20.0, sheath=None, layer=0.5
    ),
    "tube": TUBE,
    "circle": CIRCLE,
    "circle with an inlay": INLAY,
}
DOUBLE = Winding("double-helix", 3, 0.38)

every_body = pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)


def test_the_case_offers_every_shape() -> None:
    offered = get_args(case.ActuatorSpec.model_fields["section"].annotation)
    assert set(offered) == set(SECTIONS)
    dimensions = {field.name for shape in SECTIONS.values() for field in dataclasses.fields(shape)}
    assert set(case.ActuatorSpec.model_fields) == {"section", *dimensions}


def test_a_shape_without_a_part_cannot_be_made() -> None:
    # a shape without an outline would fail only once it is wound
    parts = {name: getattr(CircleActuator, name) for name in ("closed_forms", "layout")}
    triangle = type("TriangleActuator", (ShapedActuator,), {"section": "triangle", **parts})
    with pytest.raises(TypeError, match=r"abstract method '?outline"):
        triangle(length=40, wall=2, cap=8)


def test_rectangle_closed_forms() -> None:
    # by hand: 15 × 7 in walls of 2, floor 3, sheath 1
    assert RECTANGLE.winding_perimeter == pytest.approx(2 * (19 + 12))
    assert RECTANGLE.chamber_volume == pytest.approx(15 * 7 * 40)
    assert RECTANGLE.chamber_moment == pytest.approx(15 * 7 * 6.5)
    assert RECTANGLE.face_height == pytest.approx(6)
    areas = {"wall": 2 * 2 * 7 + 19 * 2, "floor": 19 * 3, "sheath": 21 * 14 - 19 * 12}
    assert RECTANGLE.region_areas() == pytest.approx(areas)
    layered = dataclasses.replace(RECTANGLE, layer=0.5)
    assert layered.winding_perimeter == pytest.approx(2 * (19 + 12.5))
    assert layered.region_areas()["layer"] == pytest.approx(19 * 0.5)
    assert layered.face_height == pytest.approx(5.75)


def test_circle_closed_forms() -> None:
    # by hand: radius 6 in a wall of 2; the floor is a quarter of the ring, or of its outer part
    assert TUBE.winding_perimeter == pytest.approx(16 * math.pi)
    assert TUBE.chamber_moment == pytest.approx(36 * math.pi * 8)
    assert TUBE.region_areas() == pytest.approx({"wall": 28 * math.pi})
    ring = {"wall": 21 * math.pi, "floor": 7 * math.pi, "sheath": 17 * math.pi}
    assert CIRCLE.region_areas() == pytest.approx(ring)
    inlay = math.pi * (8**2 - 7.2**2) / 4
    assert INLAY.region_areas()["floor"] == pytest.approx(inlay)
    assert INLAY.region_areas()["wall"] == pytest.approx(28 * math.pi - inlay)


@pytest.mark.parametrize("shape", SECTIONS)
def test_torque_of_the_pressure_is_the_papers(shape: Shape) -> None:
    # two formulas for one thing: the appendix, eqs. (A2), (A5), (A8), with t = b = a/4
    equal = EqualArea(10, 160)
    half, full = equal.radii
    shapes: dict[str, dict[str, Any]] = {
        "hemicircle": {"radius": half, "floor": 2.5},
        "rectangle": {"width": 10 * equal.aspect, "height": 10 / equal.aspect, "floor": 2.5},
        "circle": {"radius": full, "floor": None},
    }
    common = {"section": shape, "length": 160, "wall": 2.5, "sheath": None, "cap": 15}
    actuator = make_actuator(common | shapes[shape])
    assert actuator.chamber_area == pytest.approx(100)
    assert actuator.chamber_moment == pytest.approx(equal.torque(shape))


@every_body
@pytest.mark.parametrize("half", [True, False])
@pytest.mark.parametrize("section", [1, 2])
@pytest.mark.parametrize("strips", [None, Strips(2.0, 2.0)])
def test_body_is_the_actuator(
    body: ShapedActuator, half: bool, section: int, strips: Strips | None
) -> None:
    # volumes, chamber, winding, closedness and Jacobians at once, for every layout variant
    mesh = hexahedral_body(body, MeshSize(axial=4, section=section, half=half), strips)
    report = check(mesh, body, DOUBLE)
    limit = 2e-4 if section == 1 else 1e-5
    assert all(abs(row["error"]) < limit for row in report.values() if "error" in row)


def test_straight_sections_have_no_geometry_error() -> None:
    # the allowance for arcs must not hide an error where there are none
    mesh = hexahedral_body(RECTANGLE, MeshSize(axial=4))
    assert geometry_error(mesh) < 1.1e-9
    arc = math.pi / 8
    round_mesh = hexahedral_body(TUBE, MeshSize(axial=4))
    assert geometry_error(round_mesh) == pytest.approx(3 * (arc / 2) ** 4 / 30, rel=0.1)


@every_body
def test_named_facets_have_the_areas_of_their_surfaces(body: ShapedActuator) -> None:
    # a facet too many, too few or double would shift a boundary condition silently
    mesh = hexahedral_body(body, MeshSize(axial=4, section=2, half=False), Strips(2.0, 3.0))
    solid = sum(body.region_areas().values())
    face = body.profile.outer_area
    outer = body.outer_half_width
    flat, line = 2 * 2.0, 2 * outer * math.asin(2.0 / outer)
    around = {
        "hemicircle": (math.pi + 2) * body.profile.half_width,
        "rectangle": 4 * body.profile.half_width + 2 * (body.profile.top - body.profile.bottom),
        "circle": 2 * math.pi * body.profile.half_width,
    }[body.section]
    outside = {
        "hemicircle": (math.pi + 2) * outer + 2 * (body.profile.bottom - body.outer_bottom),
        "rectangle": 4 * outer + 2 * (body.outer_top - body.outer_bottom),
        "circle": 2 * math.pi * outer,
    }[body.section]
    expected = {
        "clamp": face,
        "tip": face,
        "section_root": solid,
        "section_tip": solid,
        "chamber": around * body.length + 2 * body.chamber_area,
        "winding": body.winding_perimeter * body.length,
        "outer": outside * body.total_length,
        "roof": (flat if body.section == "rectangle" else line) * body.length,
        "post": (line if body.section == "circle" else 2 * outer) * 3.0,
    }
    areas = {name: surface_area(mesh, name) for name in mesh.facets}
    assert areas == pytest.approx(expected, rel=1e-5)


@every_body
def test_half_is_half_of_full(body: ShapedActuator) -> None:
    # the solver compares half and full bodies to 1e-6: the meshes must be mirror images
    half = hexahedral_body(body, MeshSize(axial=8), Strips(2.0, 2.0))
    full = hexahedral_body(body, MeshSize(axial=8, half=False), Strips(2.0, 2.0))
    assert len(full.cells) == 2 * len(half.cells)
    assert _as_set(np.vstack([half.nodes, half.nodes * [-1, 1, 1]])) == _as_set(full.nodes)
    for name in set(half.facets) - {"symmetry"}:
        assert surface_area(full, name) == pytest.approx(2 * surface_area(half, name), rel=1e-12)
    assert np.all(half.nodes[half.facet_nodes("symmetry"), 0] == 0)
    high = body.outer_top - body.outer_bottom
    hole = (body.profile.top - body.profile.bottom) * body.length
    symmetry = high * body.total_length - hole
    assert surface_area(half, "symmetry") == pytest.approx(symmetry, rel=1e-12)


@every_body
def test_heights_of_centroids_are_those_of_the_mesh(body: ShapedActuator) -> None:
    # the tip is reported at the face's centroid, and κ is the torque of the pressure
    mesh = hexahedral_body(body, MeshSize(axial=8, section=2))
    x, normal = area_vectors(mesh, "tip")
    area = np.linalg.norm(normal, axis=2)
    assert (area * x[..., 1]).sum() / area.sum() == pytest.approx(body.face_height, rel=1e-5)
    x, normal = area_vectors(section_quadrilaterals(body, MeshSize(section=2)), "chamber")
    moment = -2 * (x[..., 0] * x[..., 1] * normal[..., 0]).sum()
    assert moment == pytest.approx(body.chamber_moment, rel=1e-5)


def test_the_floor_of_a_circle_lies_within_45_degrees() -> None:
    # where the stiff strip sits decides how the circle bends
    for body in (CIRCLE, INLAY):
        mesh = section_quadrilaterals(body, MeshSize(section=2, half=False))
        cells = np.flatnonzero(mesh.cell_region == mesh.regions["floor"])
        x = jacobians(mesh, cells, cell_rule(mesh.cell_type)[0])[0].reshape(-1, 2) - [0, 8]
        assert np.hypot(*x.T).min() > 8 - (body.floor or 0.0)
        angle = np.abs(np.arctan2(x[:, 0], -x[:, 1]))
        assert angle.max() < math.pi / 4 + 1e-3
    assert set(section_quadrilaterals(TUBE, MeshSize()).regions) == {"wall"}


def test_a_tube_is_concentric() -> None:
    # exact solutions of tubes hold for this section only if it is one
    mesh = section_quadrilaterals(TUBE, MeshSize(section=2, half=False))
    for name, radius in (("chamber", 6), ("winding", 8), ("outer", 8)):
        nodes = mesh.nodes[mesh.facet_nodes(name)]
        assert np.hypot(nodes[..., 0], nodes[..., 1] - 8) == pytest.approx(radius, abs=1e-12)


@every_body
@pytest.mark.parametrize("half", [True, False])
def test_section_slice_and_body_belong_together(body: ShapedActuator, half: bool) -> None:
    # the models are compared with each other: same areas, same names, same pin
    size = MeshSize(axial=4, half=half)
    section, thin = section_quadrilaterals(body, size), hexahedral_slice(body, size, 1.5, 2)
    part = 0.5 if half else 1.0
    areas = {name: part * area for name, area in body.region_areas().items()}
    assert determinants(section).min() > 0
    assert region_volumes(section) == pytest.approx(areas, rel=2e-4)
    assert chamber_volume(section) == pytest.approx(part * body.chamber_area, rel=2e-4)
    volumes = {name: 1.5 * area for name, area in region_volumes(section).items()}
    assert region_volumes(thin) == pytest.approx(volumes)
    sides = {"chamber", "winding", "outer"} | ({"symmetry"} if half else set())
    assert set(section.facets) == sides
    assert set(thin.facets) == sides | {"section_root", "section_tip"}
    for mesh in (section, thin, hexahedral_body(body, size)):
        assert np.all(mesh.nodes[mesh.points["pin"]] == 0)


@every_body
def test_outline_runs_around_once(body: ShapedActuator) -> None:
    perimeter = body.winding_perimeter
    s = np.linspace(0.013, perimeter - 0.013, 4001)
    xy = position(body, s)
    steps = np.linalg.norm(np.diff(xy, axis=0), axis=1)
    assert steps.sum() == pytest.approx(perimeter - 0.026, rel=5e-4)
    assert xy[200, 0] > 0
    ends = position(body, np.array([0, perimeter / 2, -1e-9]))
    assert ends[:, 0] == pytest.approx(0, abs=1e-8)
    assert ends[:, 1] == pytest.approx([body.outline_top, body.outline_bottom, body.outline_top])
    x, y = xy.T
    area = abs(np.sum(x[1:] * y[:-1] - x[:-1] * y[1:])) / 2
    assert area == pytest.approx(body.profile.outline_area, rel=5e-3)
    difference = (position(body, s + 1e-6) - position(body, s - 1e-6)) / 2e-6
    smooth = np.linalg.norm(difference, axis=1) > 0.999
    assert tangent(body, s)[smooth] == pytest.approx(difference[smooth], abs=1e-7)
    assert arc_length(body, xy, x < 0) == pytest.approx(s, abs=1e-9)


@every_body
@pytest.mark.parametrize("pattern", ["double-helix", "single-helix-right", "single-helix-left"])
def test_windings_have_their_length(body: ShapedActuator, pattern: str) -> None:
    # exact: L/p √(S² + p²) a helix, embedded or smeared, on any full mesh
    winding = Winding(pattern, 7, 0.38)
    hexes = hexahedral_body(body, MeshSize(axial=4, section=2, half=False))
    for mesh in (hexes, to_tetrahedra(hexes)):
        expected = curve_length(winding, body)
        fibers = embed(mesh, body, winding)
        for curve in range(winding.curves):
            of_curve = fibers.curve == curve
            assert fibers.length[of_curve].sum() == pytest.approx(expected, rel=2e-5)
        total = len(winding.hands) * expected
        assert smear(mesh, body, winding).length.sum() == pytest.approx(total, rel=2e-5)
    section = section_quadrilaterals(body, MeshSize(section=2, half=False))
    per_mm = len(winding.hands) * winding.turn_length(body) / 7
    assert smear(section, body, winding).length.sum() == pytest.approx(per_mm, rel=2e-5)


@every_body
def test_smeared_windings_follow_the_helix(body: ShapedActuator) -> None:
    # right-handed: −s while z grows, on the section and on the body
    around, up = body.winding_perimeter, DOUBLE.pitch
    for mesh in (
        section_quadrilaterals(body, MeshSize(section=2, half=False)),
        hexahedral_slice(body, MeshSize(section=2, half=False), 3.0, 2),
    ):
        fibers = smear(mesh, body, DOUBLE)
        x, jacobian = jacobians(mesh, fibers.cell, fibers.points)
        t = np.einsum("nqij,nqj->nqi", jacobian, fibers.tangents)[:, 0]
        t = np.hstack([t, fibers.axial]) if t.shape[1] == 2 else t
        assert np.linalg.norm(t, axis=1) == pytest.approx(fibers.length)
        s = arc_length(body, x[:, 0, :2], x[:, 0, 0] < 0)
        hand = np.array(DOUBLE.hands)[fibers.curve]
        exact = np.column_stack([-hand[:, None] * around * tangent(body, s), np.full(len(s), up)])
        cosine = (t * exact).sum(axis=1) / fibers.length / math.hypot(around, up)
        assert cosine == pytest.approx(1, abs=1e-4)


@every_body
def test_half_a_pitch_contains_one_pass(body: ShapedActuator) -> None:
    # the cell model: one pass of one fiber from the top to the bottom
    mesh = hexahedral_slice(body, MeshSize(section=2), 1.5, 2)
    fibers = embed(mesh, body, Winding("double-helix", 3, 0.0))
    expected = math.hypot(body.winding_perimeter, 3) / 2
    assert fibers.length.sum() == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize("body", [RECTANGLE, CIRCLE, INLAY], ids=["rectangle", "circle", "inlay"])
def test_gmsh_makes_the_same_mesh(body: ShapedActuator) -> None:
    # two independent ways to the same mesh: node places and names must agree
    size, strips = MeshSize(axial=4), Strips(2.0, 2.0)
    ours, theirs = hexahedral_body(body, size, strips), build_body(body, size, strips)
    assert _same(theirs.nodes, ours.nodes)
    assert set(theirs.facets) == set(ours.facets)
    for name in ours.facets:
        assert _same(_centers(theirs, name), _centers(ours, name))
    assert theirs.nodes[theirs.points["pin"]] == pytest.approx(0, abs=1e-9)
    check(theirs, body, DOUBLE)


@pytest.mark.parametrize("body", [RECTANGLE, CIRCLE], ids=["rectangle", "circle"])
def test_gmsh_tetrahedra_are_the_actuator(body: ShapedActuator) -> None:
    size = MeshSize(axial=3, element="tetrahedron")
    check(build_body(body, size, Strips(2.0, 2.0)), body, DOUBLE)


@pytest.mark.parametrize(
    ("body", "change", "line"),
    [
        (RECTANGLE, {"width": None}, "width: missing, expected the width of a rectangle"),
        (RECTANGLE, {"radius": 8.0}, "radius: no effect on a rectangle, expected no value"),
        (RECTANGLE, {"floor": None}, "floor: missing, expected the floor of a rectangle"),
        (RECTANGLE, {"height": -1.0}, "height -1.0 mm: expected a positive length"),
        (HEMICIRCLE, {"floor": None}, "floor: missing, expected the floor of a hemicircle"),
        (HEMICIRCLE, {"width": 3.0}, "width: no effect on a hemicircle, expected no value"),
        (TUBE, {"layer": 0.5}, "layer: no effect on a circle, expected no value"),
        (TUBE, {"breadth": 0.5}, "breadth: no effect on a circle, expected no value"),
        (TUBE, {"floor": 2.1}, "floor: 2.1 mm, expected at most the wall, 2 mm"),
        (TUBE, {"section": "square"}, "section 'square' is unknown: expected one of hemicircle"),
    ],
)
def test_dimensions_that_do_not_belong_together_are_refused(
    body: ShapedActuator, change: dict[str, Any], line: str
) -> None:
    given = {"section": body.section, **dataclasses.asdict(body), **change}
    with pytest.raises(ValueError, match=f"^{line}"):
        make_actuator(given)


def test_a_floor_thicker_than_its_ring_is_refused_however_the_actuator_is_made() -> None:
    with pytest.raises(ValueError, match=r"floor: 2\.1 mm, expected at most the wall, 2 mm"):
        dataclasses.replace(CIRCLE, floor=2.1)


def test_meshes_that_cannot_resolve_a_section_are_refused() -> None:
    thin = dataclasses.replace(CIRCLE, floor=1.9)
    with pytest.raises(ValueError, match=r"floor 1\.9 mm leaves 0\.1 mm of the wall, too thin"):
        check_size(thin, MeshSize(axial=4))
    check_size(thin, MeshSize(axial=2))
    with pytest.raises(ValueError, match=r"roof half width 8 mm: expected .* less than 7\.5 mm"):
        check_size(RECTANGLE, MeshSize(), Strips(8.0, 2.0))


def _centers(mesh: MeshData, name: str) -> np.ndarray:
    return mesh.nodes[mesh.facet_nodes(name)].mean(axis=1)


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two sets of points are one, to 5e-7 mm."""
    pairs = ((one, other), (other, one))
    return all(cKDTree(a).query(b)[0].max() < 5e-7 for a, b in pairs) and len(one) == len(other)


def _as_set(points: np.ndarray) -> set[tuple[float, ...]]:
    return set(map(tuple, (points.round(9) + 0.0).tolist()))


@pytest.mark.parametrize("wall", [1.0123456785, 2.3352335235, 1.9876543215])
@pytest.mark.parametrize("radius", [5.0000000005, 7.3352335235, 8.1234567895])
def test_a_corner_is_one_whichever_sum_of_lengths_has_led_to_it(wall: float, radius: float) -> None:
    # half a unit of the last digit by which corners are told apart, rounded up or down
    lengths: dict[str, Any] = {"radius": radius, "wall": wall, "floor": 1.4444444445, "sheath": 1.0}
    given = {"section": "hemicircle", "length": 30.0, "cap": 10.0, **lengths}
    plain = make_actuator(given | {"radius": 7.0, "wall": 2.0, "floor": 1.5})
    size = MeshSize(axial=4.0, section=1, half=True)
    mesh = section_quadrilaterals(make_actuator(given), size)
    assert len(mesh.nodes) == len(section_quadrilaterals(plain, size).nodes)
