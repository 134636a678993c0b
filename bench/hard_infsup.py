"""The inf-sup constant of displacement and pressure: does it stay away from zero on finer meshes?

β² is the least eigenvalue of B K⁻¹ Bᵀ q = β² M q with K the stiffness in the displacements at rest,
B the rate of volume with the displacements at some state, and M = ∫ p q / μ with the shear modulus
μ of each rubber, so that a stiff floor beside a soft wall does not count as a small constant.
"""

from __future__ import annotations

import dataclasses
import json
import sys
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
from mpi4py import MPI
from petsc4py import PETSc

from bench.hard_cases import ANGLE, TO, Hard, bulky
from fem.scene import Scene
from fem.solver.factor import Factor
from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from fiberbend.reader.reader import parse_case
from fiberbend.running.assembly import Assembly, assemble

STUB = {"actuator.length": "8 mm", "actuator.cap": "4 mm", TO: "1 kPa"}
"""A body as short as it can be: its size on the third mesh is what limits it."""


@dataclasses.dataclass(frozen=True)
class Ladder:
    """A model on three meshes.

    Attributes:
        name: of the element.
        model: section, cell or body.
        angle: at which B is taken, degrees; 0: at rest.
        changes: to the base case.
        meshes: changes for each mesh.
    """

    name: str
    model: str
    angle: float
    changes: dict[str, Any]
    meshes: tuple[dict[str, Any], ...]


def _finer(*pairs: tuple[int, float]) -> tuple[dict[str, Any], ...]:
    return tuple({"mesh.section": n, "mesh.axial": f"{axial:g} mm"} for n, axial in pairs)


SECTIONS = tuple({"mesh.section": n} for n in (1, 2, 4))
STAYS = 0.8
"""β over that of the mesh before. The last step of a ladder takes h to a half or two thirds: the
constant of a pair that locks falls as h, that is by as much."""
LEAST = 0.25
"""β on the finest mesh: half of what the coarsest has, far from a zero by round-off."""

LADDERS = (
    Ladder("quadrilateral", "section", 0.0, {}, SECTIONS),
    Ladder("quadrilateral", "section", 180.0, {}, SECTIONS),
    Ladder("hexahedron", "cell", 0.0, {}, _finer((1, 0.75), (2, 0.375), (3, 0.25))),
    Ladder("hexahedron", "cell", 180.0, {}, _finer((1, 0.75), (2, 0.375), (3, 0.25))),
    Ladder("hexahedron", "body", 0.0, STUB, _finer((1, 4.0), (2, 2.0), (3, 1.4))),
    Ladder(
        "tetrahedron",
        "body",
        0.0,
        {**STUB, "mesh.element": "tetrahedron"},
        tuple({"mesh.axial": f"{size} mm"} for size in (4, 3, 2)),
    ),
)


def constants(ladder: Ladder) -> list[tuple[int, float]]:
    """Number of elements and β on every mesh of a ladder."""
    found = []
    for mesh in ladder.meshes:
        changes = {**ladder.changes, **mesh}
        if ladder.angle:
            changes = {TO: None, ANGLE: f"{ladder.angle} deg", **changes}
        found.append(_constant(changes, ladder))
    return found


def _assemble(changes: dict[str, Any], model: str, mesh: Any = None) -> tuple[Case, Assembly]:
    case = parse_case(Hard("infsup", "", changes).case(model))
    mesh = mesh or meshed(case).mesh(case)
    return case, assemble(case, mesh, MPI.COMM_SELF)


def fault(betas: list[float]) -> str:
    """What a ladder has against it; empty where the constant stays away from zero."""
    if betas[-1] > LEAST and betas[-1] > STAYS * betas[-2]:
        return ""
    return f"the inf-sup constant falls: {', '.join(f'{beta:.3f}' for beta in betas)}"


def _constant(changes: dict[str, Any], ladder: Ladder) -> tuple[int, float]:
    _, built = _assemble(changes, ladder.model)
    scene = built.scene
    stiffness, rate, _ = _blocks(scene)
    if ladder.angle:
        report = built.march.run(built.ramps)
        if report.status != "converged":
            raise RuntimeError(report.reason)
        _, rate, _ = _blocks(scene)
    mesh = scene.domain.data
    _, soft = _assemble({**bulky(1.0), **changes}, ladder.model, mesh)
    _, _, mass = _blocks(soft.scene)
    return len(mesh.cells), least(stiffness, rate, -mass)


def _blocks(scene: Scene) -> tuple[Any, Any, Any]:
    """K, B and the block of the pressures of a scene's tangent, on its free dofs."""
    scene.predict(None)
    matrix = scene.assemble_tangent()
    plain = matrix.copy().convert("aij")
    rows, columns, values = plain.getValuesCSR()
    plain.destroy()
    full = sp.csr_matrix((values, columns, rows), shape=matrix.getSize())
    p = np.flatnonzero(scene.volumetric)
    u = np.flatnonzero(scene.free & ~scene.volumetric)
    return full[u][:, u], full[p][:, u], full[p][:, p]


def least(stiffness: Any, rate: Any, mass: Any) -> float:
    """β of given blocks; NaN where the pressures are not determined at all."""
    saddle = sp.bmat([[stiffness, rate.T], [rate, None]], format="csr")
    n, m = stiffness.shape[0], rate.shape[0]
    matrix = PETSc.Mat().createAIJ(saddle.shape, csr=(saddle.indptr, saddle.indices, saddle.data))
    factor = Factor(matrix)
    factor.renew()
    b, x = matrix.createVecRight(), matrix.createVecRight()

    def inverse(r: np.ndarray) -> np.ndarray:
        b.array_w[:n], b.array_w[n:] = 0.0, -r.ravel()
        factor.solve(b, x)
        return x.array_r[n:].copy()

    shape = (m, m)
    schur = spl.LinearOperator(shape, matvec=lambda q: q, dtype=float)
    values = spl.eigsh(
        schur,
        k=1,
        M=mass.tocsc(),
        sigma=0.0,
        OPinv=spl.LinearOperator(shape, matvec=inverse, dtype=float),
        return_eigenvectors=False,
        v0=np.ones(m),
    )
    return float(np.sqrt(values[0]))


if __name__ == "__main__":
    print(json.dumps(constants(LADDERS[int(sys.argv[1])])))
