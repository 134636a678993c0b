"""Loads on the outer face of the tip cap: forces, moments, a mass that hangs there."""

from __future__ import annotations

import functools
import math
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from analytic.path import cross_matrix, section_axes
from fem.effects.effect import Discrete, Effect, Natural
from fem.effects.gravity import Gravity
from fem.effects.sums.functionals import Functionals, Linear, Linked
from fem.kinematics.kinematics import Kinematics

Floats = npt.NDArray[np.float64]
Vector = tuple[float, float, float]

FACE = "tip"
_STEP = 1e-30
_NAMES = "xyz"


class Face:
    """The tip cap's outer face: its centroid, and what has become of its axes x and y.

    Least squares x ≈ c + (X − X̄) a_x + (Y − Ȳ) a_y over its area at rest: c is the mean position.

    Args:
        body: kinematics of a body, half of it or all.
    """

    def __init__(self, body: Kinematics) -> None:
        data = body.domain.data
        area = body.domain.surface_weights(FACE)
        self.body, self.half = body, bool(data.half)
        self.part = 0.5 if self.half else 1.0
        """Part of the load on the whole body that acts on what is modelled."""
        centre = area @ data.nodes / area.sum()
        if self.half:
            centre[0] = 0.0
        levers = (data.nodes - centre)[:, :2]
        gram = (area[:, None] * levers).T @ levers
        if self.half:
            gram[0, 1] = gram[1, 0] = 0.0
        axes = np.linalg.solve(gram, (area[:, None] * levers).T)
        self.centre: Floats = centre
        self.weights: Floats = np.vstack([area / area.sum(), axes])
        self.size = float(np.sqrt(np.trace(gram) / area.sum()))
        """Radius of gyration, mm."""

    @property
    def components(self) -> tuple[int, ...]:
        """Components in which it moves as a whole."""
        return (1, 2) if self.half else (0, 1, 2)

    def moved(self) -> Functionals:
        """Displacement of the centroid, mm, by `components`."""
        parts = [(0, i) for i in self.components]
        return Functionals.of_nodes(self.body, self.weights, parts, np.zeros(len(parts)))

    def upright(self) -> Functionals:
        """y and z of a_y."""
        parts = [(2, 1), (2, 2)]
        return Functionals.of_nodes(self.body, self.weights, parts, np.array([1.0, 0.0]))

    def all(self) -> Functionals:
        """Displacement of the centroid, then a_x where it is free, then a_y, by `components`."""
        sums = [0, 2] if self.half else [0, 1, 2]
        parts = [(number, i) for number in sums for i in self.components]
        rest = [float(number > 0 and i == number - 1) for number, i in parts]
        return Functionals.of_nodes(self.body, self.weights, parts, np.array(rest))


class TipForce(Effect):
    """Π = −q F · ū, ū the mean displacement of the tip cap's outer face: F keeps its direction.

    Spread evenly over the face at rest, F acts at its centroid. The work-conjugate of q is F · ū.

    Args:
        force: F in N, x, y and z.
    """

    scalar = "tip-load"
    units: ClassVar = {scalar: ("", "mJ")}

    def __init__(self, force: Vector) -> None:
        self.force = force

    def discrete(self, body: Kinematics) -> Discrete:
        """The load's potential."""
        face = Face(body)
        load = face.part * np.array([self.force[i] for i in face.components])
        return Linear(body, face.moved(), self.scalar, load)


class TipWeight(TipForce):
    """The weight F of a mass that hangs at the face, scaled as gravity is."""

    scalar = Gravity.scalar
    units: ClassVar = Gravity.units


class TipMoment(Effect):
    """Π = −q M φ, φ the turn of the face's axis y in the plane x = 0: a moment M about x.

    φ is the angle of (a_y·e_y, a_y·e_z), positive from y to z, and goes on beyond a full turn. For
    a body that stays in its plane M turns the face as a whole, whatever it does within.

    Args:
        moment: M in N mm, positive where it bends toward −y.
    """

    scalar = TipForce.scalar
    units: ClassVar = {scalar: ("", "mJ")}

    def __init__(self, moment: float) -> None:
        self.moment = moment

    def discrete(self, body: Kinematics) -> Discrete:
        """The load's potential."""
        face = Face(body)
        return _Turning(face, self.scalar, face.part * self.moment)


class _Turning(Linked):
    """Π = −f·(a − b) − q M ψ + η (ψ − φ(b)): ψ is φ, but goes on where φ begins anew."""

    def __init__(self, face: Face, scalar: str, moment: float) -> None:
        turn, held = "tip turn", "tip turn moment"
        ones, size = np.ones(2), np.full(2, face.body.span)
        more = {
            turn: Natural(0.0, face.body.span, True, False),
            held: Natural(0.0, 1.0, False, True),
        }
        super().__init__(face.body, face.upright(), "tip axis", ones, size, more)
        self._turn, self._held, self._scalar, self._moment = turn, held, scalar, moment
        face.body.scalar(scalar)

    def _angle(self) -> tuple[float, Floats, Floats]:
        """φ, its gradient in b, (2,), and its second derivatives, (2, 2)."""
        y, z = self.own(self.at)
        square = y * y + z * z
        gradient = np.array([-z, y]) / square
        curved = np.array([[2 * y * z, z * z - y * y], [z * z - y * y, -2 * y * z]]) / square**2
        return math.atan2(z, y), gradient, curved

    def value(self) -> float:
        """−q M ψ where the equations hold."""
        return -self.scalar(self._scalar) * self._moment * self.scalar(self._turn)

    def law(self) -> Floats:
        """η ∂φ/∂b."""
        return self.scalar(self._held) * self._angle()[1]

    def law_rate(self, name: str) -> Floats:
        """By b and η."""
        _, gradient, curved = self._angle()
        if name in self.at:
            found: Floats = self.scalar(self._held) * curved[self.at.index(name)]
            return found
        return gradient * (name == self._held)

    def others(self, name: str) -> float:
        """Of ψ q M − η, of η φ − ψ, of q M ψ."""
        if name == self._turn:
            return self.scalar(self._scalar) * self._moment - self.scalar(self._held)
        if name == self._held:
            return math.remainder(self._angle()[0] - self.scalar(self._turn), 2 * math.pi)
        return self._moment * self.scalar(self._turn) if name == self._scalar else 0.0

    def others_rate(self, first: str, second: str) -> float:
        """∂²U of ψ, η, q and b."""
        if first == self._held and second in self.at:
            return -float(self._angle()[1][self.at.index(second)])
        if {first, second} == {self._turn, self._held}:
            return 1.0
        return -self._moment if {first, second} == {self._turn, self._scalar} else 0.0


class FollowingTipLoad(Effect):
    """A force F and a moment M on the tip cap's outer face that have no potential.

    F acts at the centroid c, spread evenly; M by forces f_x and f_y on the images a_x and a_y of
    the face's axes, f_i = μ × a_i with μ such that Σ a_i × f_i = M: the virtual work is
    F·δc + M·δθ, δθ = G⁻¹ Σ a_i × δa_i the mean turn of the two axes, G = Σ |a_i|² I − a_i a_iᵀ.
    Loads that follow are R F and R M, R from the face's axes at rest to those of
    `analytic.path.section_axes`. All of it is scaled by q.

    Args:
        force: F in N.
        moment: M in N mm.
        follows: F and M turn with the face.
    """

    scalar = TipForce.scalar
    shares: ClassVar = (scalar,)

    def __init__(self, force: Vector, moment: Vector, follows: bool) -> None:
        self.force, self.moment, self.follows = force, moment, follows

    def discrete(self, body: Kinematics) -> Discrete:
        """The load's virtual work."""
        return _Following(Face(body), self)


class _Following(Linked):
    """f = q g(b), b the centroid's displacement and the axes."""

    conservative = False

    def __init__(self, face: Face, load: FollowingTipLoad) -> None:
        functionals = face.all()
        shift = len(face.components)
        turned = len(functionals.rest) - shift
        size = face.body.span
        super().__init__(
            face.body,
            functionals,
            "tip",
            np.r_[np.full(shift, size), np.ones(turned)],
            np.r_[np.ones(shift), np.full(turned, size)],
            {},
        )
        self._face, self._load, self._shift = face, load, shift
        face.body.scalar(load.scalar)
        axes = ["y"] if face.half else ["x", "y"]
        names = [f"tip force {_NAMES[i]}" for i in face.components]
        names += [f"tip couple {axis} {_NAMES[i]}" for axis in axes for i in face.components]
        self._pairs = names
        self._working = [any(load.force if j < shift else load.moment) for j in range(len(names))]
        self.pair_units = {
            name: ("N", "mm") if j < shift else ("Nmm", "")
            for j, name in enumerate(names)
            if self._working[j]
        }

    def _shares(self, places: Any) -> Any:
        """g of places b, (m,); analytic, so that complex steps differentiate it."""
        face, load = self._face, self._load
        axes = np.zeros((2, 3), dtype=places.dtype)
        if face.half:
            axes[0], axes[1, 1:] = np.eye(3)[0], places[self._shift :]
        else:
            axes[:] = places[self._shift :].reshape(2, 3)
        a_x, a_y = axes
        turned = np.eye(3, dtype=places.dtype)
        if load.follows:
            turned = section_axes(a_x, a_y, np.cross(a_x, a_y))
        force, moment = turned @ np.array(load.force), turned @ np.array(load.moment)
        gram = sum(np.sum(a * a) * np.eye(3) - np.outer(a, a) for a in axes)
        pull = np.linalg.solve(gram, moment)
        couples = [cross_matrix(pull) @ a for a in axes]
        kept = list(face.components)
        found = [force[kept], *(couple[kept] for couple in couples[1 if face.half else 0 :])]
        return face.part * np.concatenate(found)

    def law(self) -> Floats:
        """q g(b)."""
        shares: Floats = self._shares(self.own(self.at))
        return self.scalar(self._load.scalar) * shares

    @functools.cached_property
    def _none(self) -> Floats:
        return np.zeros(len(self.at))

    def law_rate(self, name: str) -> Floats:
        """By a place, by a complex step; by the load."""
        places = self.own(self.at)
        if name == self._load.scalar:
            share: Floats = self._shares(places)
            return share
        if name not in self.at:
            return self._none
        moved = places.astype(complex)
        moved[self.at.index(name)] += 1j * _STEP
        rate: Floats = self._shares(moved).imag / _STEP
        return self.scalar(self._load.scalar) * rate

    def value(self) -> float:
        """It has no potential."""
        return 0.0

    def pairs(self) -> dict[str, tuple[float, float]]:
        """Forces with the displacements, couples with the axes, of the whole body."""
        forces = self.own(self.held) / self._face.part
        pairs = zip(forces.tolist(), self.own(self.at).tolist(), strict=True)
        return {
            name: pair
            for name, pair, works in zip(self._pairs, pairs, self._working, strict=True)
            if works
        }
