"""Which polynomials about the free states of a section its symmetry leaves."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import numpy.typing as npt

from rod.functions import Floats

VARIABLES = 4
"""u of stretch, curvature, side curvature and twist."""
_SIDE, _TWIST = 2, 3


@dataclasses.dataclass(frozen=True)
class Kept:
    """What maps a section onto itself, with its threads.

    Attributes:
        across: the mirror plane x = 0, which turns the signs of k_y and τ.
        along: the mirror plane z = 0, which turns that of τ.
        turn: half a turn about y, which turns that of k_y.
        alike: any turn about z.
    """

    across: bool = False
    along: bool = False
    turn: bool = False
    alike: bool = False

    def keeps(self, powers: tuple[int, ...]) -> bool:
        """Whether a monomial is the same for all images."""
        side, twist = powers[_SIDE] % 2, powers[_TWIST] % 2
        odd = (self.across and side != twist, self.along and twist, self.turn and side)
        return not any(odd)


@dataclasses.dataclass(frozen=True)
class Terms:
    """Polynomials Σ_k w_tk u^p_k, one for each of the coefficients of a law.

    Attributes:
        powers: p, (k, 4): all monomials up to a degree.
        weights: w, (t, k).
    """

    powers: npt.NDArray[np.intp]
    weights: Floats

    @property
    def orders(self) -> npt.NDArray[np.intp]:
        """Degree of each polynomial, (t,)."""
        found: npt.NDArray[np.intp] = ((self.weights != 0) * self.powers.sum(axis=1)).max(axis=1)
        return found

    def rows(self, u: Floats) -> tuple[Floats, Floats, Floats]:
        """Value, slopes and second derivatives of the polynomials at points.

        Args:
            u: (n, 4).

        Returns:
            (n, t), (4, n, t) and (4, 4, n, t).
        """
        found, eye = monomials(u, self.powers), np.eye(len(self.powers))
        turned = self.weights
        first = [lowered(eye, self.powers, i) for i in range(VARIABLES)]
        slopes = [found @ (turned @ each).T for each in first]
        bent = [
            [found @ (turned @ lowered(each, self.powers, j)).T for j in range(VARIABLES)]
            for each in first
        ]
        return found @ turned.T, np.array(slopes), np.array(bent)


def terms(degree: int, kept: Kept) -> Terms:
    """All polynomials of a degree that a section and its images have in common.

    Args:
        degree: greatest sum of powers.
        kept: the images.
    """
    powers = powers_of(degree)
    places = {power: number for number, power in enumerate(powers)}
    found = []
    for power in powers:
        stretch, turn, side, twist = power
        if not kept.keeps(power):
            continue
        row = np.zeros(len(powers))
        if not kept.alike:
            row[places[power]] = 1.0
        elif side or turn % 2:
            # (u_x² + u_y²)^b stands at u_x^2b
            continue
        else:
            half = turn // 2
            for j in range(half + 1):
                row[places[stretch, turn - 2 * j, 2 * j, twist]] = math.comb(half, j)
        found.append(row)
    return Terms(np.array(powers, dtype=np.intp), np.array(found))


def powers_of(degree: int) -> list[tuple[int, ...]]:
    """Powers of all monomials up to a degree."""
    every = itertools.product(range(degree + 1), repeat=VARIABLES)
    return [powers for powers in every if sum(powers) <= degree]


def monomials(u: Floats, powers: npt.NDArray[np.intp]) -> Floats:
    """u^p, (n, k)."""
    most = int(powers.max(initial=0))
    z = np.empty((most + 1, *u.T.shape))
    z[0], z[1:] = 1.0, u.T
    np.multiply.accumulate(z, axis=0, out=z)
    out = z[powers[:, 0], 0]
    for i in range(1, powers.shape[1]):
        out = out * z[powers[:, i], i]
    return out.T


def lowered(coefficients: Floats, powers: npt.NDArray[np.intp], variable: int) -> Floats:
    """Coefficients of the derivative by a variable, in the same monomials, (..., k)."""
    places = {tuple(power): number for number, power in enumerate(powers.tolist())}
    from_, to = [], []
    for number, power in enumerate(powers.tolist()):
        if power[variable]:
            power[variable] -= 1
            from_.append(number)
            to.append(places[tuple(power)])
    out = np.zeros_like(coefficients)
    out[..., to] = coefficients[..., from_] * powers[from_, variable]
    return out
