"""Families of threads at any angle: exact length on any mesh, symmetry, repeat, distance."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from geometry.bodies.extrude import hexahedral_body, hexahedral_slice, section_quadrilaterals
from geometry.checks import check, loose_ends, open_threads
from geometry.mesh.data import MeshData
from geometry.mesh.errors import MeshError
from geometry.mesh.reference import jacobians
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed, embed_families
from geometry.winding.families import (
    UPRIGHT,
    Family,
    along,
    angle_at,
    helix,
    hoops,
    pitch_at,
    placed,
)
from geometry.winding.helix import Winding
from geometry.winding.outline import pieces, position
from geometry.winding.ribbons import Ribbons
from geometry.winding.smear import smear
from geometry.winding.symmetry import (
    common_period,
    least_distance,
    mirrored,
    nearest_periods,
    twofold,
)
from tests.geometry.lengths import curve_length

BODY = HemicircleActuator(radius=8, length=40, wall=2, floor=2, sheath=1, cap=8, layer=0.5)
BOX = RectangleActuator(width=10, height=12, length=40, wall=2, floor=2, cap=8)
S = BODY.winding_perimeter
ARCS = 5e-5
"""Relative error of lengths on order-2 arcs."""
WALL = sum(piece.length for piece in pieces(BODY)[:2])
"""Half of the outline without the floor."""


def at(angle_deg: float, starts: int, hand: int = 1, phase: float = 0.1) -> Family:
    """Threads at an angle from the axis, in degrees."""
    return helix(S, pitch_at(math.radians(angle_deg), S), hand, starts, phase)


FAMILIES = {
    "hoops": hoops(3.0, 0.3),
    "hoops on the ends": hoops(4.0),
    "85°": at(85, 1),
    "70°, six": at(70, 6, -1),
    "30°, twelve": at(30, 12),
    "2°, nine": at(2, 9, -1),
    "along, even": along(S, 7, 0.02),
    "along, from the top": along(S, 4),
    "place": placed(S, -11.3),
}


def meshes(half: bool) -> list[MeshData]:
    """Coarse hexahedra and tetrahedra."""
    hexes = hexahedral_body(BODY, MeshSize(axial=4, section=1, half=half))
    return [hexes, to_tetrahedra(hexes)]


@pytest.mark.parametrize("reach", [math.inf, WALL], ids=["all around", "wall"])
@pytest.mark.parametrize("name", FAMILIES)
def test_lengths_are_exact_at_every_angle(name: str, reach: float) -> None:
    for width in (0.0, 0.3):
        family = dataclasses.replace(FAMILIES[name], width=width, reach=reach)
        laid = Ribbons((family,), 4)
        (expected,) = laid.lengths(BODY)
        assert expected > 0
        for mesh in meshes(half=False):
            fibers = embed(mesh, BODY, laid)
            assert fibers.length @ fibers.share == pytest.approx(expected, rel=ARCS)


@pytest.mark.parametrize("name", FAMILIES)
def test_length_in_closed_form(name: str) -> None:
    # area over spacing, where threads are alike all along
    family = FAMILIES[name]
    (found,) = Ribbons((family,)).lengths(BODY)
    expected = S * BODY.length / family.spacing
    if family.hand or not family.angle:
        assert found == pytest.approx(expected, rel=1e-12)
    else:
        number = {"hoops": 14, "hoops on the ends": 10}[name]
        assert found == pytest.approx(number * S, rel=1e-12)


@pytest.mark.parametrize("families", [["hoops"], ["along, from the top"], ["hoops on the ends"]])
def test_half_a_mesh_has_half_of_what_is_its_own_image(families: list[str]) -> None:
    # threads that lie in the mirror plane or on an end count half
    laid = Ribbons(tuple(FAMILIES[name] for name in families))
    assert mirrored(laid.families)
    whole = float(laid.lengths(BODY).sum())
    for mesh in meshes(half=True):
        fibers = embed(mesh, BODY, laid)
        assert fibers.length @ fibers.share == pytest.approx(whole / 2, rel=ARCS)
        check(mesh, BODY, laid)


def test_a_balanced_set_on_half_a_mesh() -> None:
    laid = Ribbons((at(70, 6, 1), at(70, 6, -1), at(25, 3, 1), at(25, 3, -1)))
    for mesh in meshes(half=True):
        fibers = embed(mesh, BODY, laid)
        assert fibers.length.sum() == pytest.approx(laid.lengths(BODY).sum() / 2, rel=ARCS)


@pytest.mark.parametrize("name", ["85°", "70°, six", "30°, twelve", "2°, nine", "along, even"])
@pytest.mark.parametrize("half", [True, False])
def test_smeared_length_is_the_discrete_one(name: str, half: bool) -> None:
    family = FAMILIES[name]
    (expected,) = Ribbons((family,)).lengths(BODY)
    for mesh in meshes(half):
        fibers = smear(mesh, BODY, Ribbons((family,)))
        assert fibers.length.sum() == pytest.approx(expected / (2 if half else 1), rel=ARCS)
        tangent = np.einsum(
            "nij,nj->ni",
            jacobians(mesh, fibers.cell, fibers.points)[1][:, 0],
            fibers.tangents[:, 0],
        )
        up = tangent[:, 2] / np.linalg.norm(tangent, axis=1)
        assert up == pytest.approx(family.cosine, rel=0.02, abs=2e-2)


def test_smeared_around_the_wall_alone() -> None:
    # the smeared limit: hoops come nearer and nearer, the length goes to area over spacing
    mesh = hexahedral_body(BODY, MeshSize(axial=4, section=2, half=True))
    area = WALL * BODY.length
    for family in (at(60, 6), hoops(0.2, 0.5), along(S, 600)):
        bounded = dataclasses.replace(family, reach=WALL)
        fibers = smear(mesh, BODY, Ribbons((bounded,)))
        assert fibers.length.sum() == pytest.approx(area / family.spacing, rel=1e-4)
        assert fibers.s.max() < WALL
        assert fibers.density == pytest.approx(1 / family.spacing)
    (discrete,) = Ribbons((dataclasses.replace(hoops(0.2, 0.5), reach=WALL),)).lengths(BODY)
    assert discrete == pytest.approx(2 * area / 0.2, rel=1e-12)


def test_all_around_and_floor_alone_make_up_a_whole() -> None:
    mesh = hexahedral_body(BODY, MeshSize(axial=4, section=1, half=False))
    family = at(40, 5)
    whole = embed(mesh, BODY, Ribbons((family,)))
    wall = embed(mesh, BODY, Ribbons((dataclasses.replace(family, reach=WALL),)))
    under = np.minimum(whole.s, S - whole.s) > WALL
    assert wall.length.sum() + whole.length[under].sum() == pytest.approx(whole.length.sum())


def test_a_section_has_threads_along_the_axis_at_their_places() -> None:
    laid = Ribbons((placed(S, 0.0), placed(S, S / 2), placed(S, 9.0), placed(S, -9.0)))
    for half in (True, False):
        mesh = section_quadrilaterals(BODY, MeshSize(section=2, half=half))
        fibers, family = embed_families(mesh, BODY, laid)
        length = np.bincount(family, fibers.length, 4)
        assert length == pytest.approx([0.5, 0.5, 1, 0] if half else [1, 1, 1, 1])
        x = jacobians(mesh, fibers.cell, fibers.points)[0][:, 0]
        assert x == pytest.approx(position(BODY, fibers.s), abs=1e-3)
        assert fibers.axial == pytest.approx(1.0)
        assert not fibers.tangents.any()
        even = embed(mesh, BODY, Ribbons((along(S, 8),)))
        assert even.length.sum() == pytest.approx(4 if half else 8)
    with pytest.raises(ValueError, match="smeared windings only"):
        embed(mesh, BODY, Ribbons((at(60, 2),)))
    with pytest.raises(ValueError, match="place of its own"):
        smear(mesh, BODY, laid)


@pytest.mark.parametrize("name", ["double-helix", "single-helix-right"])
def test_a_pattern_is_its_families(name: str) -> None:
    winding = Winding(name, 7, 0.3)
    hands = (1, -1)[: len(winding.hands)]
    laid = Ribbons(
        tuple(dataclasses.replace(helix(S, 7, hand), width=0.3) for hand in hands), winding.lines
    )
    mesh = meshes(half=False)[0]
    one, other = embed(mesh, BODY, winding), embed(mesh, BODY, laid)
    for field in dataclasses.fields(one):
        assert np.array_equal(getattr(one, field.name), getattr(other, field.name))
    assert laid.lengths(BODY) == pytest.approx(curve_length(winding, BODY), rel=1e-12)


def test_starts_lie_in_a_slice_of_a_part_of_the_pitch() -> None:
    # n threads of pitch p in p/n are those in 2p/n, twice
    for family in (at(70, 6, phase=0.0), at(20, 5, -1, phase=0.0), hoops(2.0)):
        period, size = family.period, MeshSize(half=False)
        short = hexahedral_slice(BODY, size, period, 3)
        long = hexahedral_slice(BODY, size, 2 * period, 6)
        laid = Ribbons((dataclasses.replace(family, width=0.2),))
        lengths = [embed(mesh, BODY, laid).length.sum() for mesh in (short, long)]
        assert lengths[1] == pytest.approx(2 * lengths[0], rel=1e-9)
        assert lengths[0] == pytest.approx(5 * S * period / family.spacing, rel=2e-5)


def test_threads_of_a_family_have_curves_of_their_own() -> None:
    mesh = meshes(half=False)[0]
    laid = Ribbons((at(60, 3), hoops(4.0, 0.5), along(S, 2, 0.1)))
    fibers, family = embed_families(mesh, BODY, laid)
    assert [len(set(fibers.curve[family == i].tolist())) for i in range(3)] == [3, 10, 2]
    assert len(set(fibers.curve.tolist())) == 15
    # along a curve each piece goes on where the last one ended
    for curve in set(fibers.curve[family < 2].tolist()):
        mine = fibers.curve == curve
        around, up = fibers.s[mine], fibers.z[mine]
        assert np.all(np.diff(up) >= 0)
        assert np.all((np.diff(up) > 0) | (np.diff(around) > 0))
    drawn = laid.curves(BODY, 24)
    assert len(drawn) == 15
    for i, line in enumerate(drawn):
        steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
        assert steps.max() < 6 or i >= 13
    total = sum(float(np.linalg.norm(np.diff(c, axis=0), axis=1).sum()) for c in drawn)
    assert total == pytest.approx(laid.lengths(BODY).sum(), rel=0.02)


def test_threads_around_a_part_are_drawn_there() -> None:
    reach = dataclasses.replace(at(60, 3), reach=WALL)
    drawn = Ribbons((reach,)).curves(BODY, 96)
    total = sum(float(np.linalg.norm(np.diff(c, axis=0), axis=1).sum()) for c in drawn)
    assert total == pytest.approx(float(Ribbons((reach,)).lengths(BODY)[0]), rel=5e-3)
    low = BODY.outline_bottom
    assert all(line[:, 1].min() > low - 1e-9 for line in drawn)


@pytest.mark.parametrize("reach", [math.inf, WALL], ids=["all around", "wall"])
@pytest.mark.parametrize("half", [True, False])
def test_threads_close_at_corners_and_at_the_seam(half: bool, reach: float) -> None:
    families = [dataclasses.replace(FAMILIES[name], reach=reach) for name in FAMILIES]
    for mesh in meshes(half):
        for family in families[:-1]:
            assert len(open_threads(mesh, BODY, Ribbons((family,)))) == 0
    mesh = meshes(half=False)[0]
    whole = Ribbons((hoops(3.0, 0.3), at(70, 6)))
    fibers = embed(mesh, BODY, whole)
    # hoops are closed: both ends of six threads are left
    assert len(loose_ends(mesh, fibers)[0]) == 12
    torn = Ribbons((at(70, 6), dataclasses.replace(at(70, 6, -1), spacing=2.5, threads=1)))
    assert len(open_threads(mesh, BODY, torn)) > 0
    with pytest.raises(MeshError, match="a thread does not go on at x = "):
        check(mesh, BODY, torn)


def test_angles_and_pitches() -> None:
    for angle in (0.05, 0.5, 1.2, 1.5):
        pitch = pitch_at(angle, S)
        assert angle_at(pitch, S) == pytest.approx(angle, rel=1e-12)
        family = helix(S, pitch, 1, 4)
        assert family.spacing == pytest.approx(S * math.cos(angle) / 4)
        assert family.period == pytest.approx(pitch / 4)
        assert np.dot(family.tangent, family.normal) == pytest.approx(0, abs=1e-15)
    assert pitch_at(0.0, S) == math.inf
    assert pitch_at(UPRIGHT, S) == 0.0


def test_the_least_length_after_which_all_repeat() -> None:
    assert common_period([helix(S, 12, 1, 4), helix(S, 3, -1)]) == pytest.approx(3)
    assert common_period([helix(S, 10, 1), hoops(2.5)]) == pytest.approx(10)
    assert common_period([helix(S, 10, 1), hoops(4)]) == pytest.approx(20)
    assert common_period([helix(S, 10, 1), hoops(3.1)]) is None
    assert common_period([along(S, 3), placed(S, 1)]) == math.inf
    assert common_period([along(S, 3), helix(S, 6, 1, 2)]) == pytest.approx(3)
    odd = [helix(S, 10, 1), hoops(3.1)]
    first, nearest = nearest_periods(odd, 1)
    assert first == pytest.approx(10 / 3)
    assert abs(nearest - 3.1) < abs(first - 3.1)
    for period in (first, nearest):
        assert common_period([odd[0], hoops(period)]) is not None
    assert nearest_periods([hoops(3.0)], 0) == []


@pytest.mark.parametrize(
    ("families", "across", "origin"),
    [
        ([at(70, 6, 1), at(70, 6, -1)], True, 0.1),
        ([helix(S, 9, 1), helix(S, 9, -1)], True, 0.0),
        ([helix(S, 9, 1)], False, 0.0),
        ([helix(S, 9, 1, phase=0.25)], False, 2.25),
        ([helix(S, 9, 1), helix(S, 9, -1, phase=0.5)], False, 0.0),
        ([helix(S, 9, 1), helix(S, 9, -1, phase=0.2)], False, None),
        ([helix(S, 9, 1, phase=0.2), helix(S, 9, 1, phase=0.4)], False, 2.7),
        ([helix(S, 9, 1, 3), helix(S, 9, -1, 2)], False, 0.0),
        ([helix(S, 9, 1), helix(S, 9, -1), hoops(3, 0.5)], True, 0.0),
        ([helix(S, 9, 1), helix(S, 9, -1), hoops(3, 0.2)], True, None),
        ([placed(S, 4), placed(S, -4)], True, 0.0),
        ([placed(S, 4), placed(S, -5)], False, None),
        ([along(S, 5)], True, 0.0),
        ([along(S, 5, 0.03)], False, None),
    ],
)
def test_symmetry(families: list[Family], across: bool, origin: float | None) -> None:
    assert mirrored(families) is across
    found = twofold(families)
    if origin is None:
        assert found is None
        return
    assert found is not None
    whole = common_period(families)
    assert whole is not None
    if families[0].angle == math.radians(70):
        origin = 0.1 * pitch_at(families[0].angle, S)
        away = (found - origin) / (families[0].period / 2)
        assert abs(away - round(away)) < 1e-9
        return
    assert found == pytest.approx(origin, abs=1e-9)


def test_smeared_symmetry_is_that_of_directions() -> None:
    skew = [helix(S, 9, 1), helix(S, 9, -1, phase=0.2), hoops(3, 0.3)]
    assert mirrored(skew, smeared=True)
    assert twofold(skew, smeared=True) == 0.0
    assert not mirrored([helix(S, 9, 1), helix(S, 9.1, -1)], smeared=True)
    other = [helix(S, 9, 1), dataclasses.replace(helix(S, 9, -1), thread=1)]
    assert not mirrored(other, smeared=True)
    assert not mirrored([placed(S, 3)], smeared=True)
    assert twofold([placed(S, 3)], smeared=True) is None


def test_distance_of_two_families_side_by_side() -> None:
    assert least_distance(hoops(4.0), hoops(4.0, 0.25)) == pytest.approx(1)
    assert least_distance(hoops(4.0), hoops(2.0, 0.5)) == pytest.approx(1)
    assert least_distance(hoops(3.0), hoops(2.0, 0.5)) == pytest.approx(0)
    assert least_distance(hoops(3.0), hoops(2.0, 0.25)) == pytest.approx(0.5)
    assert least_distance(hoops(3.0), hoops(math.pi)) == 0.0
    assert least_distance(placed(S, 1), placed(S, S - 1)) == pytest.approx(2)


def test_families_without_meaning_are_refused() -> None:
    with pytest.raises(ValueError, match="angle"):
        Family(2.0, 1, 1.0)
    for angle, hand in ((0.5, 0), (0.0, 1), (UPRIGHT, -1)):
        with pytest.raises(ValueError, match="hand"):
            Family(angle, hand, 1.0)
    with pytest.raises(ValueError, match="spacing"):
        hoops(0.0)
    with pytest.raises(ValueError, match="width"):
        dataclasses.replace(hoops(3.0), width=-1.0)
    with pytest.raises(ValueError, match="at least one family"):
        Ribbons(())
    with pytest.raises(ValueError, match="lines 0"):
        Ribbons((hoops(3.0),), 0)
    with pytest.raises(ValueError, match="some have none"):
        Ribbons((hoops(3.0), dataclasses.replace(hoops(3.0), width=0.1)))


def test_a_surface_that_begins_further_up() -> None:
    laid = Ribbons((at(70, 2), hoops(3.0)))
    mesh = hexahedral_slice(BOX, MeshSize(half=False), 6.0, 4)
    assert laid.turned(0.0) is laid
    moved = laid.turned(1.2)
    one, other = embed(mesh, BOX, laid), embed(mesh, BOX, moved)
    hoop = one.curve >= 2, other.curve >= 2
    assert set(np.round(one.z[hoop[0]], 9)) == {0.0, 3.0, 6.0}
    assert set(np.round(other.z[hoop[1]], 9)) == {1.8, 4.8}
