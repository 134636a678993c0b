"""Bifurcations: the critical mode, and the way along it onto the branch on which the body rests.

Where a mode loses its stiffness and the load does not turn, another branch crosses the path. It is
entered by giving the amplitude a of the mode φ beside the state w0 on the path, with the load λ
found: φ · (w − w0)/(φ · φ) = a. Pinpointing by bisection of the inertia and switching along the
eigenvector: Riks 1979, doi 10.1016/0020-7683(79)90081-7; Wagner and Wriggers 1988,
doi 10.1108/eb023727.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from fem.march.equilibrium import Equilibrium
from fem.march.predictor import extrapolated, lagrange
from fem.march.records import MODES, Critical, State, measure
from fem.ranks import total
from fem.solver.modes import Mode, softest_mode
from fem.solver.newton import Outcome
from fem.solver.side_conditions import GivenFunctional

Floats = npt.NDArray[np.float64]

FIRST = 0.01
"""First amplitude of a mode, in parts of the least extent of what is modelled."""
TRIES = 30
FACTOR = 1.6
"""Growth of the amplitude from one state on an unstable branch to the next."""
FAR = 10.0
"""Amplitude, in parts of the first, from which the load or its conjugate lead on."""
CUT = 0.3
"""Factor of an amplitude that fails."""
LEAST = 1e-3
"""Amplitude, in parts of the first, below which there is no branch to be found."""
TILTED = 1e-6
"""Part of the load that works on a mode from which the loads choose its side, not round-off."""
ROUGH = 0.3
"""Roughness of a mode from which the mesh gives its wave: less than three elements."""
CLEAR = 0.3
"""A measure of the mode's direction is taken if it is so large beside the greatest of them."""


def excess(state: State, scalar: str) -> int:
    """Unstable modes that stay where the work-conjugate of a load is given in place of its value.

    Args:
        state: of assessed stability; at rest without any. Of a solver that tells no modes the
            count says nothing.
        scalar: the load that is driven.
    """
    falls = state.measures.get(measure("rate", scalar), 1.0) < 0
    return int(state.measures.get(MODES, 0)) - int(falls)


@dataclasses.dataclass(frozen=True)
class Crossing:
    """The place where another branch crosses the path, between a stable and an unstable state.

    Attributes:
        stable: the last state before it.
        unstable: a state beyond it.
        share: where it lies between the two, from 0 to 1.
        mode: the critical mode, pointing to the side that is taken.
        chosen: both sides are alike, the mode's direction was chosen.
        seen: the mode is the one that is lost: stable at one state, unstable at the other. Further
            off, another mode may be softer than that at both.
        wrinkle: the mode's waves are as short as elements: their size gives the load.
    """

    stable: State
    unstable: State
    share: float
    mode: Mode
    chosen: bool
    seen: bool
    wrinkle: bool

    def between(self, a: Floats | float, b: Floats | float) -> Floats:
        """Interpolated at the crossing between values of the two states."""
        return np.asarray(a + self.share * (b - a))

    def measure(self, name: str) -> float:
        """Interpolated measure of the two states."""
        pair = (state.measures[name] for state in (self.stable, self.unstable))
        return float(self.between(*pair))

    def critical(self, scalar: str, left: bool) -> Critical:
        """For the report; `left`: the path was left for the other branch."""
        control = self.measure("control") if "control" in self.stable.measures else None
        return Critical(
            kind="bifurcation",
            scalar=scalar,
            value=self.measure(measure("value", scalar)),
            conjugate=self.measure(measure("conjugate", scalar)),
            control=control,
            before=int(self.stable.measures.get(MODES, 0)),
            after=int(self.unstable.measures[MODES]),
            side=("chosen" if self.chosen else "by the loads") if left else "",
            wrinkle=self.wrinkle,
        )


@dataclasses.dataclass(frozen=True)
class _Point:
    """A state on the branch that is entered: amplitude, fields and scalars."""

    amplitude: float
    w: Floats
    scalars: dict[str, float]


class _Amplitude:
    """φ · (w − w0)/(φ · φ) over a size: how far a state is beside another along a mode."""

    def __init__(self, equilibrium: Equilibrium, mode: Floats, base: Floats, size: float) -> None:
        self._scene, self._base = equilibrium.scene, base
        self._row = np.where(equilibrium.displacements, mode, 0.0)
        self._row /= float(total(self._scene.domain.comm, float(self._row @ self._row))) * size

    def value(self) -> float:
        """At the present state."""
        mine = float(self._row @ (self._scene.w - self._base))
        return float(total(self._scene.domain.comm, mine))

    def row(self) -> Floats:
        """∂/∂w on the owned dofs."""
        return self._row

    def slope(self, _scalar: str) -> float:
        """∂/∂q of a global scalar: none."""
        return 0.0


class Branches:
    """Finds where branches cross and leads from one onto the other.

    Args:
        equilibrium: the scene and what finds its equilibria.
    """

    def __init__(self, equilibrium: Equilibrium) -> None:
        self._equilibrium = equilibrium
        data = equilibrium.scene.domain.data
        self._extent = float(np.ptp(data.nodes, axis=0).min())

    # --- where -----------------------------------------------------------------------------------

    def crossing(self, scalar: str, stable: State, unstable: State) -> Crossing:
        """The crossing between two states near each other, and its mode; collective.

        It lies where the stiffness of the mode, by linear interpolation, is zero.
        """
        (before, push), (after, pull) = (self._softest(s, scalar) for s in (stable, unstable))
        share, mode = 1.0, after
        seen = before.stiffness > 0 > after.stiffness
        if seen:
            share = before.stiffness / (before.stiffness - after.stiffness)
            mode = before if before.stiffness < -after.stiffness else after
        same = np.sign(self._dot(before.w, after.w))
        push, pull = (push, same * pull) if mode is before else (same * push, pull)
        value = measure("value", scalar)
        onward = np.sign(unstable.measures[value] - stable.measures[value])
        tilt = -onward * ((1 - share) * push + share * pull)
        chosen = bool(abs(tilt) < TILTED)
        side = self._direction(mode.w) if chosen else np.sign(tilt)
        scalars = {name: float(side * q) for name, q in mode.scalars.items()}
        turned = dataclasses.replace(mode, w=side * mode.w, scalars=scalars)
        wrinkle = seen and self._equilibrium.roughness(mode.w) > ROUGH
        return Crossing(stable, unstable, share, turned, chosen, seen, wrinkle)

    def wrinkles(self, state: State, scalar: str) -> bool:
        """Whether the softest mode of a state has waves as short as elements; collective.

        The scene is left at the state.
        """
        mode, _ = self._softest(state, scalar)
        return self._equilibrium.roughness(mode.w) > ROUGH

    def _softest(self, state: State, scalar: str) -> tuple[Mode, float]:
        """The softest mode of a state, and the part of a load's growth that works on it.

        That part is the cosine φ · ∂R/∂λ / (|φ| |∂R/∂λ|), λ the load; it is zero where another
        branch crosses the path, and small where an imperfection rounds the crossing.
        """
        equilibrium = self._equilibrium
        scene, newton = equilibrium.scene, equilibrium.newton
        equilibrium.restore(state)
        natural = equilibrium.natural_conditions()
        start = equilibrium.anyhow()
        mode = softest_mode(newton, scene.natural, natural, equilibrium.displacements, start)
        load = scene.load(scalar)
        work = self._dot(mode.w, load)
        for name, value in mode.scalars.items():
            work -= value * scene.second_derivative(name, scalar)
        return mode, work / max(scene.norm(load), 1e-300)

    def _dot(self, a: Floats, b: Floats) -> float:
        """Inner product of displacements over all ranks."""
        mass = self._equilibrium.displacements
        return float(total(self._equilibrium.scene.domain.comm, float(a[mass] @ b[mass])))

    def _direction(self, w: Floats) -> float:
        """1 or −1: a side of a mode by its moments, which round-off does not change.

        The moments of the displacement with 1, x, y, z, x², xy … are taken in their order, the
        first one that is large beside the greatest; it is to be positive.
        """
        scene = self._equilibrium.scene
        body, nodes = scene.body, scene.domain.data.nodes
        own = body.owned_nodes
        x = (nodes - nodes.mean(axis=0)) / np.ptp(nodes, axis=0).max()
        axes = range(x.shape[1])
        powers = [
            np.prod(x[:, list(i)], axis=1)
            for degree in range(3)
            for i in itertools.combinations_with_replacement(axes, degree)
        ]
        moved = w[body.node_dofs[own]]
        moments = np.array([p[own] @ moved / np.linalg.norm(p) for p in powers]).ravel()
        moments = np.asarray(total(scene.domain.comm, moments))
        clear = np.abs(moments) > CLEAR * np.abs(moments).max()
        return float(np.sign(moments[np.argmax(clear)])) or 1.0

    # --- onto the other branch -------------------------------------------------------------------

    def leave(
        self,
        scalar: str,
        crossing: Crossing,
        count: Callable[[Outcome], None],
        enough: Callable[[State], bool],
    ) -> tuple[list[tuple[State, Outcome]], Outcome]:
        """States on the branch along the mode that are stable at given conjugate.

        The amplitude grows along the branch, however the load does, from the first such state on
        until the body has left the crossing so far that the load or its conjugate tell states of
        the two sides of the mode apart: near it, both go with the square of the amplitude.

        Args:
            scalar: the load that is found.
            crossing: where the branches cross.
            count: is told of every solve.
            enough: whether to go no further than a state.

        Returns:
            The states and how each was found, none where there are none; and how the last solve
            ended. The scene may be at another state.
        """
        points = [self._start_point(crossing)]
        unit = self._unit(crossing.mode)
        reach = 1.0
        found: list[tuple[State, Outcome]] = []
        for _ in range(TRIES):
            outcome, new = self._beside(scalar, crossing, points, reach, unit)
            count(outcome)
            if new is None:
                reach = points[-1].amplitude + CUT * (reach - points[-1].amplitude)
                if found or reach < LEAST:
                    break
                continue
            if excess(new, scalar) <= 0:
                found.append((new, outcome))
                if reach > FAR or enough(new):
                    break
            elif found:
                break
            points.append(_Point(reach, new.w, new.scalars))
            reach *= FACTOR
        return found, outcome

    def onward(
        self,
        scalar: str,
        states: list[State],
        count: Callable[[Outcome], None],
        beyond: Callable[[State], bool],
    ) -> list[tuple[State, Outcome]]:
        """States along the tangent of the path, where that bends too sharply for its conjugate.

        Where an imperfection rounds a crossing, path and branch run side by side, and a solve at
        a given conjugate may fall on either. The way along the tangent (arc length, Riks 1979)
        tells them apart: its steps grow from that between the last two states.

        Args:
            scalar: the load that is found.
            states: the last states of the path.
            count: is told of every solve.
            beyond: whether a state lies beyond the bend.

        Returns:
            The states, stable at given conjugate, and how each was found; none where the path does
            not lead beyond. The scene may be at another state.
        """
        before, last = states[-2:]
        seed = self._equilibrium.perturbed(last, scalar)
        way, chord = seed.w - last.w, last.w - before.w
        sign = float(np.sign(self._dot(way, chord)))
        turned = {name: sign * (q - last.scalars[name]) for name, q in seed.scalars.items()}
        tangent = Mode(0.0, sign * way, turned)
        start = Crossing(last, last, 0.0, tangent, chosen=False, seen=True, wrinkle=False)
        unit, points = self._unit(tangent), [self._start_point(start)]
        first = abs(self._dot(chord, way)) / (self._dot(way, way) * unit)
        step, found = first, list[tuple[State, Outcome]]()
        for _ in range(TRIES):
            reach = points[-1].amplitude + step
            outcome, new = self._beside(scalar, start, points, reach, unit)
            count(outcome)
            if new is None:
                step *= CUT
                if step < LEAST * first:
                    break
                continue
            if excess(new, scalar) > max(0, excess(last, scalar)):
                break
            found.append((new, outcome))
            if beyond(new):
                return found
            points.append(_Point(reach, new.w, new.scalars))
            step *= FACTOR
        return []

    def _unit(self, mode: Mode) -> float:
        """Amplitude of a mode whose greatest displacement is `FIRST` of the least extent."""
        mine = float(np.max(np.abs(mode.w[self._equilibrium.displacements]), initial=0.0))
        return FIRST * self._extent / max(self._equilibrium.scene.domain.comm.allgather(mine))

    def _start_point(self, crossing: Crossing) -> _Point:
        stable, unstable = crossing.stable, crossing.unstable
        scalars = {
            name: float(crossing.between(value, unstable.scalars[name]))
            for name, value in stable.scalars.items()
        }
        return _Point(0.0, crossing.between(stable.w, unstable.w), scalars)

    def _beside(
        self, scalar: str, crossing: Crossing, points: list[_Point], reach: float, unit: float
    ) -> tuple[Outcome, State | None]:
        """The state on the other branch with an amplitude of the mode, its stability assessed.

        Args:
            scalar: the load that is found.
            crossing: where the branches cross.
            points: that crossing, and the states found on the branch so far.
            reach: amplitude in units.
            unit: mm.
        """
        equilibrium, mode = self._equilibrium, crossing.mode
        scene, last, first = equilibrium.scene, points[-1], points[0]
        if len(points) == 1:
            moved = last.w + reach * unit * mode.w
            turned = {
                name: value + reach * unit * mode.scalars.get(name, 0.0)
                for name, value in last.scalars.items()
            }
        else:
            known = points[-3:]
            ahead = lagrange(np.array([point.amplitude for point in known]), reach)
            moved = np.tensordot(ahead, [point.w for point in known], axes=1)
            turned = {
                name: extrapolated(ahead, np.array([point.scalars[name] for point in known]))
                for name in last.scalars
            }
        for name, value in turned.items():
            scene.set_scalar(name, value)
        scene.set(moved)
        weights = np.array([1 - crossing.share, crossing.share])
        scene.extrapolate([crossing.stable.discrete, crossing.unstable.discrete], weights)
        amplitude = _Amplitude(equilibrium, mode.w, first.w, unit)
        outcome = equilibrium.newton.solve(
            scene.w.copy(),
            [*scene.natural, scalar],
            [*equilibrium.natural_conditions(), GivenFunctional(amplitude, reach)],
        )
        if not outcome.converged:
            return outcome, None
        new = equilibrium.capture()
        equilibrium.assess_stability(new, crossing.stable, scalar, exactly=True)
        return outcome, new
