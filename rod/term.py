"""What acts on a rod beside its sections: one question for all of it."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

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


@runtime_checkable
class Dead(Term, Protocol):
    """A term whose potential is −amount Σ A : X of loads A that never change."""

    @property
    def loads(self) -> Floats:
        """A on the frames, (n + 1, 3, 4); see `Shape.pulled`."""


@runtime_checkable
class Standing(Term, Protocol):
    """A term that may act whole where its amount is zero: an obstacle that is not moved yet."""

    def share(self, amount: float) -> float:
        """Of it that acts: 0 nothing, 1 all."""


class Iterate(Term, Protocol):
    """A term within one search by Newton's method, of which it remembers something."""

    def stepped(self, shape: Shape, amount: float, change: Floats, grows: float) -> bool:
        """Takes note of a step.

        Args:
            shape: before it.
            amount: before it.
            change: of the strains, (n, m).
            grows: change of the amount.

        Returns:
            Whether what it remembers is of the same kind as before: if not, the search goes on.
        """


@runtime_checkable
class Iterated(Term, Protocol):
    """A term whose own iterate Newton's method converges by, to the term's own equilibrium."""

    def iterate(self, before: Shape, amount: float) -> Iterate:
        """What stands for it in one search.

        Args:
            before: a state near by.
            amount: of it there.
        """

    def gap(self, shape: Shape, amount: float) -> float:
        """Below zero where it touches; else no more than what is left to a touch, mm.

        Infinite where nothing is, or where it always touches.
        """
