"""Equilibria of a rod: Newton's method, steps of load or of an angle, and stability."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from scipy.linalg import LinAlgError, cholesky
from scipy.linalg.lapack import dgesv

from rod.functions import Floats
from rod.rod import Level, Rod
from rod.shape import Shape
from rod.term import Iterate, Iterated

_CLOSE = 1e-9
"""Greatest last correction of a stretch, and of an angle over the whole length in rad; as it falls
quadratically, what is left is of round-off."""
_LOOSE = 1e-6
"""One that round-off may keep from falling further."""
_MOST = 20
_FAR = 2.0
"""Greatest correction, in rad over the whole length or in stretch: beyond it another branch may be
met."""
_AWAY = 1.0
"""Greatest way from what a march foresees to the state that it finds."""
_SMALLEST = 2.0**-10
_SYMMETRIC = 1e-10


class NoEquilibriumError(RuntimeError):
    """Newton's method found no state, or a march could not go on."""


@dataclasses.dataclass(frozen=True)
class State:
    """An equilibrium.

    Attributes:
        shape: the rod.
        level: what acts on it.
        share: of the way between two levels.
        iterations: of Newton's method.
        unstable: number of negative eigenvalues of the tangent; of one that is not symmetric, of
            eigenvalues with a negative real part.
        tangent: there, (n m, n m).
    """

    shape: Shape
    level: Level
    share: float
    iterations: int
    unstable: int
    tangent: Floats

    @classmethod
    def at(cls, rod: Rod, shape: Shape, level: Level, share: float, iterations: int) -> State:
        """A state, its tangent and stability."""
        tangent = rod.tangent(shape, level)
        return cls(shape, level, share, iterations, unstable_modes(tangent), tangent)

    @property
    def strains(self) -> Floats:
        """(n, m)."""
        return self.shape.strains


@dataclasses.dataclass(frozen=True)
class Path:
    """From one level to another; what is beyond its ends is on it as well.

    Attributes:
        start: the level at 0.
        end: the level at 1.
    """

    start: Level
    end: Level

    def at(self, share: float) -> Level:
        """The level at a share of the way."""
        return self.start.toward(self.end, share)


class Held(Protocol):
    """What is given in place of the share of the path, which is then unknown."""

    def value(self, rod: Rod, strains: Floats, level: Level) -> float:
        """Of what is given."""

    def slopes(
        self, rod: Rod, strains: Floats, level: Level, change: Level
    ) -> tuple[Floats, float]:
        """Its derivatives by the strains, (n, m), and along a change of the level."""


@dataclasses.dataclass(frozen=True)
class Angle:
    """Σ w ε is given: an angle leads over the greatest pressure.

    Attributes:
        weights: w, (n, m); `Layout.weights` has those of an angle.
    """

    weights: Floats

    def value(self, rod: Rod, strains: Floats, level: Level) -> float:
        """Σ w ε."""
        return float(np.sum(self.weights * strains))

    def slopes(
        self, rod: Rod, strains: Floats, level: Level, change: Level
    ) -> tuple[Floats, float]:
        """See `Held`."""
        return self.weights, 0.0


@dataclasses.dataclass(frozen=True)
class Volume:
    """The volume of the chamber is given, mm³: what is in it cannot be compressed."""

    def value(self, rod: Rod, strains: Floats, level: Level) -> float:
        """Of the chamber, mm³."""
        return rod.volume(strains, level.pressure)

    def slopes(
        self, rod: Rod, strains: Floats, level: Level, change: Level
    ) -> tuple[Floats, float]:
        """See `Held`."""
        lengths = rod.layout.lengths
        by_strains = lengths[:, None] * rod.law.chamber_gradient(strains, level.pressure)
        by_pressure = float(lengths @ rod.law.chamber_slope(strains, level.pressure))
        return by_strains, by_pressure * change.pressure


def size(rod: Rod) -> Floats:
    """Changes of strains that count as one: of a stretch 1, of a curvature 1/L; (n, m)."""
    length = float(rod.layout.lengths.sum())
    sizes = np.array([1.0, 1.0, 1.0, 1 / length, 1 / length, 1 / length])
    return np.broadcast_to(sizes[list(rod.layout.columns)], rod.layout.shape)


def way(rod: Rod, change: Floats) -> float:
    """How far a change of strains leads: a mean stretch or the turns of all pieces in sum, rad."""
    parts = rod.layout.lengths[:, None] * np.abs(change) / size(rod)
    return float(parts.sum(axis=0).max()) / float(rod.layout.lengths.sum())


def solve(
    rod: Rod,
    strains: Floats,
    path: Path,
    target: float,
    held: Held | None = None,
    share: float | None = None,
    before: State | None = None,
) -> State:
    """The equilibrium at a share of a path, or at a given angle on it, by Newton's method.

    Args:
        rod: the rod.
        strains: to start from, (n, m).
        path: levels.
        target: the share; with `held` its value.
        held: what is given in place of the share.
        share: to start from where it is unknown; 0 if none is given.
        before: an equilibrium near by, whose contacts the search begins with; None: those of the
            strains to start from.

    Returns:
        The state.

    Raises:
        NoEquilibriumError: it does not converge.
    """
    sizes, change = size(rod), path.end.less(path.start)
    at = target if held is None else (0.0 if share is None else share)
    last = math.inf
    near = (rod.shape(strains), path.at(at)) if before is None else (before.shape, before.level)
    search = _Search(rod, *near)
    for iteration in range(1, _MOST + 1):
        shape, level = rod.shape(strains), path.at(at)
        tangent = search.rod.tangent(shape, level)
        columns = [-search.rod.residual(shape, level).ravel()]
        if held is not None:
            columns.append(-search.rod.growth(shape, level, change).ravel())
        solved, singular = dgesv(tangent, np.stack(columns, axis=1))[2:]
        if singular:
            raise NoEquilibriumError(f"iteration {iteration}: the tangent is singular")
        step = solved[:, 0]
        if held is not None:
            by_strains, by_share = held.slopes(rod, strains, level, change)
            row = by_strains.ravel()
            missing = target - held.value(rod, strains, level) - float(row @ step)
            with np.errstate(divide="ignore"):
                more = np.divide(missing, float(row @ solved[:, 1]) + by_share)
            step, at = step + more * solved[:, 1], at + float(more)
        settled = search.stepped(shape, level, step.reshape(strains.shape), path.at(at))
        strains = strains + step.reshape(strains.shape)
        if not way(rod, step.reshape(strains.shape)) < _FAR:
            raise NoEquilibriumError(f"iteration {iteration}: the correction is too great")
        moved = float(np.max(np.abs(step.reshape(strains.shape) / sizes)))
        if settled and (moved < _CLOSE or (moved < _LOOSE and moved > last / 2)):
            break
        last = moved
    else:
        raise NoEquilibriumError(f"{_MOST} iterations leave a correction of {moved:.3g}")
    shape, level = rod.shape(strains), path.at(at)
    outside = rod.law.outside(strains, level.pressure)
    if outside:
        raise NoEquilibriumError(outside)
    return State.at(rod, shape, level, at, iteration)


class _Search:
    """A rod whose terms remember what happens within one search.

    Args:
        rod: the rod.
        shape: from which they begin.
        level: there.

    Attributes:
        rod: with the iterates of its terms.
    """

    def __init__(self, rod: Rod, shape: Shape, level: Level) -> None:
        amounts = itertools.chain(level.amounts, itertools.repeat(0.0))
        self._iterates: dict[int, Iterate] = {
            number: term.iterate(shape, amount)
            for number, (term, amount) in enumerate(zip(rod.terms, amounts, strict=False))
            if isinstance(term, Iterated)
        }
        if not self._iterates:
            self.rod = rod
            return
        terms = [self._iterates.get(number, term) for number, term in enumerate(rod.terms)]
        self.rod = Rod(rod.layout, rod.law, None, terms)

    def stepped(self, shape: Shape, level: Level, change: Floats, after: Level) -> bool:
        """Tells them of a step; whether none of them changed its mind."""
        amounts, others = (
            [*each.amounts, *[0.0] * (len(self.rod.terms) - len(each.amounts))]
            for each in (level, after)
        )
        settled = [
            term.stepped(shape, amounts[number], change, others[number] - amounts[number])
            for number, term in self._iterates.items()
        ]
        return all(settled)


def unstable_modes(tangent: Floats) -> int:
    """Number of negative eigenvalues, or of negative real parts where it is not symmetric."""
    scale = float(np.abs(tangent).max())
    if float(np.abs(tangent - tangent.T).max()) > _SYMMETRIC * scale:
        return int(np.sum(np.linalg.eigvals(tangent).real < 0))
    try:
        cholesky(tangent, check_finite=False)
    except LinAlgError:
        return int(np.sum(np.linalg.eigvalsh(tangent) < 0))
    return 0


def march(
    rod: Rod,
    start: State | Floats,
    path: Path,
    targets: Sequence[float],
    held: Held | None = None,
) -> list[State]:
    """States along a path, each from the last two by extrapolation; steps are halved where needed.

    Args:
        rod: the rod.
        start: a state or strains of an equilibrium at share 0.
        path: levels.
        targets: shares, or with `held` its values, in turn.
        held: what is given in place of the share.

    Returns:
        The states at the targets.

    Raises:
        NoEquilibriumError: the smallest step does not converge.
    """
    strains, share = (start.strains, start.share) if isinstance(start, State) else (start, 0.0)
    now = share if held is None else held.value(rod, strains, path.at(share))
    known = [(now, strains, share)]
    last = start if isinstance(start, State) else None
    states = []
    for target in targets:
        begin, part = known[-1][0], 1.0
        done = 0.0
        while done < 1.0:
            part = min(part, 1.0 - done)
            goal = target if done + part == 1.0 else begin + (done + part) * (target - begin)
            guess, at = _ahead(known, goal)
            try:
                state = solve(rod, guess, path, goal, held, at, last)
                if way(rod, state.strains - guess) > _AWAY:
                    raise NoEquilibriumError(f"the state at {goal:.6g} is far from the last one")
            except NoEquilibriumError:
                part /= 2
                if part < _SMALLEST:
                    raise
                continue
            known, last = [*known[-1:], (goal, state.strains, state.share)], state
            done += part
            part *= 2
        states.append(state)
    return states


def _ahead(known: list[tuple[float, Floats, float]], goal: float) -> tuple[Floats, float]:
    """Strains and share by the line through the last two states."""
    (now, strains, share) = known[-1]
    if len(known) == 1 or known[0][0] == now:
        return strains, share
    before, earlier, past = known[0]
    part = (goal - now) / (now - before)
    return strains + part * (strains - earlier), share + part * (share - past)
