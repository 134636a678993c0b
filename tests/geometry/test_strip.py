"""A strip of fabric on the outline: where it lies, and how much of it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from geometry.bodies.extrude import hexahedral_body, hexahedral_slice, section_quadrilaterals
from geometry.mesh.data import MeshData
from geometry.mesh.reference import jacobians
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.circle import CircleActuator
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.size import MeshSize
from geometry.winding.outline import position
from geometry.winding.segments import push
from geometry.winding.strip import Window, arc_at, lay

TUBE = CircleActuator(radius=8, length=24, wall=2, cap=5)
HALF_DISK = HemicircleActuator(radius=8, length=24, wall=2, floor=2, sheath=1, cap=5)
BOX = RectangleActuator(width=12, height=10, length=24, wall=2, floor=2, cap=5)


def _mesh(
    kind: str, actuator: CircleActuator | HemicircleActuator | RectangleActuator, half: bool = False
) -> MeshData:
    size = MeshSize(axial=8, section=1, half=half)
    if kind == "section":
        return section_quadrilaterals(actuator, size)
    if kind == "cell":
        return hexahedral_slice(actuator, size, 3.0, 2)
    body = hexahedral_body(actuator, size)
    return to_tetrahedra(body) if kind == "tetrahedra" else body


LENGTH = {"section": 1.0, "cell": 3.0, "body": 24.0, "tetrahedra": 24.0}


@pytest.mark.parametrize("middle", [0.0, 0.3, 0.5, 0.77])
@pytest.mark.parametrize("width", [0.9, 4.0, 17.0])
@pytest.mark.parametrize("kind", LENGTH)
def test_its_area_is_that_of_the_window_whatever_the_mesh(
    kind: str, middle: float, width: float
) -> None:
    # straight sides, so that the mesh has the very outline; windows end within facets
    mesh = _mesh(kind, BOX)
    laid = lay(mesh, BOX, Window(middle * BOX.winding_perimeter, width))
    for thread in (0, 1):
        area = laid.length[laid.curve == thread].sum()
        assert area == pytest.approx(width * LENGTH[kind], rel=1e-9)


@pytest.mark.parametrize("kind", LENGTH)
def test_half_a_mesh_has_half_of_a_strip_in_the_middle(kind: str) -> None:
    for middle in (0.0, HALF_DISK.winding_perimeter / 2):
        window = Window(middle, 5.0)
        whole, half = (
            lay(_mesh(kind, HALF_DISK, part), HALF_DISK, window).length.sum()
            for part in (False, True)
        )
        assert half == pytest.approx(whole / 2, rel=1e-9)


def test_on_an_arc_the_area_converges_with_the_mesh() -> None:
    # The quadratic edge of an arc of the angle 2 φ is as long as the arc but for φ⁴. Within it arc
    # length runs unevenly, by R φ³ (ξ − ξ³)/6 at −1 ≤ ξ ≤ 1, which is at most R φ³/(9 √3): so much
    # is each end of a window off that lies within an edge, wherever it lies.
    perimeter, radius = TUBE.winding_perimeter, TUBE.outline_half_width
    whole, worst = [], []
    for number in (1, 2, 4, 8):
        mesh = section_quadrilaterals(TUBE, MeshSize(section=number, half=False))
        whole.append(lay(mesh, TUBE, Window(0.0, perimeter)).length.sum() / 2 / perimeter - 1)
        windows = [Window(middle, 4.1) for middle in np.linspace(0.0, perimeter, 97)]
        off = [lay(mesh, TUBE, window).length.sum() / 2 - window.width for window in windows]
        worst.append(np.abs(off).max())
        half_angle = perimeter / len(mesh.facets["winding"]) / radius / 2
        assert worst[-1] < 1.02 * 2 * radius * half_angle**3 / (9 * math.sqrt(3))
    assert abs(whole[0]) < 3e-5
    assert abs(whole[-1]) < 1e-8
    assert np.log2(np.divide(whole[:-1], whole[1:])) == pytest.approx(4, abs=0.02)
    assert np.log2(worst[-2] / worst[-1]) > 2.3


@pytest.mark.parametrize("kind", LENGTH)
def test_warp_runs_along_the_axis_and_weft_around(kind: str) -> None:

    mesh = _mesh(kind, BOX)
    laid = lay(mesh, BOX, Window(5.0, 8.0))
    moved = push(mesh, laid.cell, laid.points, laid.tangents)
    size = np.hypot(np.linalg.norm(moved, axis=2), laid.axial)
    assert np.sum(laid.weights * size, axis=1) == pytest.approx(laid.length, rel=1e-9)
    rise = laid.axial if kind == "section" else moved[..., 2]
    wanted = np.broadcast_to(np.where(laid.curve == 0, 1.0, 0.0)[:, None], rise.shape)
    assert rise / size == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("kind", ["section", "cell", "body"])
@pytest.mark.parametrize("middle", [5.0, 0.0])
def test_points_on_one_line_around_a_facet_are_one_piece_of_weft(kind: str, middle: float) -> None:
    mesh = _mesh(kind, TUBE)
    laid = lay(mesh, TUBE, Window(middle, 8.0))
    place = jacobians(mesh, laid.cell, laid.points)[0]
    spread = np.ptp(place, axis=1)
    warp = laid.curve == 0
    assert warp.sum() == 3 * (~warp).sum()
    assert np.abs(spread[warp]).max() < 1e-9
    assert np.linalg.norm(spread[~warp], axis=1).min() > 1e-3
    if kind != "section":
        assert np.abs(spread[~warp, 2]).max() < 1e-9


@pytest.mark.parametrize("actuator", [TUBE, HALF_DISK, BOX], ids=lambda a: a.section)
def test_a_ray_meets_the_outline(actuator: CircleActuator) -> None:
    perimeter = actuator.winding_perimeter
    middle = (actuator.outline_top + actuator.outline_bottom) / 2
    assert arc_at(actuator, 0.0) == 0.0
    assert arc_at(actuator, math.pi) == pytest.approx(perimeter / 2)
    for angle in (0.3, 1.2, math.pi / 2, 2.8):
        s = arc_at(actuator, angle)
        x, y = position(actuator, np.array([s]))[0]
        assert math.atan2(x, y - middle) == pytest.approx(angle, abs=1e-9)
        assert arc_at(actuator, -angle) == pytest.approx(perimeter - s)
    if actuator is TUBE:
        assert arc_at(TUBE, math.pi / 2) == pytest.approx(perimeter / 4)


def test_a_window_may_lie_over_the_top() -> None:
    assert Window(1.0, 4.0).intervals(10.0) == [(0.0, 3.0), (9.0, 10.0)]
    assert Window(5.0, 4.0).intervals(10.0) == [(3.0, 7.0)]
