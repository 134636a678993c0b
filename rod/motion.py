"""Motion of a rod by a scheme that keeps its energy.

With the frames X = [R | r] of all sections the kinetic energy ½ Σ tr(V P Vᵀ), V = Ẋ, has constant
masses P. Velocities of the frames are unknowns beside the strains ε, which place the frames. A step
from ε₀, V₀ to ε₁, V₁ is the midpoint rule

    X₁ − X₀ = Δt (V₀ + V₁)/2,      ∇̄G(ε₀, ε₁) + C Δε/Δt = 0,
    G(ε) = ∫ Φ(ε) ds + Π(ε) + Σ A : X(ε),     A = (V₁ − V₀) P/Δt,

with the potential Π of all terms that have one and the discrete gradient
∇̄G = ∇G(ε̄) + [G₁ − G₀ − ∇G(ε̄)·Δε] W Δε/(Δε·W Δε) at the mean strains ε̄ (Gonzalez 1996,
doi 10.1007/BF02440162). As ∇̄G·Δε = G₁ − G₀, what is undamped keeps ½ Σ tr(V P Vᵀ) + ∫ Φ ds + Π to
the last digits of Newton's method, whatever the terms are. Terms without a potential do their
virtual work at ε̄. It is the method of Betsch 2005 (doi 10.1016/j.cma.2005.01.004) with strains as
the reduced unknowns; of second order, and stable at any Δt. ΔX is exact: no rotation drifts.

Damping: `viscosity` is Kelvin's and Voigt's, forces and moments η ε̇ of the sections (N s of
stretch, N mm² s of curvatures); `drag` is Rayleigh's part of the mass, 1/s. Both take energy out in
every step, never in.

Velocities of frames that are no rates of strains, of the order Δt², change their sign from step to
step. Undamped they are kept, as energy is in them; where anything is damped they are dropped after
every step, which takes energy of the order Δt⁴ too, so that a rod comes to rest. As by every
midpoint rule, a motion that damping would end within a small part of Δt changes the sign of its
velocity from step to step instead; the strains hardly see it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator

import numpy as np
from scipy.linalg import solve
from scipy.linalg.lapack import dgetrf, dgetrs

from rod.functions import Floats
from rod.rod import Level, Rod
from rod.shape import Shape
from rod.statics import NoEquilibriumError, size

_CLOSE = 1e-11
_LOOSE = 1e-7
_MOST = 30
_FAR = 1e3
_SHORTEST = 2.0**-6
_ROUND_OFF = 1e-14
_SLOW = 0.05
"""An old factor that reduces a correction by less is made anew."""


@dataclasses.dataclass(frozen=True)
class Moving:
    """A rod in motion.

    Attributes:
        time: t, s.
        strains: ε, (n, m).
        frames: X, (n + 1, 3, 4); 1 and mm.
        velocity: V, (n + 1, 3, 4); 1/s and mm/s.
        step: Δε of the last step, (n, m).
    """

    time: float
    strains: Floats
    frames: Floats
    velocity: Floats
    step: Floats


class Motion:
    """Steps in time of a rod.

    Args:
        rod: with its inertia.
        level: what acts at a time in s.
        viscosity: η of each free strain, (n, m) or (m,); N s and N mm² s.
        drag: of the mass, 1/s.

    Attributes:
        rod: as given.
        viscosity: as given, (n, m).
        drag: as given.
        inertia: of the rod.
        sizes: changes of strains that count as one, (n, m).
        weights: W of the discrete gradient, (n, m).

    Raises:
        ValueError: no inertia, or damping below zero.
    """

    def __init__(
        self,
        rod: Rod,
        level: Callable[[float], Level],
        viscosity: Floats | float = 0.0,
        drag: float = 0.0,
    ) -> None:
        if not rod.inertia.any():
            raise ValueError("a rod without inertia does not move by itself")
        self.viscosity = np.broadcast_to(np.asarray(viscosity, dtype=float), rod.layout.shape)
        if np.any(self.viscosity < 0) or drag < 0:
            raise ValueError("damping: zero or more expected")
        self.rod, self._level, self.drag = rod, level, drag
        self._damped = bool(drag) or bool(np.any(self.viscosity))
        self.inertia = rod.inertia
        self.sizes = size(rod)
        # any positive weights: by those of lengths and of sizes a stretch and an angle count alike
        self.weights = rod.layout.lengths[:, None] / self.sizes**2

    def at(self, strains: Floats, rates: Floats | None = None, time: float = 0.0) -> Moving:
        """A rod that begins to move.

        Args:
            strains: ε, (n, m).
            rates: ε̇, (n, m), 1/s and 1/(mm s); None: it is at rest.
            time: t, s.
        """
        shape = self.rod.shape(strains)
        still = np.zeros_like(strains)
        velocity = shape.moved(still if rates is None else rates)
        return Moving(time, strains, shape.frames, velocity, still)

    def rates(self, moving: Moving) -> Floats:
        """ε̇ with the momentum of the frames' velocity, (n, m), 1/s and 1/(mm s)."""
        return self._rates(self.rod.shape(moving.strains), moving.velocity)

    def _rates(self, shape: Shape, velocity: Floats) -> Floats:
        momentum = shape.pulled(velocity @ self.inertia).ravel()
        rates: Floats = solve(shape.mass(self.inertia), momentum, assume_a="pos")
        return rates.reshape(shape.strains.shape)

    def energy(self, moving: Moving) -> float:
        """Of motion, sections and all terms that have a potential, N mm."""
        kinetic = float(np.sum(moving.velocity @ self.inertia * moving.velocity)) / 2
        shape, level = self.rod.shape(moving.strains), self._level(moving.time)
        return kinetic + self.rod.potential(shape, level)

    def run(self, moving: Moving, step: float, count: int) -> Iterator[Moving]:
        """States after each of a number of steps.

        Args:
            moving: the first one.
            step: Δt, s.
            count: number of steps.

        Yields:
            The states.

        Raises:
            NoEquilibriumError: a step does not converge.
        """
        for _ in range(count):
            moving = self.step(moving, step)
            yield moving

    def step(self, moving: Moving, step: float) -> Moving:
        """The state a time Δt later; in steps of half that time where Newton's method fails.

        Args:
            moving: a state.
            step: Δt, s.

        Raises:
            NoEquilibriumError: the shortest step does not converge.
        """
        return self._halved(moving, step, step * _SHORTEST)

    def _halved(self, moving: Moving, step: float, least: float) -> Moving:
        """A step, or two of half of it."""
        try:
            return self._whole(moving, step)
        except NoEquilibriumError:
            if step <= least:
                raise
        begun = dataclasses.replace(moving, step=moving.step / 2)
        middle = self._halved(begun, step / 2, least)
        after = self._halved(middle, step / 2, least)
        return dataclasses.replace(after, step=2 * after.step)

    def _whole(self, moving: Moving, step: float) -> Moving:
        """One step by Newton's method, from a change of strains like the last one's."""
        rod, level = self.rod, self._level(moving.time + step / 2)
        now = _Step(self, moving, step, level)
        change = moving.step
        last, slow = np.inf, True
        for _ in range(_MOST):
            residual = now.residual(change)
            if slow:
                # no exception by a singular one: what it gives is not finite, or too far
                factor = dgetrf(now.tangent())[:2]
            correction = dgetrs(*factor, residual.ravel())[0]
            change = change - correction.reshape(change.shape)
            moves = float(np.max(np.abs(correction.reshape(change.shape) / self.sizes)))
            if not moves < _FAR:
                break
            if moves < _CLOSE or (moves < _LOOSE and moves > last / 2):
                after = rod.shape(moving.strains + change)
                outside = rod.law.outside(after.strains, level.pressure)
                if outside:
                    raise NoEquilibriumError(f"at {moving.time + step:.6g} s: {outside}")
                velocity = 2 / step * (after.frames - moving.frames) - moving.velocity
                if self._damped:
                    velocity = after.moved(self._rates(after, velocity))
                return Moving(moving.time + step, after.strains, after.frames, velocity, change)
            slow = moves > _SLOW * last
            last = moves
        raise NoEquilibriumError(f"the step from {moving.time:.6g} s does not converge")


class _Step:
    """The equations of one step.

    Args:
        motion: rod and damping.
        moving: the state before.
        step: Δt, s.
        level: in the middle of the step.
    """

    def __init__(self, motion: Motion, moving: Moving, step: float, level: Level) -> None:
        self._motion, self._rod, self._before = motion, motion.rod, moving
        self._level = level
        acting = self._rod.acting(level)
        self._kept = [pair for pair in acting if pair[0].conservative]
        self._others = [pair for pair in acting if not pair[0].conservative]
        self._lengths = self._rod.layout.lengths[:, None]
        self._potentials = self._parts(self._rod.shape(moving.strains))
        self._viscous = self._lengths * motion.viscosity / step
        # A = weight ΔX P + start
        self._weight = 2 / step**2 + motion.drag / step
        self._start = -2 / step * moving.velocity @ motion.inertia

    def _parts(self, shape: Shape) -> Floats:
        """Potentials of the sections and of each term, N mm."""
        elastic = self._rod.elastic(shape.strains, self._level.pressure)
        return np.array([elastic, *(term.potential(shape, a) for term, a in self._kept)])

    def residual(self, change: Floats) -> Floats:
        """∇̄G + C Δε/Δt less the virtual work of loads without a potential, (n, m)."""
        rod, motion, pressure = self._rod, self._motion, self._level.pressure
        strains = self._before.strains
        self._change = change
        self._middle = rod.shape(strains + change / 2)
        self._after = rod.shape(strains + change)
        moved = self._after.frames - self._before.frames
        self._pushed = self._weight * moved @ motion.inertia
        self._loads = self._pushed + self._start
        law = rod.law.gradient(self._middle.strains, pressure)
        self._forces = self._lengths * law + self._middle.pulled(self._loads)
        for term, amount in self._kept:
            self._forces += term.residual(self._middle, amount)
        after, before = self._parts(self._after), self._potentials
        done, foreseen = float(np.sum(self._loads * moved)), float(np.sum(self._forces * change))
        gap = float(np.sum(after - before)) + done - foreseen
        # of a rod that hardly moves it is round-off, over a square that is next to nothing
        sizes = float(np.abs([*after, *before, done, foreseen]).sum())
        known = abs(gap) > _ROUND_OFF * sizes
        self._weighed = motion.weights * change
        square = float(np.sum(self._weighed * change))
        out = self._forces + self._viscous * change
        # what the gradient in the middle misses of the difference, and the square it is spread by
        self._missed, self._square = (gap / square, square) if known else (0.0, np.inf)
        out = out + self._missed * self._weighed
        for term, amount in self._others:
            out = out + term.residual(self._middle, amount)
        return out

    def tangent(self) -> Floats:
        """The derivative of the last residual by the change of strains, (n m, n m)."""
        rod, motion, pressure = self._rod, self._motion, self._level.pressure
        middle, after = self._middle, self._after
        out: Floats = rod.stiffness(middle.strains, pressure) + middle.curved(self._loads)
        for term, amount in self._kept:
            out += term.tangent(middle, amount)
        out = out / 2 + self._weight * middle.mass(motion.inertia, after)
        law = self._lengths * rod.law.gradient(after.strains, pressure)
        for term, amount in self._kept:
            law = law + term.residual(after, amount)
        ahead = law + after.pulled(self._loads + self._pushed) - self._forces
        w = self._weighed.ravel()
        row = (ahead.ravel() - self._change.ravel() @ out) / self._square
        out += np.outer(w, row - 2 * self._missed / self._square * w)
        diagonal = self._viscous + self._missed * motion.weights
        out[np.diag_indices_from(out)] += diagonal.ravel()
        for term, amount in self._others:
            out += term.tangent(middle, amount) / 2
        return out
