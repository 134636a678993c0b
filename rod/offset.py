"""A law whose strains are apart from those of another by what a pressure makes of the pieces."""

from __future__ import annotations

import dataclasses

import numpy as np

from rod.functions import Floats
from rod.law import Law, Sections, whole

_KEPT = 8
"""Pressures of which what they move is remembered."""


@dataclasses.dataclass(frozen=True)
class Offset:
    """Φ(ε − δ(P); P) with δ = Σ c_j P^(j + 1): the end of a chamber turns under pressure alone.

    It is a `rod.law.Law`. What turns it does work: the area of its chamber has the part of the
    forces along ∂δ/∂P.

    Attributes:
        law: of the forces.
        coefficients: c by power of P in MPa, piece and free strain, (d, n, m); or (d, m), of any
            piece.
    """

    law: Law
    coefficients: Floats
    _known: dict[tuple[float, ...], tuple[Floats, Floats, Floats]] = dataclasses.field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def _moved(self, pressure: float) -> tuple[Floats, Floats, Floats]:
        """δ and its first two derivatives by P, (n, m) or (m,) each."""
        power = 1.0 + np.arange(len(self.coefficients))
        value = pressure**power
        slope = power * pressure ** (power - 1)
        # of the first power none, also where P is zero
        bent = power * (power - 1) * pressure ** np.maximum(power - 2, 0.0)
        moved, first, second = (
            np.tensordot(each, self.coefficients, 1) for each in (value, slope, bent)
        )
        return moved, first, second

    def _turned(self, pressure: float) -> Floats:
        """δ alone, which is asked for most."""
        first, *others = self.coefficients
        out: Floats = pressure * first
        for power, coefficient in enumerate(others, 2):
            out = out + pressure**power * coefficient
        return out

    def whole(self, strains: Floats, pressures: Floats) -> Sections:
        """See `rod.law.whole`."""
        k, n, m = strains.shape
        moved, slope, bent = self._moves(tuple(pressures.tolist()))
        value, first, second = whole(self.law, strains - moved, pressures)
        pulled = second[..., :m, :m] @ np.broadcast_to(slope, (k, n, m))[..., None]
        mixed = second[..., :m, m] - pulled[..., 0]
        forces = first[..., :m]
        # dΦ/dP = ∂Φ/∂P − ∂Φ/∂ε · δ'
        second[..., m, m] -= np.sum((second[..., :m, m] + mixed) * slope + forces * bent, axis=-1)
        second[..., :m, m] = second[..., m, :m] = mixed
        first[..., m] -= np.sum(forces * slope, axis=-1)
        return Sections(value, first, second)

    def _moves(self, pressures: tuple[float, ...]) -> tuple[Floats, Floats, Floats]:
        """`_moved` of several; steps of a motion ask for the same few pressures again."""
        known = self._known
        if pressures not in known:
            if len(known) >= _KEPT:
                known.clear()
            m = self.coefficients.shape[-1]
            parts = zip(*map(self._moved, pressures), strict=True)
            a, b, c = (np.stack(part).reshape(len(pressures), -1, m) for part in parts)
            known[pressures] = a, b, c
        return known[pressures]

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.law.value(strains - self._turned(pressure), pressure)

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.law.gradient(strains - self._turned(pressure), pressure)

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.law.hessian(strains - self._turned(pressure), pressure)

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        moved, slope, _ = self._moved(pressure)
        here = strains - moved
        own = self.law.chamber(here, pressure)
        out: Floats = own + np.sum(self.law.gradient(here, pressure) * slope, axis=1)
        return out

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        moved, slope, _ = self._moved(pressure)
        here = strains - moved
        own = self.law.chamber_gradient(here, pressure)
        out: Floats = own + _times(self.law.hessian(here, pressure), slope)
        return out

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        moved, slope, bent = self._moved(pressure)
        here = strains - moved
        cross = 2 * self.law.chamber_gradient(here, pressure)
        cross = cross + _times(self.law.hessian(here, pressure), slope)
        forces = self.law.gradient(here, pressure)
        own = self.law.chamber_slope(here, pressure)
        out: Floats = own + np.sum(forces * bent - cross * slope, axis=1)
        return out

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`: of the law of the forces."""
        return self.law.outside(strains - self._turned(pressure), pressure)


def _times(matrices: Floats, vectors: Floats) -> Floats:
    """Products of (n, m, m) with (n, m) or (m,), (n, m)."""
    return np.einsum("nij,nj->ni", matrices, np.broadcast_to(vectors, matrices.shape[:2]))
