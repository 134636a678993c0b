"""Turns of a body's centre-line and sections: exact on screws, unwrapped, differentiated."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest

from analytic.path import CentreLine as Exact
from fem.kinematics.body import Body
from fem.kinematics.domain import Domain
from fem.results.centre_line import BendingAngle, CentreLine
from geometry.bodies.extrude import hexahedral_body
from geometry.mesh.centroid import winding_weights
from geometry.mesh.data import MeshData
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.circle import CircleActuator
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize
from tests.fem.parts import Floats

FINGER = HemicircleActuator(radius=8.0, length=120.0, wall=2.0, floor=2.0, sheath=1.0, cap=15.0)
TUBE = CircleActuator(radius=8.0, length=60.0, wall=1.0, cap=5.0)
PLANE = (np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))


@functools.cache
def _mesh(half: bool = False, tetrahedra: bool = False) -> MeshData:
    mesh = hexahedral_body(FINGER, MeshSize(axial=8, section=1, half=half))
    return to_tetrahedra(mesh) if tetrahedra else mesh


def _body(mesh: MeshData, placed: Floats) -> Body:
    body = Body(Domain(mesh), ["u"])
    body.set_displacement((placed - mesh.nodes)[body.owned_nodes])
    return body


def _screw(mesh: MeshData, spin: Floats) -> tuple[Body, Floats, float]:
    """A body that bends and twists evenly; its turns from z = 0 to z = L, rad; its stretch."""
    rest = winding_weights(mesh)[1]
    line = Exact.of(spin, 1.05, np.array([*rest, 0.0]), *PLANE)
    position = mesh.nodes * [1.0, 1.0, 0.0]
    rotation, centre = line.turning(mesh.nodes[:, 2])
    placed = centre + np.einsum("nij,nj->ni", rotation, position - line.centre)
    return _body(mesh, placed), line.rates * FINGER.length, line.stretch


@pytest.mark.parametrize("tetrahedra", [False, True])
@pytest.mark.parametrize("degrees", [(100.0, 45.0), (-30.0, 800.0), (0.0, -900.0), (500.0, -40.0)])
def test_a_screw_turns_by_its_rates(degrees: tuple[float, float], tetrahedra: bool) -> None:
    # counted beyond half turns of bend and beyond several turns of twist
    bend, twist = np.radians(degrees) / FINGER.length
    body, exact, stretch = _screw(_mesh(tetrahedra=tetrahedra), np.array([bend, 0.0, twist]))
    line = CentreLine(body)
    assert line.stretch() == pytest.approx(stretch, rel=3e-3)
    assert line.middle_stretch() == pytest.approx(stretch, rel=3e-3)
    error = 3e-3 * np.abs(exact).max()
    assert line.turns() == pytest.approx(exact, abs=error)
    assert line.middle() == pytest.approx(exact, abs=error)


def test_the_middle_half_has_a_stretch_of_its_own() -> None:
    mesh = _mesh()
    placed, length, more = mesh.nodes.copy(), FINGER.length, 0.3
    placed[:, 2] += more / length**2 * (mesh.nodes[:, 2] - length / 2) ** 3
    line = CentreLine(_body(mesh, placed))
    assert line.stretch() == pytest.approx(1 + more / 4, rel=1e-6)
    assert line.middle_stretch() == pytest.approx(1 + more / 16, rel=1e-6)


def test_mirrored_it_twists_the_other_way() -> None:
    mesh = _mesh()
    body, *_ = _screw(mesh, np.array([0.012, 0.0, 0.02]))
    found = CentreLine(body).turns()
    # aside too: bent about y
    u = body.displacement()
    u[:, 0] += 2e-3 * mesh.nodes[body.owned_nodes, 2] ** 2
    body.set_displacement(u)
    aside = CentreLine(body).turns()
    assert abs(aside[1] - found[1]) > 0.1
    # the mirror image across x = 0 of the deformed body, on nodes that have images themselves
    image = {tuple(np.round(x, 6)): i for i, x in enumerate(mesh.nodes)}
    order = [image[tuple(np.round(x * [-1, 1, 1] + 0.0, 6))] for x in mesh.nodes]
    whole = np.empty_like(mesh.nodes)
    whole[body.owned_nodes] = body.displacement()
    body.set_displacement((whole[order] * [-1, 1, 1])[body.owned_nodes])
    mirrored = CentreLine(body).turns()
    assert mirrored == pytest.approx(aside * [1, -1, -1], abs=1e-10)


def test_a_bend_to_the_side_is_the_side_angle() -> None:
    mesh, turn = _mesh(), np.radians(70) / FINGER.length
    x, y, z = mesh.nodes.T
    # positive about y, from z toward x
    radius = 1 / turn + x
    placed = np.column_stack(
        [radius * np.cos(-turn * z) - 1 / turn, y, -radius * np.sin(-turn * z)]
    )
    sign = np.sign(placed[np.argmax(z), 0] - x[np.argmax(z)])
    found = np.degrees(CentreLine(_body(mesh, placed)).turns())
    assert found == pytest.approx([0.0, sign * 70.0, 0.0], abs=1e-6)
    assert sign < 0


@pytest.mark.parametrize("least", [0.3, 0.0, -0.6])
def test_a_section_that_collapses_turns_nothing_over(least: float) -> None:
    # the middle is flattened, or pushed through itself, as under a vacuum without self-contact;
    # a fit of its own plane then flips, and the angle of the ends lost a full turn
    mesh = hexahedral_body(TUBE, MeshSize(axial=6, section=1, half=True))
    angle = np.radians(40.0)
    x, y, z = mesh.nodes.T
    r = TUBE.radius + TUBE.wall
    dent = np.clip(1 - np.abs(z / TUBE.length - 0.5) / 0.4, 0, 1)
    dent = dent**2 * (3 - 2 * dent)
    y = r + (y - r) * (1 - (1 - least) * dent)
    x = x * (1 + 0.3 * dent)
    k = angle / TUBE.length
    placed = np.column_stack(
        [x, y * np.cos(k * z) - (1 - np.cos(k * z)) / k, (y + 1 / k) * np.sin(k * z)]
    )
    line = CentreLine(_body(mesh, placed))
    assert BendingAngle(line).value() == pytest.approx(angle, abs=1e-9)
    assert line.middle()[0] == pytest.approx(angle, rel=0.1)


def test_half_a_body_is_the_whole_one() -> None:
    spin = np.array([np.radians(130) / FINGER.length, 0.0, 0.0])
    half, whole = (CentreLine(_screw(_mesh(half=half), spin)[0]) for half in (True, False))
    assert half.turns() == pytest.approx(whole.turns(), abs=1e-9)
    assert half.turns()[1:] == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("half", [False, True])
def test_nodes_that_lie_in_no_planes_change_nothing(half: bool) -> None:
    # as gmsh's tetrahedra have them: a station has more nodes above its centroid, or below
    mesh = _mesh(half=half, tetrahedra=True)
    x, y, z = mesh.nodes.T
    inside = np.where((z > 0) & (z < FINGER.length), np.sin(np.pi * z / FINGER.length), 0.0)
    wave = 2.5 * np.sin(1.1 * y) * np.sin(0.3 * z) * inside
    uneven = dataclasses.replace(mesh, nodes=np.column_stack([x, y, z + wave]))
    for degrees in (1e-6, 130.0):
        body, exact, _ = _screw(uneven, np.array([np.radians(degrees) / FINGER.length, 0.0, 0.0]))
        line = CentreLine(body)
        assert line.turns() == pytest.approx(exact, abs=1e-6)
        assert line.middle() == pytest.approx(exact, abs=1e-4)


@pytest.mark.parametrize("half", [False, True])
def test_row_is_the_gradient_of_the_angle(half: bool) -> None:
    # the border of Newton under a prescribed angle, of a body that twists
    body, *_ = _screw(_mesh(half=half), np.array([0.03, 0.0, 0.0 if half else 0.04]))
    line = CentreLine(body)
    angle, w = BendingAngle(line), body.w.x.array
    w += np.random.default_rng(3).uniform(-0.1, 0.1, len(w))
    base, row = w.copy(), angle.row()
    v = row / np.abs(row).max() + np.random.default_rng(4).uniform(-1, 1, len(w))
    values = []
    for k in (-2, -1, 1, 2):
        w[:] = base + k * 1e-3 * v
        values.append(angle.value())
    slope = (8 * (values[2] - values[1]) - (values[3] - values[0])) / 12e-3
    assert float(row @ v) == pytest.approx(slope, rel=1e-9)
    assert angle.slope("pressure") == 0.0


def test_centroid_moves_with_any_even_deformation() -> None:
    mesh = _mesh()
    weights, rest = winding_weights(mesh)
    area = np.pi * 10.0**2 / 2 + 20.0 * 2.0
    assert weights.sum() == pytest.approx(area * FINGER.length, rel=1e-3)
    height = (np.pi * 50.0 * (2 + 40 / (3 * np.pi)) + 40.0 * 1.0) / area
    assert rest == pytest.approx([0.0, height], abs=2e-3)
    A = np.eye(3) + np.random.default_rng(1).uniform(-0.3, 0.3, (3, 3))
    moved = weights @ (mesh.nodes @ A.T) / weights.sum()
    assert moved == pytest.approx(A @ [*rest, FINGER.length / 2], abs=1e-9)
