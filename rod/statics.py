"""Equilibria of a rod: Newton's method, steps of load or of an angle, and stability."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import Any, Generic, Protocol, TypeAlias

import numpy as np
from scipy.linalg import LinAlgError, cholesky
from scipy.linalg.lapack import dgesv

from rod.functions import Floats, Ints
from rod.rod import Level, Rod
from rod.shape import Shape
from rod.term import Flexible, L, S

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
_SMALLEST = 2.0**-12
TOUCH = 1e-3
"""Part of a step, or of the way between two targets, to which a touch is found."""
_SYMMETRIC = 1e-10


class NoEquilibriumError(RuntimeError):
    """Newton's method found no state, or a march could not go on."""


@dataclasses.dataclass(frozen=True)
class Equilibrium(Generic[S, L]):
    """An equilibrium.

    Attributes:
        shape: of the rod, or of the rods.
        level: what acts on it.
        share: of the way between two levels.
        iterations: of Newton's method.
        unstable: number of negative eigenvalues of the tangent; of one that is not symmetric, of
            eigenvalues with a negative real part.
        tangent: there, (n m, n m).
    """

    shape: S
    level: L
    share: float
    iterations: int
    unstable: int
    tangent: Floats

    @classmethod
    def at(
        cls, rod: Flexible[S, L], shape: S, level: L, share: float, iterations: int
    ) -> Equilibrium[S, L]:
        """A state, its tangent and stability."""
        tangent = rod.tangent(shape, level)
        blocks = rod.blocks(shape, level)
        unstable = sum(unstable_modes(_part(tangent, block)) for block in blocks)
        return cls(shape, level, share, iterations, unstable, tangent)

    @property
    def strains(self) -> Floats:
        """(n, m)."""
        return self.shape.strains


State: TypeAlias = Equilibrium[Shape, Level]
"""Of one rod."""


@dataclasses.dataclass(frozen=True)
class Loading(Generic[L]):
    """From one level to another; what is beyond its ends is on it as well.

    Attributes:
        start: the level at 0.
        end: the level at 1.
    """

    start: L
    end: L

    def at(self, share: float) -> L:
        """The level at a share of the way."""
        out: L = self.start.toward(self.end, share)
        return out


Path: TypeAlias = Loading[Level]
"""Of one rod."""


class Held(Protocol):
    """What is given in place of the share of the path, which is then unknown."""

    def value(self, rod: Any, strains: Floats, level: Any) -> float:
        """Of what is given."""

    def slopes(self, rod: Any, strains: Floats, level: Any, change: Any) -> tuple[Floats, float]:
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
    """Changes of strains that count as one; see `Rod.sizes`."""
    return rod.sizes


def way(rod: Rod, change: Floats) -> float:
    """How far a change of strains leads; see `Rod.way`."""
    return rod.way(change)


def solve(
    rod: Flexible[S, L],
    strains: Floats,
    path: Loading[L],
    target: float,
    held: Held | None = None,
    share: float | None = None,
    before: Equilibrium[S, L] | None = None,
) -> Equilibrium[S, L]:
    """The equilibrium at a share of a path, or at a given angle on it, by Newton's method.

    Args:
        rod: the rod, or several.
        strains: to start from, (n, m); of several rods as they have them.
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
    sizes, change = rod.sizes, path.end.less(path.start)
    at = target if held is None else (0.0 if share is None else share)
    last = math.inf
    near = (rod.shape(strains), path.at(at)) if before is None else (before.shape, before.level)
    search = rod.search(*near)
    for iteration in range(1, _MOST + 1):
        shape, level = rod.shape(strains), path.at(at)
        tangent = search.rod.tangent(shape, level)
        columns = [-search.rod.residual(shape, level).ravel()]
        if held is not None:
            columns.append(-search.rod.growth(shape, level, change).ravel())
        solved = np.empty((strains.size, len(columns)))
        for block in search.rod.blocks(shape, level):
            right = np.stack([column[block] for column in columns], axis=1)
            solved[block], singular = dgesv(_part(tangent, block), right)[2:]
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
        if not rod.way(step.reshape(strains.shape)) < _FAR:
            raise NoEquilibriumError(f"iteration {iteration}: the correction is too great")
        moved = float(np.max(np.abs(step.reshape(strains.shape) / sizes)))
        if settled and (moved < _CLOSE or (moved < _LOOSE and moved > last / 2)):
            break
        last = moved
    else:
        raise NoEquilibriumError(f"{_MOST} iterations leave a correction of {moved:.3g}")
    shape, level = rod.shape(strains), path.at(at)
    outside = rod.outside(shape, level)
    if outside:
        raise NoEquilibriumError(outside)
    return Equilibrium.at(rod, shape, level, at, iteration)


def _part(matrix: Floats, block: Ints) -> Floats:
    return matrix if len(block) == len(matrix) else matrix[np.ix_(block, block)]


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


@dataclasses.dataclass(frozen=True)
class Step(Generic[S, L]):
    """A state of a march.

    Attributes:
        state: the equilibrium.
        reached: it is at a target.
        touches: places of the terms, among those of the rod, that the last state did not touch; it
            is at most a thousandth of the way from target to target beyond the touch.
    """

    state: Equilibrium[S, L]
    reached: bool
    touches: tuple[int, ...]


def march(
    rod: Flexible[S, L],
    start: Equilibrium[S, L] | Floats,
    path: Loading[L],
    targets: Sequence[float],
    held: Held | None = None,
) -> list[Equilibrium[S, L]]:
    """States along a path at targets in turn; see `steps`.

    Raises:
        NoEquilibriumError: the smallest step does not converge.
    """
    walked = steps(rod, start, path, targets, held)
    return [step.state for step in walked if step.reached]


def steps(
    rod: Flexible[S, L],
    start: Equilibrium[S, L] | Floats,
    path: Loading[L],
    targets: Sequence[float],
    held: Held | None = None,
) -> Iterator[Step[S, L]]:
    """States along a path, each from the last two by extrapolation; steps are halved where needed.

    A step on which something is touched for the first time ends there, and the next one starts
    without what was foreseen before: a touch is a kink of the path.

    Args:
        rod: the rod, or several.
        start: a state or strains of an equilibrium at share 0.
        path: levels.
        targets: shares, or with `held` its values, in turn.
        held: what is given in place of the share.

    Yields:
        The states at the targets, at touches and on the way.

    Raises:
        NoEquilibriumError: the smallest step does not converge.
    """
    if isinstance(start, Equilibrium):
        strains, share = start.strains, start.share
    else:
        strains, share = start, 0.0
    now = share if held is None else held.value(rod, strains, path.at(share))
    known = [(now, strains, share)]
    last = Equilibrium.at(rod, rod.shape(strains), path.at(share), share, 0)
    for target in targets:
        begin, part, done, beyond = known[-1][0], 1.0, 0.0, math.inf
        while done < 1.0:
            ahead = min(part, 1.0 - done)
            guess, at = _ahead(known, begin + (done + ahead) * (target - begin))
            foreseen = rod.shape(guess), path.at(at)
            ahead = min(ahead, until_touch(closing(rod, last, *foreseen), ahead, beyond - done))
            goal = target if done + ahead >= 1.0 else begin + (done + ahead) * (target - begin)
            guess, at = _ahead(known, goal)
            try:
                state = solve(rod, guess, path, goal, held, at, last)
                if rod.way(state.strains - guess) > _AWAY:
                    raise NoEquilibriumError(f"the state at {goal:.6g} is far from the last one")
                leapt = rod.leapt(last.shape, state.shape)
                if leapt:
                    raise NoEquilibriumError(leapt)
            except NoEquilibriumError:
                part = ahead / 2
                if part < _SMALLEST:
                    raise
                continue
            touches = tuple(place for place, _ in closing(rod, last, state.shape, state.level))
            if touches and ahead > TOUCH:
                beyond = done + ahead
                continue
            known = [*known[-1:], (goal, state.strains, state.share)][1 if touches else 0 :]
            last, done, part, beyond = state, done + ahead, max(part, 2 * ahead), math.inf
            yield Step(state, done >= 1.0, touches)


def until_touch(closing: list[tuple[int, float]], ahead: float, beyond: float) -> float:
    """How long a step may be, in parts of one to which `TOUCH` belongs.

    To just before a touch, then to just beyond it; where that has been missed, halfway to it.

    Args:
        closing: what is foreseen to be touched; see `closing`.
        ahead: length of the step without a touch.
        beyond: that of one known to touch, infinite if none is.
    """
    halfway = max(beyond / 2, TOUCH)
    if not closing:
        return min(ahead, halfway)
    near = min(share for _, share in closing) * ahead
    return min(near + (-TOUCH / 4 if near > TOUCH * 3 / 4 else TOUCH / 2), halfway)


def closing(
    rod: Flexible[S, L], last: Equilibrium[S, L], shape: S, level: L
) -> list[tuple[int, float]]:
    """What the last state does not touch, but another one does; see `Flexible.closing`.

    Args:
        rod: the rod, or several.
        last: the one that does not.
        shape: of the other one.
        level: there.
    """
    return rod.closing(last.shape, last.level, shape, level)


def _ahead(known: list[tuple[float, Floats, float]], goal: float) -> tuple[Floats, float]:
    """Strains and share by the line through the last two states."""
    (now, strains, share) = known[-1]
    if len(known) == 1 or known[0][0] == now:
        return strains, share
    before, earlier, past = known[0]
    part = (goal - now) / (now - before)
    return strains + part * (strains - earlier), share + part * (share - past)
