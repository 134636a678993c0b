"""The equations of one step of a moving rod: residual, tangent, and where its energy goes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rod.functions import Floats
from rod.motion.air import Swelling
from rod.motion.moving import Energy, Moving, Work
from rod.shape import Shape

if TYPE_CHECKING:
    from rod.motion.motion import Motion

_ROUND_OFF = 1e-14
_NUDGE = 1e-4
"""Part of the chamber's volume by which the slope of the pressure is taken: it speeds up Newton's
method and leaves no trace in what is found."""


class Equations:
    """Residual and tangent of a step by the change of strains; see `rod.motion.motion`.

    Args:
        motion: rod, damping and air.
        before: the state before.
        step: Δt, s.
    """

    def __init__(self, motion: Motion, before: Moving, step: float) -> None:
        self._motion, self._rod, self._before, self._step = motion, motion.rod, before, step
        self._level = motion.level(before.time + step / 2)
        acting = self._rod.acting(self._level)
        dead = motion.dead
        self._kept = [p for p in acting if p[0].conservative and id(p[0]) not in dead]
        self._dead = sum(
            (amount * dead[id(term)] for term, amount in acting if id(term) in dead),
            start=np.zeros_like(before.velocity),
        )
        self._others = [pair for pair in acting if not pair[0].conservative]
        self._lengths = self._rod.layout.lengths[:, None]
        # A = weight ΔX P + start
        self._weight = 2 / step**2 + motion.drag / step
        self._start = -2 / step * before.velocity @ motion.inertia - self._dead
        self.pressure = self._level.pressure
        """In the step, MPa."""
        if motion.air is None:
            self._end = motion.level(before.time + step).pressure
        else:
            self.pressure = self._end = before.pressure
            first = before.strains, before.pressure
            self._volume = self._rod.volume(*first)
            lengths = self._rod.layout.lengths
            self._compliance = float(lengths @ self._rod.law.chamber_slope(*first))
        self._terms = self._potential(before.shape)
        self._elastic = (
            before.energy.elastic - self.pressure * before.energy.volume
            if self.pressure == before.pressure
            else self._rod.elastic(before.strains, self.pressure)
        )

    def _potential(self, shape: Shape) -> float:
        """Of the terms that have one, N mm."""
        return float(sum(term.potential(shape, amount) for term, amount in self._kept))

    def _viscous(self, change: Floats) -> Floats:
        """C Δε/Δt, (n, m)."""
        out: Floats = np.einsum("nij,nj->ni", self._motion.viscous, change) / self._step
        return out

    # --- the pressure ----------------------------------------------------------------------------

    def _breathe(self, shape: Shape) -> None:
        """Pressure by what the chamber swells and by what the valves let through."""
        self._growth = (
            self._rod.volume(shape.strains, self._end)
            - self._volume
            - self._compliance * (self._end - self._before.pressure)
        )
        self._end, self.pressure = self._passed(self._growth)
        self._elastic = self._rod.elastic(self._before.strains, self.pressure)

    def _passed(self, growth: float) -> tuple[float, float]:
        swelling = Swelling(self._volume, growth, self._compliance)
        before, air = self._before, self._motion.air
        assert air is not None
        return air.passed(before.time, self._step, before.pressure, swelling)

    def _stiffer(self) -> Floats:
        """What air that is compressed adds to the tangent, (n m, n m)."""
        nudge = _NUDGE * self._volume
        slope = (self._passed(self._growth + nudge)[1] - self.pressure) / nudge
        law = self._rod.law
        pushed = self._lengths * law.chamber_gradient(self._middle.strains, self.pressure)
        swelled = self._lengths * law.chamber_gradient(self._after.strains, self._end)
        return np.outer(pushed.ravel(), -slope * swelled.ravel())

    # --- the equations ---------------------------------------------------------------------------

    def residual(self, change: Floats) -> Floats:
        """∇̄G + C Δε/Δt less the virtual work of loads without a potential, (n, m)."""
        rod, motion = self._rod, self._motion
        strains = self._before.strains
        self._change = change
        self._middle = rod.shape(strains + change / 2)
        self._after = rod.shape(strains + change)
        if motion.air is not None:
            self._breathe(self._after)
        moved = self._after.frames - self._before.frames
        self._pushed = self._weight * moved @ motion.inertia
        self._loads = self._pushed + self._start
        law = rod.law.gradient(self._middle.strains, self.pressure)
        self._forces = self._lengths * law + self._middle.pulled(self._loads)
        for term, amount in self._kept:
            self._forces += term.residual(self._middle, amount)
        parts = (
            rod.elastic(self._after.strains, self.pressure),
            -self._elastic,
            self._potential(self._after),
            -self._terms,
            float(np.vdot(self._loads, moved)),
            -float(np.vdot(self._forces, change)),
        )
        gap = sum(parts)
        # of a rod that hardly moves it is round-off, over a square that is next to nothing
        known = abs(gap) > _ROUND_OFF * sum(map(abs, parts))
        self._weighed = motion.weights * change
        square = float(np.vdot(self._weighed, change))
        # what the gradient in the middle misses of the difference, and the square it is spread by
        self._missed, self._square = (gap / square, square) if known else (0.0, np.inf)
        out = self._forces + self._missed * self._weighed
        if motion.viscid:
            out = out + self._viscous(change)
        for term, amount in self._others:
            out = out + term.residual(self._middle, amount)
        return out

    def tangent(self) -> Floats:
        """The derivative of the last residual by the change of strains, (n m, n m)."""
        rod, motion = self._rod, self._motion
        middle, after = self._middle, self._after
        out: Floats = rod.stiffness(middle.strains, self.pressure) + middle.curved(self._loads)
        for term, amount in self._kept:
            out += term.tangent(middle, amount)
        out = out / 2 + self._weight * middle.mass(motion.inertia, after)
        ahead = self._lengths * rod.law.gradient(after.strains, self.pressure)
        for term, amount in self._kept:
            ahead = ahead + term.residual(after, amount)
        ahead = ahead + after.pulled(self._loads + self._pushed) - self._forces
        w = self._weighed.ravel()
        row = (ahead.ravel() - self._change.ravel() @ out) / self._square
        out += np.outer(w, row - 2 * self._missed / self._square * w)
        out[np.diag_indices_from(out)] += self._missed * motion.weights.ravel()
        if motion.viscid:
            n, m = self._change.shape
            place = np.arange(n)
            out.reshape(n, m, n, m)[place, :, place] += motion.viscous / self._step
        if motion.air is not None:
            out += self._stiffer()
        for term, amount in self._others:
            out += term.tangent(middle, amount) / 2
        return out

    def _free(self, energy: Energy, shape: Shape) -> float:
        """∫ Φ ds after the step, under the pressure in it."""
        if self._end == self.pressure:
            return energy.elastic - self._end * energy.volume
        return self._rod.elastic(shape.strains, self.pressure)

    # --- what it leads to ------------------------------------------------------------------------

    def moved(self, change: Floats, iterations: int) -> Moving:
        """The state after the step, with the change of strains that solves its equations."""
        before, motion, rod, step = self._before, self._motion, self._rod, self._step
        time = before.time + step
        shape = rod.shape(before.strains + change)
        if motion.air is not None:
            self._breathe(shape)
        moved = shape.frames - before.frames
        velocity = 2 / step * moved - before.velocity
        kinetic = motion.kinetic(velocity)
        dropped = 0.0
        if motion.damped:
            velocity = shape.moved(motion.rates_of(shape, velocity))
            kinetic, dropped = motion.kinetic(velocity), kinetic - motion.kinetic(velocity)
        amounts = motion.level(time).amounts
        stored, volume = motion.stored(shape.strains, self._end)
        energy = Energy(kinetic, stored, motion.held(shape, amounts), volume)
        # along held, moving and held strains the air does ∫ P dV = Δ(Φ + P V) − ΔΦ(P in the step)
        changed = self._free(energy, shape) - self._elastic
        loads = -sum(
            float(np.vdot(term.residual(self._middle, amount), change))
            for term, amount in self._others
        )
        held = self._potential(shape) - self._terms - float(np.vdot(self._dead, moved))
        loads += energy.potential - before.energy.potential - held
        work = Work(
            air=energy.elastic - before.energy.elastic - changed,
            loads=loads,
            viscous=float(np.vdot(self._viscous(change), change)) if motion.viscid else 0.0,
            drag=motion.drag / step * float(np.vdot(moved @ motion.inertia, moved)),
            dropped=dropped,
        )
        rate = change / step
        ahead = 2 * rate - before.rate
        passed = before.work.plus(work)
        return Moving(time, shape, velocity, rate, ahead, self._end, energy, passed, iterations)
