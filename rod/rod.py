"""A rod with what acts on it: its potential, residual and tangent."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from rod.functions import Floats, Ints
from rod.law import Law
from rod.layout import Layout
from rod.plane import placed
from rod.shape import Shape
from rod.term import Iterate, Iterated, Standing, Term


@dataclasses.dataclass(frozen=True)
class Level:
    """How much of everything acts.

    Attributes:
        pressure: P of the chamber, MPa.
        amounts: one for each term of the rod, in order; those that are missing are zero.
    """

    pressure: float = 0.0
    amounts: tuple[float, ...] = ()

    def toward(self, other: Level, share: float) -> Level:
        """On the way to another: itself at 0, the other at 1."""
        rest = 1 - share
        pressure = rest * self.pressure + share * other.pressure
        return Level(pressure, tuple(rest * a + share * b for a, b in self._pairs(other)))

    def less(self, other: Level) -> Level:
        """Difference to another."""
        pressure = self.pressure - other.pressure
        return Level(pressure, tuple(a - b for a, b in self._pairs(other)))

    def _pairs(self, other: Level) -> Iterator[tuple[float, float]]:
        return itertools.zip_longest(self.amounts, other.amounts, fillvalue=0.0)


class Rod:
    """A rod with its law, inertia and terms.

    Args:
        layout: pieces, free strains and root.
        law: energy of the sections.
        inertia: masses on the frames, (n + 1, 4, 4); see `rod.inertia`. None: it has no mass. Its
            weight is a term.
        terms: what acts on it beside pressure.

    Attributes:
        layout: as given.
        law: as given.
        inertia: as given; zero where nothing is given.
        terms: as given.

    Raises:
        ValueError: inertia of another number of frames.
    """

    def __init__(
        self,
        layout: Layout,
        law: Law,
        inertia: Floats | None = None,
        terms: Sequence[Term] = (),
    ) -> None:
        frames = len(layout.lengths) + 1
        if inertia is not None and inertia.shape != (frames, 4, 4):
            raise ValueError(f"inertia: one of (4, 4) for each of {frames} frames expected")
        self.layout, self.law, self.terms = layout, law, tuple(terms)
        self.inertia: Floats = np.zeros((frames, 4, 4)) if inertia is None else inertia
        self._stands = [isinstance(each, Standing) and bool(each.share(0.0)) for each in terms]

    @property
    def sizes(self) -> Floats:
        """Changes of strains that count as one: of a stretch 1, of a curvature 1/L; (n, m)."""
        length = float(self.layout.lengths.sum())
        sizes = np.array([1.0, 1.0, 1.0, 1 / length, 1 / length, 1 / length])
        return np.broadcast_to(sizes[list(self.layout.columns)], self.layout.shape)

    def way(self, change: Floats) -> float:
        """How far a change of strains leads: a mean stretch or the turns of all pieces, rad."""
        parts = self.layout.lengths[:, None] * np.abs(change) / self.sizes
        return float(parts.sum(axis=0).max()) / float(self.layout.lengths.sum())

    def blocks(self, shape: Shape, level: Level) -> list[Ints]:
        """Unknowns that the tangent couples: all of them."""
        return [np.arange(shape.strains.size)]

    def outside(self, shape: Shape, level: Level) -> str:
        """What of a state is beyond the range in which its law is known; empty where nothing is."""
        return self.law.outside(shape.strains, level.pressure)

    def shape(self, strains: Floats) -> Shape:
        """Its line at given strains, (n, m)."""
        return placed(self.layout, strains)

    def leapt(self, before: Shape, after: Shape) -> str:
        """What may have passed through something between two states: nothing is known to."""
        return ""

    def closing(
        self, shape: Shape, level: Level, after: Shape, then: Level
    ) -> list[tuple[int, float]]:
        """What one state does not touch, but another one does; see `rod.term.Flexible`."""
        found = []
        begun, ended = self.amounts(level), self.amounts(then)
        for place, (term, first, last) in enumerate(zip(self.terms, begun, ended, strict=True)):
            if not isinstance(term, Iterated):
                continue
            gap = term.gap(after, last)
            if gap < 0 <= (room := term.gap(shape, first)) < math.inf:
                found.append((place, room / (room - gap)))
        return found

    def amounts(self, level: Level) -> list[float]:
        """Of all terms at a level."""
        return [*level.amounts, *[0.0] * (len(self.terms) - len(level.amounts))]

    def search(self, shape: Shape, level: Level) -> Search:
        """What stands for it in one search by Newton's method, from a state near by."""
        return Search(self, shape, level)

    def acting(self, level: Level) -> list[tuple[Term, float]]:
        """The terms of which something acts, with their amounts.

        Raises:
            ValueError: more amounts than terms.
        """
        if len(level.amounts) > len(self.terms):
            raise ValueError(f"{len(level.amounts)} amounts for {len(self.terms)} terms")
        three = zip(self.terms, self.amounts(level), self._stands, strict=True)
        return [(term, amount) for term, amount, stands in three if amount or stands]

    def elastic(self, strains: Floats, pressure: float) -> float:
        """∫ Φ ds, N mm; the work of the air is in it."""
        return float(self.layout.lengths @ self.law.value(strains, pressure))

    def potential(self, shape: Shape, level: Level) -> float:
        """∫ Φ ds and that of the terms, N mm; what has no potential is left out."""
        terms = sum(term.potential(shape, amount) for term, amount in self.acting(level))
        return self.elastic(shape.strains, level.pressure) + terms

    def residual(self, shape: Shape, level: Level) -> Floats:
        """Its derivative by the strains less the virtual work of other loads, (n, m)."""
        forces = self.law.gradient(shape.strains, level.pressure)
        out: Floats = self.layout.lengths[:, None] * forces
        for term, amount in self.acting(level):
            out = out + term.residual(shape, amount)
        return out

    def stiffness(self, strains: Floats, pressure: float) -> Floats:
        """Second derivative of ∫ Φ ds, (n m, n m): a block for each piece."""
        n, m = self.layout.shape
        blocks = self.layout.lengths[:, None, None] * self.law.hessian(strains, pressure)
        out = np.zeros((n, m, n, m))
        place = np.arange(n)
        out[place, :, place] = blocks
        return out.reshape(n * m, n * m)

    def tangent(self, shape: Shape, level: Level) -> Floats:
        """Derivative of the residual by the strains, (n m, n m)."""
        out = self.stiffness(shape.strains, level.pressure)
        for term, amount in self.acting(level):
            out += term.tangent(shape, amount)
        return out

    def growth(self, shape: Shape, level: Level, change: Level) -> Floats:
        """Derivative of the residual along a change of the level, (n, m)."""
        chamber = self.law.chamber_gradient(shape.strains, level.pressure)
        out: Floats = -change.pressure * self.layout.lengths[:, None] * chamber
        grown = zip(self.terms, change.amounts, strict=False)
        amounts = itertools.chain(level.amounts, itertools.repeat(0.0))
        for (term, grows), amount in zip(grown, amounts, strict=False):
            if grows:
                out = out + grows * term.growth(shape, amount)
        return out

    def volume(self, strains: Floats, pressure: float) -> float:
        """Of the chamber, mm³."""
        return float(self.layout.lengths @ self.law.chamber(strains, pressure))


class Search:
    """A rod whose terms remember what happens within one search.

    Args:
        rod: the rod.
        shape: from which they begin.
        level: there.

    Attributes:
        rod: with the iterates of its terms.
    """

    def __init__(self, rod: Rod, shape: Shape, level: Level) -> None:
        amounts = rod.amounts(level)
        self._iterates: dict[int, Iterate] = {
            number: term.iterate(shape, amounts[number])
            for number, term in enumerate(rod.terms)
            if isinstance(term, Iterated)
        }
        if not self._iterates:
            self.rod = rod
            return
        terms = [self._iterates.get(number, term) for number, term in enumerate(rod.terms)]
        self.rod = Rod(rod.layout, rod.law, None, terms)

    def stepped(self, shape: Shape, level: Level, change: Floats, after: Level) -> bool:
        """Tells them of a step; whether none of them changed its mind."""
        amounts, others = self.rod.amounts(level), self.rod.amounts(after)
        settled = [
            term.stepped(shape, amounts[number], change, others[number] - amounts[number])
            for number, term in self._iterates.items()
        ]
        return all(settled)
