"""The rotation exp [φ×], its integral along a screw, and their exact derivatives.

With s = |φ|² and the functions c_k(s) = Σ (−s)^j/(2j + k)! of Stumpff (Stiefel and Scheifele 1971,
Linear and Regular Celestial Mechanics, doi 10.1007/978-3-642-65027-7),

    exp [φ×] = I + c1 [φ×] + c2 [φ×]²,      ∫₀¹ exp [u φ×] du = I + c2 [φ×] + c3 [φ×]²:

Rodrigues' formula and its integral (Murray, Li and Sastry 1994, A Mathematical Introduction to
Robotic Manipulation, eqs. (2.14) and (2.36)) without a limit at φ = 0. Their slopes are
dc_k/ds = (k c_{k+2} − c_{k+1})/2.
"""

from __future__ import annotations

import functools
import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.intp]
Bools = npt.NDArray[np.bool_]

ORDER = 8
"""Functions c_0 to c_7: two derivatives of c3 need the last one."""
_SMALL = 4.0
"""Greatest s by the series: its terms fall from the first one on."""
_TERMS = 13
"""Of the series of c_6 and c_7 at s = 4: the next one is below 1e-23."""
_NEAR = ((1e-3, 6), (0.05, 8), (0.5, 11))
"""Greatest s, and terms of all series that leave less than 1e-18 of c_0 out."""
_SERIES: Floats = np.array(
    [[(-1) ** j / math.factorial(2 * j + k) for j in range(_NEAR[-1][1])] for k in range(ORDER)]
)
_EYE = np.eye(3)
_CROSS = np.zeros((3, 3, 3))
"""[a×] = Σ a_k of these."""
for _i, _j, _k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    _CROSS[_k, _j, _i], _CROSS[_k, _i, _j] = 1.0, -1.0
_CROSS = _CROSS.reshape(3, 9)


def cross(a: Floats, b: Floats) -> Floats:
    """a × b of vectors in the last axis, (..., 3)."""
    out: Floats = a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]]
    return out


def cross_matrix(vector: Floats) -> Floats:
    """[a×] with [a×] x = a × x, (..., 3, 3) of (..., 3)."""
    # one product of matrices: numpy needs a microsecond for every call
    return (vector @ _CROSS).reshape(*vector.shape[:-1], 3, 3)


def axial(dyad: Floats) -> Floats:
    """Σ y × f of dyads Σ y ⊗ f, (..., 3) of (..., 3, 3)."""
    out: Floats = dyad.reshape(*dyad.shape[:-2], 9) @ -_CROSS.T
    return out


def trace(dyad: Floats) -> Floats:
    """Σ y·f of dyads Σ y ⊗ f, (...,) of (..., 3, 3)."""
    out: Floats = dyad[..., 0, 0] + dyad[..., 1, 1] + dyad[..., 2, 2]
    return out


def stumpff(s: Floats) -> Floats:
    """c_0 to c_7.

    Args:
        s: squared angles, rad², any shape.

    Returns:
        The functions along a new first axis, (8, ...).
    """
    greatest = float(s.max())
    for bound, terms in _NEAR:
        if greatest <= bound:
            # one product of matrices: numpy needs a microsecond for every call
            powers = np.vander(s.ravel(), terms, increasing=True).T
            out: Floats = np.matmul(_SERIES[:, :terms], powers).reshape(ORDER, *s.shape)
            return out
    c = np.empty((ORDER, *s.shape))
    near = s if greatest <= _SMALL else np.minimum(s, _SMALL)
    for k in (ORDER - 2, ORDER - 1):
        total = np.ones_like(near)
        for j in range(_TERMS, 0, -1):
            total = 1.0 - near * total / ((2 * j + k) * (2 * j + k - 1))
        c[k] = total / math.factorial(k)
    for k in range(ORDER - 3, -1, -1):
        c[k] = 1.0 / math.factorial(k) - near * c[k + 2]
    if greatest > _SMALL:
        far = s > _SMALL
        large = s[far]
        angle = np.sqrt(large)
        c[0][far], c[1][far] = np.cos(angle), np.sin(angle) / angle
        for k in range(2, ORDER):
            c[k][far] = (1.0 / math.factorial(k - 2) - c[k - 2][far]) / large
    return c


def matrices(phi: Floats, c: Floats) -> tuple[Floats, Floats]:
    """The rotation exp [φ×] and its mean on the way from 0 to φ, (n, 3, 3) both.

    Args:
        phi: φ, (n, 3), rad.
        c: `stumpff` of |φ|².
    """
    across = cross_matrix(phi)
    first, second = c[1:3, :, None, None], c[2:4, :, None, None]
    both = _EYE + first * across + second * (across @ across)
    return both[0], both[1]


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
        self._c, self._k = c, k

    @functools.cached_property
    def s(self) -> Floats:
        """|φ|², (...), rad²."""
        square: Floats = np.sum(self.phi * self.phi, axis=-1)
        return square

    @functools.cached_property
    def _f(self) -> tuple[Floats, Floats]:
        """f, df/ds."""
        return self._c[self._k], self._slope(self._k)

    @functools.cached_property
    def _g(self) -> tuple[Floats, Floats]:
        return self._c[self._k + 1], self._slope(self._k + 1)

    def _slope(self, k: int) -> Floats:
        """dc_k/ds."""
        out: Floats = (k * self._c[k + 2] - self._c[k + 1]) / 2
        return out

    def _second(self, k: int) -> Floats:
        """d²c_k/ds²."""
        out: Floats = (k * self._slope(k + 2) - self._slope(k + 1)) / 2
        return out

    def matrix(self) -> Floats:
        """The map itself, (..., 3, 3)."""
        across = cross_matrix(self.phi)
        f, g = self._c[self._k][..., None, None], self._c[self._k + 1][..., None, None]
        out: Floats = _EYE + f * across + g * (across @ across)
        return out

    def slope(self, x: Floats) -> Floats:
        """∂(map x)/∂φ of fixed vectors x, (..., 3, 3)."""
        phi, s = self.phi, self.s[..., None]
        along = np.sum(phi * x, axis=-1)[..., None]
        turned = cross(phi, x)
        square = phi * along - s * x
        rate = 2 * (self._f[1][..., None] * turned + self._g[1][..., None] * square)
        bent = _outer(phi, x) - 2 * _outer(x, phi) + along[..., None] * _EYE
        f, g = self._f[0][..., None, None], self._g[0][..., None, None]
        out: Floats = _outer(rate, phi) - f * cross_matrix(x) + g * bent
        return out

    def gradient(self, z: Floats) -> Floats:
        """∂(Z : map)/∂φ, (..., 3) of Z (..., 3, 3)."""
        w, both, total = _split(z)
        phi = self.phi
        bent = np.einsum("...ij,...j->...i", both, phi)
        square = np.sum(phi * bent, axis=-1) / 2 - self.s * total
        rate = 2 * (self._f[1] * np.sum(phi * w, axis=-1) + self._g[1] * square)
        f, g = self._f[0][..., None], self._g[0][..., None]
        out: Floats = rate[..., None] * phi + f * w + g * (bent - 2 * total[..., None] * phi)
        return out

    def hessian(self, z: Floats) -> Floats:
        """∂²(Z : map)/∂φ², (..., 3, 3) of Z (..., 3, 3)."""
        w, both, total = _split(z)
        phi = self.phi
        bent = np.einsum("...ij,...j->...i", both, phi)
        along = np.sum(phi * w, axis=-1)
        square = np.sum(phi * bent, axis=-1) / 2 - self.s * total
        bent = bent - 2 * total[..., None] * phi
        f, g = self._f, self._g
        rate = 2 * (f[1] * along + g[1] * square)
        second = 4 * (self._second(self._k) * along + self._second(self._k + 1) * square)
        half = 2 * (f[1][..., None] * w + g[1][..., None] * bent) + second[..., None] * phi / 2
        outer = _outer(half, phi)
        eye = _EYE
        out: Floats = outer + np.swapaxes(outer, -1, -2) + rate[..., None, None] * eye
        return out + g[0][..., None, None] * (both - 2 * total[..., None, None] * eye)


def _outer(a: Floats, b: Floats) -> Floats:
    out: Floats = a[..., :, None] * b[..., None, :]
    return out


def _split(z: Floats) -> tuple[Floats, Floats, Floats]:
    """w, Z + Zᵀ and tr Z."""
    return -axial(z), z + np.swapaxes(z, -1, -2), trace(z)
