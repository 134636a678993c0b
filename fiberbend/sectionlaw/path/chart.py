"""Coordinates about the free states of a section."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.sectionlaw.path.curve import Curve
from rod.functions import Floats


@dataclasses.dataclass(frozen=True)
class PathChart:
    """u = (δλ + a(P)·δc, δc)/s(P) with δ = ε − ε₀(P), c curvatures and twist, |u| ≤ 1.

    ε₀ are the free states, next to enough. a = ∂²Φ/∂λ∂c over ∂²Φ/∂λ² there: where a section is bent
    or twisted a little further, nothing pulls along it at u_λ = 0. s grows with the pressure, which
    keeps a wall from buckling, from a part of it at rest. Its signs follow the free states: of a
    section and of its mirror image the law is made at the same u.

    Attributes:
        path: ε₀ and a by P, (4 + 3).
        sizes: s at the greatest pressure, (4,): 1 and rad/mm.
        least: part of s at rest.
    """

    path: Curve
    sizes: tuple[float, ...]
    least: float = 1.0

    def share(self, pressure: float) -> tuple[float, float]:
        """s over that at the greatest pressure, and its slope by P."""
        high = float(self.path.lines[-1])
        return self.least + (1 - self.least) * pressure / high, (1 - self.least) / high

    def at(self, pressure: float) -> Floats:
        """|s|, (4,)."""
        sizes: Floats = self.share(pressure)[0] * np.abs(self.sizes)
        return sizes

    def _at(self, pressure: float) -> tuple[Floats, Floats]:
        """ε₀ and A = ∂u/∂ε with their first two derivatives by P, (3, 4) and (3, 4, 4)."""
        found, s = np.array(self.path.at(pressure)), np.array(self.sizes)
        plain = np.zeros((3, 4, 4))
        plain[0] = np.diag(1.0 / s)
        plain[:, 0, 1:] = found[:, 4:] / s[0]
        # over the share of the sizes, whose second derivative is zero
        share, slope = self.share(pressure)
        turn = plain / share
        turn[1] -= slope / share * turn[0]
        turn[2] -= 2 * slope / share * turn[1]
        return found[:, :4], turn

    def free(self, pressure: float) -> Floats:
        """ε₀, (4,)."""
        return self.path.at(pressure)[0][:4]

    def place(self, strains: Floats, pressure: float) -> Floats:
        """u, (n, 4), by ε."""
        free, turn = self._at(pressure)
        out: Floats = (strains - free[0]) @ turn[0].T
        return out

    def strains(self, points: Floats) -> Floats:
        """ε, (n, 4), by u and P, (n, 5)."""
        return np.array([self._back(point)[0] for point in points])

    def placed(self, strains: Floats, pressure: float) -> tuple[Floats, Floats, Floats, Floats]:
        """u and its derivatives at strains.

        Returns:
            u, (n, 4); ∂(u, P)/∂(ε, P), (n, 5, 5); ∂²u/∂ε∂P, (4, 4), alike everywhere, and ∂²u/∂P²,
            (n, 4).
        """
        free, turn = self._at(pressure)
        away = strains - free[0]
        first = np.zeros((len(strains), 5, 5))
        first[:, :4, :4], first[:, 4, 4] = turn[0], 1.0
        first[:, :4, 4] = away @ turn[1].T - turn[0] @ free[1]
        bent = away @ turn[2].T - 2 * turn[1] @ free[1] - turn[0] @ free[2]
        return away @ turn[0].T, first, turn[1], bent

    def _back(self, point: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """ε = ε₀ + B u, ∂(ε, P)/∂(u, P), (5, 5), ∂²ε/∂u∂P, (4, 4), and ∂²ε/∂P², (4,)."""
        found, s = np.array(self.path.at(float(point[4]))), np.array(self.sizes)
        plain = np.zeros((3, 4, 4))
        plain[0] = np.diag(s)
        plain[:, 0, 1:] = -found[:, 4:] * s[1:]
        share, slope = self.share(float(point[4]))
        back = share * plain
        back[1] += slope * plain[0]
        back[2] += 2 * slope * plain[1]
        free, u = found[:, :4], point[:4]
        first = np.zeros((5, 5))
        first[:4, :4], first[4, 4] = back[0], 1.0
        first[:4, 4] = free[1] + back[1] @ u
        return free[0] + back[0] @ u, first, back[1], free[2] + back[2] @ u

    def carried(self, point: Floats, slopes: Floats, second: Floats) -> tuple[Floats, Floats]:
        """First and second derivatives by u and P of what is known by ε and P.

        Args:
            point: u and P, (5,).
            slopes: ∂Φ/∂(ε, P), (5,).
            second: ∂²Φ/∂(ε, P)², (5, 5).
        """
        _, first, mixed, bent = self._back(point)
        out = first.T @ second @ first
        more = mixed.T @ slopes[:4]
        out[:4, 4] += more
        out[4, :4] += more
        out[4, 4] += bent @ slopes[:4]
        return first.T @ slopes, out
