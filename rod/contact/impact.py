"""Contact of a rod with a rigid obstacle during one step of a motion.

A point whose depth goes from d₀ to d₁ is pushed by k a s along ñ, with

    s = (d₁₊² − d₀₊²)/(2 (d₁ − d₀)),      ñ·(x₁ − x₀) = −(d₁ − d₀):

the discrete gradients of ½ k a d₊² and of the distance (Gonzalez 1996, doi 10.1007/BF02440162; for
contact Armero and Petőcz 1998, Comput. Methods Appl. Mech. Eng. 158, 269–300; Doyen, Ern and
Piperno 2011, doi 10.1137/100791440, compare such schemes). The force is one of the whole step, and
its work k a s (d₁ − d₀) is what the potential changes by, to round-off: what is undamped keeps its
energy, however a step begins and ends.

Within Newton's method the mean pressures are unknowns beside the strains, as those of
`rod.contact.penalty.Pressed`: a point that a step presses is held, wherever the turns of the rod
have taken it, and the slope of s is taken at its pressure and not at its depth.

What touches may yield as Kelvin and Voigt have it, k (d + τ ḋ) without a pull. A stiff contact is
damped within a small part of a step. The midpoint rule would then turn the velocity of its points
round in every step, and the rod would leave what it rests on. Half of the viscosity therefore acts
in the step, and half on the velocities at its end, by the implicit Euler method: they come to rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rod.contact.points import placed
from rod.functions import Floats
from rod.shape import Shape
from rod.term import Push

if TYPE_CHECKING:
    from rod.contact.touch import Touch

_ROUND_OFF = 1e-12
"""Part of a place that a distance is known to."""
_SOON = 0.05
"""Part of a step within which after the first touch others are held to touch too."""


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
        active: something is pressed.
        known: by forces that a step of Newton's method has found.
    """

    def __init__(self, touch: Touch, before: Shape, amount: float, delay: float) -> None:
        self._touch, self._before, self._amount, self._delay = touch, before, amount, delay
        self._stiffness = touch.share(amount) * touch.stiffness
        self._close = touch.close(before, amount)
        self._shape = before.layout.shape
        self._pressed: Floats = np.zeros(len(touch.skin.station))
        self._chords = self._pressed
        self.active = False
        self._none()

    def _none(self) -> None:
        self.work = self.stored = 0.0
        self.push = Push(np.zeros(3), np.zeros(3))
        self.active, self.known = False, True

    def begin(self, after: Shape) -> float:
        """Takes note of where the step would end if nothing was touched.

        Newton's method begins where the first point touches, and holds all that would be deep: one
        that began there would find forces of thousands of times those that are sought.

        Args:
            after: the rod there.

        Returns:
            The part of the way until something touches.
        """
        touch, amount = self._touch, self._amount
        near = self._close | touch.close(after, amount)
        if touch.keeps or not near.any():
            return 1.0
        stations = np.flatnonzero(near)
        first, last = (placed(touch.skin, shape, stations) for shape in (self._before, after))
        d0, d1 = touch.depth(first, amount), touch.depth(last, amount)
        deep, way = d1 > 0, np.where(d1 > d0, d1 - d0, 1.0)
        parts = np.where(deep, np.maximum(-d0, 0.0) / way, np.inf)
        free = float(np.min(parts[deep & (d0 <= 0)], initial=1.0))
        held = parts <= free + _SOON
        self._chords = np.zeros_like(self._pressed)
        self._chords[first.which[held]] = pressed(d0, d1, self._delay)[0][held] / d1[held]
        return free

    def residual(self, middle: Shape, after: Shape) -> Floats:
        """Less the virtual work of the forces, (n, m).

        Args:
            middle: the rod at the mean strains of the step.
            after: at its end.
        """
        touch, amount, delay = self._touch, self._amount, self._delay
        near = self._close | touch.close(after, amount)
        self._none()
        if not near.any():
            return np.zeros(self._shape)
        stations = np.flatnonzero(near)
        first, last = (placed(touch.skin, shape, stations) for shape in (self._before, after))
        d0, d1 = touch.depth(first, amount), touch.depth(last, amount)
        stiff = self._stiffness * first.areas
        if touch.keeps:
            in0, in1 = d0, d1
            press, slope = (d0 + d1) / 2 + delay * (d1 - d0), np.full(len(d0), 0.5 + delay)
            acts, known = np.full(len(d0), True), press
        else:
            in0, in1 = np.maximum(d0, 0.0), np.maximum(d1, 0.0)
            known = self._pressed[first.which]
            start = np.where(known > 0, known, pressed(d0, d1, delay)[0])
            foreseen = depth_of(d0, start, delay)
            slope = pressed(d0, foreseen, delay)[1]
            press = start + slope * (d1 - foreseen)
            held = self._chords[first.which]
            begins = (held > 0) & (known <= 0)
            slope, press = np.where(begins, held, slope), np.where(begins, held * d1, press)
            acts = (start > 0) | begins
        self.stored = float(stiff @ (in1**2 - in0**2)) / 2
        if not acts.any():
            return np.zeros(self._shape)
        self.active = True
        x0, self._last = first.x[acts], last.only(acts)
        stiff, self._deeper = stiff[acts], (d1 - d0)[acts]
        self._force_of, self._share = stiff, press[acts]
        self._press, self._slope = stiff * press[acts], stiff * slope[acts]
        self._known = stiff * known[acts]
        self.known = bool(np.all(known[acts] > 0)) or touch.keeps
        self._held = stiff * (in1[acts] != 0)
        x1 = self._last.x
        half = touch.distance((x0 + x1) / 2, amount)
        self._end = touch.distance(x1, amount)
        way = x1 - x0
        square = np.sum(way * way, axis=1)
        missed = -self._deeper - np.sum(half.normal * way, axis=1)
        # of points that hardly move it is round-off, over a square that is next to nothing
        seen = np.abs(missed) > _ROUND_OFF * float(np.abs(x1).max())
        part = np.divide(missed, square, out=np.zeros_like(square), where=seen & (square > 0))
        self._normal, self._bend = half.normal + part[:, None] * way, half.bend
        self._force = self._press[:, None] * self._normal
        self.work = float(self._press @ self._deeper)
        self.push = Push(self._force.sum(axis=0), np.cross((x0 + x1) / 2, self._force).sum(axis=0))
        self._middle = placed(touch.skin, middle, stations).only(acts)
        return -self._middle.pulled(self._force)

    def leapt(self, after: Shape) -> bool:
        """Whether the rod may have passed through the obstacle in the step."""
        return self._touch.leapt(self._before, after, self._amount)

    def stepped(self, change: Floats) -> bool:
        """Takes note of a step by Newton's method from the last residual.

        Args:
            change: of the strains at the end of the step in time, (n, m).

        Returns:
            Whether the same points are pressed as before.
        """
        if self._touch.keeps:
            return True
        before = self._pressed > 0
        self._pressed, self._chords = np.zeros_like(self._pressed), np.zeros_like(self._chords)
        if self.active:
            last = self._last
            deeper = -np.sum(self._end.normal * last.moved(change), axis=1)
            found = self._share + self._slope / self._force_of * deeper
            self._pressed[last.which] = np.maximum(found, 0.0)
        return bool(np.array_equal(before, self._pressed > 0))

    def tangent(self) -> Floats:
        """Derivative of the last residual by the strains at the end, (n m, n m)."""
        if not self.active:
            count = self._shape[0] * self._shape[1]
            return np.zeros((count, count))
        spring = self._slope[:, None, None] * _dyads(self._normal, self._end.normal)
        # what turns is pushed as far as is known: depths that are foreseen may be far too great
        spring -= self._known[:, None, None] / 2 * self._bend
        out: Floats = self._middle.coupled(spring, self._last)
        return out - self._middle.bent(self._known[:, None] * self._normal) / 2

    def ahead(self) -> Floats:
        """Derivative of the work by the strains at the end, (n, m)."""
        if not self.active:
            return np.zeros(self._shape)
        size = self._press + self._slope * self._deeper
        return self._last.pulled(-size[:, None] * self._end.normal)

    def resisting(self, shape: Shape, step: float) -> Floats | float:
        """What acts on velocities at the end of the last residual's step, (n m, n m); t mm² etc.

        Args:
            shape: the rod there.
            step: Δt, s.
        """
        if not (self.active and self._delay):
            return 0.0
        size = self._delay * step**2 * self._held
        spring = size[:, None, None] * _dyads(self._end.normal, self._end.normal)
        out: Floats = self._last.coupled(spring, self._last)
        return out


def pressed(d0: Floats, d1: Floats, delay: float) -> tuple[Floats, Floats]:
    """Mean pressure over k of points in a step, by their depths when it begins and ends.

    Args:
        d0: when it begins, (q,), mm; negative apart.
        d1: when it ends.
        delay: τ/(2 Δt).

    Returns:
        It, (q,), mm, zero where nothing would be pulled, and its slope by d₁ where it is not.
    """
    in0, in1 = np.maximum(d0, 0.0), np.maximum(d1, 0.0)
    way = np.abs(d1 - d0)
    crosses = (d0 > 0) != (d1 > 0)
    # of the way that is within the obstacle
    part = np.divide(in0 + in1, way, out=np.ones_like(way), where=crosses & (way > 0))
    mean = part * (in0 + in1) / 2 + delay * (in1 - in0)
    slope = np.where(d1 > 0, part - part**2 / 2 + delay, np.where(d0 > 0, part**2 / 2, 0.0))
    return np.maximum(mean, 0.0), slope


def depth_of(d0: Floats, press: Floats, delay: float) -> Floats:
    """d₁ by the mean pressure over k, where that is above zero: `pressed` turned round."""
    a = 0.5 + delay
    apart = np.maximum(-d0, 0.0)
    rest = press - delay * apart
    enters = (rest + np.sqrt(rest**2 + 4 * a * press * apart)) / (2 * a)
    stays = (press - (0.5 - delay) * d0) / a
    pull = press + delay * d0
    leaves = d0 - np.divide(d0**2, 2 * pull, out=np.zeros_like(d0), where=pull > 0)
    return np.where(d0 <= 0, enters, np.where(stays >= 0, stays, leaves))


def _dyads(a: Floats, b: Floats) -> Floats:
    out: Floats = a[:, :, None] * b[:, None, :]
    return out
