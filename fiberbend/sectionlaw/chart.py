"""Coordinates in which the states that a rod takes fill a box."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from fiberbend.sectionlaw.polynomial import Polynomial
from rod.functions import Floats


@dataclasses.dataclass(frozen=True)
class Chart:
    """u = (z − z₀(P))/h(P), each from 0 to 1, of z = (λ − λ₀(c, P), c), c curvatures and twist.

    λ₀ is about the stretch at which nothing pulls along the line: forces on a rod change it by
    little, what bends and inflates it by much. z₀ = l + d P and h = a + b P follow the strains of
    the free section: bent as far without pressure, a section buckles, and has no smooth law.

    Attributes:
        unpulled: λ₀ by y = (c, P).
        least: l, the least of each, 1 and rad/mm.
        drifts: d, 1/MPa and rad/mm/MPa.
        widths: a, 1 and rad/mm.
        growths: b, 1/MPa and rad/mm/MPa.
    """

    unpulled: Polynomial
    least: tuple[float, ...]
    drifts: tuple[float, ...]
    widths: tuple[float, ...]
    growths: tuple[float, ...]

    def sizes(self, pressure: Floats | float) -> Floats:
        """h, (..., m), at pressures."""
        grown = np.asarray(pressure)[..., None] * np.array(self.growths)
        sizes: Floats = np.array(self.widths) + grown
        return sizes

    def place(self, strains: Floats, pressure: Floats | float) -> Floats:
        """u, (n, m), by λ and c."""
        return self._away(strains, pressure) / self.sizes(pressure)

    def _away(self, strains: Floats, pressure: Floats | float) -> Floats:
        """z − z₀, (n, m)."""
        z = strains - self._least(pressure)
        z[:, 0] -= self.unpulled.value(_beside(strains, pressure))
        return z

    def _least(self, pressure: Floats | float) -> Floats:
        """z₀, (..., m)."""
        moved = np.asarray(pressure)[..., None] * np.array(self.drifts)
        least: Floats = np.array(self.least) + moved
        return least

    def strains(self, points: Floats) -> Floats:
        """λ and c, (n, m), by u and P."""
        z: Floats = self._least(points[:, -1]) + points[:, :-1] * self.sizes(points[:, -1])
        z[:, 0] += self.unpulled.value(_beside(z, points[:, -1]))
        return z

    def first(self, strains: Floats, pressure: float) -> Floats:
        """∂(u, P)/∂(λ, c, P), (n, m + 1, m + 1), at strains, (n, m)."""
        return self.placed(strains, pressure)[1]

    def second(self, strains: Floats, slopes: Floats, pressure: float) -> Floats:
        """Σ_j f_j ∂²u_j/∂(λ, c, P)², (n, m + 1, m + 1).

        Args:
            strains: λ and c, (n, m).
            slopes: f, derivatives by u of what is carried over, (n, m).
            pressure: P, MPa.
        """
        return self.placed(strains, pressure)[2](slopes)

    def placed(
        self, strains: Floats, pressure: Floats | float
    ) -> tuple[Floats, Floats, Callable[[Floats], Floats]]:
        """`place`, `first` and, by f, `second`, which share what is dear."""
        n, m = strains.shape
        h, growths = self.sizes(pressure), np.array(self.growths)
        unpulled, rise, bent = self.unpulled.all(_beside(strains, pressure))
        away = strains - self._least(pressure)
        away[:, 0] -= unpulled
        inner = np.arange(m)
        moved = np.array(self.drifts) + away * growths / h
        first = np.zeros((n, m + 1, m + 1))
        first[:, inner, inner], first[:, m, m] = 1.0 / h, 1.0
        first[:, 0, 1:] -= rise / h[..., :1]
        first[:, :m, m] -= moved / h

        def second(slopes: Floats) -> Floats:
            out = np.zeros((n, m + 1, m + 1))
            by_z = slopes / h
            out[:, 1:, 1:] = -by_z[:, :1, None] * bent
            # z_j/h_j: a part in ∂z and ∂h, which hangs on P alone
            mixed = -by_z * growths / h
            own = mixed.copy()
            own[:, 1:] -= mixed[:, :1] * rise[:, :-1]
            out[:, inner, m] += own
            out[:, m, inner] += own
            out[:, m, m] -= 2 * mixed[:, 0] * rise[:, -1]
            out[:, m, m] -= 2 * np.sum(mixed * moved, axis=1)
            return out

        return away / h, first, second

    def back(self, points: Floats) -> Floats:
        """∂(λ, c, P)/∂(u, P), (n, m + 1, m + 1)."""
        n, m = len(points), points.shape[1] - 1
        out = np.zeros((n, m + 1, m + 1))
        inner = np.arange(m)
        out[:, inner, inner], out[:, m, m] = self.sizes(points[:, -1]), 1.0
        out[:, :m, m] = np.array(self.drifts) + points[:, :m] * np.array(self.growths)
        rise = self.unpulled.first(_beside(self.strains(points), points[:, -1]))
        out[:, 0] += np.einsum("ni,nij->nj", rise, out[:, 1:])
        return out

    def carried(self, points: Floats, forces: Floats) -> Floats:
        """∂Φ by u and P, (n, m + 1), by those by λ, c and P."""
        found: Floats = np.einsum("ni,nij->nj", forces, self.back(points))
        return found

    def forces(self, points: Floats, slopes: Floats) -> Floats:
        """∂Φ by λ, c and P, (n, m + 1), by those by u and P: `carried` undone."""
        back = self.back(points).transpose(0, 2, 1)
        found: Floats = np.linalg.solve(back, slopes[:, :, None])[:, :, 0]
        return found

    def bent(self, points: Floats, forces: Floats, second: Floats) -> Floats:
        """∂²Φ by u and P, (n, m + 1, m + 1), by first and second ones by λ, c and P."""
        back, m = self.back(points), points.shape[1] - 1
        out: Floats = back.transpose(0, 2, 1) @ second @ back
        y = _beside(self.strains(points), points[:, -1])
        rise, inner = self.unpulled.first(y), back[:, 1:]
        curved = inner.transpose(0, 2, 1) @ self.unpulled.second(y) @ inner
        out += forces[:, :1, None] * curved
        own = forces[:, :m].copy()
        own[:, 1:] += forces[:, :1] * rise[:, :-1]
        mixed = own * np.array(self.growths)
        out[:, np.arange(m), m] += mixed
        out[:, m, np.arange(m)] += mixed
        return out


def _beside(strains: Floats, pressure: Floats | float) -> Floats:
    """y = (c, P), (n, m)."""
    return np.column_stack([strains[:, 1:], np.broadcast_to(pressure, len(strains))])
