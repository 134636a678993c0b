"""The equations of one step of a moving rod: residual, tangent, and where its energy goes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rod.functions import Floats
from rod.law import Sections, whole
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
        self._impacts = [
            motion.struck[id(term)].impact(before.shape, amount, motion.touching / (2 * step))
            for term, amount in acting
            if id(term) in motion.struck
        ]
        left = [pair for pair in acting if id(pair[0]) not in motion.struck]
        self._kept = [p for p in left if p[0].conservative and id(p[0]) not in dead]
        self._dead = sum(
            (amount * dead[id(term)] for term, amount in left if id(term) in dead),
            start=np.zeros_like(before.velocity),
        )
        self._others = [pair for pair in left if not pair[0].conservative]
        self._late = 0.0
        if any(push.force.any() for push in before.pushes):
            self._rests()
        self._lengths = self._rod.layout.lengths
        # A = weight ΔX P + start
        self._weight = 2 / step**2 + motion.drag / step
        self._start = -2 / step * before.velocity @ motion.inertia - self._dead
        self.pressure = self._level.pressure
        """In the step, MPa."""
        self._elastic: float | None = None
        if motion.air is None:
            self._end = motion.level(before.time + step).pressure
            if self.pressure == before.pressure:
                self._elastic = before.energy.elastic - self.pressure * before.energy.volume
        else:
            self.pressure = self._end = before.pressure
            first = self._sections(before.pressure, before.strains)
            self._volume = -self._over(first.first[0, :, -1])
            self._compliance = -self._over(first.second[0, :, -1, -1])
        self._terms = self._potential(before.shape)

    def _sections(self, pressure: float, *strains: Floats) -> Sections:
        """The law under one pressure at several strains."""
        return whole(self._rod.law, np.stack(strains), np.full(len(strains), pressure))

    def _over(self, values: Floats) -> float:
        """∫ ds."""
        return float(self._lengths @ values)

    def _potential(self, shape: Shape) -> float:
        """Of the terms that have one, N mm; what is struck has its own difference."""
        return float(sum(term.potential(shape, amount) for term, amount in self._kept))

    def _viscous(self, change: Floats) -> Floats:
        """C Δε/Δt in the step, (n, m)."""
        part = (1 - self._late) / self._step
        return part * (self._motion.viscous @ change[..., None])[..., 0]

    def _resisting(self, shape: Shape) -> Floats | float:
        """What velocities at the end of the step meet beside their masses, (n m, n m)."""
        out = sum(impact.resisting(shape, self._step) for impact in self._impacts)
        if not self._late:
            return out
        n, m = self._rod.layout.shape
        late, place = np.zeros((n, m, n, m)), np.arange(n)
        late[place, :, place] = self._late * self._step * self._motion.viscous
        return out + late.reshape(n * m, n * m)

    # --- the pressure ----------------------------------------------------------------------------

    def _breathe(self, shape: Shape) -> None:
        """Pressure by what the chamber swells and by what the valves let through."""
        swollen = self._sections(self._end, shape.strains)
        self._growth = (
            -self._over(swollen.first[0, :, -1])
            - self._volume
            - self._compliance * (self._end - self._before.pressure)
        )
        # −∂²Φ/∂ε∂P
        self._swelling = -swollen.second[0, :, :-1, -1]
        self._end, self.pressure = self._passed(self._growth)
        self._elastic = None

    def _passed(self, growth: float) -> tuple[float, float]:
        swelling = Swelling(self._volume, growth, self._compliance)
        before, air = self._before, self._motion.air
        assert air is not None
        return air.passed(before.time, self._step, before.pressure, swelling)

    def _stiffer(self) -> Floats:
        """What air that is compressed adds to the tangent, (n m, n m)."""
        nudge = _NUDGE * self._volume
        slope = (self._passed(self._growth + nudge)[1] - self.pressure) / nudge
        lengths = self._lengths[:, None]
        pushed = lengths * -self._law.second[0, :, :-1, -1]
        return np.outer(pushed.ravel(), -slope * (lengths * self._swelling).ravel())

    # --- the equations ---------------------------------------------------------------------------

    def begin(self, change: Floats) -> Floats:
        """Where Newton's method begins, (n, m), by a change of strains that is foreseen."""
        if not self._impacts:
            return change
        after = self._rod.shape(self._before.strains + change)
        free = min(impact.begin(after) for impact in self._impacts)
        if free < 1:
            self._rests()
        return change * free

    def _rests(self) -> None:
        """Moves a part of the viscosity to the velocities at the end of the step.

        Of a rod that rests on something forces would change with velocities that change their sign.
        """
        if self._motion.touching:
            self._late = self._step / (self._step + self._motion.touching)

    @property
    def kinked(self) -> bool:
        """A tangent that is a little older is of no use."""
        return any(impact.active for impact in self._impacts)

    def residual(self, change: Floats) -> Floats:
        """∇̄G + C Δε/Δt less the virtual work of loads without a potential, (n, m)."""
        rod, motion = self._rod, self._motion
        strains = self._before.strains
        self._change = change
        self._middle = rod.shape(strains + change / 2)
        self._after = rod.shape(strains + change)
        if motion.air is not None:
            self._breathe(self._after)
        # what is asked of the law is asked at once
        places = [self._middle.strains, self._after.strains]
        if self._elastic is None:
            places.append(strains)
        self._law = self._sections(self.pressure, *places)
        if self._elastic is None:
            self._elastic = self._over(self._law.value[2])
        moved = self._after.frames - self._before.frames
        self._pushed = self._weight * moved @ motion.inertia
        self._loads = self._pushed + self._start
        law = self._law.first[0, :, :-1]
        self._forces = self._lengths[:, None] * law + self._middle.pulled(self._loads)
        for term, amount in self._kept:
            self._forces += term.residual(self._middle, amount)
        work, self._struck = 0.0, []
        for impact in self._impacts:
            pulled = impact.residual(self._middle, self._after)
            self._forces += pulled
            self._struck.append(pulled)
            # depths that are too great say nothing of what the middle misses
            work += impact.work if impact.known else float(np.vdot(pulled, change))
        parts = (
            self._over(self._law.value[1]),
            -self._elastic,
            self._potential(self._after),
            -self._terms,
            work,
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
        motion, middle, after = self._motion, self._middle, self._after
        n, m = self._change.shape
        place, lengths = np.arange(n), self._lengths[:, None]
        out = middle.curved(self._loads)
        blocks = lengths[..., None] * self._law.second[0, :, :-1, :-1]
        out.reshape(n, m, n, m)[place, :, place] += blocks
        for term, amount in self._kept:
            out += term.tangent(middle, amount)
        out = out / 2 + self._weight * middle.mass(motion.inertia, after)
        ahead = lengths * self._law.first[1, :, :-1]
        for term, amount in self._kept:
            ahead = ahead + term.residual(after, amount)
        ahead = ahead + after.pulled(self._loads + self._pushed) - self._forces
        for impact, pulled in zip(self._impacts, self._struck, strict=True):
            stiff = impact.tangent()
            out += stiff
            if impact.known:
                ahead = ahead + impact.ahead()
            else:
                ahead = ahead + pulled + (self._change.ravel() @ stiff).reshape(pulled.shape)
        w = self._weighed.ravel()
        row = (ahead.ravel() - self._change.ravel() @ out) / self._square
        out += np.outer(w, row - 2 * self._missed / self._square * w)
        out[np.diag_indices_from(out)] += self._missed * motion.weights.ravel()
        if motion.viscid:
            out.reshape(n, m, n, m)[place, :, place] += (
                (1 - self._late) / self._step * motion.viscous
            )
        if motion.air is not None:
            out += self._stiffer()
        for term, amount in self._others:
            out += term.tangent(middle, amount) / 2
        return out

    def stepped(self, change: Floats) -> bool:
        """Takes note of a step by Newton's method, (n, m); whether nothing changes its mind."""
        settled = [impact.stepped(change) for impact in self._impacts]
        return all(settled)

    def leapt(self, shape: Shape) -> bool:
        """Whether the rod may have passed through something on the way to the end of the step."""
        return any(impact.leapt(shape) for impact in self._impacts)

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
        for impact in self._impacts:
            impact.residual(self._middle, shape)
        dropped = 0.0
        if motion.damped:
            rates = motion.rates_of(shape, velocity, self._resisting(shape))
            velocity = shape.moved(rates)
            kinetic, dropped = motion.kinetic(velocity), kinetic - motion.kinetic(velocity)
        pressures = [self._end, self.pressure][: 2 if self._end != self.pressure else 1]
        places = [shape.strains] * len(pressures)
        if self._elastic is None:
            pressures, places = [*pressures, self.pressure], [*places, before.strains]
        found = whole(rod.law, np.stack(places), np.array(pressures))
        # ∫ Φ ds after the step, under the pressure at its end and in it
        last = self._over(found.value[0])
        free = last if self._end == self.pressure else self._over(found.value[1])
        elastic = self._over(found.value[-1]) if self._elastic is None else self._elastic
        volume = -self._over(found.first[0, :, -1])
        amounts = motion.level(time).amounts
        stored = last + self._end * volume
        energy = Energy(kinetic, stored, motion.held(shape, amounts), volume)
        # along held, moving and held strains the air does ∫ P dV = Δ(Φ + P V) − ΔΦ(P in the step)
        changed = free - elastic
        loads = -sum(
            float(np.vdot(term.residual(self._middle, amount), change))
            for term, amount in self._others
        )
        held = self._potential(shape) - self._terms - float(np.vdot(self._dead, moved))
        held += sum(impact.stored for impact in self._impacts)
        loads += energy.potential - before.energy.potential - held
        work = Work(
            air=energy.elastic - before.energy.elastic - changed,
            loads=loads,
            viscous=float(np.vdot(self._viscous(change), change)) if motion.viscid else 0.0,
            drag=motion.drag / step * float(np.vdot(moved @ motion.inertia, moved)),
            dropped=dropped,
            touch=sum(impact.work - impact.stored for impact in self._impacts),
        )
        rate = change / step
        ahead = 2 * rate - before.rate
        passed = before.work.plus(work)
        pushes = tuple(impact.push for impact in self._impacts)
        return Moving(
            time, shape, velocity, rate, ahead, self._end, energy, passed, iterations, pushes
        )
