"""Rubber that bulges between the turns of a winding: a spring in series with the thread."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Bulging:
    """Stiffness per area against a bulge of rubber between the turns.

    A thread on a curve of radius r presses with T/r per length; the rubber bulges between the turns
    by b, so that the thread strains by e − b/r where its surface strains by e. The bulge costs
    ½ K_b b² per area, K_b = K0 [1 + a1 (λ_z − 1) + a2 (λ_z − 1)²] with λ_z the stretch along the
    actuator's axis at that point.

    Attributes:
        stiffness: K0, MPa/mm.
        linear: a1.
        quadratic: a2.

    Raises:
        ValueError: K_b is not positive at every stretch λ_z > 0: K0 ≤ 0; a2 < 0; a parabola that
            reaches zero there, which none does with 4 a2 > a1².
    """

    stiffness: float
    linear: float = 0.0
    quadratic: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.stiffness) and self.stiffness > 0):
            raise ValueError(
                f"bulging stiffness {self.stiffness} MPa/mm, expected a finite value above zero"
            )
        if not self._least() > 0:
            raise ValueError(
                f"bulging stiffness 1 + {self.linear:.6g} (λz − 1) + {self.quadratic:.6g} "
                "(λz − 1)²: expected a value above zero at every stretch λz > 0, as with "
                "4 a2 > a1²"
            )

    def _least(self) -> float:
        """Infimum of K_b/K0 over λ_z > 0, nan of what is no number."""
        a1, a2 = self.linear, self.quadratic
        if not (math.isfinite(a1) and math.isfinite(a2)):
            return math.nan
        if a2 < 0 or (a2 == 0 and a1 < 0):
            return -math.inf
        lowest = max(-a1 / (2 * a2), -1.0) if a2 > 0 else -1.0
        return 1 + a1 * lowest + a2 * lowest**2

    def factor(self, stretch: Floats) -> tuple[Floats, Floats, Floats]:
        """K_b/K0 and its first two derivatives by λ_z, at stretches λ_z (n,)."""
        part = stretch - 1.0
        slope = self.linear + 2 * self.quadratic * part
        value = 1.0 + part * (self.linear + self.quadratic * part)
        return value, slope, np.full(len(part), 2 * self.quadratic)
