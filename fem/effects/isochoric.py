"""The isochoric part of a deformation, as the laws take it, in UFL."""

from __future__ import annotations

import functools
from typing import Any

import ufl

from fem.kinematics.kinematics import Kinematics
from materials.power_sum import PowerSums


class _Functions:
    """The functions of `materials.power_sum` in UFL."""

    acos = staticmethod(ufl.acos)
    cos = staticmethod(ufl.cos)
    ln = staticmethod(ufl.ln)
    sqrt = staticmethod(ufl.sqrt)
    larger = staticmethod(ufl.max_value)
    smaller = staticmethod(ufl.min_value)


class Isochoric:
    """F J^(−1/3) of a body: a `materials.laws.law.Deformation`.

    Args:
        body: the kinematics that give F.
    """

    def __init__(self, body: Kinematics) -> None:
        self._body = body
        self._c = body.F.T * body.F
        self._j = ufl.det(body.F)
        self._trace = ufl.tr(self._c)

    @functools.cached_property
    def i1(self) -> Any:
        """Ī1 = J^(−2/3) tr C."""
        return self._j ** (-2 / 3) * self._trace

    @functools.cached_property
    def i2(self) -> Any:
        """Ī2 = J^(−4/3) (tr² C − tr C²)/2."""
        return self._j ** (-4 / 3) * ((self._trace**2 - ufl.tr(self._c * self._c)) / 2)

    def ln(self, x: Any) -> Any:
        """Natural logarithm; by the square root, so that its derivatives too are NaN below 0."""
        return 2 * ufl.ln(ufl.sqrt(x))

    def exp(self, x: Any) -> Any:
        """Exponential function."""
        return ufl.exp(x)

    def power_sum(self, exponent: Any) -> Any:
        """Σ λ̄i^a by its Taylor polynomial of degree 2 in Ī1 and Ī2 about the present state.

        There its value and its first two derivatives are those of the sum, and no potential is
        derived more often. The coefficients are frozen: nothing differentiates through them.
        """
        value, *slopes = (self._body.frozen(part) for part in self._sums(exponent))
        s1, s2, s11, s12, s22 = slopes
        d1, d2 = self._away
        return (
            3
            + value
            + (s1 * d1 + s2 * d2)
            + (s11 / 2 * d1 * d1 + s12 * d1 * d2 + s22 / 2 * d2 * d2)
        )

    @functools.cached_property
    def _sums(self) -> PowerSums:
        return PowerSums(self.i1, self.i2, _Functions())

    @functools.cached_property
    def _away(self) -> tuple[Any, Any]:
        """Ī1 and Ī2 less their own present values: zero, with derivatives."""
        return self.i1 - self._body.frozen(self.i1), self.i2 - self._body.frozen(self.i2)
