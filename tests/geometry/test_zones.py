"""Zones along a body: planes of nodes at borders, regions by zone, windings put together."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from geometry.bodies.counts import body_counts
from geometry.bodies.extrude import hexahedral_body
from geometry.bodies.gmsh_body import build_body
from geometry.bodies.zones import joined, with_regions, wound_part
from geometry.mesh.data import MeshData
from geometry.mesh.reference import determinants
from geometry.sections.size import MeshSize, in_unit
from geometry.sections.table import make_actuator
from geometry.winding.embed import embed
from geometry.winding.helix import Winding

ACTUATOR = make_actuator(
    {"section": "hemicircle", "radius": 8.0, "length": 40.0, "wall": 2.0, "floor": 2.0, "cap": 6.0}
)
BORDERS = (13.0, 27.5)
SIZE = MeshSize(axial=4.0, borders=BORDERS)


def crossing(mesh: MeshData, plane: float) -> int:
    """Cells with nodes on both sides of a plane."""
    z = mesh.nodes[mesh.cells, 2] - plane
    return int(np.sum((z.min(axis=1) < -1e-9) & (z.max(axis=1) > 1e-9)))


@pytest.mark.parametrize("element", ["hexahedron", "tetrahedron"])
def test_no_element_crosses_a_border(element: str) -> None:
    mesh = build_body(ACTUATOR, dataclasses.replace(SIZE, element=element))
    assert [crossing(mesh, border) for border in BORDERS] == [0, 0]
    assert determinants(mesh).min() > 0


def test_the_mesh_of_gmsh_is_that_of_the_blocks_and_has_the_counts() -> None:
    swept, meshed = hexahedral_body(ACTUATOR, SIZE), build_body(ACTUATOR, SIZE)
    counts = body_counts(ACTUATOR, SIZE)
    assert len(swept.cells) == len(meshed.cells) == counts.cells
    assert len(swept.nodes) == len(meshed.nodes) == counts.nodes
    assert set(swept.facets) == set(meshed.facets)
    for name, pairs in swept.facets.items():
        assert len(pairs) == len(meshed.facets[name]), name


def test_without_borders_nothing_is_another() -> None:
    plain = dataclasses.replace(SIZE, borders=())
    assert plain == MeshSize(axial=4.0)
    assert in_unit(SIZE, 10.0).borders == (1.3, 2.75)


def test_regions_of_zones_have_their_volumes() -> None:
    mesh = hexahedral_body(ACTUATOR, SIZE)
    named = with_regions(mesh, BORDERS, [{}, {"floor": "floor_2"}, {"floor": "floor_3"}])
    assert set(named.regions) == {"wall", "floor", "floor_2", "floor_3"}
    z = named.nodes[named.cells, 2].mean(axis=1)
    low = {"floor": -6.0, "floor_2": 13.0, "floor_3": 27.5}
    high = {"floor": 13.0, "floor_2": 27.5, "floor_3": 46.0}
    for name, start in low.items():
        here = z[named.cell_region == named.regions[name]]
        assert here.min() > start
        assert here.max() < high[name]
    wall = mesh.cell_region == mesh.regions["wall"]
    assert np.array_equal(wall, named.cell_region == named.regions["wall"])


def test_a_region_that_no_zone_leaves_is_gone() -> None:
    mesh = hexahedral_body(ACTUATOR, SIZE)
    named = with_regions(mesh, BORDERS, [{"floor": f"floor_{n}"} for n in (1, 2, 3)])
    assert set(named.regions) == {"wall", "floor_1", "floor_2", "floor_3"}
    assert sorted(named.regions.values()) == [0, 1, 2, 3]


def test_windings_of_zones_are_as_long_as_their_zones() -> None:
    mesh = hexahedral_body(ACTUATOR, dataclasses.replace(SIZE, half=False))
    bounds = (0.0, *BORDERS, ACTUATOR.length)
    pieces, expected = [], 0.0
    for number, pitch in enumerate((3.0, 5.0, 4.0)):
        length = bounds[number + 1] - bounds[number]
        zone = dataclasses.replace(ACTUATOR, length=length)
        winding = Winding("double-helix", pitch, 0.0, 1)
        part = wound_part(mesh, BORDERS, number, ("winding",))
        pieces.append((embed(part, zone, winding), bounds[number], float(number)))
        expected += 2 * length / pitch * winding.turn_length(zone)
    fibers, own = joined(pieces)
    assert fibers.length @ fibers.share == pytest.approx(expected, rel=2e-3)
    assert np.array_equal(np.searchsorted(BORDERS, fibers.z), own)
    order = np.lexsort((fibers.z, fibers.curve))
    assert np.array_equal(order, np.arange(len(order)))
