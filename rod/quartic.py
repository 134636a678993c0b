"""A law whose stiffness changes with its strains: of solid sections that are bent far."""

from __future__ import annotations

import dataclasses

import numpy as np

from rod.functions import Floats
from rod.law import Sections


@dataclasses.dataclass(frozen=True)
class Quartic:
    """Φ = ½ K e e + ⅙ L e e e + 1/24 Q e e e e with e = ε − ε₀, and no chamber.

    It is a `rod.law.Law`. Of fibers along the axis with energies U(λ), K, L and Q are the sums of
    areas, of the second to fourth derivative of U at rest, and of products of their levers.

    Attributes:
        stiffness: K, (m, m), N, N mm and N mm².
        cubic: L, (m, m, m), alike in all its places.
        quartic: Q, (m, m, m, m), alike in all its places.
        rest: ε₀, (m,).
    """

    stiffness: Floats
    cubic: Floats
    quartic: Floats
    rest: Floats

    def times(self, factor: float) -> Quartic:
        """The same law, as much stiffer."""
        stiffness, cubic, quartic = factor * self.stiffness, factor * self.cubic, self.quartic
        return Quartic(stiffness, cubic, factor * quartic, self.rest)

    def _bent(self, strains: Floats) -> tuple[Floats, Floats, Floats]:
        """e, and L e and Q e e, (n, m, m) each."""
        e = strains - self.rest
        n, m = e.shape
        # products of matrices: einsum takes longer for so few numbers
        cubic = (e @ self.cubic.reshape(m * m, m).T).reshape(n, m, m)
        pairs = (e[:, :, None] * e[:, None, :]).reshape(n, m * m)
        quartic = (pairs @ self.quartic.reshape(m * m, m * m).T).reshape(n, m, m)
        return e, cubic, quartic

    def whole(self, strains: Floats, pressures: Floats) -> Sections:
        """See `rod.law.whole`."""
        k, n, m = strains.shape
        e, cubic, quartic = self._bent(strains.reshape(k * n, m))
        column = e[:, :, None]
        parts = np.concatenate([cubic @ column, quartic @ column], axis=2)
        linear = e @ self.stiffness
        first, second = np.zeros((k * n, m + 1)), np.zeros((k * n, m + 1, m + 1))
        first[:, :m] = linear + parts @ (1 / 2, 1 / 6)
        second[:, :m, :m] = self.stiffness + cubic + quartic / 2
        value = np.sum(e * (linear / 2 + parts @ (1 / 6, 1 / 24)), axis=1)
        return Sections(
            value.reshape(k, n),
            first.reshape(k, n, m + 1),
            second.reshape(k, n, m + 1, m + 1),
        )

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        e, cubic, quartic = self._bent(strains)
        whole = self.stiffness / 2 + cubic / 6 + quartic / 24
        out: Floats = np.sum((whole @ e[:, :, None])[..., 0] * e, axis=1)
        return out

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        e, cubic, quartic = self._bent(strains)
        out: Floats = (self.stiffness + cubic / 2 + quartic / 6) @ e[:, :, None]
        return out[..., 0]

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        _, cubic, quartic = self._bent(strains)
        return self.stiffness + cubic + quartic / 2

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`: it has none."""
        return np.zeros(len(strains))

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return np.zeros_like(strains)

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return np.zeros(len(strains))

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`: nothing is."""
        return ""
