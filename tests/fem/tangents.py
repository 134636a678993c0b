"""The tangent as dolfinx and PETSc assemble it, entry by entry, beside that of the scene."""

from __future__ import annotations

import functools

from fem import compat  # starts MPI, without which dolfinx may find none

# isort: split
import dolfinx.fem as dfem
import dolfinx.fem.petsc
import numpy as np
import ufl
from mpi4py import MPI
from petsc4py import PETSc

from fem.effects.supports import Symmetry
from fem.effects.winding import Winding as Discrete
from fem.kinematics.domain import Domain
from fem.scene import Scene
from geometry.bodies.extrude import hexahedral_body
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from tests.fem.parts import EA, PITCH, SHORT, actuator_effects, perturb


def misfit(scene: Scene, opposite: bool = False) -> float:
    """Greatest difference of K x over three vectors x by lot, relative to the greatest of K x."""
    free = scene.free_opposite if opposite else scene.free
    assert free is not None
    fixed = dfem.dirichletbc(
        dfem.Function(scene.body.space), np.flatnonzero(~free).astype(np.int32)
    )
    body = scene.body
    whole = [effect.potential(body) for effect in scene.effects.values()]
    whole = sum((form for form in whole if form is not None), ufl.Form([]))
    arguments = (ufl.TestFunction(body.space), ufl.TrialFunction(body.space))
    tangent = functools.reduce(
        lambda form, direction: ufl.derivative(form, body.w, direction), arguments, whole
    )
    form = compat.compile_form(scene.domain.mesh, ufl.replace(tangent, body.stand_ins))
    full = dolfinx.fem.petsc.assemble_matrix(form, [fixed])
    full.assemble(PETSc.Mat.AssemblyType.FLUSH)
    for item in scene.discrete.values():
        keep = free[item.block_dofs].astype(float)
        values = item.tangent_blocks() * keep[:, :, None] * keep[:, None, :]
        for dofs, block in zip(item.block_dofs, values, strict=True):
            full.setValuesLocal(dofs, dofs, block, addv=PETSc.InsertMode.ADD_VALUES)
    full.assemble()
    matrix = scene.assemble_tangent(opposite)
    x, y = matrix.createVecs()
    follow, lead = scene.body.ties
    worst = 0.0
    rng = np.random.default_rng(scene.domain.comm.rank)
    for _ in range(3):
        given = rng.uniform(-1, 1, x.getLocalSize())
        x.array_w[:] = given
        matrix.mult(x, y)
        found = y.array_r.copy()
        spread = given.copy()
        spread[follow] = given[lead]
        x.array_w[:] = spread
        full.mult(x, y)
        right = y.array_r.copy()
        fixed_lead = ~free[lead]
        np.add.at(right, lead[~fixed_lead], right[follow[~fixed_lead]])
        right[follow] = given[follow]
        errors = float(np.abs(found - right).max(initial=0)), float(np.abs(right).max(initial=0))
        error, size = (scene.domain.comm.allreduce(value, MPI.MAX) for value in errors)
        worst = max(worst, error / size)
    return worst


def actuator(comm: MPI.Comm) -> Scene:
    """Half of the short actuator with a winding that is smeared, and one of single fibers."""
    domain = Domain(hexahedral_body(SHORT, MeshSize(axial=6, section=1, half=True)), comm)
    fibers = embed(domain.data, SHORT, Winding("double-helix", PITCH, 0.38))
    own = [effect for effect in actuator_effects(domain) if not isinstance(effect, Symmetry)]
    scene = Scene(domain, [*own, Symmetry(halves=True), Discrete(fibers, EA)])
    perturb(scene, 0.05, seed=7 + comm.rank)
    return scene


if __name__ == "__main__":
    spread = actuator(MPI.COMM_WORLD)
    found = [misfit(spread), misfit(spread, opposite=True)]
    if MPI.COMM_WORLD.rank == 0:
        print(*found)
