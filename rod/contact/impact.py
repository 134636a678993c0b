"""Contact of a rod with a rigid obstacle during one step of a motion.

A point whose depth goes from d₀ to d₁ is pushed by k a s along ñ, with

    s = (d₁₊² − d₀₊²)/(2 (d₁ − d₀)),      ñ·(x₁ − x₀) = −(d₁ − d₀):

the discrete gradients of ½ k a d₊² and of the distance (Gonzalez 1996, doi 10.1007/BF02440162; for
contact Armero and Petőcz 1998, doi 10.1016/S0045-7825(97)00256-9). The force is one of the step, and
its work k a s (d₁ − d₀) is what the potential changes by, to round-off: what is undamped keeps its
energy, however a step begins and ends.

What touches may yield as Kelvin and Voigt have it, k (d + τ ḋ) without a pull. A stiff contact is
damped within a small part of a step. The midpoint rule would then turn the velocity of its points
round in every step, and the rod would leave what it rests on. Half of the viscosity therefore acts
in the step, and half on the velocities at its end, by the implicit Euler method: they come to rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rod.contact.points import Points, placed
from rod.functions import Floats
from rod.shape import Shape
from rod.term import Push

if TYPE_CHECKING:
    from rod.contact.touch import Touch


class Impact:
    """What an obstacle does to a rod in one step; a `rod.term.Impact`.

    Args:
        touch: obstacle and surface.
        before: the rod when the step begins.
        amount: of the term, all the step long.
        delay: τ/(2 Δt).

    Attributes:
        work: that the forces have taken from the rod, N mm.
        stored: what of it is in the potential; the rest is lost.
        push: mean force on the rod in the step.
    """

    def __init__(self, touch: Touch, before: Shape, amount: float, delay: float) -> None:
        self._touch, self._before, self._amount, self._delay = touch, before, amount, delay
        self._stiffness = touch.share(amount) * touch.stiffness
        self._close = touch.close(before, amount)
        self._shape = before.layout.shape
        self._none()

    def _none(self) -> None:
        self.work = self.stored = 0.0
        self.push = Push(np.zeros(3), np.zeros(3))
        self._active = False

    def residual(self, middle: Shape, after: Shape) -> Floats:
        """Less the virtual work of the forces, (n, m).

        Args:
            middle: the rod at the mean strains of the step.
            after: at its end.
        """
        touch, amount = self._touch, self._amount
        near = self._close | touch.close(after, amount)
        self._none()
        if not near.any():
            return np.zeros(self._shape)
        stations = np.flatnonzero(near)
        first, last = (placed(touch.skin, shape, stations) for shape in (self._before, after))
        d0, d1 = touch.depth(first, amount), touch.depth(last, amount)
        if touch.keeps:
            in0, in1, mean, slope = d0, d1, (d0 + d1) / 2, np.full(len(d0), 0.5)
            slope = slope + self._delay
        else:
            in0, in1 = np.maximum(d0, 0.0), np.maximum(d1, 0.0)
            mean, slope = _secant(d0, d1)
            slope = slope + self._delay * (d1 > 0)
        press = mean + self._delay * (in1 - in0)
        stiff = self._stiffness * first.areas
        self.stored = float(stiff @ (in1**2 - in0**2)) / 2
        acts = np.full(len(press), True) if touch.keeps else press > 0
        if not acts.any():
            return np.zeros(self._shape)
        self._active = True
        x0, self._last = first.x[acts], last.only(acts)
        stiff, self._deeper = stiff[acts], (d1 - d0)[acts]
        self._press, self._slope = stiff * press[acts], stiff * slope[acts]
        self._held = stiff * (in1[acts] != 0)
        x1 = self._last.x
        half = touch.distance((x0 + x1) / 2, amount)
        self._end = touch.distance(x1, amount)
        way = x1 - x0
        square = np.sum(way * way, axis=1)
        missed = -self._deeper - np.sum(half.normal * way, axis=1)
        # of points that do not move nothing is missed
        part = np.divide(missed, square, out=np.zeros_like(square), where=square > 0)
        self._normal, self._bend = half.normal + part[:, None] * way, half.bend
        self._force = self._press[:, None] * self._normal
        self.work = float(self._press @ self._deeper)
        self.push = Push(self._force.sum(axis=0), np.cross((x0 + x1) / 2, self._force).sum(axis=0))
        self._middle = placed(touch.skin, middle, stations).only(acts)
        return -self._middle.pulled(self._force)

    def tangent(self) -> Floats:
        """Derivative of the last residual by the strains at the end, (n m, n m)."""
        if not self._active:
            count = self._shape[0] * self._shape[1]
            return np.zeros((count, count))
        spring = self._slope[:, None, None] * _dyads(self._normal, self._end.normal)
        spring -= self._press[:, None, None] / 2 * self._bend
        out: Floats = self._middle.coupled(spring, self._last)
        return out - self._middle.bent(self._force) / 2

    def ahead(self) -> Floats:
        """Derivative of the work by the strains at the end, (n, m)."""
        if not self._active:
            return np.zeros(self._shape)
        size = self._press + self._slope * self._deeper
        return self._last.pulled(-size[:, None] * self._end.normal)

    def resisting(self, shape: Shape, step: float) -> Floats | float:
        """What acts on velocities at the end of the last residual's step, (n m, n m); t mm² etc.

        Args:
            shape: the rod there.
            step: Δt, s.
        """
        if not (self._active and self._delay):
            return 0.0
        size = self._delay * step**2 * self._held
        spring = size[:, None, None] * _dyads(self._end.normal, self._end.normal)
        out: Floats = self._last.coupled(spring, self._last)
        return out


def _secant(d0: Floats, d1: Floats) -> tuple[Floats, Floats]:
    """(d₁₊² − d₀₊²)/(2 (d₁ − d₀)) and its derivative by d₁."""
    in0, in1 = np.maximum(d0, 0.0), np.maximum(d1, 0.0)
    way = d1 - d0
    crosses = (d0 > 0) != (d1 > 0)
    part = np.divide(in0 + in1, np.abs(way), out=np.ones_like(way), where=crosses)
    # in1/way where it enters, in0/way where it leaves; half of both depths where it stays in
    mean = np.where(crosses, part * (in0 + in1) / 2, (in0 + in1) / 2)
    enters = part - part**2 / 2
    leaves = part**2 / 2
    stays = np.where(d1 > 0, 0.5, 0.0)
    return mean, np.where(crosses, np.where(d1 > 0, enters, leaves), stays)


def _dyads(a: Floats, b: Floats) -> Floats:
    out: Floats = a[:, :, None] * b[:, None, :]
    return out
