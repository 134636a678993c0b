"""A bar of Young's modulus and Poisson's ratio: both are exact at small strains."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from fem.effects.elastic import Elastic
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Symmetry
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from fiberbend.case import convert
from fiberbend.case.case import MaterialSpec
from geometry.mesh.tets import to_tetrahedra
from tests.exact.solids import box
from tests.fem.parts import CELLS

YOUNG, STRAIN = 0.8, 1e-5


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.45, 0.49, 0.4999, 0.5])
def test_a_bar_has_the_modulus_and_the_ratio_of_its_case(cell: str, ratio: float) -> None:
    spec = MaterialSpec.model_validate({"young": f"{YOUNG} MPa", "poisson": ratio})
    material = convert.material(spec)
    mesh = box((2.0, 3.0, 4.0), (2, 2, 2))
    mesh = to_tetrahedra(mesh) if cell == "tetrahedron" else mesh
    domain = Domain(mesh, MPI.COMM_SELF)
    rubber = Elastic(material.law, {"solid": dict(material.parameters)})
    bulk = None if material.bulk is None else {"solid": material.bulk}
    planes = [Symmetry("left", 0), Symmetry("front", 1), Symmetry("bottom", 2)]
    scene = Scene(domain, [rubber, Incompressible(bulk), *planes])
    dofs = scene.body.node_dofs
    top = domain.surface_nodes("top")
    scene.fix(dofs[top, 2], STRAIN * mesh.nodes[top, 2])
    outcome = Newton(scene, MPI.COMM_SELF, Settings(tolerance=1e-12)).solve(scene.w.copy())
    assert outcome.converged, outcome.reason
    # one part of the strain is what is not linear
    linear = mesh.nodes * [-ratio * STRAIN, -ratio * STRAIN, STRAIN]
    assert np.abs(scene.w[dofs] - linear).max() < 10 * STRAIN * np.abs(linear).max()
    force = scene.residual()[0][dofs[top, 2]].sum()
    assert abs(force) / (2.0 * 3.0) == pytest.approx(YOUNG * STRAIN, rel=10 * STRAIN)
