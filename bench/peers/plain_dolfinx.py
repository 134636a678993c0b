"""The actuator as a plain dolfinx script: Taylor–Hood, MUMPS, Newton's method, fixed load steps.

What a competent user writes after the tutorials of FEniCSx, and no more: mixed elements Q2–Q1, or
Q2 with pressures that jump from element to element, forms by `ufl.derivative`, `NewtonSolver` with
its own settings, LU of the whole matrix. The winding is a membrane on its surface that is stiff
along hoops. The mesh is gmsh's, from `fiberbend mesh`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import dolfinx.fem as dfem
import numpy as np
import ufl
from dolfinx.fem.petsc import NonlinearProblem
from dolfinx.io import gmshio
from dolfinx.nls.petsc import NewtonSolver
from mpi4py import MPI
from petsc4py import PETSc
from scipy.spatial import cKDTree

from bench.peers.arrays import Floats, Ints, bending_angles, load_body

DEGREE = 5
"""Of quadrature: three points along each edge of a hexahedron."""
NEAR = 1e-6
"""Distance in mm of places that are the same."""


def solve(task: dict[str, Any]) -> None:
    """Bend the actuator and write a line for every load step.

    Args:
        task: mesh file, element of the pressures, rubbers (C1, C2, bulk in MPa), hoop stiffness in
            N/mm, pressure and step in MPa, goal in degrees, the same mesh as arrays (`body`), file
            to write.
    """
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(task["mesh"])
    groups = {gmsh.model.getPhysicalName(d, tag): tag for d, tag in gmsh.model.getPhysicalGroups()}
    domain, cells, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_SELF, 0, gdim=3)
    gmsh.finalize()

    u_element = ufl.VectorElement("Lagrange", domain.ufl_cell(), 2)
    p_element = ufl.FiniteElement(task["pressures"], domain.ufl_cell(), 1)
    space = dfem.FunctionSpace(domain, ufl.MixedElement([u_element, p_element]))
    w = dfem.Function(space)
    u, p = ufl.split(w)
    pressure = dfem.Constant(domain, PETSc.ScalarType(0.0))
    n = ufl.FacetNormal(domain)
    F = ufl.Identity(3) + ufl.grad(u)
    J = ufl.det(F)
    rule = {"quadrature_degree": DEGREE}
    dx = ufl.Measure("dx", domain, subdomain_data=cells, metadata=rule)
    ds = ufl.Measure("ds", domain, subdomain_data=facets, metadata=rule)
    dS = ufl.Measure("dS", domain, subdomain_data=facets, metadata=rule)

    energy = 0
    for name, (c1, c2, bulk) in task["rubbers"].items():
        excess = J ** (-2 / 3) * ufl.inner(F, F) - 3
        density = c1 * excess + c2 * excess**2 + p * (J - 1) - p**2 / (2 * bulk)
        energy += density * dx(groups[name])
    around = ufl.cross(n("+"), ufl.as_vector((0.0, 0.0, 1.0)))
    stretch = ufl.sqrt(ufl.inner(F("+") * around, F("+") * around))
    energy += task["hoop"] / 2 * (stretch - 1) ** 2 * dS(groups["winding"])
    v = ufl.TestFunction(space)
    residual = ufl.derivative(energy, w, v)
    follower = pressure * J * ufl.inv(F).T * n
    residual += ufl.inner(follower, ufl.split(v)[0]) * ds(groups["chamber"])

    problem = NonlinearProblem(residual, w, supports(space, domain, facets, groups))
    solver = NewtonSolver(domain.comm, problem)
    ksp = solver.krylov_solver
    options = PETSc.Options()
    options[f"{ksp.getOptionsPrefix()}ksp_type"] = "preonly"
    options[f"{ksp.getOptionsPrefix()}pc_type"] = "lu"
    options[f"{ksp.getOptionsPrefix()}pc_factor_mat_solver_type"] = "mumps"
    ksp.setFromOptions()

    body = load_body(Path(task["body"]))
    ring = np.unique(np.concatenate([body.root.ravel(), body.tip.ravel()]))
    dofs, moved, states = dofs_at(space, body.points[ring]), body.points.copy(), []
    unknowns = space.dofmap.index_map.size_global * space.dofmap.index_map_bs
    with Path(task["out"]).open("w") as file:
        for step in np.arange(task["step"], task["pressure"] * 1.001, task["step"]):
            pressure.value = step
            try:
                iterations, _ = solver.solve(w)
                w.x.scatter_forward()
            except RuntimeError as error:
                file.write(json.dumps({"failed": str(error).splitlines()[-1]}) + "\n")
                return
            moved[ring] = body.points[ring] + w.x.array[dofs]
            states.append(moved.copy())
            angle = np.degrees(bending_angles(body.points, states, body.root, body.tip)[-1])
            line = {"MPa": float(step), "degrees": float(angle), "iterations": iterations}
            file.write(json.dumps(line | {"unknowns": unknowns}) + "\n")
            file.flush()
            if angle > task["goal"]:
                return


def supports(space: Any, domain: Any, facets: Any, groups: dict[str, int]) -> list[Any]:
    """The clamp, and the plane of symmetry."""
    conditions = []
    for name, part in (("clamp", space.sub(0)), ("symmetry", space.sub(0).sub(0))):
        collapsed, _ = part.collapse()
        still = dfem.Function(collapsed)
        there = facets.indices[facets.values == groups[name]]
        dofs = dfem.locate_dofs_topological((part, collapsed), domain.topology.dim - 1, there)
        conditions.append(dfem.dirichletbc(still, dofs, part))
    return conditions


def dofs_at(space: Any, points: Floats) -> Ints:
    """Places in a mixed function of the displacements at nodes, (k, 3)."""
    collapsed, parents = space.sub(0).collapse()
    distance, there = cKDTree(collapsed.tabulate_dof_coordinates()).query(points)
    if distance.max() > NEAR:
        raise ValueError("a node of the mesh's file is none of the displacements'")
    return np.array(parents).reshape(-1, 3)[there]


if __name__ == "__main__":
    solve(json.loads(Path(sys.argv[1]).read_text()))
