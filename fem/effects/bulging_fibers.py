"""Smeared fibers on rubber that bulges between their turns: energy, force and tangent."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from fem.effects.embedded_fibers import FiberPotential
from fem.effects.mean_stretch import MeanStretch, Second
from fem.kinematics.kinematics import Kinematics
from geometry.mesh.data import MeshData
from geometry.mesh.reference import jacobians
from geometry.winding.segments import Lines, SmearedFibers
from materials.bulging import Bulging

Floats = npt.NDArray[np.float64]


def along_axis(mesh: MeshData, lines: Lines) -> Lines:
    """Lines along the actuator's axis through the points of others on a surface parallel to it.

    Args:
        mesh: the mesh; a section has no z of its own.
        lines: on the surface.
    """
    if mesh.nodes.shape[1] == 2:
        tangents, axial = np.zeros_like(lines.tangents), np.ones_like(lines.axial)
    else:
        jacobian = jacobians(mesh, lines.cell, lines.points)[1]
        tangents = np.linalg.solve(jacobian, np.array([[0.0], [0.0], [1.0]]))[..., 0]
        axial = np.zeros_like(lines.axial)
    return dataclasses.replace(lines, tangents=tangents, axial=axial)


class BulgingPotential(FiberPotential):
    """Π = Σ ½ S ℓ e², S = EA/(1 + EA ρ/(K_b r²)): the fiber in series with the rubber under it.

    Of e, the strain of the surface along the fiber, the bulge b takes b/r; the fiber's own strain
    is e − b/r. It presses on the surface by T/r per length, all fibers together by T ρ/r per area,
    ρ their length per area, which the bulge carries: K_b b = T ρ/r. So T = EA (e − b/r) = S e, and
    fiber and bulge together store ½ S e² per length of fiber. 1/r is the curvature of the fiber's
    path at rest: on straight pieces of the outline S = EA.

    K_b depends on λ_z = |F e_z|, the stretch along the axis at the point, so that Π is a function
    of two stretches of the surface there. Their derivatives, with a and b any of the unknowns and
    S' = dS/dλ_z:

        ∂Π/∂a = Σ ℓ [S e ∂e/∂a + ½ S' e² ∂λ_z/∂a],
        ∂²Π/∂a∂b = Σ ℓ [S ∂e/∂a ∂e/∂b + S' e (∂e/∂a ∂λ_z/∂b + ∂λ_z/∂a ∂e/∂b)
                        + ½ S'' e² ∂λ_z/∂a ∂λ_z/∂b + S e ∂²e/∂a∂b + ½ S' e² ∂²λ_z/∂a∂b].

    The force S e and the force across it, ½ S' e², may be those that Newton's last correction
    predicts; see `FiberPotential`.

    Args:
        body: the kinematics.
        segments: pieces of fiber; those of cells owned elsewhere are left out.
        stiffness: axial stiffness EA of a whole fiber, N.
        bulging: stiffness K_b of the bulge.
        tension_only: slack fibers carry nothing, and no rubber bulges under them.
    """

    def __init__(
        self,
        body: Kinematics,
        segments: SmearedFibers,
        stiffness: float,
        bulging: Bulging,
        tension_only: bool = False,
    ) -> None:
        super().__init__(body, segments, stiffness, tension_only)
        self._bulging = bulging
        self._whole = self.stiffness
        curvature, density = segments.curvature[self.index], segments.density[self.index]
        self._bent = np.flatnonzero(curvature)
        """Segments that are curved, (m,): λ_z enters there alone."""
        self._softness = (stiffness * density * curvature**2 / bulging.stiffness)[self._bent]
        """EA ρ/(K0 r²): bulge over fiber in flexibility, at λ_z = 1, (m,)."""
        lines = segments.lines(self.index[self._bent])
        self._axial = MeanStretch(body, along_axis(body.domain.data, lines))
        self._predicted_across: Floats | None = None

    def update(self, w: Floats) -> None:
        """Strains, stiffness and their derivatives at local coefficients w and the scalars."""
        super().update(w)
        self._axial.update(w)
        factor, slope, bend = self._bulging.factor(self._axial.value)
        bent, soft = self._bent, self._softness
        whole, both = self._whole[bent], factor + soft
        # S = EA m/(m + h) with m = K_b/K0 and h = EA ρ/(K0 r²)
        self.stiffness = self._whole.copy()
        self.stiffness[bent] *= factor / both
        taut = self.strain[bent]
        if self.tension_only:
            taut = np.maximum(taut, 0.0)
        first = whole * soft * slope / both**2
        second = whole * soft * (bend - 2 * slope**2 / both) / both**2
        self._across, self._coupling = first * taut**2 / 2, first * taut
        """∂/∂λ_z and ∂²/∂e∂λ_z of the energy per length, N, (m,)."""
        self._axial_stiffness = second * taut**2 / 2

    # --- first derivative ------------------------------------------------------------------------

    def add_residual(self, b: Floats) -> None:
        """Add ∂Π/∂w to local coefficients."""
        super().add_residual(b)
        pull = self.length[self._bent] * self._across
        self._axial.add(b, pull[:, None] * self._axial.by_dofs)

    def conjugate(self, name: str) -> float:
        """This rank's −∂Π/∂q of a global scalar; zero where it does not enter."""
        found = super().conjugate(name)
        if name in self._axial.by_scalar:
            pull = self.length[self._bent] * self._across
            found -= float(np.sum(pull * self._axial.by_scalar[name]))
        return found

    # --- second derivative -----------------------------------------------------------------------

    def predict(
        self, correction: Floats | None, scalars: Mapping[str, float] | None = None
    ) -> None:
        """Both forces from the values and gradients at the last tangent; None: the present ones."""
        super().predict(correction, scalars)
        self._predicted_across = None
        if correction is None:
            return
        assert self._predicted is not None
        strain = self._along.change(correction, scalars)[self._bent]
        stretch = self._axial.change(correction, scalars)
        self._predicted[self._bent] += self._coupling * stretch
        self._predicted_across = (
            self._across + self._coupling * strain + self._axial_stiffness * stretch
        )

    def _second_derivatives(self) -> Second:
        """∂²Π of every segment in its own dofs and the scalars, at the present state."""
        if self._second is not None:
            return self._second
        whole = super()._second_derivatives()
        bent, length = self._bent, self.length[self._bent]
        across = self._across
        if self._predicted_across is not None:
            across = self._predicted_across
            if self.tension_only and self._predicted is not None:
                across = np.where(self._predicted[bent] > 0, across, 0.0)
        part = self._axial.curved(length * across)
        coupling, stiff = length * self._coupling, length * self._axial_stiffness
        e, z = self._along.by_dofs[bent], self._axial.by_dofs
        # half of what is symmetric, and its transpose
        sides = coupling[:, None] * e + (stiff / 2)[:, None] * z
        half = sides[:, :, None] * z[:, None, :]
        whole.block[bent] += part.block + half + half.swapaxes(1, 2)
        for name, by_z in self._axial.by_scalar.items():
            by_e = self._along.by_scalar[name][bent]
            whole.mixed[name][bent] += (
                part.mixed[name]
                + (coupling * by_z)[:, None] * e
                + (coupling * by_e + stiff * by_z)[:, None] * z
            )
            for other, last in self._axial.by_scalar.items():
                mixed = by_e * last + by_z * self._along.by_scalar[other][bent]
                whole.scalars[name, other] += part.scalars[name, other] + float(
                    np.sum(coupling * mixed + stiff * by_z * last)
                )
        return whole

    # --- memory of converged steps ---------------------------------------------------------

    def state(self) -> dict[str, Floats]:
        """Both forces, from which the next step's first tangent is built."""
        across = np.zeros(len(self.index))
        across[self._bent] = self._across
        return {**super().state(), "across": across}

    def extrapolate(self, states: list[dict[str, Floats]], weights: Floats) -> None:
        """Predicted forces from a weighted sum of remembered states."""
        super().extrapolate(states, weights)
        self._predicted_across = sum(
            (
                weight * state["across"][self._bent]
                for weight, state in zip(weights, states, strict=True)
            ),
            np.zeros(len(self._bent)),
        )
