"""Polynomials of a few variables with two derivatives."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np

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
        return self._derived(y)

    def first(self, y: Floats) -> Floats:
        """∂/∂y, (n, d)."""
        return np.stack([self._derived(y, i) for i in range(y.shape[1])], axis=-1)

    def second(self, y: Floats) -> Floats:
        """∂²/∂y², (n, d, d)."""
        d = range(y.shape[1])
        rows = [np.stack([self._derived(y, i, j) for j in d], axis=-1) for i in d]
        return np.stack(rows, axis=-2)

    def _derived(self, y: Floats, *by: int) -> Floats:
        return self._terms(y, *by) @ np.array(self.coefficients)

    def _terms(self, y: Floats, *by: int) -> Floats:
        """Derivatives of all terms, (n, t)."""
        powers, factor = np.array(self.powers), np.ones(len(self.powers))
        for i in by:
            factor = factor * powers[:, i] / self.sizes[i]
            powers = powers.copy()
            powers[:, i] = np.maximum(powers[:, i] - 1, 0)
        out: Floats = factor * np.prod((y / np.array(self.sizes))[:, None, :] ** powers, axis=2)
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
    matrix = weights[:, None] * empty._terms(y)
    found, *_ = np.linalg.lstsq(matrix, weights * (values - start), rcond=1e-10)
    constant = (0,) * d
    return Polynomial(sizes, (constant, *powers), (start, *found.tolist()))


def count(d: int, degree: int) -> int:
    """Terms of a polynomial of d variables."""
    return math.comb(d + degree, degree)
