"""Shape functions and facet rules against basix, which the finite elements are made of."""

from __future__ import annotations

import basix
import numpy as np
import pytest

from geometry.bodies.extrude import hexahedral_body, section_quadrilaterals
from geometry.checks import surface_area
from geometry.mesh.data import (
    FACET_VERTICES,
    Floats,
    MeshData,
    facet_positions,
    reference_nodes,
    vertex_positions,
)
from geometry.mesh.reference import facet_rules, shape_functions, surface_weights
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize

CELLS = ("quadrilateral", "hexahedron", "tetrahedron")
DEGREE = {"quadrilateral": 5, "hexahedron": 5, "tetrahedron": 4}
"""Of the finite elements' measures."""
STUB = HemicircleActuator(radius=8, length=8, wall=2, floor=2, cap=4)
PLANE = ("clamp", "section_root", "section_tip", "tip")
CURVED = ("chamber", "winding", "outer")


def _basix(cell: str, points: Floats) -> tuple[Floats, Floats]:
    """Values (q, nodes) and gradients (q, nodes, d) of basix in the node order of `MeshData`."""
    element = basix.create_element(
        basix.ElementFamily.P, getattr(basix.CellType, cell), 2, basix.LagrangeVariant.equispaced
    )
    table = element.tabulate(1, points)[..., 0]
    gap = np.abs(reference_nodes(cell)[:, None] - element.points).sum(axis=2)
    order = gap.argmin(axis=1)
    assert gap.min(axis=1).max() < 1e-12
    return table[0][:, order], np.moveaxis(table[1:], 0, -1)[:, order]


def _mesh(cell: str) -> MeshData:
    size = MeshSize(axial=4, section=1, half=True)
    if cell == "quadrilateral":
        return section_quadrilaterals(STUB, size)
    mesh = hexahedral_body(STUB, size)
    return to_tetrahedra(mesh) if cell == "tetrahedron" else mesh


@pytest.mark.parametrize("cell", CELLS)
def test_shape_functions_are_those_of_the_finite_elements(cell: str) -> None:
    points = np.random.default_rng(3).random((40, reference_nodes(cell).shape[1]))
    values, gradients = shape_functions(cell, points)
    theirs = _basix(cell, points)
    assert values == pytest.approx(theirs[0], abs=1e-13)
    assert gradients == pytest.approx(theirs[1], abs=1e-13)
    assert values.sum(axis=1) == pytest.approx(np.ones(40))
    assert gradients.sum(axis=1) == pytest.approx(np.zeros_like(points), abs=1e-13)
    nodal = shape_functions(cell, reference_nodes(cell))[0]
    assert nodal == pytest.approx(np.eye(len(nodal)), abs=1e-14)


@pytest.mark.parametrize("cell", CELLS)
def test_facet_rules_integrate_polynomials_as_the_finite_elements_do(cell: str) -> None:
    vertices = reference_nodes(cell)[vertex_positions(cell)]
    points, weights, normals = facet_rules(cell)
    for facet, corners in enumerate(FACET_VERTICES[cell]):
        axes = (vertices[list(corners[1 : points.shape[2]])] - vertices[corners[0]]).T
        kind = {2: "interval", 3: "triangle", 4: "quadrilateral"}[len(corners)]
        flat, theirs = basix.make_quadrature(getattr(basix.CellType, kind), DEGREE[cell])
        at = vertices[corners[0]] + flat @ axes.T
        for power in range(DEGREE[cell] + 1):
            for i in range(points.shape[2]):
                other = points[facet][:, (i + 1) % points.shape[2]]
                mine = weights @ (points[facet][:, i] ** power * other ** (DEGREE[cell] - power))
                its = at[:, i] ** power * at[:, (i + 1) % points.shape[2]] ** (DEGREE[cell] - power)
                assert mine == pytest.approx(theirs @ its, abs=1e-14)
        outward = at.mean(axis=0) - vertices.mean(axis=0)
        assert normals[facet] @ outward > 0
        assert axes.T @ normals[facet] == pytest.approx(np.zeros(axes.shape[1]))


def _weights(mesh: MeshData, name: str) -> Floats:
    """∫ φ_a dA with the quadrature of the finite elements, facet by facet."""
    cell, total = mesh.cell_type, np.zeros(len(mesh.nodes))
    vertices = reference_nodes(cell)[vertex_positions(cell)]
    for number, facet in mesh.facets[name]:
        corners = vertices[list(FACET_VERTICES[cell][facet])]
        axes = (corners[1:3] - corners[0]).T
        kind = basix.CellType.triangle if len(corners) == 3 else basix.CellType.quadrilateral
        flat, quadrature = basix.make_quadrature(kind, DEGREE[cell])
        values, gradients = _basix(cell, corners[0] + flat @ axes.T)
        spans = np.einsum("ai,qad,de->qie", mesh.nodes[mesh.cells[number]], gradients, axes)
        area = np.linalg.norm(np.cross(spans[..., 0], spans[..., 1]), axis=1)
        on = facet_positions(cell)[facet]
        np.add.at(total, mesh.cells[number][on], (area * quadrature) @ values[:, on])
    return total


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
@pytest.mark.parametrize("name", [*PLANE, *CURVED])
def test_surface_weights_are_those_of_the_finite_elements(cell: str, name: str) -> None:
    # the two rules for triangles agree where the area is a polynomial, that is on a plane
    mesh = _mesh(cell)
    weights, theirs = surface_weights(mesh, name), _weights(mesh, name)
    exact = cell == "hexahedron" or name in PLANE
    assert weights == pytest.approx(theirs, abs=(1e-13 if exact else 1e-4) * theirs.max())
    assert weights.sum() == pytest.approx(theirs.sum(), rel=1e-13 if exact else 1e-6)


@pytest.mark.parametrize("cell", CELLS)
def test_surface_weights_stay_on_their_surface(cell: str) -> None:
    mesh = _mesh(cell)
    weights = surface_weights(mesh, "winding")
    assert weights.sum() == pytest.approx(surface_area(mesh, "winding"))
    assert not np.delete(weights, np.unique(mesh.facet_nodes("winding"))).any()
