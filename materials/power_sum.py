"""Sums of powers of principal stretches as smooth functions of two invariants.

S(a) = λ1^a + λ2^a + λ3^a with λ1 λ2 λ3 = 1 is symmetric in the stretches, hence a smooth function
of I1 and I2, also where stretches are equal; there the stretches themselves are not. Its value and
its derivatives up to the second come from here through the invariants of the logarithmic strain,

    hi = ln λi,   J2 = −(h1 h2 + h2 h3 + h3 h1),   J3 = h1 h2 h3,   h³ = J2 h + J3,

of which S(a) = Σ exp(a hi) is an entire function. With Hn = J2 H(n−2) + J3 H(n−3), H0 = 1, the
complete symmetric polynomials of the hi, and Gn = J2 G(n−2) + J3 G(n−3) + Hn, those of the hi
taken twice, the divided differences of the exponential give

    S − 3 = Σ a^n/n! (3 Hn − J2 H(n−2)),        ∂S/∂J2 = Σ a^n/(n−1)! H(n−2),
    ∂S/∂J3 = Σ a^n/(n−1)! H(n−3),                ∂²S/∂J2² = Σ a^n/(n−1)! G(n−4),
    ∂²S/∂J2∂J3 = Σ a^n/(n−1)! G(n−5),            ∂²S/∂J3² = Σ a^n/(n−1)! G(n−6).

The series is summed for a/2^m and doubled m times: S(2a) = S(a)² − 2 S(−a). I1 = S(2) and
I2 = S(−2) are two of these sums; the chain rule through them turns ∂/∂J into ∂/∂I. Generating
functions: I. G. Macdonald, Symmetric Functions and Hall Polynomials (1995), section I.2; divided
differences of functions of matrices: N. J. Higham, Functions of Matrices (2008), appendix B.16,
doi 10.1137/1.9780898717778. Only arithmetic: numbers, numpy arrays or ufl expressions.
"""

from __future__ import annotations

import math
from typing import Any, Protocol

DEGREE = 16
"""Last power of the series."""
HALVINGS = 5
"""m of a sum; |a h| up to 40 leaves 1e-13."""
_BASE_HALVINGS = 3
"""m of I1 and I2."""

Jet = tuple[Any, Any, Any, Any, Any, Any]
"""f, ∂f/∂J2, ∂f/∂J3, ∂²f/∂J2², ∂²f/∂J2∂J3, ∂²f/∂J3²; or the same for I1 and I2."""


class Functions(Protocol):
    """What arithmetic lacks."""

    def acos(self, x: Any) -> Any:
        """Inverse cosine."""

    def cos(self, x: Any) -> Any:
        """Cosine."""

    def ln(self, x: Any) -> Any:
        """Natural logarithm."""

    def sqrt(self, x: Any) -> Any:
        """Square root."""

    def larger(self, x: Any, y: Any) -> Any:
        """The larger of two."""

    def smaller(self, x: Any, y: Any) -> Any:
        """The smaller of two."""


class PowerSums:
    """S(a) of one deformation for any exponents.

    Args:
        i1: λ1² + λ2² + λ3².
        i2: λ1⁻² + λ2⁻² + λ3⁻².
        functions: what goes with the kind of number that these are.
    """

    def __init__(self, i1: Any, i2: Any, functions: Functions) -> None:
        self._j2, j3 = _logarithmic(i1, i2, functions)
        self._h: list[Any] = [1.0, 0.0, self._j2]
        self._g: list[Any] = [1.0, 0.0, 2 * self._j2]
        for n in range(3, DEGREE + 1):
            self._h.append(self._j2 * self._h[n - 2] + j3 * self._h[n - 3])
            self._g.append(self._j2 * self._g[n - 2] + j3 * self._g[n - 3] + self._h[n])
        self._i1, self._i2 = self._pair(2.0, _BASE_HALVINGS)
        (_, a, b, *_), (_, c, d, *_) = self._i1, self._i2
        determinant = a * d - b * c
        # rows: ∂J2/∂I1, ∂J3/∂I1 and ∂J2/∂I2, ∂J3/∂I2
        self._rows = (
            (d / determinant, -c / determinant),
            (-b / determinant, a / determinant),
        )

    def __call__(self, exponent: Any) -> Jet:
        """S(a) − 3 and its derivatives by I1 and I2."""
        s = self._pair(exponent, HALVINGS)[0]
        first, second = (row[0] * s[1] + row[1] * s[2] for row in self._rows)
        # ∂²S/∂J² less the curvature of I1 and I2 themselves
        a, b, c = (s[k] - first * self._i1[k] - second * self._i2[k] for k in (3, 4, 5))

        def curvature(u: tuple[Any, Any], v: tuple[Any, Any]) -> Any:
            return a * u[0] * v[0] + b * (u[0] * v[1] + u[1] * v[0]) + c * u[1] * v[1]

        u, v = self._rows
        return s[0], first, second, curvature(u, u), curvature(u, v), curvature(v, v)

    def _pair(self, exponent: Any, halvings: int) -> tuple[Jet, Jet]:
        """S(a) − 3 and S(−a) − 3 with derivatives by J2 and J3."""
        h, g, small = self._h, self._g, exponent / 2**halvings
        even: list[Any] = [0.0] * 6
        odd: list[Any] = [0.0] * 6
        power = small
        for n in range(2, DEGREE + 1):
            power = power * small
            weight = power / math.factorial(n - 1)
            terms = [
                (3 * h[n] - self._j2 * h[n - 2]) / n,
                h[n - 2],
                *(h[n - 3 : n - 2] if n > 2 else [0.0]),
                *(g[n - k] if n >= k else 0.0 for k in (4, 5, 6)),
            ]
            half = odd if n % 2 else even
            for k, term in enumerate(terms):
                if not (isinstance(term, float) and term == 0):
                    half[k] = half[k] + weight * term
        up = tuple(e + o for e, o in zip(even, odd, strict=True))
        down = tuple(e - o for e, o in zip(even, odd, strict=True))
        for _ in range(halvings):
            up, down = _doubled(up, down), _doubled(down, up)
        return up, down  # type: ignore[return-value]


def _doubled(x: Any, y: Any) -> Jet:
    """S(2a) − 3 = x² + 6 x − 2 y of x = S(a) − 3 and y = S(−a) − 3, with derivatives."""
    slope = 2 * (x[0] + 3)
    return (
        x[0] * (x[0] + 6) - 2 * y[0],
        slope * x[1] - 2 * y[1],
        slope * x[2] - 2 * y[2],
        slope * x[3] + 2 * x[1] * x[1] - 2 * y[3],
        slope * x[4] + 2 * x[1] * x[2] - 2 * y[4],
        slope * x[5] + 2 * x[2] * x[2] - 2 * y[5],
    )


def _logarithmic(i1: Any, i2: Any, functions: Functions) -> tuple[Any, Any]:
    """J2 and J3, from the roots λi² of x³ − I1 x² + I2 x − 1 by the cosine formula.

    Where roots meet each is wrong by the root of round-off, but J2 and J3, symmetric in them, are
    those of a cubic that differs by round-off.
    """
    q = functions.sqrt(functions.larger(i1 * i1 - 3 * i2, 0.0))
    cosine = (i1 * (2 * i1 * i1 - 9 * i2) + 27) / functions.larger(2 * q * q * q, 1e-300)
    cosine = functions.larger(functions.smaller(cosine, 1.0), -1.0)
    third = functions.acos(cosine) / 3
    h1, h2, h3 = (
        functions.ln((i1 + 2 * q * functions.cos(third + 2 * math.pi * k / 3)) / 3) / 2
        for k in range(3)
    )
    return -(h1 * h2 + h2 * h3 + h3 * h1), h1 * h2 * h3
