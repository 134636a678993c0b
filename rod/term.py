"""What is asked of all that acts on a rod beside its sections, and of rods themselves."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol, TypeVar, runtime_checkable

from rod.functions import Floats, Ints
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


class Push(NamedTuple):
    """What something does to a rod."""

    force: Floats
    """(3,), N."""
    moment: Floats
    """About the origin, (3,), N mm."""


class Impact(Protocol):
    """A term in one step of a motion, with the work of its forces for the change of its potential.

    What it tells is of the last residual that it was asked for.
    """

    work: float
    """That its forces have taken from the rod, N mm."""
    stored: float
    """What of it is in the potential; the rest is lost."""
    push: Push
    """Mean of the step."""
    active: bool
    """Something is pressed."""
    known: bool
    """By forces that a step of Newton's method has found, not by depths that it began with."""

    def begin(self, after: Shape) -> float:
        """Takes note of where the step would end without it; the part of the way that is free."""

    def residual(self, middle: Shape, after: Shape) -> Floats:
        """Less the virtual work of its forces at the mean strains, (n, m)."""

    def tangent(self) -> Floats:
        """Its derivative by the strains at the end of the step, (n m, n m)."""

    def ahead(self) -> Floats:
        """Derivative of the work by the strains at the end, (n, m)."""

    def stepped(self, change: Floats) -> bool:
        """Takes note of a step by Newton's method, (n, m); whether it has not changed its mind."""

    def leapt(self, after: Shape) -> bool:
        """Whether the rod may have passed through it on the way to the end of the step."""

    def resisting(self, shape: Shape, step: float) -> Floats | float:
        """Viscosity times Δt that the velocities at the end meet, (n m, n m)."""


@runtime_checkable
class Struck(Term, Protocol):
    """A term that a rod in motion may run into."""

    def impact(self, before: Shape, amount: float, delay: float) -> Impact:
        """What stands for it in one step.

        Args:
            before: the rod when it begins.
            amount: of the term in the step.
            delay: retardation time of what touches, over 2 Δt.
        """


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


# --- what Newton's method and a march ask of a rod, and of several alike -------------------------


class Placed(Protocol):
    """What strains give: the shape of a rod, or of several."""

    @property
    def strains(self) -> Floats:
        """The unknowns."""


class Loads(Protocol):
    """How much of everything acts; see `rod.rod.Level`."""

    def toward(self, other: Any, share: float) -> Any:
        """On the way to another."""

    def less(self, other: Any) -> Any:
        """Difference to another."""


S = TypeVar("S", bound=Placed)
L = TypeVar("L", bound=Loads)
Acting = TypeVar("Acting", bound=Loads, contravariant=True)


class Flexible(Protocol[S, Acting]):
    """A rod, or several of them; see `rod.rod.Rod` and `rod.several.system.System`."""

    @property
    def sizes(self) -> Floats:
        """Changes of strains that count as one."""

    def way(self, change: Floats) -> float:
        """How far a change of strains leads."""

    def shape(self, strains: Floats) -> S:
        """What strains give."""

    def residual(self, shape: S, level: Acting) -> Floats:
        """Of equilibrium, as many numbers as there are strains."""

    def tangent(self, shape: S, level: Acting) -> Floats:
        """Its derivative by the strains, a matrix."""

    def growth(self, shape: S, level: Acting, change: Acting) -> Floats:
        """Its derivative along a change of the level."""

    def outside(self, shape: S, level: Acting) -> str:
        """What of a state is not known; empty where nothing is."""

    def blocks(self, shape: S, level: Acting) -> list[Ints]:
        """Unknowns that the tangent couples, each group by itself."""

    def leapt(self, before: S, after: S) -> str:
        """What may have passed through something between two states; empty where nothing has."""

    def closing(self, shape: S, level: Acting, after: S, then: Acting) -> list[tuple[int, float]]:
        """What one state does not touch, but another one does.

        Args:
            shape: that does not.
            level: there.
            after: that does.
            then: level there.

        Returns:
            Places among the terms, and the parts of the way at which gaps close if they fall
            evenly.
        """

    def search(self, shape: S, level: Acting) -> Search[S, Acting]:
        """What stands for it in one search by Newton's method."""


class Search(Protocol[S, Acting]):
    """A rod, or several, within one search; see `rod.term.Iterated`."""

    @property
    def rod(self) -> Flexible[S, Acting]:
        """What equilibrium is asked of."""

    def stepped(self, shape: S, level: Acting, change: Floats, after: Acting) -> bool:
        """Takes note of a step; whether nothing has changed its mind."""
