"""Fiber curves and their embedding: exact length, on the surface, whatever the mesh."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from geometry.bodies.extrude import hexahedral_body, hexahedral_slice, section_quadrilaterals
from geometry.mesh.data import Floats, Ints, MeshData
from geometry.mesh.reference import jacobians
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.circle import CircleActuator
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from geometry.winding.outline import arc_length, curvature, pieces, position
from geometry.winding.patterns import PATTERNS, Helix, Pattern
from geometry.winding.segments import EmbeddedFibers
from geometry.winding.smear import smear
from tests.geometry.lengths import curve_length

BODY = HemicircleActuator(radius=8, length=40, wall=2, floor=2, sheath=1, cap=8, layer=0.5)
DOUBLE = Winding("double-helix", 3, 0.38)
SINGLES = [Winding("single-helix-right", 3, 0.38), Winding("single-helix-left", 7, 0.0)]


def _meshes(half: bool) -> list[MeshData]:
    hexes = hexahedral_body(BODY, MeshSize(axial=4, section=1, half=half))
    fine = hexahedral_body(BODY, MeshSize(axial=1.3, section=2, half=half))
    return [hexes, fine, to_tetrahedra(hexes)]


@pytest.mark.parametrize("winding", [DOUBLE, *SINGLES])
def test_curves_have_their_length_and_tangents(winding: Winding) -> None:
    for curve in range(winding.curves):
        x, t = winding.points(BODY, curve, 40_001)
        length = np.linalg.norm(np.diff(x, axis=0), axis=1).sum()
        assert length == pytest.approx(curve_length(winding, BODY), rel=2e-4)
        chord = np.diff(x, axis=0)
        mean = (t[1:] + t[:-1]) / 2
        aligned = (chord * mean).sum(axis=1) / np.linalg.norm(chord, axis=1)
        assert np.median(aligned) == pytest.approx(1, abs=1e-6)


def test_hands_are_geometric() -> None:
    # a right-handed helix turns counterclockwise seen from +z while it rises
    x, t = Winding("single-helix-right", 5, 0.0).points(BODY, 0, 2)
    assert x[0] == pytest.approx([0, 12, 0])
    assert t[0, 0] < 0 < t[0, 2]


def test_double_helix_crosses_on_the_mirror_plane() -> None:
    # the phase by convention: the crossings are the mirror planes of the cell model
    winding = Winding("double-helix", 4, 0.0)
    first, second = (winding.points(BODY, i, 21)[0] for i in range(2))
    assert first[:, 2] == pytest.approx(np.arange(21) * 2.0)
    assert first == pytest.approx(second, abs=1e-9)
    assert first[:, 0] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("helices", "mirrored"),
    [
        ([Helix(1), Helix(-1)], True),
        ([Helix(1)], False),
        ([Helix(1), Helix(1, 0.5)], False),
        ([Helix(1), Helix(1), Helix(-1)], False),
        ([Helix(hand, start) for hand in (1, -1) for start in (0, 0.5)], True),
        ([Helix(hand, start / 3) for hand in (1, -1) for start in range(3)], True),
        # its own image in x, but not in the end of a half pitch
        ([Helix(1, 0.25), Helix(-1, 0.25)], False),
        # crosses beside x = 0
        ([Helix(1), Helix(-1, 0.5)], False),
        ([Helix(1, 1.0), Helix(-1, -3)], True),
    ],
)
def test_a_pattern_knows_its_mirrors(helices: list[Helix], mirrored: bool) -> None:
    assert Pattern("made up", tuple(helices)).mirrored is mirrored


def test_a_pattern_has_helices_with_a_hand() -> None:
    with pytest.raises(ValueError, match="hand 0"):
        Helix(0)
    with pytest.raises(ValueError, match="made up: expected at least one helix"):
        Pattern("made up", ())


def test_a_helix_starts_where_its_pattern_says(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PATTERNS, "two", Pattern("two", (Helix(1), Helix(1, 0.5))))
    two, one = Winding("two", 4, 0.4, lines=3), Winding("single-helix-right", 4, 0.4, lines=3)
    assert two.rises(BODY, 0) == pytest.approx(one.rises(BODY, 0), abs=1e-12)
    assert two.rises(BODY, 1) == pytest.approx(one.rises(BODY, 0) + 2, abs=1e-12)
    # on the mesh half the helices cross x = 0 half a pitch higher
    fibers = embed(_meshes(half=False)[0], BODY, dataclasses.replace(two, width=0.0))
    for curve in range(2):
        mine = fibers.curve == curve
        phase = (fibers.z[mine] + 4 * fibers.s[mine] / BODY.winding_perimeter) / 4 % 1
        assert np.abs((phase - 0.5 * curve + 0.5) % 1 - 0.5).max() < 1e-9
        assert fibers.length[mine].sum() == pytest.approx(curve_length(one, BODY), rel=2e-5)


@pytest.mark.parametrize("winding", [DOUBLE, *SINGLES])
def test_embedded_length_is_exact_on_any_full_mesh(winding: Winding) -> None:
    # coarse and fine, hexes and tets: nothing lost at seams, doubled at borders
    for mesh in _meshes(half=False):
        fibers = embed(mesh, BODY, winding)
        for curve in range(winding.curves):
            length = fibers.length[fibers.curve == curve].sum()
            assert length == pytest.approx(curve_length(winding, BODY), rel=2e-5)


def test_half_mesh_has_half_the_fibers() -> None:
    for mesh in _meshes(half=True):
        fibers = embed(mesh, BODY, DOUBLE)
        half = curve_length(DOUBLE, BODY) * len(DOUBLE.hands) / 2
        assert fibers.length @ fibers.share == pytest.approx(half, rel=2e-5)
        assert fibers.s.max() <= BODY.winding_perimeter / 2


@pytest.mark.parametrize("build", [embed, smear])
def test_points_lie_on_the_outline_and_tangents_along_the_helix(build: object) -> None:
    # a host cell or reference coordinate gone wrong would put the fiber inside the rubber
    for mesh in _meshes(half=False):
        fibers: EmbeddedFibers = build(mesh, BODY, DOUBLE)  # type: ignore[operator]
        assert fibers.weights.sum(axis=1) == pytest.approx(1)
        x, jacobian = jacobians(mesh, fibers.cell, fibers.points)
        s = arc_length(BODY, x[..., :2], x[..., 0] < 0)
        assert x[..., :2] == pytest.approx(position(BODY, s.ravel()).reshape(*s.shape, 2), abs=0.01)
        t = np.einsum("nqij,nqj->nqi", jacobian, fibers.tangents)
        speed = np.linalg.norm(t, axis=2)
        assert (speed * fibers.weights).sum(axis=1) == pytest.approx(fibers.length)
        rise = DOUBLE.pitch / DOUBLE.turn_length(BODY)
        assert t[..., 2] / speed == pytest.approx(rise, rel=0.02)


def test_ribbon_lines_are_parallel_and_apart() -> None:
    ribbon = Winding("single-helix-left", 3, 0.4, lines=4)
    spacing = np.diff(ribbon.rises(BODY, 0)) * BODY.winding_perimeter / ribbon.turn_length(BODY)
    assert spacing == pytest.approx(0.1)
    assert ribbon.rises(BODY, 0).sum() == pytest.approx(0, abs=1e-12)
    fibers = embed(_meshes(half=False)[0], BODY, ribbon)
    assert np.all(fibers.share == 0.25)
    assert dataclasses.replace(ribbon, width=0.0).curves == 1


def test_segments_follow_each_other() -> None:
    # output draws the fibers as lines in this order
    fibers = embed(_meshes(half=False)[2], BODY, SINGLES[0])
    z = fibers.z[fibers.curve == 2]
    assert np.all(np.diff(z) > 0)


def test_a_line_along_a_border_of_tetrahedra_counts_once() -> None:
    # the measure-zero case: a helix that runs exactly along the diagonals of the facets
    hexes = hexahedral_body(BODY, MeshSize(axial=4, section=1, half=False))
    tets = to_tetrahedra(hexes)
    side = (BODY.profile.bottom - BODY.outline_bottom) / 2
    nodes = tets.nodes[tets.facet_nodes("winding")]
    on_floor_side = np.isclose(nodes[..., 0], BODY.outline_half_width).all(axis=1)
    assert on_floor_side.any()
    slopes = np.diff(nodes[on_floor_side], axis=1)[..., 1:]
    ratios = np.abs(slopes[..., 1] / np.where(slopes[..., 0] == 0, np.nan, slopes[..., 0]))
    pitch = float(np.nanmax(ratios)) * BODY.winding_perimeter
    assert pitch > side
    for pattern in ("single-helix-right", "single-helix-left"):
        winding = Winding(pattern, pitch, 0.0)
        for mesh in (hexes, tets):
            total = embed(mesh, BODY, winding).length.sum()
            assert total == pytest.approx(curve_length(winding, BODY), rel=2e-5)


def test_smeared_length_is_the_discrete_one() -> None:
    for mesh in _meshes(half=False):
        fibers = smear(mesh, BODY, DOUBLE)
        total = len(DOUBLE.hands) * curve_length(DOUBLE, BODY)
        assert fibers.length.sum() == pytest.approx(total, rel=2e-5)


def test_slice_of_half_a_pitch_contains_one_pass() -> None:
    # the cell model: one pass of one fiber from the top to the bottom
    mesh = hexahedral_slice(BODY, MeshSize(), 1.5, 2)
    fibers = embed(mesh, BODY, Winding("double-helix", 3, 0.0))
    assert fibers.length.sum() == pytest.approx(math.hypot(BODY.winding_perimeter, 3) / 2, rel=2e-5)
    assert len(set(fibers.curve.tolist())) == 1
    empty = embed(mesh, BODY, Winding("single-helix-right", 3, 0.0))
    assert len(empty.length) == 0


def test_windings_without_meaning_are_refused() -> None:
    for bad in ({"pitch": 0.0}, {"pitch": math.nan}, {"width": -1.0}, {"lines": 0}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            dataclasses.replace(DOUBLE, **bad)
    with pytest.raises(ValueError, match="pattern 'triple'"):
        Winding("triple", 3, 0.38)


def test_smeared_fibers_know_the_curvature_of_their_path() -> None:
    # of the discrete helices, by differences of their tangents; none on the straight sides, and a
    # corner has no length to be curved on
    winding, perimeter = Winding("double-helix", 9.0, 0.0), BODY.winding_perimeter
    ends = np.cumsum([piece.length for piece in pieces(BODY)])[:-1]

    def piece_at(s: Floats) -> Ints:
        return np.searchsorted(ends, np.minimum(s % perimeter, -s % perimeter))

    points, tangents = winding.points(BODY, 0, 20001)
    step = curve_length(winding, BODY) / 20000
    bend = np.linalg.norm(np.diff(tangents, axis=0), axis=1) / step
    middle = (points[1:] + points[:-1]) / 2
    along = piece_at(arc_length(BODY, middle[:, :2], middle[:, 0] < 0))
    quads = section_quadrilaterals(BODY, MeshSize(section=1, half=False))
    for mesh in (*_meshes(half=True), quads):
        fibers = smear(mesh, BODY, winding)
        assert fibers.density == pytest.approx(2 * winding.density(BODY))
        there = piece_at(fibers.s)
        for number in range(3):
            expected = float(np.median(bend[along == number]))
            assert fibers.curvature[there == number] == pytest.approx(expected, rel=1e-6, abs=1e-9)
        assert set(np.sign(fibers.curvature)) == {0.0, 1.0}


def test_curvature_of_outlines() -> None:
    circle = CircleActuator(radius=8, length=40, wall=2, cap=8)
    assert curvature(circle, np.linspace(-99, 99, 50)) == pytest.approx(1 / 10)
    rectangle = RectangleActuator(width=10, height=6, length=40, wall=2, floor=2, cap=8)
    assert not np.any(curvature(rectangle, np.linspace(-99, 99, 50)))
