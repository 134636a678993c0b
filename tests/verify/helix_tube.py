"""Exact state of a round tube wound with smeared helices: extension, inflation and torsion."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import root

from materials.bulging import Bulging

Floats = npt.NDArray[np.float64]
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)
_TINY = 1e-30


@dataclasses.dataclass(frozen=True)
class HelixTube:
    """r² = a² + (R² − A²)/λ and θ = Θ + ψ Z hold the tube in equilibrium; a, λ, ψ are found.

    A material that is isotropic and incompressible, and a membrane that is alike all around, leave
    only these three free: the exact state is where the potential is stationary in them.

    Attributes:
        c1: Yeoh's first coefficient, MPa.
        c2: Yeoh's second coefficient, MPa.
        inner: inner radius at rest A, mm.
        outer: outer radius at rest B, where the fibers are, mm.
        pitch: rise of a turn, mm.
        stiffness: EA of a fiber, N.
        hands: 1 for each right-handed helix, −1 for each left-handed one.
        bulging: stiffness of the rubber that bulges by b, alike all around and one more unknown;
            None where none does.
    """

    c1: float
    c2: float
    inner: float
    outer: float
    pitch: float
    stiffness: float
    hands: tuple[int, ...]
    bulging: Bulging | None = None

    def potential(self, a: Any, stretch: Any, twist: Any, pressure: Any, bulge: Any = 0.0) -> Any:
        """Potential per mm of length, N; analytic, so that complex steps differentiate it."""
        half = (self.outer - self.inner) / 2
        R = self.inner + half * (_NODES + 1)
        square = a * a + (R * R - self.inner**2) / stretch
        i1 = R * R / (square * stretch**2) + square / R**2 + stretch**2 + twist**2 * square
        energy = self.c1 * (i1 - 3) + self.c2 * (i1 - 3) ** 2
        total = 2 * math.pi * half * np.sum(_WEIGHTS * energy * R)
        turn = math.hypot(2 * math.pi * self.outer, self.pitch)
        radius = np.sqrt(a * a + (self.outer**2 - self.inner**2) / stretch)
        for hand in self.hands:
            around = radius * (2 * math.pi * hand + twist * self.pitch) / turn
            strain = np.sqrt(around**2 + (stretch * self.pitch / turn) ** 2) - 1
            # a helix of radius B has the curvature sin²/B
            strain -= bulge * (2 * math.pi * self.outer / turn) ** 2 / self.outer
            total += turn / self.pitch * self.stiffness * strain**2 / 2
        if self.bulging is not None:
            longer = np.sqrt(stretch**2 + (twist * radius) ** 2) - 1
            law = self.bulging
            per_area = law.stiffness * (1 + law.linear * longer + law.quadratic * longer**2)
            total += 2 * math.pi * self.outer * per_area * bulge**2 / 2
        return total - pressure * math.pi * a * a * stretch

    @property
    def _bulges(self) -> list[float]:
        """The bulge at rest, if there is one."""
        return [] if self.bulging is None else [0.0]

    def _balance(
        self, a: float, stretch: float, twist: float, pressure: float, *bulge: float
    ) -> list[float]:
        """Derivatives of the potential by a, λ, ψ and the bulge, to round-off."""
        rows = []
        for i in (0, 1, 2, *(4 for _ in bulge)):
            state = np.array([a, stretch, twist, pressure, *bulge], dtype=complex)
            state[i] += 1j * _TINY
            rows.append(float(self.potential(*state).imag) / _TINY)
        return rows

    def at_stretch(self, stretch: float) -> float:
        """The pressure in MPa that stretches the tube."""
        a = math.sqrt(self.outer**2 - (self.outer**2 - self.inner**2) / stretch)
        start = [a, 0.0, 0.03, *self._bulges]
        found = root(lambda q: self._balance(q[0], stretch, *q[1:]), start, tol=1e-14)
        return float(found.x[2])

    def at_pressure(self, pressure: float) -> tuple[float, float]:
        """Stretch and twist in rad/mm, followed from rest."""
        state = np.array([self.inner, 1.0, 0.0, *self._bulges])
        for part in np.linspace(0.1, 1.0, 10):
            now = part * pressure
            state = root(
                lambda q, p=now: self._balance(q[0], q[1], q[2], p, *q[3:]), state, tol=1e-14
            ).x
        return float(state[1]), float(state[2])
