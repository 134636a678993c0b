"""The rotation exp [φ×], its integral along a screw, and their exact derivatives.

With s = |φ|² and the functions c_k(s) = Σ (−s)^j/(2j + k)! of Stumpff (Stiefel and Scheifele 1971,
Linear and Regular Celestial Mechanics, doi 10.1007/978-3-642-65027-7),

    exp [φ×] = I + c1 [φ×] + c2 [φ×]²,      ∫₀¹ exp [u φ×] du = I + c2 [φ×] + c3 [φ×]²:

Rodrigues' formula and its integral (Murray, Li and Sastry 1994, A Mathematical Introduction to
Robotic Manipulation, eqs. (2.14) and (2.36)) without a limit at φ = 0. Their slopes are
dc_k/ds = (k c_{k+2} − c_{k+1})/2.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

ORDER = 8
"""Functions c_0 to c_7: two derivatives of c3 need the last one."""
_SMALL = 4.0
"""Greatest s by the series: its terms fall from the first one on."""
_TERMS = 13
"""Of the series of c_6 and c_7; the next one is below 1e-23 at s = 4."""
_AXES = np.zeros((3, 3, 3))
for _i, _j, _k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    _AXES[_i, _j, _k], _AXES[_i, _k, _j] = 1.0, -1.0


def cross(a: Floats, b: Floats) -> Floats:
    """a × b of vectors in the last axis, (..., 3)."""
    out: Floats = a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]]
    return out


def cross_matrix(vector: Floats) -> Floats:
    """[a×] with [a×] x = a × x, (..., 3, 3) of (..., 3)."""
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    zero = np.zeros_like(x)
    rows = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1)
    return rows.reshape(*vector.shape[:-1], 3, 3)


def axial(dyad: Floats) -> Floats:
    """Σ y × f of dyads Σ y ⊗ f, (..., 3) of (..., 3, 3)."""
    pairs = ((1, 2), (2, 0), (0, 1))
    return np.stack([dyad[..., i, j] - dyad[..., j, i] for i, j in pairs], axis=-1)


def stumpff(s: Floats) -> Floats:
    """c_0 to c_7.

    Args:
        s: squared angles, rad², any shape.

    Returns:
        The functions along a new first axis, (8, ...).
    """
    c = np.empty((ORDER, *s.shape))
    near = np.minimum(s, _SMALL)
    for k in (ORDER - 2, ORDER - 1):
        total = np.full_like(near, 1.0)
        for j in range(_TERMS, 0, -1):
            total = 1.0 - near / ((2 * j + k) * (2 * j + k - 1)) * total
        c[k] = total / math.factorial(k)
    for k in range(ORDER - 3, -1, -1):
        c[k] = 1.0 / math.factorial(k) - near * c[k + 2]
    far = s > _SMALL
    if np.any(far):
        large = s[far]
        angle = np.sqrt(large)
        c[0][far], c[1][far] = np.cos(angle), np.sin(angle) / angle
        for k in range(2, ORDER):
            c[k][far] = (1.0 / math.factorial(k - 2) - c[k - 2][far]) / large
    return c


class Pair:
    """The map I + f [φ×] + g [φ×]² of vectors φ, by f = c_k and g = c_{k+1}.

    k = 1 is the rotation, k = 2 its mean on the way from 0 to φ. A sum Z : map over all entries is
    tr Z + f φ·w + g (φ·Zφ − s tr Z) with w = (Z32 − Z23, Z13 − Z31, Z21 − Z12); so are its
    gradient and Hessian in φ.

    Args:
        phi: φ, (..., 3), rad.
        c: `stumpff` of |φ|².
        k: order of f.
    """

    def __init__(self, phi: Floats, c: Floats, k: int) -> None:
        self.phi = phi
        self.s = np.sum(phi * phi, axis=-1)
        # f, df/ds, d²f/ds², and those of g
        first = {i: (i * c[i + 2] - c[i + 1]) / 2 for i in range(k, min(k + 4, ORDER - 2))}
        self._f, self._g = (
            (c[i], first[i], (i * first[i + 2] - first[i + 1]) / 2) for i in (k, k + 1)
        )

    def matrix(self) -> Floats:
        """The map itself, (..., 3, 3)."""
        across = cross_matrix(self.phi)
        f, g = self._f[0][..., None, None], self._g[0][..., None, None]
        out: Floats = np.eye(3) + f * across + g * (across @ across)
        return out

    def slope(self, x: Floats) -> Floats:
        """∂(map x)/∂φ of fixed vectors x, (..., 3, 3)."""
        phi, s = self.phi, self.s[..., None]
        along = np.sum(phi * x, axis=-1)[..., None]
        turned = cross(phi, x)
        square = phi * along - s * x
        rate = 2 * (self._f[1][..., None] * turned + self._g[1][..., None] * square)
        bent = _outer(phi, x) - 2 * _outer(x, phi) + along[..., None] * np.eye(3)
        f, g = self._f[0][..., None, None], self._g[0][..., None, None]
        out: Floats = _outer(rate, phi) - f * cross_matrix(x) + g * bent
        return out

    def gradient(self, z: Floats) -> Floats:
        """∂(Z : map)/∂φ, (..., 3) of Z (..., 3, 3)."""
        w, both, trace = _split(z)
        phi = self.phi
        bent = np.einsum("...ij,...j->...i", both, phi)
        square = np.sum(phi * bent, axis=-1) / 2 - self.s * trace
        rate = 2 * (self._f[1] * np.sum(phi * w, axis=-1) + self._g[1] * square)
        f, g = self._f[0][..., None], self._g[0][..., None]
        out: Floats = rate[..., None] * phi + f * w + g * (bent - 2 * trace[..., None] * phi)
        return out

    def hessian(self, z: Floats) -> Floats:
        """∂²(Z : map)/∂φ², (..., 3, 3) of Z (..., 3, 3)."""
        w, both, trace = _split(z)
        phi = self.phi
        bent = np.einsum("...ij,...j->...i", both, phi)
        along = np.sum(phi * w, axis=-1)
        square = np.sum(phi * bent, axis=-1) / 2 - self.s * trace
        bent = bent - 2 * trace[..., None] * phi
        f, g = self._f, self._g
        rate = 2 * (f[1] * along + g[1] * square)
        second = 4 * (f[2] * along + g[2] * square)
        half = 2 * (f[1][..., None] * w + g[1][..., None] * bent) + second[..., None] * phi / 2
        outer = _outer(half, phi)
        eye = np.eye(3)
        out: Floats = outer + np.swapaxes(outer, -1, -2) + rate[..., None, None] * eye
        return out + g[0][..., None, None] * (both - 2 * trace[..., None, None] * eye)


def _outer(a: Floats, b: Floats) -> Floats:
    out: Floats = a[..., :, None] * b[..., None, :]
    return out


def _split(z: Floats) -> tuple[Floats, Floats, Floats]:
    """w, Z + Zᵀ and tr Z."""
    return -axial(z), z + np.swapaxes(z, -1, -2), np.trace(z, axis1=-2, axis2=-1)
