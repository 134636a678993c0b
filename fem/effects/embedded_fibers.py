"""Fibers embedded in the faces of solid elements: energy, force and tangent, vectorised."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.effects.effect import Natural
from fem.effects.mean_stretch import MeanStretch, Second
from fem.kinematics.kinematics import Kinematics
from fem.ranks import total
from geometry.mesh.data import facet_positions
from geometry.winding.segments import EmbeddedFibers

Floats = npt.NDArray[np.float64]

ROUND_OFF = 1e-12
"""Strains of fibers at rest are ±1e-15; one that carries in tension only is taut down to −this."""


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
        stiffness: axial stiffness EA of a whole fiber, N; of several that of every segment, (m,).
        tension_only: slack fibers carry nothing.
    """

    natural: Mapping[str, Natural] = {}
    conservative: bool = True
    pair_units: Mapping[str, tuple[str, str]] = {}
    thread: ClassVar[bool] = True
    """Its pieces are those of a winding, whose forces are told."""

    def pairs(self) -> dict[str, tuple[float, float]]:
        """None: it has a potential."""
        return {}

    def __init__(
        self,
        body: Kinematics,
        segments: EmbeddedFibers,
        stiffness: float | Floats,
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
        self.stiffness = (stiffness * segments.share)[self.index]
        self._along = MeanStretch(body, segments.lines(self.index))
        self._dofs = self._along.dofs
        self.block_dofs = self._dofs
        self._predicted: Floats | None = None
        self._second: Second | None = None
        self._slackens = False
        """The predicted motion shortens those fibers that are as long as at rest, as a whole."""
        self.strain = np.zeros(len(self.index))

    # --- state ---------------------------------------------------------------------------------

    def update(self, w: Floats) -> None:
        """Strain and its derivatives at the local coefficients w and the present scalars."""
        self._along.update(w)
        self.strain = self._along.value - 1
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
        self._along.add(b, (self.length * self.force)[:, None] * self._along.by_dofs)

    def add_noise(self, b: Floats) -> None:
        """Add the forces that round-off in the strains makes, at rest, to local coefficients."""
        force = self.length * self.stiffness * self._along.noise()
        self._along.add(b, force[:, None] * np.abs(self._along.by_dofs))

    def noise_along(self, name: str) -> float:
        """Sum of squares over the segments, whose strains round off each for itself."""
        along = self._along.by_scalar.get(name)
        if along is None:
            return 0.0
        noise = self.length * self.stiffness * self._along.noise() * along
        return float(noise @ noise)

    def predict(
        self, correction: Floats | None, scalars: Mapping[str, float] | None = None
    ) -> None:
        """Force EA (e + b₀·δw + e_q₀ δq), b₀ and e_q₀ those of the last tangent; None: EA e."""
        self._second = None
        self._slackens = False
        if correction is None:
            self._predicted = None
            return
        change = self._along.change(correction, scalars)
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
        self._along.add_lag(b, self._unpredicted())

    def lag_along(self, name: str) -> float:
        """This rank's Σ ℓ (EA e − N) (e_q₀ − e_q) of a global scalar; zero where it has none."""
        return self._along.lag_along(name, self._unpredicted())

    def _second_derivatives(self) -> Second:
        """∂²Π of every segment in its own dofs and the scalars, at the present state.

        With ℓ in mm, EA and the force N in N, and a, b any of the unknowns w and q:

            ∂²Π/∂a∂b = ℓ EA ∂e/∂a ∂e/∂b + ℓ N ∂²e/∂a∂b,

        material and geometric stiffness of a truss: Crisfield 1991, Non-linear Finite Element
        Analysis of Solids and Structures 1, chapter 3.
        """
        if self._second is not None:
            return self._second
        force, stiffness = self.force, self.stiffness
        if self._predicted is not None:
            force = np.maximum(self._predicted, 0) if self.tension_only else self._predicted
        if self.tension_only:
            slack = self.slack | self._at_rest if self._slackens else self.slack
            stiffness = np.where(slack, 0.0, stiffness)
        self._second = second = self._along.curved(self.length * force)
        stiff, first = self.length * stiffness, self._along.by_dofs
        block = second.block
        block += (stiff[:, None] * first)[:, :, None] * first[:, None, :]
        for name, rate in self._along.by_scalar.items():
            second.mixed[name] += (stiff * rate)[:, None] * first
            for other, last in self._along.by_scalar.items():
                second.scalars[name, other] += float(np.sum(stiff * rate * last))
        return self._second

    def tangent_blocks(self) -> Floats:
        """∂²Π/∂w² of every segment, (n, k, k)."""
        self._along.hold()
        return self._second_derivatives().block

    # --- global scalars ------------------------------------------------------------------------

    def conjugate(self, name: str) -> float:
        """This rank's −∂Π/∂q of a global scalar; zero where it does not enter."""
        if name not in self._along.by_scalar:
            return 0.0
        return -float(np.sum(self.length * self.force * self._along.by_scalar[name]))

    def add_load(self, name: str, b: Floats) -> None:
        """Add ∂²Π/∂w∂q to local coefficients (owned and ghosts)."""
        if name in self._along.by_scalar:
            self._along.add(b, self._second_derivatives().mixed[name])

    def second_derivative(self, first: str, second: str) -> float:
        """This rank's ∂²Π/∂q∂r of two global scalars."""
        if first not in self._along.by_scalar or second not in self._along.by_scalar:
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
