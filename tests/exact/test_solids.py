"""Solids for exact solutions: exact volumes, converging with order 4, positive Jacobians."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from geometry.checks import region_volumes, surface_area
from geometry.mesh.data import MeshData
from geometry.mesh.reference import determinants
from geometry.mesh.tets import to_tetrahedra
from tests.exact.solids import (
    box,
    cylinder,
    sphere_octant,
    tube_sector,
)


def _tube(n: int) -> MeshData:
    return tube_sector(8, 10, math.pi / 2, 3, (n, 2 * n, 1))


def _bar(n: int) -> MeshData:
    return cylinder(10, 5, n, 1, quarter=True)


def _full_bar(n: int) -> MeshData:
    return cylinder(10, 5, n, 1, quarter=False)


def _hollow(n: int) -> MeshData:
    return sphere_octant(6, 10, (n, n))


SOLIDS = [
    (_tube, 27 * math.pi),
    (_bar, 125 * math.pi),
    (_full_bar, 500 * math.pi),
    (_hollow, math.pi / 6 * (10**3 - 6**3)),
]


@pytest.mark.parametrize(("build", "volume"), SOLIDS)
@pytest.mark.parametrize("split", [False, True])
def test_volume_converges_with_the_order_of_the_arcs(
    build: Callable[[int], MeshData], volume: float, split: bool
) -> None:
    # h⁴ is the order-2 geometry's; less would spoil the rates of the exact solutions
    meshes = [to_tetrahedra(build(n)) if split else build(n) for n in (1, 2, 4)]
    assert all(determinants(mesh).min() > 0 for mesh in meshes)
    errors = [abs(region_volumes(mesh)["solid"] / volume - 1) for mesh in meshes]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert rates == pytest.approx([4, 4], abs=0.2)


def test_arc_nodes_lie_on_the_circle() -> None:
    for mesh, name, radius in ((_tube(2), "inner", 8), (_full_bar(2), "outer", 10)):
        x = mesh.nodes[mesh.facet_nodes(name)]
        assert np.hypot(x[..., 0], x[..., 1]) == pytest.approx(radius, abs=1e-12)


def test_box_faces() -> None:
    mesh = box((1, 2, 3), (1, 2, 2))
    areas = {name: surface_area(mesh, name) for name in mesh.facets}
    assert areas == pytest.approx(
        {"left": 6, "right": 6, "front": 3, "back": 3, "bottom": 2, "top": 2}
    )
    assert len(mesh.nodes) == 3 * 5 * 5


def test_full_cylinder_is_watertight() -> None:
    # four quarters made separately must share their nodes
    mesh = _full_bar(2)
    layer = 4 * 3 * 2**2
    assert len(mesh.cells) == layer
    assert len(mesh.nodes) == 3 * (4 * layer + 1 + 8 * 2)


def test_octant_of_a_sphere() -> None:
    # its planes are mirrors of a sphere, and a pressure acts on its inner side
    mesh = sphere_octant(6, 10, (2, 3))
    for name, radius in (("inner", 6), ("outer", 10)):
        assert np.linalg.norm(mesh.nodes[mesh.facet_nodes(name)], axis=-1) == pytest.approx(radius)
    for axis, name in enumerate(("left", "front", "bottom")):
        assert len(mesh.facets[name]) == 2 * 2 * 3
        assert np.abs(mesh.nodes[mesh.facet_nodes(name)][..., axis]).max() < 1e-12
