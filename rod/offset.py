"""A law whose strains are apart from those of another by what a pressure makes of its piece."""

from __future__ import annotations

import dataclasses

import numpy as np

from rod.functions import Floats
from rod.law import Law


@dataclasses.dataclass(frozen=True)
class Offset:
    """Φ(ε − δ(P); P) with δ = Σ c_j P^(j + 1): the end of a chamber turns under pressure alone.

    It is a `rod.law.Law`. What turns it does work: the area of its chamber has the part of the
    forces along ∂δ/∂P.

    Attributes:
        law: of the forces.
        coefficients: c, (d, m), a row for each power of P in MPa, by the free strains.
    """

    law: Law
    coefficients: Floats

    def _moved(self, pressure: float) -> tuple[Floats, Floats, Floats]:
        """δ and its first two derivatives by P, (m,) each."""
        power = 1.0 + np.arange(len(self.coefficients))
        value = pressure**power
        slope = power * pressure ** (power - 1)
        # of the first power none, also where P is zero
        bent = power * (power - 1) * pressure ** np.maximum(power - 2, 0.0)
        return (
            value @ self.coefficients,
            slope @ self.coefficients,
            bent @ self.coefficients,
        )

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.law.value(strains - self._moved(pressure)[0], pressure)

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.law.gradient(strains - self._moved(pressure)[0], pressure)

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.law.hessian(strains - self._moved(pressure)[0], pressure)

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        moved, slope, _ = self._moved(pressure)
        here = strains - moved
        own = self.law.chamber(here, pressure)
        out: Floats = own + self.law.gradient(here, pressure) @ slope
        return out

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        moved, slope, _ = self._moved(pressure)
        here = strains - moved
        own = self.law.chamber_gradient(here, pressure)
        out: Floats = own + self.law.hessian(here, pressure) @ slope
        return out

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        moved, slope, bent = self._moved(pressure)
        here = strains - moved
        stiff = slope @ self.law.hessian(here, pressure) @ slope
        cross = self.law.chamber_gradient(here, pressure) @ slope
        own = self.law.chamber_slope(here, pressure)
        out: Floats = own - 2 * cross - stiff + self.law.gradient(here, pressure) @ bent
        return out

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`: of the law of the forces."""
        return self.law.outside(strains - self._moved(pressure)[0], pressure)
