"""Laws of a section: energy per length at rest by strains and chamber pressure."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from rod.functions import Bools, Floats


class Law(Protocol):
    """Φ(ε; P), N mm per mm, of n pieces at once, with exact first and second derivatives.

    ε are the free strains of the rod, (n, m), in the order of its layout; P in MPa. Conjugates of
    shears and stretch are forces in N, of curvatures and twist moments in N mm. What the air does
    is in Φ: −∂Φ/∂P is the area of the chamber per length at rest, mm².
    """

    def value(self, strains: Floats, pressure: float) -> Floats:
        """Φ, (n,), N."""

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ/∂ε, (n, m)."""

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """∂²Φ/∂ε², (n, m, m)."""

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """−∂Φ/∂P, (n,), mm²."""

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """−∂²Φ/∂ε∂P, (n, m)."""

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """−∂²Φ/∂P², (n,), mm²/MPa: how a section whose strains are held takes more air."""

    def outside(self, strains: Floats, pressure: float) -> str:
        """What is beyond the range in which the law is known; empty where nothing is."""


class Sections(NamedTuple):
    """Φ of n pieces at k places, and all its derivatives by the strains and, last, the pressure."""

    value: Floats
    """(k, n), N."""
    first: Floats
    """(k, n, m + 1)."""
    second: Floats
    """(k, n, m + 1, m + 1)."""


def whole(law: Law, strains: Floats, pressures: Floats) -> Sections:
    """All of a law at several places: by its own `whole`, where that is quicker.

    Args:
        law: of n pieces.
        strains: (k, n, m).
        pressures: of each place, (k,), MPa.
    """
    # looking for an attribute is a tenth of the time that asking a protocol takes
    own: Callable[[Floats, Floats], Sections] | None = getattr(law, "whole", None)
    if own is not None:
        return own(strains, pressures)
    k, n, m = strains.shape
    out = Sections(np.empty((k, n)), np.empty((k, n, m + 1)), np.empty((k, n, m + 1, m + 1)))
    for i, pressure in enumerate(pressures.tolist()):
        at = strains[i], pressure
        out.value[i] = law.value(*at)
        out.first[i, :, :m], out.first[i, :, m] = law.gradient(*at), -law.chamber(*at)
        out.second[i, :, :m, :m], out.second[i, :, m, m] = law.hessian(*at), -law.chamber_slope(*at)
        out.second[i, :, :m, m] = out.second[i, :, m, :m] = -law.chamber_gradient(*at)
    return out


@dataclasses.dataclass(frozen=True)
class Linear:
    """Φ = ½ (ε − ε₀)·K (ε − ε₀) − P (A + a·(ε − ε₀)): constant stiffness and a chamber.

    Attributes:
        stiffness: K, (m, m): GA_x, GA_y, EA in N, EI_x, EI_y, GJ in N mm² on its diagonal.
        rest: ε₀, (m,): the strains without load.
        area: A of the chamber at rest, mm².
        thrust: a, (m,): forces and moments of a pressure of one, mm² and mm³.

    Raises:
        ValueError: a stiffness that is not symmetric, or other numbers of strains.
    """

    stiffness: Floats
    rest: Floats
    area: float = 0.0
    thrust: Floats | None = None

    def __post_init__(self) -> None:
        count = len(self.rest)
        largest = float(np.abs(self.stiffness).max())
        if self.stiffness.shape != (count, count) or not np.allclose(
            self.stiffness, self.stiffness.T, rtol=1e-12, atol=1e-12 * largest
        ):
            raise ValueError(f"stiffness: a symmetric matrix of {count} × {count} expected")
        if self.thrust is not None and np.shape(self.thrust) != (count,):
            raise ValueError(f"thrust: {count} numbers expected, not {self.thrust}")

    def _thrust(self) -> Floats:
        return np.zeros(len(self.rest)) if self.thrust is None else self.thrust

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        away = strains - self.rest
        elastic: Floats = np.sum(away @ self.stiffness * away, axis=1) / 2
        return elastic - pressure * self.chamber(strains, pressure)

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        out: Floats = (strains - self.rest) @ self.stiffness - pressure * self._thrust()
        return out

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        return np.broadcast_to(self.stiffness, (len(strains), *self.stiffness.shape))

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        out: Floats = self.area + (strains - self.rest) @ self._thrust()
        return out

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        return np.broadcast_to(self._thrust(), strains.shape)

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`: its chamber is held by the strains."""
        return np.zeros(len(strains))

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `Law`: nothing is."""
        return ""


@dataclasses.dataclass(frozen=True)
class Zones:
    """A law for each piece: caps and zones have their own.

    Attributes:
        laws: one after another.
        pieces: place in `laws` of each piece's law, (n,).
        names: of the parts that have them, in words; an empty one where a law names its own. Of
            parts without names a message has none.

    Raises:
        ValueError: a place without a law, or other numbers of names.
    """

    laws: Sequence[Law]
    pieces: Sequence[int]
    names: Sequence[str] = ()

    def __post_init__(self) -> None:
        if not all(0 <= place < len(self.laws) for place in self.pieces):
            raise ValueError(f"zones: a law from 0 to {len(self.laws) - 1} for each piece expected")
        if self.names and len(self.names) != len(self.laws):
            raise ValueError(f"zones: {len(self.laws)} names expected, not {len(self.names)}")

    def _each(self, what: str, strains: Floats, pressure: float, *shape: int) -> Floats:
        if len(strains) != len(self.pieces):
            raise ValueError(f"zones of {len(self.pieces)} pieces for a rod of {len(strains)}")
        out = np.empty((len(strains), *shape))
        for law, mine in self._runs:
            out[mine] = getattr(law, what)(strains[mine], pressure)
        return out

    @functools.cached_property
    def _runs(self) -> list[tuple[Law, slice | Bools]]:
        """Each law with its pieces: a slice of those that follow each other, which is quicker."""
        out: list[tuple[Law, slice | Bools]] = []
        pieces = np.asarray(self.pieces)
        for place, law in enumerate(self.laws):
            mine = pieces == place
            if not mine.any():
                continue
            first, count = int(mine.argmax()), int(mine.sum())
            run = slice(first, first + count)
            out.append((law, run if mine[run].all() else mine))
        return out

    def whole(self, strains: Floats, pressures: Floats) -> Sections:
        """See `whole`."""
        k, n, m = strains.shape
        out = Sections(np.empty((k, n)), np.empty((k, n, m + 1)), np.empty((k, n, m + 1, m + 1)))
        for law, mine in self._runs:
            for all_of, part in zip(out, whole(law, strains[:, mine], pressures), strict=True):
                all_of[:, mine] = part
        return out

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        return self._each("value", strains, pressure)

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        return self._each("gradient", strains, pressure, strains.shape[1])

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        return self._each("hessian", strains, pressure, *(2 * strains.shape[1:]))

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        return self._each("chamber", strains, pressure)

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        return self._each("chamber_gradient", strains, pressure, strains.shape[1])

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        return self._each("chamber_slope", strains, pressure)

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `Law`."""
        pieces = np.asarray(self.pieces)
        for place, law in enumerate(self.laws):
            mine = pieces == place
            found = law.outside(strains[mine], pressure) if mine.any() else ""
            if found:
                name = self.names[place] if self.names else ""
                return f"{name}: {found}" if name else found
        return ""
