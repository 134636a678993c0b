"""The tangent's own assembly puts every entry where dolfinx and PETSc put it."""

from __future__ import annotations

import functools

import numpy as np
import pytest
import ufl
from mpi4py import MPI

from fem import compat
from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.contact import Contact, Plane
from fem.effects.effect import Effect
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp, Symmetry
from fem.effects.winding import SmearedWinding
from fem.effects.winding import Winding as Discrete
from fem.kinematics.cell import Cell
from fem.kinematics.domain import Domain
from fem.kinematics.kinematics import Kinematics
from fem.kinematics.section import Section
from fem.scene import Scene
from geometry.bodies.extrude import hexahedral_slice, section_quadrilaterals
from geometry.mesh.data import MeshData
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from geometry.winding.smear import smear
from tests.conftest import MpiRun
from tests.fem.parts import CELLS, EA, PITCH, SHORT, gravity, law, perturb, stub, winding
from tests.fem.tangents import actuator, misfit

REGIONS = ("wall", "floor", "sheath")
HELIX = Winding("double-helix", PITCH, 0.38)
ROUND_OFF = 1e-13


def _uniform(mesh: MeshData, kind: type[Section] | type[Cell], twisted: bool) -> Scene:
    wound: Effect = (
        SmearedWinding(smear(mesh, SHORT, HELIX), EA)
        if kind is Section
        else Discrete(embed(mesh, SHORT, HELIX), EA)
    )
    effects = [law("yeoh", REGIONS), Incompressible({"wall": 40.0}), ChamberPressure(), wound]
    make = functools.partial(kind, length=SHORT.length, twisted=twisted)
    scene = Scene(Domain(mesh), effects, make)
    perturb(scene, 0.02, seed=3)
    return scene


@pytest.mark.parametrize("half", [True, False])
@pytest.mark.parametrize("twisted", [False, True])
def test_a_section(half: bool, twisted: bool) -> None:
    mesh = section_quadrilaterals(SHORT, MeshSize(section=1, half=half))
    scene = _uniform(mesh, Section, twisted)
    assert misfit(scene) < ROUND_OFF
    if half:
        assert misfit(scene, opposite=True) < ROUND_OFF if scene.free_opposite is not None else True


@pytest.mark.parametrize(("half", "layers"), [(True, 1), (False, 1), (False, 2), (False, 3)])
def test_a_cell_with_ends_that_are_tied_or_not(half: bool, layers: int) -> None:
    # of one layer: nodes of an element follow others of the same element
    pitch, size = PITCH / 2 if half else PITCH, MeshSize(section=1, half=half)
    scene = _uniform(hexahedral_slice(SHORT, size, pitch, layers), Cell, True)
    assert bool(len(scene.body.ties[0])) is not half
    assert misfit(scene) < ROUND_OFF


@pytest.mark.parametrize("cell", CELLS)
def test_a_body_with_all_effects(cell: str) -> None:
    domain = stub(cell)
    roof = Plane((0.0, 5.0, 0.0), (0.0, -1.0, 0.0))
    effects: list[Effect] = [
        law("yeoh", ["wall"]),
        law("neo-hooke", ["floor"]),
        Incompressible({"floor": 60.0}),
        ChamberPressure(),
        winding(domain, 0.38),
        gravity(["wall", "floor"]),
        Contact("roof", roof, ("outer", "tip"), 3.0),
        Clamp(),
        Symmetry("tip", 2),
    ]
    scene = Scene(domain, effects)
    perturb(scene, 0.02, seed=5)
    assert misfit(scene) < ROUND_OFF


def test_an_actuator_and_the_opposite_of_its_symmetry() -> None:
    scene = actuator(MPI.COMM_SELF)
    assert misfit(scene) < ROUND_OFF
    assert misfit(scene, opposite=True) < ROUND_OFF


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 3])
def test_several_ranks(mpirun: MpiRun, ranks: int) -> None:
    run = mpirun(ranks, ["-m", "tests.fem.tangents"])
    assert run.returncode == 0, run.stderr
    assert max(map(float, run.stdout.split())) < ROUND_OFF


def test_all_that_couples_is_stored_and_no_more() -> None:
    scene = actuator(MPI.COMM_SELF)
    dofs = compat.cell_dofs(scene.body.space)
    pairs = np.zeros((scene.body.local,) * 2, dtype=bool)
    for row in dofs:
        pairs[np.ix_(row, row)] = True
    assert scene.matrix.getInfo()["nz_used"] == np.triu(pairs).sum()


class _Jump(Effect):
    """A potential over the facets between cells, which no effect has."""

    def potential(self, body: Kinematics) -> ufl.Form:
        """½ ∫ (u·u at one side) (u·u at the other) dS."""
        square = ufl.dot(body.u, body.u)
        return square("+") * square("-") / 2 * ufl.dS(domain=body.domain.mesh)


def test_an_integral_of_another_kind_is_refused() -> None:
    with pytest.raises(NotImplementedError, match="boundary facets"):
        Scene(stub("hexahedron"), [law("yeoh", ["wall", "floor"]), _Jump()])


def test_blocks_of_dofs_that_no_cell_couples_are_refused() -> None:
    scene = actuator(MPI.COMM_SELF)
    ends = [scene.body.node_dofs[scene.domain.surface_nodes(name)[0]] for name in ("clamp", "tip")]
    with pytest.raises(ValueError, match="no cell"):
        scene._assembler.blocks(np.concatenate(ends)[None].astype(np.int32))
