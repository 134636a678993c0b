"""Fibers embedded in the faces of solid elements: energy, force and tangent, vectorised."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from fem import compat
from fem.kinematics import Body
from geometry.embed import EmbeddedFibers
from geometry.mesh import facet_positions

Floats = npt.NDArray[np.float64]


class FiberPotential:
    """Π = Σ ½ EA ℓ e², e = λ_f − 1, λ_f the mean of |F T| over the points of a segment.

    One strain a segment, because several would lock; every segment couples the dofs of one facet
    only, so that the sparsity of the solid is kept.

    The tangent's geometric part may use the force that Newton's last correction predicts,
    EA (e + b·δu), instead of EA e: the converged state is the same, the iterations fewer. That is
    not the tangent at the solution; `predict(None)` switches it off.

    Args:
        body: the kinematics.
        segments: pieces of fiber; those of cells owned elsewhere are left out.
        stiffness: axial stiffness EA of a whole fiber, N.
        tension_only: slack fibers carry nothing.
    """

    def __init__(
        self, body: Body, segments: EmbeddedFibers, stiffness: float, tension_only: bool = False
    ) -> None:
        self._body = body
        domain = body.domain
        local = domain.local_cell[segments.cell]
        facets = len(facet_positions(domain.data.cell_type))
        host = segments.cell * facets + segments.facet
        mine = np.flatnonzero(local >= 0)
        self.index = mine[np.argsort(host[mine], kind="stable")]
        """Number within `segments` of every segment held here, (n,)."""
        self.tension_only = tension_only
        self.length = segments.length[self.index]
        self.stiffness = stiffness * segments.share[self.index]
        local, facet = local[self.index], segments.facet[self.index]
        host = host[self.index]
        self._start = np.flatnonzero(np.r_[True, host[1:] != host[:-1]][: len(host)])

        positions = facet_positions(domain.data.cell_type)[facet]
        count, quadrature = len(self.index), segments.weights.shape[1]
        nodes = positions.shape[1]
        points = segments.points[self.index].reshape(-1, 3)
        _, gradient = compat.tabulate_gradient(domain.data.cell_type, points)
        tangent = segments.tangents[self.index].reshape(-1, 3)
        along = np.einsum("pad,pd->pa", gradient, tangent).reshape(count, quadrature, -1)
        along = np.take_along_axis(along, positions[:, None, :], axis=2)
        self._dofs = body.cell_dofs[local[:, None], positions].reshape(count, 3 * nodes)
        cells = domain.data.cells[segments.cell[self.index, None], positions]
        self._reference = domain.data.nodes[cells]
        x_t = along @ self._reference
        metric = np.linalg.norm(x_t, axis=2)
        self._slope = along / metric[:, :, None]  # ∂φ_a/∂S, 1/mm
        share = segments.weights[self.index] * metric
        self._share = share / share.sum(axis=1, keepdims=True)
        self._matrices: Floats = np.zeros(0)
        self._predicted: Floats | None = None
        self._b = np.zeros((count, 3 * nodes))
        self.strain = np.zeros(count)
        self._first_force: Floats | None = None

    # --- state ---------------------------------------------------------------------------------

    def update(self, w: Floats) -> None:
        """Strain and its gradient at the local coefficients w."""
        count, width = self._dofs.shape
        x = self._reference + w[self._dofs].reshape(count, width // 3, 3)
        t = self._slope @ x
        self._stretch = np.linalg.norm(t, axis=2)
        self._direction = t / self._stretch[:, :, None]
        self.strain = np.einsum("nq,nq->n", self._share, self._stretch) - 1
        weighted = self._share[:, :, None] * self._direction
        self._b = np.matmul(self._slope.transpose(0, 2, 1), weighted).reshape(count, width)

    @property
    def force(self) -> Floats:
        """Axial force of every segment, N; zero where a tension-only fiber is slack."""
        force: Floats = self.stiffness * self.strain
        return np.maximum(force, 0) if self.tension_only else force

    def energy(self) -> float:
        """This rank's stored energy, N mm."""
        return float(0.5 * np.sum(self.length * self.force * self.strain))

    def force_range(self) -> tuple[float, float]:
        """Least and greatest axial force over all ranks, N."""
        comm = self._body.domain.comm
        force = self.force
        low = float(force.min()) if len(force) else np.inf
        high = float(force.max()) if len(force) else -np.inf
        return float(comm.allreduce(low, MPI.MIN)), float(comm.allreduce(high, MPI.MAX))

    # --- first and second derivative ---------------------------------------------------------

    def add_residual(self, b: Floats) -> None:
        """Add ∂Π/∂w = Σ ℓ N ∂e/∂w to local coefficients."""
        np.add.at(b, self._dofs, (self.length * self.force)[:, None] * self._b)

    def predict(self, correction: Floats | None) -> None:
        """Force EA (e + b·δw) from the strain and gradient at the last tangent; None: EA e."""
        if correction is None:
            self._predicted = None
            return
        change = np.einsum("nk,nk->n", self._b, correction[self._dofs])
        self._predicted = self.stiffness * (self.strain + change)

    def add_tangent(self, matrix: PETSc.Mat, free: npt.NDArray[np.bool_]) -> None:
        """Add ∂²Π/∂w², summed facet by facet, on the free dofs."""
        if not len(self._start):
            return
        count, width = self._dofs.shape
        force, stiffness = self.force, self.stiffness
        if self._predicted is not None:
            force = np.maximum(self._predicted, 0) if self.tension_only else self._predicted
        if self.tension_only:
            stiffness = np.where(self.strain > 0, stiffness, 0.0)
        n = self._direction
        across = np.eye(3) - n[..., :, None] * n[..., None, :]
        across *= (self.length[:, None] * force[:, None] * self._share / self._stretch)[
            ..., None, None
        ]
        nodes = width // 3
        block = np.zeros((count, nodes, 3, nodes, 3))
        for q in range(n.shape[1]):
            s = self._slope[:, q]
            pair = s[:, :, None] * s[:, None, :]
            block += pair[:, :, None, :, None] * across[:, q, None, :, None, :]
        full = block.reshape(count, width, width)
        full += (self.length * stiffness)[:, None, None] * (
            self._b[:, :, None] * self._b[:, None, :]
        )
        sums = np.add.reduceat(full, self._start, axis=0)
        dofs = self._dofs[self._start]
        keep = free[dofs].astype(float)
        sums *= keep[:, :, None] * keep[:, None, :]
        for rows, values in zip(dofs, sums, strict=True):
            matrix.setValuesLocal(rows, rows, values, PETSc.InsertMode.ADD_VALUES)

    # --- memory of converged steps ---------------------------------------------------------

    def state(self) -> dict[str, Floats]:
        """Axial forces, from which the next step's first tangent is built."""
        return {"force": self.stiffness * self.strain}

    def extrapolate(self, states: list[dict[str, Floats]], weights: Floats) -> None:
        """Predicted force from a weighted sum of remembered states."""
        self._predicted = sum(
            (weight * state["force"] for weight, state in zip(weights, states, strict=True)),
            np.zeros(len(self.strain)),
        )
