"""Contact by a penalty on depths, and how Newton's method converges with one that is stiff.

Π = Σ ½ k a d² over points that are d > 0 deep, each with an area a at rest: once continuously
differentiable, so that touch and lift-off bend the forces and do not break them; nothing acts at a
distance.
"""

from __future__ import annotations

import abc
import math
from typing import Protocol, Self

import numpy as np

from rod.functions import Bools, Floats, Ints
from rod.shape import Shape


class Contacts(Protocol):
    """Points that touch something or may do so, and the derivatives of their depths d."""

    @property
    def which(self) -> Ints:
        """Which of the points of the surface they are, (q,)."""

    @property
    def areas(self) -> Floats:
        """At rest, (q,), mm²."""

    @property
    def depth(self) -> Floats:
        """d, (q,), mm; negative apart."""

    def only(self, mask: Bools) -> Self:
        """Some of them."""

    def pushed(self, push: Floats) -> Floats:
        """Σ p ∂d/∂ε, (n, m)."""

    def stiffened(self, stiff: Floats, push: Floats) -> Floats:
        """Σ s ∂d/∂ε ⊗ ∂d/∂ε + p ∂²d/∂ε², (n m, n m)."""

    def deeper(self, change: Floats) -> Floats:
        """First order of d by a change of the strains, (q,), mm."""


class Penalty(abc.ABC):
    """A term that pushes points back; a `rod.term.Iterated`. Its amount is the share of k.

    Args:
        count: number of points of the surface.
        stiffness: k, MPa/mm: pressure per depth.
        keeps: it pulls them as well: what is near is held where d = 0.

    Attributes:
        conservative: it is the derivative of its potential.
        stiffness: as given.
        keeps: as given.

    Raises:
        ValueError: a stiffness that is not positive.
    """

    conservative = True

    def __init__(self, count: int, stiffness: float, keeps: bool = False) -> None:
        if not stiffness > 0:
            raise ValueError(f"contact stiffness {stiffness} MPa/mm, expected a positive value")
        self._count, self.stiffness, self.keeps = count, stiffness, keeps

    @abc.abstractmethod
    def near(self, shape: Shape, amount: float) -> Contacts:
        """Points that are near enough to touch."""

    @abc.abstractmethod
    def room(self, shape: Shape, amount: float) -> float:
        """Where no point is near: a lower bound of all gaps, mm."""

    def share(self, amount: float) -> float:
        """Of the stiffness that acts; see `rod.term.Standing`."""
        return amount

    def grown(self, contacts: Contacts, amount: float) -> Floats:
        """Derivative by the amount of the residual of contacts, (n, m)."""
        return contacts.pushed(self.stiffness * contacts.areas * contacts.depth)

    def deeper(self, contacts: Contacts, amount: float, change: Floats, grows: float) -> Floats:
        """First order of depths by changes of the strains and of the amount, (q,), mm."""
        return contacts.deeper(change)

    # --- the term ---------------------------------------------------------------------------------

    def held(self, shape: Shape, amount: float, pressure: Floats | None = None) -> Contacts:
        """Points that touch: that are deep, or pressed already.

        Args:
            shape: the rod.
            amount: of the term.
            pressure: of each point of the surface, MPa.
        """
        contacts = self.near(shape, amount)
        if self.keeps:
            return contacts
        touches = contacts.depth > 0
        if pressure is not None:
            touches |= pressure[contacts.which] > 0
        return contacts.only(touches)

    def potential(self, shape: Shape, amount: float) -> float:
        """Π, N mm."""
        contacts = self.held(shape, amount)
        square = float(contacts.areas @ contacts.depth**2)
        return self.share(amount) * self.stiffness / 2 * square

    def residual(self, shape: Shape, amount: float) -> Floats:
        """∂Π/∂ε, (n, m)."""
        contacts = self.held(shape, amount)
        stiff = self.share(amount) * self.stiffness * contacts.areas
        return contacts.pushed(stiff * contacts.depth)

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """∂²Π/∂ε², (n m, n m)."""
        contacts = self.held(shape, amount)
        stiff = self.share(amount) * self.stiffness * contacts.areas
        return contacts.stiffened(stiff, stiff * contacts.depth)

    def growth(self, shape: Shape, amount: float) -> Floats:
        """Derivative of the residual by the amount, (n, m)."""
        return self.grown(self.held(shape, amount), amount)

    def gap(self, shape: Shape, amount: float) -> float:
        """See `rod.term.Iterated`."""
        if self.keeps or not self.share(amount):
            return math.inf
        depth = self.near(shape, amount).depth
        return -float(depth.max()) if len(depth) else self.room(shape, amount)

    def iterate(self, before: Shape, amount: float) -> Pressed:
        """See `rod.term.Iterated`."""
        contacts = self.held(before, amount)
        pressure = np.zeros(self._count)
        pressure[contacts.which] = self.share(amount) * self.stiffness * contacts.depth
        return Pressed(self, pressure)


class Pressed:
    """A penalty within Newton's method: pressures of points are unknowns beside the strains.

    With p = k d where something is pressed and p = 0 elsewhere, a step gives p = k (d + ∂d·δε) of
    the points that are held to touch: those that are pressed already, or are deep (the active set
    of Hintermüller, Ito and Kunisch 2002, doi 10.1137/S1052623401383558, for c → 0). What turns
    leaves the straight line of a step by the square of an angle times a lever, many times a depth:
    by depths alone a step would lose what touches, and the next one find nothing there.

    Args:
        penalty: the term.
        pressure: p of each point of the surface, MPa.

    Attributes:
        conservative: as the term.
    """

    conservative = True

    def __init__(self, penalty: Penalty, pressure: Floats) -> None:
        self._penalty, self._pressure = penalty, pressure

    def share(self, amount: float) -> float:
        """See `rod.term.Standing`."""
        return self._penalty.share(amount)

    def _held(self, shape: Shape, amount: float) -> Contacts:
        return self._penalty.held(shape, amount, self._pressure)

    def potential(self, shape: Shape, amount: float) -> float:
        """Of the term."""
        return self._penalty.potential(shape, amount)

    def residual(self, shape: Shape, amount: float) -> Floats:
        """With the depths, or heights, of the points that are held to touch, (n, m)."""
        contacts = self._held(shape, amount)
        stiff = self._penalty.share(amount) * self._penalty.stiffness * contacts.areas
        return contacts.pushed(stiff * contacts.depth)

    def tangent(self, shape: Shape, amount: float) -> Floats:
        """With the pressures that are known, (n m, n m)."""
        contacts = self._held(shape, amount)
        stiff = self._penalty.share(amount) * self._penalty.stiffness * contacts.areas
        return contacts.stiffened(stiff, contacts.areas * self._pressure[contacts.which])

    def growth(self, shape: Shape, amount: float) -> Floats:
        """See `rod.term.Term`."""
        return self._penalty.grown(self._held(shape, amount), amount)

    def stepped(self, shape: Shape, amount: float, change: Floats, grows: float) -> bool:
        """See `rod.term.Iterate`."""
        contacts = self._held(shape, amount)
        more = self._penalty.deeper(contacts, amount, change, grows)
        stiffness = self._penalty.share(amount) * self._penalty.stiffness
        found = stiffness * (contacts.depth + more)
        before = self._pressure
        self._pressure = np.zeros_like(before)
        self._pressure[contacts.which] = found if self._penalty.keeps else np.maximum(found, 0.0)
        return self._penalty.keeps or bool(np.array_equal(before > 0, self._pressure > 0))
