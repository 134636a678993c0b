"""Invariants of an isochoric deformation from its principal stretches."""

from __future__ import annotations

from typing import Any


class Invariants:
    """What arithmetic gives of a `materials.laws.law.Deformation`, of numbers or arrays.

    Args:
        stretches: λ1, λ2, λ3, numbers or arrays of one shape, real or complex.
    """

    def __init__(self, *stretches: Any) -> None:
        self._stretches = stretches

    @property
    def i1(self) -> Any:
        """λ1² + λ2² + λ3²."""
        a, b, c = self._stretches
        return a * a + b * b + c * c

    @property
    def i2(self) -> Any:
        """λ1² λ2² + λ2² λ3² + λ3² λ1²."""
        a, b, c = (stretch * stretch for stretch in self._stretches)
        return a * b + b * c + c * a

    def power_sum(self, exponent: Any) -> Any:
        """λ1^a + λ2^a + λ3^a."""
        a, b, c = self._stretches
        return a**exponent + b**exponent + c**exponent

    def ln(self, x: Any) -> Any:
        """Natural logarithm; NaN where the real part is not positive."""
        raise NotImplementedError

    def exp(self, x: Any) -> Any:
        """Exponential function."""
        raise NotImplementedError
