"""Block preconditioners and multigrid for a tangent K = [A Bᵀ; B 0] of a body of hexahedra.

Augmented Lagrangian: with W the element blocks of B diag(A)⁻¹ Bᵀ, A + γ Bᵀ W⁻¹ B has the same
solutions and the same entries as A, and the Schur complement nears W/γ as γ grows (Benzi and
Olshanskii 2006, doi 10.1137/050646421). Its inner solve is exact. Multigrid is asked for less: A x
= f alone, at rest positive definite, with the rigid motions as its near-nullspace.
"""

from __future__ import annotations

import time
from typing import Any

from fem.scene import Scene  # starts MPI, without which petsc4py may find none

# isort: split
import numpy as np
import numpy.typing as npt
from petsc4py import PETSc
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, gmres

from fem.solver.rows import StoredRows

Floats = npt.NDArray[np.float64]
Row = dict[str, Any]

ENOUGH, MOST, MOST_S = 1e-8, 400, 5.0
"""Residual, relative; iterations; seconds of the processor of a solve."""
GAMMAS = (0.0, 1.0, 100.0)
LEVELS = {
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_ksp_max_it": "2",
}
AGGREGATION = {"pc_type": "gamg", "pc_gamg_agg_nsmooths": "1", "mg_coarse_pc_type": "svd"}
HYPRE = {"pc_type": "hypre", "pc_hypre_type": "boomeramg"}
MULTIGRID = {
    "GAMG, Chebyshev and SOR": AGGREGATION
    | LEVELS
    # coarse unknowns of aggregates with fewer than six free motions have no diagonal
    | {"mg_levels_pc_type": "sor", "mg_levels_pc_sor_diagonal_shift": "1e-6"},
    "GAMG, Chebyshev and Jacobi": AGGREGATION | LEVELS | {"mg_levels_pc_type": "jacobi"},
    "hypre by unknowns": HYPRE,
    "hypre by nodes": HYPRE
    | {
        "pc_hypre_boomeramg_nodal_coarsen": "4",
        "pc_hypre_boomeramg_vec_interp_variant": "2",
        "pc_hypre_boomeramg_strong_threshold": "0.5",
    },
}


class Parts:
    """Displacements by nodes, pressures by elements.

    Args:
        scene: a body whose tangent is assembled.
    """

    def __init__(self, scene: Scene) -> None:
        rows = StoredRows(scene.matrix)
        size = len(rows.begin) - 1
        entries = (rows.inner_values(), rows.columns, rows.begin)
        upper = sparse.csr_matrix(entries, shape=(size, size))
        whole = (upper + sparse.triu(upper, 1).T).tocsr()
        self.u = scene.body.node_dofs[scene.body.owned_nodes].ravel()
        elements = scene.body.dofs("p")[:, :, 0]
        self.p = elements.ravel()
        self.a = whole[self.u][:, self.u].tocsr()
        self.b = whole[self.p][:, self.u].tocsr()
        schur = (self.b @ sparse.diags(1 / self.a.diagonal()) @ self.b.T).tocsr()
        width = elements.shape[1]
        inverses = [
            np.linalg.inv(schur[k : k + width, k : k + width].toarray())
            for k in range(0, len(self.p), width)
        ]
        self.inverse = sparse.block_diag(inverses).tocsr()


def stored(matrix: Any, block: int = 1) -> PETSc.Mat:
    """A PETSc matrix of scipy's."""
    rows = matrix.tocsr()
    rows.sort_indices()
    index = (rows.indptr.astype(PETSc.IntType), rows.indices.astype(PETSc.IntType))
    made = PETSc.Mat().createAIJ(rows.shape, bsize=block, csr=(*index, rows.data))
    made.assemble()
    return made


def blocks(scene: Scene, b: Floats, known: Floats) -> list[Row]:
    """The augmented Lagrangian with an exact inner solve."""
    parts = Parts(scene)
    nu, n = len(parts.u), len(parts.u) + len(parts.p)
    whole = sparse.bmat([[parts.a, parts.b.T], [parts.b, None]]).tocsr()
    right = np.r_[b[parts.u], np.zeros(len(parts.p))]
    found = []
    for gamma in GAMMAS:
        augmented = stored(parts.a + gamma * (parts.b.T @ parts.inverse @ parts.b))
        ksp = PETSc.KSP().create(PETSc.COMM_SELF)
        ksp.setOperators(augmented)
        ksp.setType("preonly")
        ksp.getPC().setType("lu")
        ksp.getPC().setFactorSolverType("mumps")
        x, y = augmented.createVecs()
        start = time.process_time()
        ksp.setUp()
        middle = time.process_time()

        def apply(
            r: Floats, gamma: float = gamma, ksp: Any = ksp, x: Any = x, y: Any = y
        ) -> Floats:
            volumes = parts.inverse @ r[nu:]
            pressures = -(1 + gamma) * volumes
            x.array_w[:] = r[:nu] + gamma * (parts.b.T @ volumes) - parts.b.T @ pressures
            ksp.solve(x, y)
            return np.r_[y.array_r, pressures]

        # from the right, so that the residual is the true one
        product = LinearOperator((n, n), matvec=lambda z, f=apply: whole @ f(z))
        count = [0]

        def step(_norm: float, count: list[int] = count) -> None:
            count[0] += 1

        z, failed = gmres(
            product, right, tol=ENOUGH, restart=MOST, maxiter=1, callback=step,
            callback_type="pr_norm",
        )  # fmt: skip
        u = known[parts.u]
        row: Row = {
            "solver": f"augmented Lagrangian, γ = {gamma:g}",
            "factor": middle - start,
            "solve": time.process_time() - middle,
            "iterations": count[0],
            "error": float(np.linalg.norm(apply(z)[:nu] - u) / np.linalg.norm(u)),
        }
        found.append(row | ({"why": f"no convergence in {count[0]} iterations"} if failed else {}))
        ksp.destroy()
        augmented.destroy()
    return found


def multigrid(scene: Scene, b: Floats) -> list[Row]:
    """A x = f by conjugate gradients."""
    parts = Parts(scene)
    a = stored(parts.a, 3)
    rigid = np.linalg.qr(scene.place().rigid[parts.u])[0]
    modes = []
    for column in rigid.T:
        vector = a.createVecLeft()
        vector.array_w[:] = column
        modes.append(vector)
    a.setNearNullSpace(PETSc.NullSpace().create(vectors=modes))
    a.setOption(PETSc.Mat.Option.SPD, True)
    return [_conjugate_gradients(a, b[parts.u], name) for name in MULTIGRID]


def _conjugate_gradients(a: PETSc.Mat, b: Floats, name: str) -> Row:
    options, prefix = PETSc.Options(), "bench_"
    for key, value in MULTIGRID[name].items():
        options.setValue(prefix + key, value)
    x, f = a.createVecs()
    f.array_w[:] = b
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOptionsPrefix(prefix)
    ksp.setType("cg")
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    ksp.setOperators(a)
    ksp.setFromOptions()
    least, begun = [1.0], [0.0]

    def test(_ksp: PETSc.KSP, iteration: int, norm: float) -> int:
        left = norm / f.norm()
        least.append(left)
        if left <= ENOUGH:
            return int(PETSc.KSP.ConvergedReason.CONVERGED_RTOL)
        spent = time.process_time() - begun[0]
        if not np.isfinite(left) or iteration >= MOST or spent > MOST_S:
            return int(PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT)
        return 0

    ksp.setConvergenceTest(test)
    row: Row = {"solver": f"{name}, A alone"}
    start = time.process_time()
    try:
        ksp.setUp()
        begun[0] = time.process_time()
        ksp.solve(f, x)
    except PETSc.Error as error:
        return row | {"why": f"PETSc's error {error.ierr}"}
    finally:
        for key in MULTIGRID[name]:
            options.delValue(prefix + key)
    row |= {
        "factor": begun[0] - start,
        "solve": time.process_time() - begun[0],
        "iterations": len(least) - 2 if len(least) > 1 else 0,
    }
    reason = ksp.getConvergedReason()
    ksp.destroy()
    if reason > 0:
        return row
    indefinite = (PETSc.KSP.ConvergedReason.DIVERGED_INDEFINITE_PC, -10)
    if reason in indefinite:
        return row | {"why": "preconditioner or A not positive definite"}
    return row | {"why": f"a residual of {least[-1]:.1e} after {row['iterations']} iterations"}
