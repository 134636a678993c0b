"""A law of some strains, and beside it a quadratic form in all: of sections that shear."""

from __future__ import annotations

import dataclasses

import numpy as np

from rod.functions import Floats
from rod.law import Law, Sections, whole


@dataclasses.dataclass(frozen=True)
class Sheared:
    """Φ = Φ₀(ε; P) + ½ (ξ − ξ₀)·Q(P) (ξ − ξ₀): all strains ξ cost beside a law of some of them.

    It is a `rod.law.Law`. With ξ = (γ, ε) and Q = Wᵀ C W, W = (I, −B), no shear force acts where
    γ = B (ε − ε₀), and all else is there as without shear: B leads to the centre of shear. As Q
    grows with the pressure, a section that is sheared gives its chamber less room.

    Attributes:
        law: Φ₀.
        columns: places of ε among ξ.
        forms: Q by power of P in MPa from zero on, (d, m, m), symmetric; N, N mm and N mm².
        rest: ξ₀, (m,).

    Raises:
        ValueError: forms that are not symmetric, or of another number of strains.
    """

    law: Law
    columns: tuple[int, ...]
    forms: Floats
    rest: Floats

    def __post_init__(self) -> None:
        count, largest = len(self.rest), float(np.abs(self.forms).max())
        if self.forms.shape[1:] != (count, count) or not np.allclose(
            self.forms, self.forms.transpose(0, 2, 1), rtol=1e-12, atol=1e-12 * largest
        ):
            raise ValueError(f"forms: symmetric matrices of {count} × {count} expected")

    def _own(self, strains: Floats) -> Floats:
        return strains[:, self.columns]

    def _form(self, pressure: float, slopes: int = 0) -> Floats:
        """Q or a derivative of it by the pressure, (m, m)."""
        out: Floats = np.zeros_like(self.forms[0])
        for power in range(len(self.forms) - 1, slopes - 1, -1):
            out = pressure * out + np.prod(power - np.arange(slopes)) * self.forms[power]
        return out

    def _energy(self, strains: Floats, form: Floats) -> Floats:
        away = strains - self.rest
        out: Floats = np.sum(away @ form * away, axis=1) / 2
        return out

    def whole(self, strains: Floats, pressures: Floats) -> Sections:
        """See `rod.law.whole`."""
        k, n, m = strains.shape
        own = whole(self.law, strains[..., self.columns], pressures)
        at = pressures.tolist()
        form, slope, bend = (np.stack([self._form(p, order) for p in at]) for order in range(3))
        away = strains - self.rest
        pulled, grown = away @ form, away @ slope
        out = Sections(
            own.value + np.sum(pulled * away, axis=-1) / 2,
            np.empty((k, n, m + 1)),
            np.empty((k, n, m + 1, m + 1)),
        )
        out.first[..., :m], out.first[..., m] = pulled, np.sum(grown * away, axis=-1) / 2
        out.second[..., :m, :m] = form[:, None]
        out.second[..., :m, m] = out.second[..., m, :m] = grown
        out.second[..., m, m] = np.sum(away @ bend * away, axis=-1) / 2
        inner = np.array([*self.columns, m])
        out.first[..., inner] += own.first
        out.second[..., inner[:, None], inner] += own.second
        return out

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        own = self._energy(strains, self._form(pressure))
        return own + self.law.value(self._own(strains), pressure)

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        out: Floats = (strains - self.rest) @ self._form(pressure)
        out[:, self.columns] += self.law.gradient(self._own(strains), pressure)
        return out

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        out = np.empty((len(strains), *self.forms.shape[1:]))
        out[:] = self._form(pressure)
        rows = np.array(self.columns)[:, None]
        out[:, rows, self.columns] += self.law.hessian(self._own(strains), pressure)
        return out

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        own = self.law.chamber(self._own(strains), pressure)
        return own - self._energy(strains, self._form(pressure, 1))

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        out: Floats = -(strains - self.rest) @ self._form(pressure, 1)
        out[:, self.columns] += self.law.chamber_gradient(self._own(strains), pressure)
        return out

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        own = self.law.chamber_slope(self._own(strains), pressure)
        return own - self._energy(strains, self._form(pressure, 2))

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`: of Φ₀."""
        return self.law.outside(self._own(strains), pressure)
