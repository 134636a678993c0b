"""What acts on a rod beside its sections: one question for all of it."""

from __future__ import annotations

from typing import Protocol

from rod.functions import Floats
from rod.shape import Shape


class Term(Protocol):
    """A load or an obstacle; its amount is how much of it acts: 0 nothing, 1 all.

    A term whose amount is something else, such as a way in mm by which an obstacle has been pushed,
    says so.
    """

    @property
    def conservative(self) -> bool:
        """Whether it is the derivative of its potential; what is not does virtual work alone."""

    def potential(self, shape: Shape, amount: float) -> float:
        """Π, N mm; 0.0 of what has none."""

    def residual(self, shape: Shape, amount: float) -> Floats:
        """Its derivative by the strains, or minus the virtual work, (n, m); N mm and N mm²."""

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """Derivative of the residual by the strains, (n m, n m)."""

    def growth(self, shape: Shape, amount: float) -> Floats:
        """Derivative of the residual by the amount, (n, m)."""
