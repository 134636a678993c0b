"""Fibers embedded in the faces of solid elements: energy, force and tangent, vectorised."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from analytic.path import cross_matrix
from fem.kinematics.kinematics import Kinematics
from fem.ranks import total
from geometry.mesh.data import facet_positions
from geometry.mesh.reference import shape_functions
from geometry.winding.segments import EmbeddedFibers

Floats = npt.NDArray[np.float64]

ROUND_OFF = 1e-12
"""Strains of fibers at rest are ±1e-15; one that carries in tension only is taut down to −this."""


@dataclasses.dataclass(frozen=True)
class _Second:
    """Second derivatives of s segments with k dofs each.

    Attributes:
        block: ∂²Π/∂w², (s, k, k).
        mixed: by scalar, ∂²Π/∂w∂q, (s, k).
        scalars: by pair of scalars, ∂²Π/∂q∂r of all segments together.
    """

    block: Floats
    mixed: dict[str, Floats]
    scalars: dict[tuple[str, str], float]


def _contract(vectors: Floats, maps: Floats) -> Floats:
    """Σ_qi v_qi M_qik over points and components: v (n, q, 3), M (n, q, 3, k), result (n, k)."""
    count, width = len(maps), maps.shape[3]
    result: Floats = (vectors.reshape(count, 1, -1) @ maps.reshape(count, -1, width))[:, 0]
    return result


class FiberPotential:
    """Π = Σ ½ EA ℓ e², e = λ_f − 1, λ_f the mean of |F T| over the points of a segment.

    One strain a segment, because several would lock; every segment couples the dofs of one facet
    only, so that the sparsity of the solid is kept.

    The tangent's geometric part may use the force that Newton's last correction predicts,
    EA (e + b·δu), instead of EA e: the converged state is the same, the iterations fewer. That is
    not the tangent at the solution; `predict(None)` switches it off.

    In uniform bending F T has a part T_z (λ0 e_z + ω × x') that depends on global scalars; the
    derivatives with respect to these are `conjugate`, `add_load` and `second_derivative`.

    Args:
        body: the kinematics.
        segments: pieces of fiber; those of cells owned elsewhere are left out.
        stiffness: axial stiffness EA of a whole fiber, N.
        tension_only: slack fibers carry nothing.
    """

    def __init__(
        self,
        body: Kinematics,
        segments: EmbeddedFibers,
        stiffness: float,
        tension_only: bool = False,
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
        self.mixed = not tension_only
        self.length = segments.length[self.index]
        self.stiffness = stiffness * segments.share[self.index]
        local, facet = local[self.index], segments.facet[self.index]
        host = host[self.index]
        self._start = np.flatnonzero(np.r_[True, host[1:] != host[:-1]][: len(host)])

        # With φ_a the shape functions of the host cell, ξ its reference coordinates, X_a (mm) the
        # nodes of the host facet and t = dξ/ds along the piece (s its parameter): dX/ds =
        # Σ_a (∇φ_a · t) X_a, S (mm) the arc length, dS = |dX/ds| ds. At each point i
        #   _slope: T·∇φ_a = (∇φ_a · t)/|dX/ds|, 1/mm, so that F T = Σ_a slope_a x_a;
        #   _rise: T_z = dZ/dS; _value: φ_a; _share: c_i = w_i dS_i/Σ w dS, weights of the mean.
        # Only nodes of the facet enter: off it φ_a and its derivative along it vanish.
        positions = facet_positions(domain.data.cell_type)[facet]
        count, quadrature = len(self.index), segments.weights.shape[1]
        dim = segments.points.shape[2]
        points = segments.points[self.index].reshape(-1, dim)
        value, gradient = shape_functions(domain.data.cell_type, points)
        tangent = segments.tangents[self.index].reshape(-1, dim)
        along = np.einsum("pad,pd->pa", gradient, tangent).reshape(count, quadrature, -1)
        along = np.take_along_axis(along, positions[:, None, :], axis=2)
        self._dofs = body.cell_dofs[local[:, None], positions].reshape(count, -1)
        cells = domain.data.cells[segments.cell[self.index, None], positions]
        self._reference = domain.data.nodes[cells]
        rise = segments.axial[self.index]
        if self._reference.shape[2] == 3:
            rise = np.einsum("nqa,na->nq", along, self._reference[:, :, 2])
        plane = along @ self._reference[:, :, :2]
        metric = np.sqrt(np.sum(plane**2, axis=2) + rise**2)
        slope = along / metric[:, :, None]  # ∂φ_a/∂S, 1/mm
        share = segments.weights[self.index] * metric
        self._share = share / share.sum(axis=1, keepdims=True)
        self._uniform = body.carry() is not None
        parts = body.components
        if self._uniform:
            value = np.take_along_axis(
                value.reshape(count, quadrature, -1), positions[:, None, :], axis=2
            )
            self._value = np.einsum("nqa,ij->nqiaj", value, np.eye(3)[:, :parts]).reshape(
                count, quadrature, 3, -1
            )
            self._rise: Floats = (rise / metric)[:, :, None]
        self._slope = np.einsum("nqa,ij->nqiaj", slope, np.eye(3)[:, :parts]).reshape(
            count, quadrature, 3, -1
        )
        rest = np.zeros((*self._reference.shape[:2], parts))
        # x' in the turning frame: z is not a position there
        shown = 2 if self._uniform else 3
        rest[:, :, :shown] = self._reference[:, :, :shown]
        self._reference = rest.reshape(count, -1)
        self._predicted: Floats | None = None
        self._second: _Second | None = None
        self._tangent_b: Floats | None = None
        self._tangent_e_q: dict[str, Floats] = {}
        self._slackens = False
        """The predicted motion shortens those fibers that are as long as at rest, as a whole."""
        self.strain = np.zeros(count)

    # --- state ---------------------------------------------------------------------------------

    def update(self, w: Floats) -> None:
        """Strain and its derivatives at the local coefficients w and the present scalars."""
        x = self._reference + w[self._dofs]
        self._map = self._slope
        self._rates: dict[str, Floats] = {}
        t = (self._slope @ x[:, None, :, None])[..., 0]
        carry = self._body.carry()
        if carry is not None:
            position = (self._value @ x[:, None, :, None])[..., 0]
            along, spin = np.array([0.0, 0.0, carry.stretch]), cross_matrix(carry.spin)
            t = t + self._rise * (along + position @ spin.T)
            self._map = self._slope + self._rise[..., None] * (spin @ self._value)
            for name, (vector, turn) in carry.rates.items():
                self._rates[name] = self._rise * (vector + position @ cross_matrix(turn).T)
        self._stretch = np.linalg.norm(t, axis=2)
        self._direction = t / self._stretch[:, :, None]
        self.strain = np.sum(self._share * self._stretch, axis=1) - 1
        weighted = self._share[:, :, None] * self._direction
        self._b = _contract(weighted, self._map)
        self._e_q = {
            name: np.sum(weighted * rate, axis=(1, 2)) for name, rate in self._rates.items()
        }
        self._second = None

    @property
    def slack(self) -> npt.NDArray[np.bool_]:
        """Which segments are shorter than at rest, (n,); they are slack where they cannot push."""
        slack: npt.NDArray[np.bool_] = self.strain < -ROUND_OFF
        return slack

    @property
    def _at_rest(self) -> npt.NDArray[np.bool_]:
        """Which segments are as long as at rest, (n,)."""
        at_rest: npt.NDArray[np.bool_] = np.abs(self.strain) <= ROUND_OFF
        return at_rest

    @property
    def undecided(self) -> bool:
        """Whether the tangent hangs on where the next motion goes, on this rank."""
        return bool(self.tension_only and self._at_rest.any())

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
        self._add(b, (self.length * self.force)[:, None] * self._b)

    def add_noise(self, b: Floats) -> None:
        """Add the forces that round-off in the strains makes, at rest, to local coefficients.

        F T is a sum of positions over the size of an element: its error is that of the summands.
        """
        x = np.abs(self._reference)[:, None, :, None]
        error = np.finfo(float).eps * np.linalg.norm((np.abs(self._slope) @ x)[..., 0], axis=2)
        force = self.length * self.stiffness * np.sum(self._share * error, axis=1)
        self._add(b, force[:, None] * np.abs(self._b))

    def _add(self, b: Floats, values: Floats) -> None:
        b += np.bincount(self._dofs.ravel(), values.ravel(), len(b))

    def predict(
        self, correction: Floats | None, scalars: Mapping[str, float] | None = None
    ) -> None:
        """Force EA (e + b₀·δw + e_q₀ δq), b₀ and e_q₀ those of the last tangent; None: EA e."""
        self._second = None
        self._slackens = False
        if correction is None:
            self._predicted = None
            return
        assert self._tangent_b is not None, "a correction needs a tangent"
        change = np.einsum("nk,nk->n", self._tangent_b, correction[self._dofs])
        for name, value in (scalars or {}).items():
            if name in self._tangent_e_q:
                change += self._tangent_e_q[name] * value
        self._predicted = self.stiffness * (self.strain + change)
        if self.tension_only:
            # fiber by fiber it would be a set that the answer itself changes: all or none
            pull = np.where(self._at_rest, self.length * self.stiffness * change, 0.0)
            self._slackens = bool(total(self._body.domain.comm, float(pull.sum())) < 0)

    @property
    def predicted(self) -> Floats:
        """Axial force that the last correction predicts of every segment, (n,), N."""
        return self.stiffness * self.strain if self._predicted is None else self._predicted

    @predicted.setter
    def predicted(self, forces: Floats) -> None:
        self._second = None
        self._predicted = forces

    def _unpredicted(self) -> Floats:
        """ℓ (EA e − N), N the predicted force, (n,), N mm; 0 where slack is no matter of N alone.

        Newton's method for N as an unknown of its own, N = EA (e + b·δw), with the b₀ and the
        factor of an earlier iterate has the residual Σ ℓ [N b + (EA e − N) b₀]. In Σ ℓ EA e b what
        a stiff fiber strains too much by turning acts along b, where that factor is soft: such
        steps diverge with EA. Magisano, Leonetti and Garcea 2017, Advantages of the mixed format in
        geometrically nonlinear analysis of beams and shells using solid finite elements, Int. J.
        Numer. Meth. Engng 109, pp. 1237–1262, doi 10.1002/nme.5322.
        """
        if self.tension_only or self._predicted is None:
            return np.zeros(len(self.strain))
        return self.length * (self.stiffness * self.strain - self._predicted)

    def add_lag(self, b: Floats) -> None:
        """Add Σ ℓ (EA e − N) (b₀ − b) to local coefficients."""
        if self._tangent_b is not None:
            self._add(b, self._unpredicted()[:, None] * (self._tangent_b - self._b))

    def lag_along(self, name: str) -> float:
        """This rank's Σ ℓ (EA e − N) (e_q₀ − e_q) of a global scalar; zero where it has none."""
        if name not in self._e_q or name not in self._tangent_e_q:
            return 0.0
        return float(self._unpredicted() @ (self._tangent_e_q[name] - self._e_q[name]))

    def _second_derivatives(self) -> _Second:
        """∂²Π of every segment in its own dofs and the scalars, at the present state.

        With t = F T, λ = |t| and n = t/λ at each point, c its weight, e = Σ c λ − 1, ℓ in mm, EA
        and the force N in N, and a, b any of the unknowns w and q:

            ∂e/∂a = Σ c n · ∂t/∂a,
            ∂²Π/∂a∂b = ℓ EA ∂e/∂a ∂e/∂b
                     + ℓ N Σ c [∂t/∂a · (I − n nᵀ)/λ · ∂t/∂b + n · ∂²t/∂a∂b].

        t is linear in w and in q; ∂²t/∂w∂q = T_z (∂ω/∂q) × φ alone does not vanish, and only in
        uniform bending. Material and geometric stiffness of a truss: Crisfield 1991, Non-linear
        Finite Element Analysis of Solids and Structures 1, chapter 3.
        """
        if self._second is not None:
            return self._second
        force, stiffness = self.force, self.stiffness
        if self._predicted is not None:
            force = np.maximum(self._predicted, 0) if self.tension_only else self._predicted
        if self.tension_only:
            slack = self.slack | self._at_rest if self._slackens else self.slack
            stiffness = np.where(slack, 0.0, stiffness)
        n = self._direction
        across = np.eye(3) - n[..., :, None] * n[..., None, :]
        pull = self.length[:, None] * force[:, None] * self._share
        across *= (pull / self._stretch)[..., None, None]
        stiff = self.length * stiffness
        side = across @ self._map
        count, width = self._dofs.shape
        block = self._map.reshape(count, -1, width).swapaxes(1, 2) @ side.reshape(count, -1, width)
        block += stiff[:, None, None] * (self._b[:, :, None] * self._b[:, None, :])
        mixed: dict[str, Floats] = {}
        scalars: dict[tuple[str, str], float] = {}
        carry = self._body.carry()
        for name, rate in self._rates.items():
            assert carry is not None
            turned = self._rise[..., None] * (cross_matrix(carry.rates[name][1]) @ self._value)
            geometric = _contract(rate, side) + _contract(pull[:, :, None] * n, turned)
            mixed[name] = geometric + (stiff * self._e_q[name])[:, None] * self._b
            for other, last in self._rates.items():
                turning = np.sum(rate * (across @ last[..., None])[..., 0])
                material = np.sum(stiff * self._e_q[name] * self._e_q[other])
                scalars[name, other] = float(turning + material)
        self._second = _Second(block, mixed, scalars)
        return self._second

    def add_tangent(self, matrix: PETSc.Mat, free: npt.NDArray[np.bool_]) -> None:
        """Add ∂²Π/∂w², summed facet by facet, on the free dofs."""
        self._tangent_b, self._tangent_e_q = self._b, self._e_q
        if not len(self._start):
            return
        sums = np.add.reduceat(self._second_derivatives().block, self._start, axis=0)
        dofs = self._dofs[self._start]
        keep = free[dofs].astype(float)
        sums *= keep[:, :, None] * keep[:, None, :]
        rows = dofs.astype(PETSc.IntType)
        matrix.setValuesLocalRCV(rows, rows, sums, PETSc.InsertMode.ADD_VALUES)

    # --- global scalars ------------------------------------------------------------------------

    def conjugate(self, name: str) -> float:
        """This rank's −∂Π/∂q of a global scalar; zero where it does not enter."""
        if name not in self._e_q:
            return 0.0
        return -float(np.sum(self.length * self.force * self._e_q[name]))

    def add_load(self, name: str, b: Floats) -> None:
        """Add ∂²Π/∂w∂q to local coefficients (owned and ghosts)."""
        if name in self._e_q:
            self._add(b, self._second_derivatives().mixed[name])

    def second_derivative(self, first: str, second: str) -> float:
        """This rank's ∂²Π/∂q∂r of two global scalars."""
        if first not in self._e_q or second not in self._e_q:
            return 0.0
        return self._second_derivatives().scalars[first, second]

    # --- memory of converged steps ---------------------------------------------------------

    def state(self) -> dict[str, Floats]:
        """Axial forces, from which the next step's first tangent is built."""
        return {"force": self.stiffness * self.strain}

    def extrapolate(self, states: list[dict[str, Floats]], weights: Floats) -> None:
        """Predicted force from a weighted sum of remembered states."""
        self._second = None
        self._slackens = False
        self._predicted = sum(
            (weight * state["force"] for weight, state in zip(weights, states, strict=True)),
            np.zeros(len(self.strain)),
        )
