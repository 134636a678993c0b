"""Several rods solved together: they share the way of their loads, and what is between them.

The strains of all rods one after another are the unknowns. Rods that nothing couples make blocks of
their own: a system of rods that are apart takes no more than its rods take one by one.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from rod.functions import Floats, Ints
from rod.rod import Level, Rod
from rod.shape import Shape


@dataclasses.dataclass(frozen=True)
class Levels:
    """How much of everything acts on several rods.

    Attributes:
        rods: on each of them.
        amounts: one for each coupling of the system, in order.
    """

    rods: tuple[Level, ...]
    amounts: tuple[float, ...] = ()

    def toward(self, other: Levels, share: float) -> Levels:
        """On the way to another: itself at 0, the other at 1."""
        pairs = zip(self.rods, other.rods, strict=True)
        between = self._level.toward(other._level, share)
        return Levels(tuple(one.toward(two, share) for one, two in pairs), between.amounts)

    def less(self, other: Levels) -> Levels:
        """Difference to another."""
        pairs = zip(self.rods, other.rods, strict=True)
        between = self._level.less(other._level)
        return Levels(tuple(one.less(two) for one, two in pairs), between.amounts)

    @property
    def _level(self) -> Level:
        return Level(amounts=self.amounts)


class Coupling(Protocol):
    """What acts between rods of a system; amounts are as those of a term."""

    @property
    def rods(self) -> tuple[int, ...]:
        """Places in the system of those that it couples."""

    def acts(self, shapes: Sequence[Shape]) -> bool:
        """Whether it does anything to its rods as they are."""

    def potential(self, shapes: Sequence[Shape], amount: float) -> float:
        """Π, N mm."""

    def residual(self, shapes: Sequence[Shape], amount: float) -> Floats:
        """Its derivative by the strains of its rods, one after another, (k,)."""

    def tangent(self, shapes: Sequence[Shape], amount: float) -> Floats:
        """Its second derivative, (k, k)."""

    def growth(self, shapes: Sequence[Shape], amount: float) -> Floats:
        """Derivative of the residual by the amount, (k,)."""

    def outside(self, shapes: Sequence[Shape]) -> str:
        """What of it is not known; empty where nothing is."""

    def leapt(self, before: Sequence[Shape], after: Sequence[Shape]) -> str:
        """Whether its rods may have passed through each other; empty where they have not."""

    def gap(self, shapes: Sequence[Shape]) -> float:
        """Least distance of what may touch, mm; see `rod.term.Iterated`."""

    def iterate(self, before: Sequence[Shape]) -> CouplingIterate:
        """What stands for it in one search by Newton's method, from a state near by."""


class CouplingIterate(Coupling, Protocol):
    """A coupling within one search; see `rod.term.Iterate`."""

    def stepped(self, shapes: Sequence[Shape], changes: Sequence[Floats]) -> bool:
        """Takes note of a step; whether it has not changed its mind.

        Args:
            shapes: before it.
            changes: of the strains of each of its rods, (n, m).
        """


@dataclasses.dataclass(frozen=True)
class Shapes:
    """Several rods at given strains.

    Attributes:
        each: their shapes.
    """

    each: tuple[Shape, ...]

    @functools.cached_property
    def strains(self) -> Floats:
        """Of all rods, one after another, flat."""
        return np.concatenate([shape.strains.ravel() for shape in self.each])


class System:
    """Several rods, and what couples them.

    Args:
        rods: at least one.
        couplings: what acts between them.

    Attributes:
        rods: as given.
        couplings: as given.
        places: where the strains of each rod begin and end among all.

    Raises:
        ValueError: no rod, or a coupling of rods that are not there.
    """

    def __init__(self, rods: Sequence[Rod], couplings: Sequence[Coupling] = ()) -> None:
        self.rods, self.couplings = tuple(rods), tuple(couplings)
        if not self.rods:
            raise ValueError("a system of no rods: at least one expected")
        for coupling in self.couplings:
            if any(not 0 <= place < len(self.rods) for place in coupling.rods):
                raise ValueError(f"coupling of rods {coupling.rods} among {len(self.rods)}")
        counts = [rod.layout.shape[0] * rod.layout.shape[1] for rod in self.rods]
        ends = list(itertools.accumulate(counts, initial=0))
        self.places = tuple(slice(*pair) for pair in itertools.pairwise(ends))

    @property
    def sizes(self) -> Floats:
        """Changes of strains that count as one, flat."""
        return np.concatenate([rod.sizes.ravel() for rod in self.rods])

    def at_rest(self) -> Floats:
        """Strains of straight rods, flat."""
        return np.concatenate([rod.layout.at_rest().ravel() for rod in self.rods])

    def split(self, strains: Floats) -> list[Floats]:
        """Strains of each rod, (n, m)."""
        pairs = zip(self.rods, self.places, strict=True)
        return [strains[place].reshape(rod.layout.shape) for rod, place in pairs]

    def way(self, change: Floats) -> float:
        """How far a change of strains leads, as that of the rod that it leads farthest."""
        parts = zip(self.rods, self.split(change), strict=True)
        return max(rod.way(part) for rod, part in parts)

    def shape(self, strains: Floats) -> Shapes:
        """All rods at given strains, flat."""
        parts = zip(self.rods, self.split(strains), strict=True)
        return Shapes(tuple(rod.shape(part) for rod, part in parts))

    def potential(self, shapes: Shapes, levels: Levels) -> float:
        """Of all rods and couplings, N mm."""
        total = sum(rod.potential(shape, level) for rod, shape, level in self._all(shapes, levels))
        for coupling, own, amount, _ in self._between(shapes, levels):
            total += coupling.potential(own, amount)
        return total

    def residual(self, shapes: Shapes, levels: Levels) -> Floats:
        """Of equilibrium, flat."""
        parts = [r.residual(shape, level).ravel() for r, shape, level in self._all(shapes, levels)]
        out = np.concatenate(parts)
        for coupling, own, amount, where in self._between(shapes, levels):
            out[where] += coupling.residual(own, amount)
        return out

    def tangent(self, shapes: Shapes, levels: Levels) -> Floats:
        """Derivative of the residual by the strains, a matrix."""
        out = np.zeros(2 * (self.places[-1].stop,))
        for (rod, shape, level), place in zip(self._all(shapes, levels), self.places, strict=True):
            out[place, place] = rod.tangent(shape, level)
        for coupling, own, amount, where in self._between(shapes, levels):
            out[np.ix_(where, where)] += coupling.tangent(own, amount)
        return out

    def growth(self, shapes: Shapes, levels: Levels, change: Levels) -> Floats:
        """Derivative of the residual along a change of the levels, flat."""
        both = zip(self._all(shapes, levels), change.rods, strict=True)
        out = np.concatenate([r.growth(shape, at, by).ravel() for (r, shape, at), by in both])
        amounts = itertools.chain(levels.amounts, itertools.repeat(0.0))
        grown = zip(self.couplings, change.amounts, amounts, strict=False)
        for coupling, grows, amount in grown:
            if grows:
                out[self._where(coupling)] += grows * coupling.growth(
                    self.own(coupling, shapes), amount
                )
        return out

    def blocks(self, shapes: Shapes, levels: Levels) -> list[Ints]:
        """Unknowns of rods that hang together, each group by itself."""
        groups = [{number} for number in range(len(self.rods))]
        for coupling, own, _, _ in self._between(shapes, levels):
            if coupling.acts(own):
                met = [group for group in groups if not group.isdisjoint(coupling.rods)]
                groups = [group for group in groups if group not in met]
                groups.append(set().union(*met))
        return [self._unknowns(sorted(group)) for group in groups]

    def outside(self, shapes: Shapes, levels: Levels) -> str:
        """What of a state is not known; empty where nothing is."""
        for number, (rod, shape, level) in enumerate(self._all(shapes, levels)):
            found = rod.outside(shape, level)
            if found:
                return f"rod {number + 1}: {found}"
        for coupling, own, _, _ in self._between(shapes, levels):
            found = coupling.outside(own)
            if found:
                return found
        return ""

    def closing(
        self, shapes: Shapes, levels: Levels, after: Shapes, then: Levels
    ) -> list[tuple[int, float]]:
        """What one state does not touch, but another one does; see `rod.term.Flexible`.

        Places are those of the terms of all rods, one rod after another, then of couplings.
        """
        found, before = [], 0
        both = zip(self._all(shapes, levels), after.each, then.rods, strict=True)
        for (rod, shape, level), later, last in both:
            found += [(before + n, part) for n, part in rod.closing(shape, level, later, last)]
            before += len(rod.terms)
        for number, coupling in enumerate(self.couplings):
            gap = coupling.gap(self.own(coupling, after))
            if gap < 0 <= (room := coupling.gap(self.own(coupling, shapes))) < math.inf:
                found.append((before + number, room / (room - gap)))
        return found

    def leapt(self, before: Shapes, after: Shapes) -> str:
        """Which rods may have passed through something between two states."""
        for rod, one, two in zip(self.rods, before.each, after.each, strict=True):
            found = rod.leapt(one, two)
            if found:
                return found
        for coupling in self.couplings:
            found = coupling.leapt(self.own(coupling, before), self.own(coupling, after))
            if found:
                return found
        return ""

    def search(self, shapes: Shapes, levels: Levels) -> Search:
        """What stands for it in one search by Newton's method, from a state near by."""
        return Search(self, shapes, levels)

    def own(self, coupling: Coupling, shapes: Shapes) -> list[Shape]:
        """Shapes of the rods of a coupling."""
        return [shapes.each[place] for place in coupling.rods]

    def _all(self, shapes: Shapes, levels: Levels) -> list[tuple[Rod, Shape, Level]]:
        return list(zip(self.rods, shapes.each, levels.rods, strict=True))

    def _between(
        self, shapes: Shapes, levels: Levels
    ) -> list[tuple[Coupling, list[Shape], float, Ints]]:
        """Couplings of which something acts, with their shapes, amounts and unknowns."""
        if len(levels.amounts) > len(self.couplings):
            raise ValueError(f"{len(levels.amounts)} amounts for {len(self.couplings)} couplings")
        return [
            (coupling, self.own(coupling, shapes), amount, self._where(coupling))
            for coupling, amount in zip(self.couplings, levels.amounts, strict=False)
            if amount
        ]

    def _where(self, coupling: Coupling) -> Ints:
        return self._unknowns(coupling.rods)

    def _unknowns(self, rods: Sequence[int]) -> Ints:
        ranges = [np.arange(self.places[rod].start, self.places[rod].stop) for rod in rods]
        return np.concatenate(ranges)


class Search:
    """Several rods and couplings that remember what happens within one search.

    Args:
        system: the rods.
        shapes: from which they begin.
        levels: there.

    Attributes:
        rod: the system of their iterates.
    """

    def __init__(self, system: System, shapes: Shapes, levels: Levels) -> None:
        parts = zip(system.rods, shapes.each, levels.rods, strict=True)
        self._rods = [rod.search(shape, level) for rod, shape, level in parts]
        self._couplings = [
            coupling.iterate(system.own(coupling, shapes)) for coupling in system.couplings
        ]
        self.rod = System([search.rod for search in self._rods], self._couplings)

    def stepped(self, shapes: Shapes, levels: Levels, change: Floats, after: Levels) -> bool:
        """Tells them of a step; whether none of them changed its mind."""
        changes = self.rod.split(change)
        parts = zip(shapes.each, levels.rods, changes, after.rods, strict=True)
        settled = [search.stepped(*part) for search, part in zip(self._rods, parts, strict=True)]
        settled += [
            coupling.stepped(
                self.rod.own(coupling, shapes), [changes[place] for place in coupling.rods]
            )
            for coupling in self._couplings
        ]
        return all(settled)
