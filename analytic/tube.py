"""Exact states of a round tube with fibers around it: extension, inflation and torsion.

A thick tube of one isotropic, incompressible material, A ≤ R ≤ B, with families of fibers on its
outer surface, its ends closed. A material and a membrane that are alike along the tube and around
it leave the universal deformation (Adkins and Rivlin 1955, Phil. Trans. R. Soc. A 248, 201)

    r² = a² + (R² − A²)/λ,   φ = Θ + ψ Z,   z = λ Z

three free numbers: inner radius a, stretch λ, twist ψ. The exact state is where

    Π = ∫ W 2π R dR + Σ 2π B k (λf − 1)²/2 − P π a² λ − N λ − T ψ

per mm of length at rest is stationary. λf is the stretch of a family, which leans by α from the
axis: λf² = ((b/B) sin α + b ψ cos α)² + (λ cos α)² with b = r(B). A family that cannot be stretched
has λf = 1 instead, and its tension is the multiplier.

Signs: an angle α > 0 is a right-handed helix, ψ > 0 turns the end at greater Z counterclockwise
seen from there, so that a right-handed family unwinds (ψ < 0) under pressure. N pulls the ends, in
addition to the pressure on them; T turns the end at greater Z as ψ does. mm, N, MPa, rad.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from analytic.stress import Floats, PrincipalStresses

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)
_NEAR = 1e-8
"""Half the difference of two squared stretches below which their axes are not told apart."""
_STEP = 1e-6
_CLOSE = 1e-12
_SMALLEST = 1 / 4096
_LAXEST = 1e-6


@dataclasses.dataclass(frozen=True)
class Family:
    """Parallel fibers all around the outer surface.

    Attributes:
        angle: lean from the axis α, rad, between −π/2 and π/2; above zero: right-handed.
        stiffness: axial stiffness of a fiber times fibers per width across them, N/mm; infinite:
            the fibers cannot be stretched.

    Raises:
        ValueError: an angle outside, or a stiffness that is not positive.
    """

    angle: float
    stiffness: float = math.inf

    def __post_init__(self) -> None:
        if not -math.pi / 2 <= self.angle <= math.pi / 2:
            raise ValueError(f"angle {self.angle} rad: expected −π/2 to π/2")
        if not self.stiffness > 0:
            raise ValueError(f"stiffness {self.stiffness} N/mm: expected a positive value")

    @property
    def inextensible(self) -> bool:
        """Whether its length is kept."""
        return math.isinf(self.stiffness)


@dataclasses.dataclass(frozen=True)
class Held:
    """What is given: one of each pair; a force or torque of zero where neither is.

    Attributes:
        pressure: P in the chamber, MPa.
        volume: of the chamber per mm of length at rest, mm²; instead of P.
        force: N that pulls the closed ends, N.
        stretch: λ instead of N.
        torque: T on the ends, N mm.
        twist: ψ in rad per mm at rest, instead of T.

    Raises:
        ValueError: neither pressure nor volume, or both of a pair.
    """

    pressure: float | None = None
    volume: float | None = None
    force: float | None = None
    stretch: float | None = None
    torque: float | None = None
    twist: float | None = None

    def __post_init__(self) -> None:
        pairs = (
            ("pressure", "volume", self.pressure, self.volume),
            ("force", "stretch", self.force, self.stretch),
            ("torque", "twist", self.torque, self.twist),
        )
        for load, place, one, other in pairs:
            if one is not None and other is not None:
                raise ValueError(f"{load} and {place} are both given: expected one of them")
        if self.pressure is None and self.volume is None:
            raise ValueError("expected a pressure or a volume")

    @property
    def targets(self) -> list[tuple[str, float]]:
        """Names of attributes of a state and the values that they shall have."""
        found = []
        for load, place in (("pressure", "volume"), ("force", "stretch"), ("torque", "twist")):
            given: float | None = getattr(self, place)
            found.append((load, getattr(self, load) or 0.0) if given is None else (place, given))
        return found


@dataclasses.dataclass(frozen=True)
class TubeState:
    """A state of equilibrium.

    Attributes:
        inner: inner radius a, mm.
        stretch: λ.
        twist: ψ, rad per mm of length at rest.
        pressure: P, MPa.
        force: N that pulls the closed ends, N.
        torque: T on the ends, N mm.
        tensions: of each family, N per mm of width at rest across its fibers.
    """

    inner: float
    stretch: float
    twist: float
    pressure: float
    force: float
    torque: float
    tensions: tuple[float, ...]

    @property
    def volume(self) -> float:
        """Of the chamber per mm of length at rest, mm²."""
        return math.pi * self.inner**2 * self.stretch


@dataclasses.dataclass(frozen=True)
class Tube:
    """A tube at rest.

    Attributes:
        law: λi ∂W/∂λi of its material, MPa.
        inner: inner radius A, mm.
        outer: outer radius B, where the fibers are, mm.
        families: of fibers.

    Raises:
        ValueError: radii that leave no wall.
    """

    law: PrincipalStresses
    inner: float
    outer: float
    families: tuple[Family, ...] = ()

    def __post_init__(self) -> None:
        if not 0 < self.inner < self.outer:
            raise ValueError(f"radii {self.inner} and {self.outer} mm: expected a wall")

    @property
    def rest(self) -> TubeState:
        """Nothing acts on it."""
        return TubeState(self.inner, 1.0, 0.0, 0.0, 0.0, 0.0, (0.0,) * len(self.families))

    def outer_radius(self, inner: float, stretch: float) -> float:
        """b in mm."""
        return math.sqrt(inner**2 + (self.outer**2 - self.inner**2) / stretch)

    def solve(self, held: Held, start: TubeState | None = None) -> TubeState:
        """The state that is reached when what is held goes to its values in proportion.

        Args:
            held: what is given.
            start: a state to go on from; None: rest.

        Raises:
            ValueError: no state is found, as beyond a greatest pressure, or where families leave
                the tube no way to move.
        """
        here = self.rest if start is None else start
        targets = held.targets
        begun = [float(getattr(here, name)) for name, _ in targets]
        done, step = 0.0, 1.0
        while done < 1:
            part = min(1.0, done + step)
            now = [(name, a + part * (b - a)) for a, (name, b) in zip(begun, targets, strict=True)]
            found = self._newton(here, now)
            if found is not None:
                here, done, step = found, part, 2 * step
            elif step > _SMALLEST:
                step /= 2
            else:
                given = ", ".join(f"{name} {value:g}" for name, value in now)
                raise ValueError(f"no state of the tube is found at {given}")
        return here

    # --- equilibrium ---------------------------------------------------------------------------

    def solid_slopes(self, inner: float, stretch: float, twist: float) -> Floats:
        """Derivatives of the wall's energy per mm by a, λ and ψ, (3,); N/mm, N, N mm.

        dW = S : dC/2, with S = Σ (λi ∂W/∂λi) λi⁻² Ni ⊗ Ni of the principal axes: R, and two in the
        plane of Θ and Z.
        """
        half = (self.outer - self.inner) / 2
        R = self.inner + half * (_NODES + 1)
        beyond = R * R - self.inner**2
        q = inner**2 + beyond / stretch
        dq = np.stack([np.full_like(R, 2 * inner), -beyond / stretch**2, np.zeros_like(R)])
        along = np.array([0.0, 1.0, 0.0])[:, None]
        turn = np.array([0.0, 0.0, 1.0])[:, None]
        radial = R * R / (q * stretch**2)
        hoop, shear, axial = q / R**2, q * twist / R, stretch**2 + q * twist**2
        d_radial = -radial * (dq / q + 2 * along / stretch)
        d_hoop, d_shear = dq / R**2, (twist * dq + q * turn) / R
        d_axial = 2 * stretch * along + twist**2 * dq + 2 * q * twist * turn
        mean, lean = (hoop + axial) / 2, (hoop - axial) / 2
        # so small a difference leaves the mean of both, which is then the value for any axes
        apart = np.sqrt(lean**2 + shear**2 + _NEAR**2)
        great, small = mean + apart, mean - apart
        s_r, s_1, s_2 = (
            stress / square
            for stress, square in zip(
                self.law(np.sqrt(radial), np.sqrt(great), np.sqrt(small)),
                (radial, great, small),
                strict=True,
            )
        )
        both, split = (s_1 + s_2) / 2, (s_1 - s_2) / (2 * apart)
        work = s_r * d_radial + both * (d_hoop + d_axial)
        work += split * (lean * (d_hoop - d_axial) + 2 * shear * d_shear)
        slopes: Floats = math.pi * half * (work * R) @ _WEIGHTS
        return slopes

    def _fiber(self, family: Family, place: Floats) -> tuple[float, Floats]:
        """λf of a family and its derivatives by a, λ, ψ, (3,)."""
        inner, stretch, twist = place
        b = self.outer_radius(inner, stretch)
        sine, cosine = math.sin(family.angle), math.cos(family.angle)
        rate = sine / self.outer + twist * cosine
        around, along = b * rate, stretch * cosine
        length = math.hypot(around, along)
        grown = (self.outer**2 - self.inner**2) / (2 * b * stretch**2)
        return length, np.array(
            [
                around * rate * inner / b,
                along * cosine - around * rate * grown,
                around * b * cosine,
            ]
        ) / length

    def _residual(self, x: Floats, targets: Sequence[tuple[str, float]]) -> Floats:
        """What vanishes: three derivatives of Π, what is held, λf − 1 of what keeps its length."""
        inner, stretch, _, pressure, force, torque = x[:6]
        slopes = self.solid_slopes(*x[:3])
        slopes -= pressure * math.pi * inner * np.array([2 * stretch, inner, 0.0])
        slopes -= np.array([0.0, force, torque])
        kept, number = [], 6
        for family in self.families:
            length, by = self._fiber(family, x[:3])
            if family.inextensible:
                tension = x[number]
                kept.append(length - 1)
                number += 1
            else:
                tension = family.stiffness * (length - 1)
            slopes += 2 * math.pi * self.outer * tension * by
        state = self._state(x)
        gaps = [getattr(state, name) - value for name, value in targets]
        return np.array([*slopes, *gaps, *kept])

    def _state(self, x: Floats) -> TubeState:
        number, tensions = 6, []
        for family in self.families:
            if family.inextensible:
                tensions.append(float(x[number]))
                number += 1
            else:
                tensions.append(family.stiffness * (self._fiber(family, x[:3])[0] - 1))
        inner, stretch, twist, pressure, force, torque = (float(value) for value in x[:6])
        return TubeState(inner, stretch, twist, pressure, force, torque, tuple(tensions))

    def _newton(self, start: TubeState, targets: Sequence[tuple[str, float]]) -> TubeState | None:
        """A state near another one; None where there is none."""
        own = [t for f, t in zip(self.families, start.tensions, strict=True) if f.inextensible]
        x = np.array([start.inner, start.stretch, start.twist])
        x = np.array([*x, start.pressure, start.force, start.torque, *own])
        small = self.law(np.array(1 + _STEP), np.array(1.0), np.array(1 / (1 + _STEP)))
        modulus = float(small[0] - small[2]) / (4 * _STEP)
        B = self.outer
        scale = np.array([B, 1.0, 1 / B, modulus, modulus * B**2, modulus * B**3])
        scale = np.concatenate([scale, np.full(len(own), modulus * B)])
        last = math.inf
        for _ in range(60):
            with np.errstate(invalid="ignore", divide="ignore"):
                gaps = self._residual(x, targets)
                tangent = self._tangent(x, scale, targets)
            if not (np.all(np.isfinite(gaps)) and np.all(np.isfinite(tangent))):
                return None
            rows = np.abs(tangent).max(axis=1)
            scaled = tangent / rows[:, None]
            if not np.linalg.cond(scaled) < 1e13:
                return None
            move = np.linalg.solve(scaled, -gaps / rows)
            size = float(np.abs(move).max())
            if size < _CLOSE or (last < _LAXEST and size >= last / 2):
                return self._state(x)
            # a fifth of a radius and of the length at once
            kept = min(1.0, 0.2 / float(np.abs(move[:3]).max() + 1e-300))
            x = x + kept * scale * move
            last = size
            if not (x[0] > 0 and x[1] > 0):
                return None
        return None

    def _tangent(self, x: Floats, scale: Floats, targets: Sequence[tuple[str, float]]) -> Floats:
        """Derivatives of the residual by the scaled unknowns, of differences of exact slopes."""
        columns = []
        for step in np.diag(_STEP * scale):
            up, down = self._residual(x + step, targets), self._residual(x - step, targets)
            columns.append((up - down) / (2 * _STEP))
        return np.stack(columns, axis=1)
