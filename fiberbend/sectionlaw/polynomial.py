"""Polynomials of a few variables with two derivatives."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math

import numpy as np
import numpy.typing as npt

from rod.functions import Floats


@dataclasses.dataclass(frozen=True)
class Polynomial:
    """Σ_t c_t Π_i (y_i/s_i)^p_ti.

    Attributes:
        sizes: s, (d,).
        powers: p, (t, d).
        coefficients: c, (t,).
    """

    sizes: tuple[float, ...]
    powers: tuple[tuple[int, ...], ...]
    coefficients: tuple[float, ...]

    def value(self, y: Floats) -> Floats:
        """At points, (n, d): (n,)."""
        return self._derived(self._powers(y))

    def first(self, y: Floats) -> Floats:
        """∂/∂y, (n, d)."""
        z = self._powers(y)
        return np.stack([self._derived(z, i) for i in range(y.shape[1])], axis=-1)

    def second(self, y: Floats) -> Floats:
        """∂²/∂y², (n, d, d)."""
        z, d = self._powers(y), range(y.shape[1])
        rows = [np.stack([self._derived(z, i, j) for j in d], axis=-1) for i in d]
        return np.stack(rows, axis=-2)

    def all(self, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Value, first and second derivatives at once: (n,), (n, d) and (n, d, d)."""
        monomials, rows = self._plan
        n, d = y.shape
        z = self._powers(y)
        out = z[monomials[0], 0]
        for i in range(1, d):
            out = out * z[monomials[i], i]
        found = (rows @ out).T
        return found[:, 0], found[:, 1 : d + 1], found[:, d + 1 :].reshape(n, d, d)

    @functools.cached_property
    def _plan(self) -> tuple[npt.NDArray[np.intp], Floats]:
        """What `all` needs.

        Returns:
            Powers of all terms and of their derivatives, (d, k), and their coefficients in value,
            first and second derivatives, (1 + d + d², k).
        """
        d = len(self.sizes)
        orders = [(), *((i,) for i in range(d)), *itertools.product(range(d), repeat=2)]
        parts: list[dict[tuple[int, ...], float]] = []
        for order in orders:
            part: dict[tuple[int, ...], float] = {}
            for powers, coefficient in zip(self.powers, self.coefficients, strict=True):
                left = list(powers)
                for i in order:
                    coefficient *= left[i] / self.sizes[i]
                    left[i] = max(left[i] - 1, 0)
                part[tuple(left)] = part.get(tuple(left), 0.0) + coefficient
            parts.append(part)
        known = sorted(set().union(*parts))
        rows = np.array([[part.get(powers, 0.0) for powers in known] for part in parts])
        return np.array(known, dtype=np.intp).reshape(-1, d).T, rows

    def terms(self, y: Floats) -> Floats:
        """All terms with coefficients of one, (n, t)."""
        return self._terms(self._powers(y)).T

    def _powers(self, y: Floats) -> Floats:
        """(y_i/s_i)^p from p = 0 on, (p, d, n): an integer power by itself is slow."""
        most = max(map(max, self.powers), default=0)
        out = np.empty((most + 1, *y.shape[::-1]))
        out[0], out[1:] = 1.0, (y / np.array(self.sizes)).T
        return np.multiply.accumulate(out, axis=0)

    def _derived(self, z: Floats, *by: int) -> Floats:
        found: Floats = np.array(self.coefficients) @ self._terms(z, *by)
        return found

    def _terms(self, z: Floats, *by: int) -> Floats:
        """Derivatives of all terms, (t, n), by the powers of the variables."""
        powers, factor = np.array(self.powers), np.ones(len(self.powers))
        for i in by:
            factor = factor * powers[:, i] / self.sizes[i]
            powers[:, i] = np.maximum(powers[:, i] - 1, 0)
        out: Floats = factor[:, None] * z[powers[:, 0], 0]
        for i in range(1, powers.shape[1]):
            out = out * z[powers[:, i], i]
        return out


def fit(y: Floats, values: Floats, weights: Floats, degree: int, start: float) -> Polynomial:
    """By weighted least squares, with a given value at y = 0.

    Args:
        y: points, (n, d).
        values: there, (n,).
        weights: of the errors, (n,).
        degree: greatest sum of the powers in a term.
        start: value at y = 0.
    """
    d = y.shape[1]
    powers = [p for p in itertools.product(range(degree + 1), repeat=d) if 0 < sum(p) <= degree]
    sizes = tuple(float(size) or 1.0 for size in np.abs(y).max(axis=0))
    empty = Polynomial(sizes, tuple(powers), (0.0,) * len(powers))
    matrix = weights[:, None] * empty.terms(y)
    found, *_ = np.linalg.lstsq(matrix, weights * (values - start), rcond=1e-10)
    constant = (0,) * d
    return Polynomial(sizes, (constant, *powers), (start, *found.tolist()))


def count(d: int, degree: int) -> int:
    """Terms of a polynomial of d variables."""
    return math.comb(d + degree, degree)
