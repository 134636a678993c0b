"""What residuals say about the errors of parameters.

The points of a tensile test are many, and what a law misses it misses over a range of strains: one
residual says what the next will be. They are taken as a stationary series along each test with the
correlation φ^|i − j| of points i and j in the order of stretch, of one φ, and with a variance of
its own in each mode. What is known of φ is its restricted likelihood, which counts the parameters
that were fitted (H. D. Patterson and R. Thompson, Biometrika 58 (1971) 545-554); the covariance is
the mean over it, and as much wider as Student's interval of 95 % is for so few points. So the
misfit of a law counts as correlated noise: the errors say how far numbers move where the same
rubber's noise, or the same law's misfit, falls otherwise along the curve. What lies outside the
tests they do not know: a mode that was not measured, another batch, another speed.

A misfit is smoother than such a series, so that more points of the same curve would seem to say
more. Points are therefore taken together, along each test to `PARTS` means at most.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from materials.stretches import Floats

_CORRELATIONS = np.tanh(np.linspace(0.0, 3.0, 25))
"""φ that are weighed, all from 0 to 0.995 alike before the residuals are seen."""
PARTS = 50
"""Means of neighbours that a test is divided into where it has more points."""
NORMAL = 1.959964
"""Half of an interval of 95 % in standard deviations."""


@dataclasses.dataclass(frozen=True, eq=False)
class Noise:
    """A series of residuals.

    Attributes:
        correlations: φ that may be, (m,).
        chances: of each its probability, (m,).
        factors: of each what standard deviations are multiplied with, (m,).
        size: root mean square of the means of a mode, for each mean, (k,).
        lengths: means of each test.
        counts: points of each mean, (k,).
        deviance: −2 log of the greatest likelihood of the residuals but for a constant, with φ and
            the variances as they are most likely.
    """

    correlations: Floats
    chances: Floats
    factors: Floats
    size: Floats
    lengths: tuple[int, ...]
    counts: NDArray[np.int64]
    deviance: float

    def spread(self, matrix: Floats) -> Floats:
        """Aᵀ Σ A of the residuals' covariance Σ.

        Args:
            matrix: A, (n, p).
        """
        begins = np.cumsum(self.counts) - self.counts
        scaled = np.add.reduceat(matrix, begins, axis=0) * self.size[:, None]
        total = np.zeros((matrix.shape[1],) * 2)
        for phi, chance, factor in zip(self.correlations, self.chances, self.factors, strict=True):
            for part in _parts(scaled, self.lengths):
                total += chance * factor**2 * part.T @ _smoothed(part, phi)
        return (total + total.T) / 2

    def draw(self, source: np.random.Generator) -> Floats:
        """Residuals of another test, (n,)."""
        i = source.choice(len(self.chances), p=self.chances)
        phi = self.correlations[i]
        series = [_correlated(source.standard_normal(n), phi) for n in self.lengths]
        return np.repeat(np.concatenate(series) * self.factors[i] * self.size, self.counts)


def noise_of(
    residuals: Floats, slopes: Floats, groups: Sequence[int], lengths: Sequence[int]
) -> Noise:
    """What kind of series residuals are.

    Args:
        residuals: weighted residuals of all tests in the order of stretch, (n,).
        slopes: their derivatives by what was free to be fitted, (n, p), p < n.
        groups: of each test a number; those of a group share a variance.
        lengths: points of each test.
    """
    split = [np.array_split(np.arange(n), min(n, PARTS)) for n in lengths]
    counts = np.array([len(part) for parts in split for part in parts])
    begins = np.cumsum(counts) - counts
    residuals = np.add.reduceat(residuals, begins) / counts
    slopes = np.add.reduceat(slopes, begins, axis=0) / counts[:, None]
    lengths = [len(parts) for parts in split]
    group = np.repeat(groups, lengths)
    size = np.zeros(len(residuals))
    for g in set(groups):
        size[group == g] = np.sqrt(np.mean(residuals[group == g] ** 2))
    size = np.maximum(size, max(1e-9 * size.max(), 1e-300))
    rest, free = residuals / size, slopes / size[:, None]
    rank = int(np.linalg.matrix_rank(free))
    freedom = max(len(rest) - rank, 1)
    likely, factors = np.empty(len(_CORRELATIONS)), np.empty(len(_CORRELATIONS))
    deviance = np.inf
    for i, phi in enumerate(_CORRELATIONS):
        white = np.concatenate([_whitened(part, phi) for part in _parts(rest[:, None], lengths)])
        seen = np.concatenate([_whitened(part, phi) for part in _parts(free, lengths)])
        basis, values, _ = np.linalg.svd(seen, full_matrices=False)
        left = white[:, 0] - basis[:, :rank] @ (basis[:, :rank].T @ white[:, 0])
        variance = max(float(left @ left) / freedom, 1e-300)
        bent = 2 * float(np.log(np.maximum(values[:rank], 1e-300)).sum())
        points = sum(n - 1 for n in lengths) * np.log1p(-(phi**2))
        plain = max(float(np.mean(white**2)), 1e-300)
        deviance = min(deviance, points + len(rest) * np.log(plain) + 2 * np.log(size).sum())
        likely[i] = -(points + bent + freedom * np.log(variance)) / 2
        factors[i] = np.sqrt(variance) * stdtrit(freedom, 0.975) / NORMAL
    chances = np.exp(likely - likely.max()) * (1 - _CORRELATIONS**2)
    chances = chances / chances.sum()
    return Noise(_CORRELATIONS, chances, factors, size, tuple(lengths), counts, float(deviance))


def _parts(values: Floats, lengths: Sequence[int]) -> list[Floats]:
    return np.split(values, np.cumsum(lengths)[:-1])


def _whitened(part: Floats, phi: float) -> Floats:
    """A test's rows as independent ones of variance 1."""
    rest = (part[1:] - phi * part[:-1]) / np.sqrt(1 - phi**2)
    return np.concatenate([part[:1], rest])


def _correlated(white: Floats, phi: float) -> Floats:
    """A series of variance 1 with the correlations φ^|i − j|, of independent numbers."""
    series = white.copy()
    for i in range(1, len(series)):
        series[i] = phi * series[i - 1] + np.sqrt(1 - phi**2) * white[i]
    return series


def _smoothed(part: Floats, phi: float) -> Floats:
    """Rows times the correlations φ^|i − j|, without their matrix."""
    up, down = part.copy(), part.copy()
    for i in range(1, len(part)):
        up[i] += phi * up[i - 1]
        down[-1 - i] += phi * down[-i]
    return up + down - part
