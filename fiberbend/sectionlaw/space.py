"""Laws of a section that bends to the side and twists, from its law in the plane."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.sectionlaw.law import Derived, SectionLaw
from rod.functions import Floats

_STRAIGHT = 1e-9
"""Curvature of which no direction is told, over the greatest."""


@dataclasses.dataclass(frozen=True)
class Round(Derived):
    """A section that is alike in all directions: Φ(λ, κ; P), κ² = k_x² + k_y².

    The law in the plane is taken for the mean of itself and its mirror image, which it is but for
    the error of its table: so no moment is left where nothing is bent.

    Attributes:
        plane: by stretch and curvature.
    """

    plane: SectionLaw

    @property
    def strains(self) -> tuple[str, ...]:
        """Names of the strains."""
        return ("stretch", "curvature", "side_curvature")

    def _polar(self, strains: Floats) -> tuple[Floats, Floats, Floats]:
        """λ and κ, (n, 2), and λ and −κ; the direction of the curvature, (n, 2)."""
        turn = np.hypot(strains[:, 1], strains[:, 2])
        way = np.tile([1.0, 0.0], (len(strains), 1))
        bent = turn > 0
        way[bent] = strains[bent, 1:] / turn[bent, None]
        ahead = np.column_stack([strains[:, 0], turn])
        return ahead, ahead * [1.0, -1.0], way

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        ahead, behind, _ = self._polar(strains)
        found: Floats = self.plane.value(ahead, pressure) + self.plane.value(behind, pressure)
        return found / 2

    def _first_in_plane(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ by λ, κ and P, (n, 3)."""
        ahead, behind, _ = self._polar(strains)
        sign = np.array([1.0, -1.0, 1.0])
        both = self.plane.first(ahead, pressure) + sign * self.plane.first(behind, pressure)
        found: Floats = both / 2
        return found

    def first(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ by λ, k_x, k_y and P, (n, 4)."""
        force, moment, area = self._first_in_plane(strains, pressure).T
        _, _, way = self._polar(strains)
        return np.column_stack([force, moment[:, None] * way, area])

    def second(self, strains: Floats, pressure: float) -> Floats:
        """∂²Φ by λ, k_x, k_y and P, (n, 4, 4)."""
        ahead, behind, way = self._polar(strains)
        sign = np.array([1.0, -1.0, 1.0])
        own = self.plane.second(ahead, pressure)
        own = (own + np.outer(sign, sign) * self.plane.second(behind, pressure)) / 2
        turn = ahead[:, 1]
        least = _STRAIGHT * float(np.abs(self.plane.chart.least[1]))
        moment = self._first_in_plane(strains, pressure)[:, 1]
        across = np.where(turn > least, moment / np.maximum(turn, least), own[:, 1, 1])
        # from (λ, κ, P) to (λ, k_x, k_y, P), κ bent as a circle is
        carry = np.zeros((len(strains), 3, 4))
        carry[:, 0, 0] = carry[:, 2, 3] = 1.0
        carry[:, 1, 1:3] = way
        out: Floats = carry.transpose(0, 2, 1) @ own @ carry
        beside = np.column_stack([-way[:, 1], way[:, 0]])
        out[:, 1:3, 1:3] += across[:, None, None] * beside[:, :, None] * beside[:, None, :]
        return out

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`."""
        ahead, behind, _ = self._polar(strains)
        return self.plane.outside(ahead, pressure) or self.plane.outside(behind, pressure)


@dataclasses.dataclass(frozen=True)
class Space(Derived):
    """Φ = Φ₀(ε; P) + ½ Σ H_ij(ε; P) s_i s_j: s are strains that only loads make, and small.

    A symmetry of the section turns the sign of each s, so that Φ has no part linear in them. H are
    exact second derivatives of Φ at s = 0, as tables; Φ has exact derivatives in ε, s and P.

    Attributes:
        base: Φ₀.
        small: names of s.
        parts: i, j and H_ij.
        limits: greatest |s| at which the error of forces is known, rad/mm.
    """

    base: SectionLaw | Round
    small: tuple[str, ...]
    parts: tuple[tuple[int, int, SectionLaw | Round], ...]
    limits: tuple[float, ...]

    @property
    def strains(self) -> tuple[str, ...]:
        """Names of all strains, in the order of `rod.layout.STRAINS`."""
        order = ("stretch", "curvature", "side_curvature", "twist")
        return tuple(name for name in order if name in (*self.base.strains, *self.small))

    def _split(self, strains: Floats) -> tuple[list[int], list[int], Floats, Floats]:
        """Columns of ε and s, and both."""
        names = self.strains
        large = [names.index(name) for name in self.base.strains]
        small = [names.index(name) for name in self.small]
        return large, small, strains[:, large], strains[:, small]

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        _, _, large, s = self._split(strains)
        out = self.base.value(large, pressure)
        for i, j, part in self.parts:
            out = out + _weight(i, j) * s[:, i] * s[:, j] * part.value(large, pressure)
        return out

    def first(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ by strains and P, (n, m + 1)."""
        at, small, large, s = self._split(strains)
        inner = [*at, strains.shape[1]]
        out = np.zeros((len(strains), strains.shape[1] + 1))
        out[:, inner] = self.base.first(large, pressure)
        for i, j, part in self.parts:
            value, weight = part.value(large, pressure), _weight(i, j)
            square = weight * s[:, i] * s[:, j]
            out[:, inner] += square[:, None] * part.first(large, pressure)
            out[:, small[i]] += weight * s[:, j] * value
            out[:, small[j]] += weight * s[:, i] * value
        return out

    def second(self, strains: Floats, pressure: float) -> Floats:
        """∂²Φ by strains and P, (n, m + 1, m + 1)."""
        at, small, large, s = self._split(strains)
        n, m = strains.shape
        inner = [*at, m]
        out = np.zeros((n, m + 1, m + 1))
        block = np.ix_(range(n), inner, inner)
        out[block] = self.base.second(large, pressure)
        for i, j, part in self.parts:
            value, weight = part.value(large, pressure), _weight(i, j)
            slopes = part.first(large, pressure)
            square = weight * s[:, i] * s[:, j]
            out[block] += square[:, None, None] * part.second(large, pressure)
            out[:, small[i], small[j]] += weight * value
            out[:, small[j], small[i]] += weight * value
            for one, other in ((i, j), (j, i)):
                mixed = weight * s[:, other, None] * slopes
                out[:, small[one], inner] += mixed
                out[:, inner, small[one]] += mixed
        return out

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`."""
        _, _, large, s = self._split(strains)
        if found := self.base.outside(large, pressure):
            return found
        for name, limit, values in zip(self.small, self.limits, s.T, strict=True):
            most = float(np.abs(values).max(initial=0.0))
            if most > limit:
                return (
                    f"{name.replace('_', ' ')} {1e3 * most:.6g} 1/m, known up to "
                    f"{1e3 * limit:.6g} 1/m"
                )
        return ""


def _weight(i: int, j: int) -> float:
    return 0.5 if i == j else 1.0
