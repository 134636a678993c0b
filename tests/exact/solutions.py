"""Exact solutions of incompressible elasticity for any isotropic law, to verify a solver against.

mm, N, MPa. With the principal stretches λi and βi = λi ∂W/∂λi the principal Cauchy stresses are βi
but for a pressure. With the energy W of the isochoric deformation and p (J − 1) the multiplier p is
the mean stress tr σ / 3.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from analytic.stress import PrincipalStresses

Floats = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


def _integral(f: Callable[[Floats], Floats], low: Floats | float, high: Floats | float) -> Floats:
    """∫ f from `low` to `high`, elementwise; to round-off for the smooth integrands here."""
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    half = (high - low)[..., None] / 2
    result: Floats = np.sum(f(half * _NODES + (high + low)[..., None] / 2) * half * _WEIGHTS, -1)
    return result


@dataclasses.dataclass(frozen=True)
class Tube:
    """Inflation and uniform extension of a thick tube about the z axis, r² = a² + (R² − A²)/λz.

    Attributes:
        law: the rubber.
        inner: inner radius at rest, A.
        outer: outer radius at rest, B.
        deformed_inner: inner radius, a.
        stretch: axial stretch, λz.
        outside: pressure on the outer surface, MPa.
    """

    law: PrincipalStresses
    inner: float
    outer: float
    deformed_inner: float
    stretch: float = 1.0
    outside: float = 0.0

    def radius(self, R: Floats | float) -> Floats:
        """Deformed radius of the material at radius R."""
        return np.sqrt(self.deformed_inner**2 + (np.square(R) - self.inner**2) / self.stretch)

    def _stresses(self, R: Floats | float) -> tuple[Floats, Floats, Floats]:
        """βr, βθ, βz."""
        around = self.radius(R) / R
        along = np.full_like(around, self.stretch)
        return self.law(1 / (around * along), around, along)

    def radial_stress(self, R: Floats | float) -> Floats:
        """Cauchy stress σ_rr, from dσ_rr/dr = (σ_θθ − σ_rr)/r and the outer surface."""

        def rate(s: Floats) -> Floats:
            across, around, _ = self._stresses(s)
            return (around - across) * s / (self.radius(s) ** 2 * self.stretch)

        return -self.outside - _integral(rate, R, self.outer)

    @property
    def pressure(self) -> float:
        """Pressure inside, MPa."""
        return -float(self.radial_stress(self.inner))

    @property
    def axial_force(self) -> float:
        """Force on a section less the thrust π a² of the pressure on closed ends, N."""

        def axial(R: Floats) -> Floats:
            across, _, along = self._stresses(R)
            return (self.radial_stress(R) + along - across) * R / self.stretch

        section = 2 * math.pi * float(_integral(axial, self.inner, self.outer))
        return section - math.pi * self.deformed_inner**2 * self.pressure

    def displacement(self, X: Floats) -> Floats:
        """Displacement at reference points (n, 3)."""
        R = np.hypot(X[:, 0], X[:, 1])
        factor = self.radius(R) / R - 1
        return np.column_stack([X[:, :2] * factor[:, None], (self.stretch - 1) * X[:, 2]])

    def multiplier(self, X: Floats) -> Floats:
        """Mean stress p at reference points (n, 3)."""
        R = np.hypot(X[:, 0], X[:, 1])
        across, around, along = self._stresses(R)
        return self.radial_stress(R) - across + (across + around + along) / 3


@dataclasses.dataclass(frozen=True)
class LayeredTube:
    """A thick tube in another: the outer one presses on the inner one, and the mean stress jumps.

    Attributes:
        within: the inner tube.
        around: the outer tube.
    """

    within: Tube
    around: Tube

    @classmethod
    def inflated(
        cls,
        laws: tuple[PrincipalStresses, PrincipalStresses],
        radii: tuple[float, float, float],
        deformed_inner: float,
    ) -> LayeredTube:
        """In plane strain.

        Args:
            laws: of the inner and of the outer rubber.
            radii: at rest, from the cavity outwards, mm.
            deformed_inner: radius of the cavity, mm.
        """
        bare = Tube(laws[0], radii[0], radii[1], deformed_inner)
        around = Tube(laws[1], radii[1], radii[2], float(bare.radius(radii[1])))
        return cls(dataclasses.replace(bare, outside=around.pressure), around)

    @property
    def pressure(self) -> float:
        """Pressure inside, MPa."""
        return self.within.pressure

    def displacement(self, X: Floats) -> Floats:
        """Displacement at reference points (n, 3)."""
        return self.within.displacement(X)

    def multiplier(self, X: Floats) -> Floats:
        """Mean stress p at reference points (n, 3), on one side of the face between."""
        inner = np.hypot(X[:, 0], X[:, 1]) < self.around.inner
        return np.where(inner, self.within.multiplier(X), self.around.multiplier(X))


def closed_tube(law: PrincipalStresses, inner: float, outer: float, deformed_inner: float) -> Tube:
    """A tube whose closed ends are free: λz follows from the thrust."""

    def force(stretch: float) -> float:
        return Tube(law, inner, outer, deformed_inner, stretch).axial_force

    stretch = brentq(force, 0.8, 1.3, xtol=1e-14)
    return Tube(law, inner, outer, deformed_inner, stretch)


def wound_tube(
    law: PrincipalStresses, inner: float, outer: float, stretch: float, stiffness: float = math.inf
) -> Tube:
    """A tube with closed free ends and hoops on its outer surface.

    The hoops press on the tube; `outside` is that pressure. They carry no axial load, so the
    thrust of the pressure inside alone balances the section.

    Args:
        law: the rubber.
        inner: inner radius at rest, mm.
        outer: outer radius at rest, mm.
        stretch: axial stretch.
        stiffness: axial stiffness EA of the hoops per reference length of the tube, N/mm; without
            it they cannot stretch and r(B) = B.
    """

    def at(radius: float) -> Tube:
        deformed_inner = math.sqrt(radius**2 - (outer**2 - inner**2) / stretch)
        bare = Tube(law, inner, outer, deformed_inner, stretch)
        # the same pressure more inside and outside moves nothing, and adds π b² of thrust
        return dataclasses.replace(bare, outside=bare.axial_force / (math.pi * radius**2))

    def tension(radius: float) -> float:
        return stiffness * (radius / outer - 1) - at(radius).outside * radius * stretch

    if math.isinf(stiffness):
        return at(outer)
    return at(brentq(tension, outer, 1.2 * outer, xtol=1e-15, rtol=1e-15))


@dataclasses.dataclass(frozen=True)
class Torsion:
    """Torsion of a solid cylinder about the z axis at constant length, θ = Θ + ψ Z.

    Attributes:
        law: the rubber.
        outer: radius, mm.
        twist: ψ, rad/mm.
    """

    law: PrincipalStresses
    outer: float
    twist: float

    def _stresses(self, R: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """βr, and of the two other directions θθ, zz and the shear θz.

        In simple shear by γ = ψ R the stretches are (√(4 + γ²) ± γ)/2, and the greatest one makes
        the angle φ with the direction of shear, tan 2φ = 2/γ.
        """
        shear = self.twist * R
        root = np.sqrt(4 + shear**2)
        first, second, radial = self.law((root + shear) / 2, (root - shear) / 2, np.ones_like(R))
        mean, half = (first + second) / 2, (first - second) / 2
        return radial, mean + half * shear / root, mean - half * shear / root, 2 * half / root

    def radial_stress(self, R: Floats) -> Floats:
        """Cauchy stress σ_rr, from dσ_rr/dr = (σ_θθ − σ_rr)/r and the free outer surface."""

        def rate(s: Floats) -> Floats:
            radial, around, _, _ = self._stresses(s)
            return (around - radial) / s

        return -_integral(rate, R, self.outer)

    @property
    def moment(self) -> float:
        """Torque, N mm."""

        def shear(R: Floats) -> Floats:
            return 2 * math.pi * self._stresses(R)[3] * R**2

        return float(_integral(shear, 0.0, self.outer))

    @property
    def axial_force(self) -> float:
        """Axial force that keeps the length, N; negative: the bar would grow."""

        def axial(R: Floats) -> Floats:
            radial, _, along, _ = self._stresses(R)
            return 2 * math.pi * (self.radial_stress(R) + along - radial) * R

        return float(_integral(axial, 0.0, self.outer))

    def displacement(self, X: Floats) -> Floats:
        """Displacement at reference points (n, 3)."""
        c, s = np.cos(self.twist * X[:, 2]), np.sin(self.twist * X[:, 2])
        x, y = X[:, 0], X[:, 1]
        return np.column_stack([c * x - s * y - x, s * x + c * y - y, np.zeros_like(x)])

    def multiplier(self, X: Floats) -> Floats:
        """Mean stress p at reference points (n, 3)."""
        R = np.hypot(X[:, 0], X[:, 1])
        radial, around, along, _ = self._stresses(R)
        return self.radial_stress(R) - radial + (radial + around + along) / 3


@dataclasses.dataclass(frozen=True)
class Flexure:
    """Plane-strain bending of a block 0 ≤ Y ≤ H about the x axis by moments alone.

    r² = 2 α Y + β and θ = Z/α, toward −y; both curved faces are free, so r₁ r₂ = α².

    Attributes:
        law: the rubber.
        thickness: H, mm.
        length_per_angle: α, mm/rad.
    """

    law: PrincipalStresses
    thickness: float
    length_per_angle: float

    @property
    def radii(self) -> tuple[float, float]:
        """Deformed radii r₁ and r₂ of the faces Y = 0 and Y = H, mm."""
        H, alpha = self.thickness, self.length_per_angle
        first = math.sqrt(alpha * (math.hypot(alpha, H) - H))
        return first, alpha**2 / first

    def _radius(self, Y: Floats) -> Floats:
        result: Floats = np.sqrt(2 * self.length_per_angle * Y + self.radii[0] ** 2)
        return result

    def _stresses(self, r: Floats) -> tuple[Floats, Floats, Floats]:
        """βr, βθ, βx."""
        around = r / self.length_per_angle
        return self.law(1 / around, around, np.ones_like(around))

    def _radial_stress(self, r: Floats) -> Floats:
        def rate(s: Floats) -> Floats:
            across, around, _ = self._stresses(s)
            return (around - across) / s

        return -_integral(rate, r, self.radii[1])

    @property
    def moment(self) -> float:
        """Moment per depth, N."""

        def around(r: Floats) -> Floats:
            across, hoop, _ = self._stresses(r)
            return (self._radial_stress(r) + hoop - across) * r

        return float(_integral(around, *self.radii))

    def displacement(self, X: Floats) -> Floats:
        """Displacement at reference points (n, 3); the centre of curvature is y = −α, z = 0."""
        r, angle = self._radius(X[:, 1]), X[:, 2] / self.length_per_angle
        y, z = r * np.cos(angle) - self.length_per_angle, r * np.sin(angle)
        return np.column_stack([np.zeros_like(r), y - X[:, 1], z - X[:, 2]])

    def multiplier(self, X: Floats) -> Floats:
        """Mean stress p at reference points (n, 3)."""
        r = self._radius(X[:, 1])
        across, around, along = self._stresses(r)
        return self._radial_stress(r) - across + (across + around + along) / 3


def sphere_pressure(
    law: PrincipalStresses, inner: float, outer: float, deformed_inner: float
) -> float:
    """Pressure in MPa inside a thick sphere of radii A, B (mm) whose inner radius is a."""

    def rate(R: Floats) -> Floats:
        r = np.cbrt(deformed_inner**3 + R**3 - inner**3)
        stretch = r / R
        around, _, across = law(stretch, stretch, stretch**-2)
        return 2 * (around - across) * R**2 / r**3

    return float(_integral(rate, inner, outer))


def sphere_limit(law: PrincipalStresses, inner: float, outer: float) -> tuple[float, float]:
    """Limit point of a thick sphere: a/A and the greatest pressure in MPa, 1 ≤ a/A ≤ 2."""
    best = minimize_scalar(
        lambda ratio: -sphere_pressure(law, inner, outer, ratio * inner),
        bounds=(1.0, 2.0),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return float(best.x), -float(best.fun)
