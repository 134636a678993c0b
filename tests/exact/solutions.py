"""Exact solutions of incompressible elasticity for laws W(I1), to verify a solver against.

mm, N, MPa. With the isochoric energy W(Ī1) + p (J − 1) the Cauchy stress at J = 1 is
σ = p I + 2 W' (b − I1/3 I), so the multiplier p is the mean stress tr σ / 3.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

Floats = NDArray[np.float64]
Slope = Callable[[Floats], Floats]
"""dW/dI1 in MPa as a function of I1."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


def yeoh_slope(c1: float, c2: float = 0.0, c3: float = 0.0) -> Slope:
    """Derivative of W = c1 (I1 − 3) + c2 (I1 − 3)² + c3 (I1 − 3)³; neo-Hooke is c1 = μ/2."""
    return lambda i1: c1 + 2 * c2 * (i1 - 3) + 3 * c3 * (i1 - 3) ** 2


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
        slope: dW/dI1.
        inner: inner radius at rest, A.
        outer: outer radius at rest, B.
        deformed_inner: inner radius, a.
        stretch: axial stretch, λz.
        outside: pressure on the outer surface, MPa.
    """

    slope: Slope
    inner: float
    outer: float
    deformed_inner: float
    stretch: float = 1.0
    outside: float = 0.0

    def radius(self, R: Floats | float) -> Floats:
        """Deformed radius of the material at radius R."""
        return np.sqrt(self.deformed_inner**2 + (np.square(R) - self.inner**2) / self.stretch)

    def _stretches(self, R: Floats | float) -> tuple[Floats, Floats, Floats]:
        """λr, λθ and 2 W'."""
        around = self.radius(R) / R
        across = 1 / (around * self.stretch)
        i1 = across**2 + around**2 + self.stretch**2
        return across, around, 2 * self.slope(i1)

    def radial_stress(self, R: Floats | float) -> Floats:
        """Cauchy stress σ_rr, from dσ_rr/dr = (σ_θθ − σ_rr)/r and the outer surface."""

        def rate(s: Floats) -> Floats:
            across, around, twice = self._stretches(s)
            return twice * (around**2 - across**2) / (around**2 * s * self.stretch)

        return -self.outside - _integral(rate, R, self.outer)

    @property
    def pressure(self) -> float:
        """Pressure inside, MPa."""
        return -float(self.radial_stress(self.inner))

    @property
    def axial_force(self) -> float:
        """Force on a section less the thrust π a² of the pressure on closed ends, N."""

        def axial(R: Floats) -> Floats:
            across, _, twice = self._stretches(R)
            stress = self.radial_stress(R) + twice * (self.stretch**2 - across**2)
            return stress * R / self.stretch

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
        across, around, twice = self._stretches(R)
        third = (across**2 + around**2 + self.stretch**2) / 3
        return self.radial_stress(R) - twice * (across**2 - third)


def closed_tube(slope: Slope, inner: float, outer: float, deformed_inner: float) -> Tube:
    """A tube whose closed ends are free: λz follows from the thrust."""

    def force(stretch: float) -> float:
        return Tube(slope, inner, outer, deformed_inner, stretch).axial_force

    stretch = brentq(force, 0.8, 1.3, xtol=1e-14)
    return Tube(slope, inner, outer, deformed_inner, stretch)


def wound_tube(
    slope: Slope, inner: float, outer: float, stretch: float, stiffness: float = math.inf
) -> Tube:
    """A tube with closed free ends and hoops on its outer surface.

    The hoops press on the tube; `outside` is that pressure. They carry no axial load, so the
    thrust of the pressure inside alone balances the section.

    Args:
        slope: dW/dI1.
        inner: inner radius at rest, mm.
        outer: outer radius at rest, mm.
        stretch: axial stretch.
        stiffness: axial stiffness EA of the hoops per reference length of the tube, N/mm; without
            it they cannot stretch and r(B) = B.
    """

    def at(radius: float) -> Tube:
        deformed_inner = math.sqrt(radius**2 - (outer**2 - inner**2) / stretch)
        bare = Tube(slope, inner, outer, deformed_inner, stretch)
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
        slope: dW/dI1.
        outer: radius, mm.
        twist: ψ, rad/mm.
    """

    slope: Slope
    outer: float
    twist: float

    def _twice(self, R: Floats) -> Floats:
        return 2 * self.slope(3 + (self.twist * R) ** 2)

    def radial_stress(self, R: Floats) -> Floats:
        """Cauchy stress σ_rr = σ_zz."""
        return -_integral(lambda s: self._twice(s) * self.twist**2 * s, R, self.outer)

    @property
    def moment(self) -> float:
        """Torque, N mm."""

        def shear(R: Floats) -> Floats:
            return 2 * math.pi * self._twice(R) * self.twist * R**3

        return float(_integral(shear, 0.0, self.outer))

    @property
    def axial_force(self) -> float:
        """Axial force that keeps the length, N; negative: the bar would grow."""
        return float(_integral(lambda R: 2 * math.pi * self.radial_stress(R) * R, 0.0, self.outer))

    def displacement(self, X: Floats) -> Floats:
        """Displacement at reference points (n, 3)."""
        c, s = np.cos(self.twist * X[:, 2]), np.sin(self.twist * X[:, 2])
        x, y = X[:, 0], X[:, 1]
        return np.column_stack([c * x - s * y - x, s * x + c * y - y, np.zeros_like(x)])

    def multiplier(self, X: Floats) -> Floats:
        """Mean stress p at reference points (n, 3)."""
        R = np.hypot(X[:, 0], X[:, 1])
        return self.radial_stress(R) + self._twice(R) * (self.twist * R) ** 2 / 3


@dataclasses.dataclass(frozen=True)
class Flexure:
    """Plane-strain bending of a block 0 ≤ Y ≤ H about the x axis by moments alone.

    r² = 2 α Y + β and θ = Z/α, toward −y; both curved faces are free, so r₁ r₂ = α².

    Attributes:
        slope: dW/dI1.
        thickness: H, mm.
        length_per_angle: α, mm/rad.
    """

    slope: Slope
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

    def _stretches(self, r: Floats) -> tuple[Floats, Floats, Floats]:
        """λr, λθ and 2 W'."""
        around = r / self.length_per_angle
        across = 1 / around
        return across, around, 2 * self.slope(1 + across**2 + around**2)

    def _radial_stress(self, r: Floats) -> Floats:
        def rate(s: Floats) -> Floats:
            across, around, twice = self._stretches(s)
            return twice * (around**2 - across**2) / s

        return -_integral(rate, r, self.radii[1])

    @property
    def moment(self) -> float:
        """Moment per depth, N."""

        def around(r: Floats) -> Floats:
            across, hoop, twice = self._stretches(r)
            return (self._radial_stress(r) + twice * (hoop**2 - across**2)) * r

        return float(_integral(around, *self.radii))

    def displacement(self, X: Floats) -> Floats:
        """Displacement at reference points (n, 3); the centre of curvature is y = −α, z = 0."""
        r, angle = self._radius(X[:, 1]), X[:, 2] / self.length_per_angle
        y, z = r * np.cos(angle) - self.length_per_angle, r * np.sin(angle)
        return np.column_stack([np.zeros_like(r), y - X[:, 1], z - X[:, 2]])

    def multiplier(self, X: Floats) -> Floats:
        """Mean stress p at reference points (n, 3)."""
        r = self._radius(X[:, 1])
        across, around, twice = self._stretches(r)
        third = (1 + across**2 + around**2) / 3
        return self._radial_stress(r) - twice * (across**2 - third)


def sphere_pressure(slope: Slope, inner: float, outer: float, deformed_inner: float) -> float:
    """Pressure in MPa inside a thick sphere of radii A, B (mm) whose inner radius is a."""

    def rate(R: Floats) -> Floats:
        r = np.cbrt(deformed_inner**3 + R**3 - inner**3)
        stretch = r / R
        twice = 2 * slope(2 * stretch**2 + stretch**-4)
        return 2 * twice * (stretch**2 - stretch**-4) * R**2 / r**3

    return float(_integral(rate, inner, outer))


def sphere_limit(slope: Slope, inner: float, outer: float) -> tuple[float, float]:
    """Limit point of a thick sphere: a/A and the greatest pressure in MPa, 1 ≤ a/A ≤ 2."""
    best = minimize_scalar(
        lambda ratio: -sphere_pressure(slope, inner, outer, ratio * inner),
        bounds=(1.0, 2.0),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return float(best.x), -float(best.fun)
