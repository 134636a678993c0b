"""A law of some strains, and beside it a quadratic form in all: of sections that shear."""

from __future__ import annotations

import dataclasses

import numpy as np

from rod.functions import Floats
from rod.law import Law


@dataclasses.dataclass(frozen=True)
class Sheared:
    """Φ = Φ₀(ε; P) + ½ (ξ − ξ₀)·Q (ξ − ξ₀): all strains ξ cost beside a law of some of them.

    It is a `rod.law.Law`. With ξ = (γ, ε) and Q = Wᵀ C W, W = (I, −B), no shear force acts where
    γ = B (ε − ε₀), and all else is there as without shear: B leads to the centre of shear.

    Attributes:
        law: Φ₀.
        columns: places of ε among ξ.
        form: Q, (m, m), symmetric; N, N mm and N mm².
        rest: ξ₀, (m,).

    Raises:
        ValueError: a form that is not symmetric, or of another number of strains.
    """

    law: Law
    columns: tuple[int, ...]
    form: Floats
    rest: Floats

    def __post_init__(self) -> None:
        count, largest = len(self.rest), float(np.abs(self.form).max())
        if self.form.shape != (count, count) or not np.allclose(
            self.form, self.form.T, rtol=1e-12, atol=1e-12 * largest
        ):
            raise ValueError(f"form: a symmetric matrix of {count} × {count} expected")

    def _own(self, strains: Floats) -> Floats:
        return strains[:, self.columns]

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        away = strains - self.rest
        own: Floats = np.sum(away @ self.form * away, axis=1) / 2
        return own + self.law.value(self._own(strains), pressure)

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        out: Floats = (strains - self.rest) @ self.form
        out[:, self.columns] += self.law.gradient(self._own(strains), pressure)
        return out

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        out = np.empty((len(strains), *self.form.shape))
        out[:] = self.form
        rows = np.array(self.columns)[:, None]
        out[:, rows, self.columns] += self.law.hessian(self._own(strains), pressure)
        return out

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`: a section that shears keeps its area, and its way along its normal."""
        return self.law.chamber(self._own(strains), pressure)

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        out = np.zeros_like(strains)
        out[:, self.columns] = self.law.chamber_gradient(self._own(strains), pressure)
        return out

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.law.chamber_slope(self._own(strains), pressure)

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`: of Φ₀."""
        return self.law.outside(self._own(strains), pressure)
