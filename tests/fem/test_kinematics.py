"""Volumes, det F, node numbers and areas, under maps and meshes without special directions."""

from __future__ import annotations

import numpy as np
import pytest

from fem.effects.chamber_pressure import ChamberPressure
from fem.kinematics.body import Body
from fem.kinematics.domain import Domain
from fem.scene import Scene
from geometry.checks import surface_area
from geometry.mesh.reference import area_vectors
from tests.fem.parts import CELLS, STUB, Floats, law, sector, set_positions, stub

RNG = np.random.default_rng(11)


def _general() -> Floats:
    """A random map without any symmetry, det > 0."""
    A = np.eye(3) + RNG.uniform(-0.45, 0.45, (3, 3))
    return A if np.linalg.det(A) > 0 else _general()


def _keeps_x_zero() -> Floats:
    """Random, but the plane x = 0 stays: what the open half of a chamber admits."""
    A = _general()
    A[0, 1:] = 0.0
    return A


def _keeps_planes() -> Floats:
    """Random, but x = 0 stays and planes y, z = const stay parallel to x: for the tube's ends."""
    A = _keeps_x_zero()
    A[1:, 0] = 0.0
    return A


def _pressure_scene(domain: Domain, surface: str) -> Scene:
    return Scene(domain, [ChamberPressure(surface)])


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize(
    ("which", "make"), [("whole", _general), ("half", _keeps_x_zero), ("tube", _keeps_planes)]
)
def test_cavity_volume_scales_by_the_determinant(cell: str, which: str, make: object) -> None:
    # a wrong cofactor once hid because only rotations about x were tried
    if which == "tube":
        domain, surface = sector(cell), "inner"
    else:
        domain, surface = stub(cell, which == "half"), "chamber"
    scene = _pressure_scene(domain, surface)
    scene.set(scene.w.copy())
    rest = scene.conjugate("pressure")
    exact = {"whole": STUB.chamber_volume, "half": STUB.chamber_volume / 2, "tube": 48 * np.pi}
    # two quadratic elements on a quarter circle miss its area by 1.3e-3
    assert rest == pytest.approx(exact[which], rel=3e-3)
    for _ in range(5):
        A = make()  # type: ignore[operator]
        set_positions(scene, domain.data.nodes @ A.T + [0.0 if which != "whole" else 3, 5, -4])
        volume = np.linalg.det(A) * rest
        assert scene.conjugate("pressure") == pytest.approx(volume, rel=1e-12)
        assert scene.det_f() == pytest.approx(np.linalg.det(A), rel=1e-11)


@pytest.mark.parametrize("cell", CELLS)
def test_least_det_f_finds_the_inverted_element(cell: str) -> None:
    # the march cuts its step on this number alone
    scene = _pressure_scene(sector(cell), "inner")
    x = sector(cell).data.nodes.copy()
    x[:, 2] *= 1 - 0.1 * x[:, 2] ** 2
    set_positions(scene, x)
    assert scene.det_f() < 0


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("field", ["u", "p"])
def test_dofs_follow_input_numbers(cell: str, field: str) -> None:
    # dolfinx renumbers nodes and cells; the coordinates it keeps itself are the witness
    domain = stub(cell)
    body = Body(domain, ["u", "p"])
    component = 3 if field == "p" else 0
    for i in range(component, 4 if field == "p" else 3):
        collapsed, parent = body.space.sub(i).collapse()
        place = np.full((body.local, 3), np.nan)
        place[np.asarray(parent)] = collapsed.tabulate_dof_coordinates()
        if field == "u":
            assert place[body.node_dofs[:, i]] == pytest.approx(domain.data.nodes, abs=1e-12)
            cells = domain.data.nodes[domain.data.cells[domain.cells]]
            assert place[body.cell_dofs[:, :, i]] == pytest.approx(cells, abs=1e-12)
        elif cell == "tetrahedron":
            vertices = domain.data.nodes[domain.data.cells[domain.cells][:, :4]]
            assert place[body.dofs("p")[:, :, 0]] == pytest.approx(vertices, abs=1e-12)


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("surface", ["chamber", "section_tip", "tip", "outer"])
def test_surface_weights_add_up_to_areas_and_moments(cell: str, surface: str) -> None:
    # tip and angle are weighted by them; two quadratures of a curved area agree to 1e-6
    domain = stub(cell)
    weights = domain.surface_weights(surface)
    x, vectors = area_vectors(domain.data, surface)
    areas = np.linalg.norm(vectors, axis=2)
    assert weights.sum() == pytest.approx(surface_area(domain.data, surface), rel=1e-6)
    moment = np.einsum("kq,kqi->i", areas, x)
    scale = weights.sum() * 10
    assert weights @ domain.data.nodes == pytest.approx(moment, abs=1e-6 * scale)
    away = np.setdiff1d(np.arange(len(weights)), domain.surface_nodes(surface))
    assert not weights[away].any()


def test_a_scene_of_one_law_has_no_pressure_field() -> None:
    # fields exist only when an effect asks for them
    body = Scene(sector("hexahedron"), [law("neo-hooke", ["solid"])]).body
    assert body.names == ["u"]
    assert body.size == 3 * len(sector("hexahedron").data.nodes)
    with pytest.raises(KeyError):
        _ = body.p
