"""Contact of a rod with itself, without friction.

A point x of the surface is held against the section through it elsewhere along the rod: at the part
s of a piece where x lies in the plane of the section, at y(s) = Rᵀ(x − r) in its axes with
y₃(s) = 0. With the signed distance φ(y₁, y₂) of the section, Π = Σ ½ k a d², d = −φ, as for a rigid
obstacle. Where the section is follows from the strains, and all derivatives are exact: those of
G(ε) = φ(y(s(ε), ε)) are those of L = φ + μ y₃ with μ such that ∂L/∂s = 0,

    ∂G = L_ε,    ∂²G = L_εε + L_εs t + t L_sε + L_ss t t,    t = ds/dε = −∂y₃/∂ε / y₃'.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple, Self

import numpy as np

from rod.contact.penalty import Penalty
from rod.contact.points import placed
from rod.contact.region import Region
from rod.contact.skin import Skin
from rod.contact.split import Split
from rod.functions import Bools, Floats, Ints, cross, cross_matrix
from rod.layout import Layout
from rod.shape import Shape

_MOST = 30
_CLOSE, _SAME = 1e-12, 1e-9
_LEAST = 1e-12
"""Least part of a piece before a section: the root is no place on the first piece."""


class _Cuts(NamedTuple):
    """Points of the surface and the sections through them."""

    which: Ints
    """Points of the skin, (q,)."""
    pieces: Ints
    """Pieces of the sections, (q,)."""
    parts: Floats
    """Of those pieces before the sections, (q,)."""
    y: Floats
    """Places of the points in the axes of the sections, (q, 3), mm; the last one is 0."""

    def only(self, mask: Bools) -> _Cuts:
        """Some of them."""
        return _Cuts(self.which[mask], self.pieces[mask], self.parts[mask], self.y[mask])


class Itself(Penalty):
    """A rod against itself.

    Args:
        layout: of the rod.
        skin: points of its surface, both sides and tip.
        region: its section, from the rod's line.
        stiffness: k, MPa/mm: pressure per depth.
        apart: parts of the rod that are less apart at rest do not touch, mm; None: half the turn of
            a rod that is bent as sharply as its section allows.

    Raises:
        ValueError: a stiffness or a distance that is not positive.
    """

    def __init__(
        self,
        layout: Layout,
        skin: Skin,
        region: Region,
        stiffness: float,
        apart: float | None = None,
    ) -> None:
        super().__init__(len(skin.station), stiffness)
        self._skin, self._region = skin, region
        self._reach = skin.reach
        self._apart = math.pi * self._reach if apart is None else apart
        if not self._apart > 0:
            raise ValueError(f"apart {apart} mm: a positive distance expected")
        ends = np.concatenate([[0.0], np.cumsum(layout.lengths)])
        at = ends[skin.pieces] + skin.parts * layout.lengths[skin.pieces]
        # of stations and pieces, the nearer end of which counts
        away = np.maximum(ends[None, :-1] - at[:, None], at[:, None] - ends[None, 1:])
        self._may = away >= self._apart

    def room(self, shape: Shape, amount: float) -> float:
        """See `Penalty`: nothing is known of it."""
        return math.inf

    def near(self, shape: Shape, amount: float) -> Meeting:
        """See `Penalty`."""
        cuts = self._met(shape)
        depth = np.zeros(0)
        if len(cuts.which):
            depth = -self._region.near(cuts.y[:, :2]).value
        return Meeting(self._skin, self._region, shape, cuts, depth)

    # --- what touches -----------------------------------------------------------------------------

    def _met(self, shape: Shape) -> _Cuts:
        """Points near a section through them that is not of their own part of the rod."""
        skin, places = self._skin, shape.places
        none = np.zeros(0, dtype=np.intp)
        empty = _Cuts(none, none, np.zeros(0), np.zeros((0, 3)))
        # a station and a piece whose surfaces are apart by more than their arms and arcs
        arcs = shape.arcs
        chord = (places[1:] + places[:-1]) / 2
        own, other = arcs[skin.pieces] / 2, arcs / 2
        away = np.linalg.norm(chord[skin.pieces][:, None] - chord[None], axis=2)
        near = self._may & (away <= 2 * self._reach + own[:, None] + other[None])
        stations = np.flatnonzero(near.any(axis=1))
        if not len(stations):
            return empty
        points = placed(skin, shape, stations)
        # the plane of its root is behind the point, that of its end is not
        height = np.einsum("fi,qfi->qf", shape.rotations[:, :, 2], points.x[:, None] - places[None])
        between = (height[:, :-1] >= 0) & (height[:, 1:] < 0)
        row, pieces = np.nonzero(between & near[skin.station[points.which]])
        found = self._cut(shape, points.which[row], points.x[row], pieces)
        inside = np.sum(found.y[:, :2] ** 2, axis=1) <= (2 * self._reach) ** 2
        return found.only(inside)

    def _cut(self, shape: Shape, which: Ints, x: Floats, pieces: Ints) -> _Cuts:
        """Sections of pieces through points, by Newton's method within the piece."""
        layout = shape.layout
        full = layout.full(shape.strains)[pieces]
        lengths = layout.lengths[pieces]
        low, high = np.zeros(len(which)), np.ones(len(which))
        parts = np.full(len(which), 0.5)
        y = np.zeros((len(which), 3))
        for _ in range(_MOST):
            frames = shape.between(pieces, parts)
            y = np.einsum("qij,qi->qj", frames[:, :, :3], x - frames[:, :, 3])
            slope = -(full[:, :3] + cross(full[:, 3:], y)) * lengths[:, None]
            ahead = y[:, 2] >= 0
            low, high = np.where(ahead, parts, low), np.where(ahead, high, parts)
            with np.errstate(divide="ignore", invalid="ignore"):
                to = parts - y[:, 2] / slope[:, 2]
            inside = (to > low - _SAME) & (to < high + _SAME)
            to = np.where(inside, to, (low + high) / 2)
            settled = np.all(np.abs(to - parts) < _CLOSE)
            parts = to
            if settled:
                # what is left of y₃ would be noise of the distance where sections turn
                y = y - (y[:, 2] / slope[:, 2])[:, None] * slope
                break
        return _Cuts(which, pieces, np.maximum(parts, _LEAST), y)


class Meeting:
    """Points of a rod near a section of it; `rod.contact.penalty.Contacts`.

    Args:
        skin: of the rod.
        region: its section.
        shape: the rod.
        cuts: points and sections.
        depth: of the points, (q,), mm.

    Attributes:
        depth: as given.
    """

    def __init__(
        self, skin: Skin, region: Region, shape: Shape, cuts: _Cuts, depth: Floats
    ) -> None:
        self._of = skin, region, shape
        self._cuts, self.depth = cuts, depth

    @property
    def which(self) -> Ints:
        """See `Contacts`."""
        return self._cuts.which

    @property
    def areas(self) -> Floats:
        """See `Contacts`."""
        areas: Floats = self._of[0].areas[self.which]
        return areas

    @functools.cached_property
    def _slopes(self) -> _Slopes:
        return _Slopes(*self._of, self._cuts)

    def only(self, mask: Bools) -> Self:
        """See `Contacts`."""
        return type(self)(*self._of, self._cuts.only(mask), self.depth[mask])

    def pushed(self, push: Floats) -> Floats:
        """See `Contacts`."""
        shape = self._of[2].layout.shape
        if not len(push):
            return np.zeros(shape)
        return -(push @ self._slopes.first).reshape(shape)

    def stiffened(self, stiff: Floats, push: Floats) -> Floats:
        """See `Contacts`."""
        if not len(push):
            count = self._of[2].strains.size
            return np.zeros((count, count))
        first = self._slopes.first
        out: Floats = first.T * stiff @ first - self._slopes.second(push)
        return out

    def deeper(self, change: Floats) -> Floats:
        """See `Contacts`."""
        if not len(self.depth):
            return np.zeros(0)
        return -self._slopes.first @ change.ravel()


class _Slopes:
    """Derivatives of the distances of points by the strains.

    Args:
        skin: of the rod.
        region: its section.
        shape: the rod.
        cuts: points and sections.

    Attributes:
        first: ∂φ/∂ε of each, (q, n m).
    """

    def __init__(self, skin: Skin, region: Region, shape: Shape, cuts: _Cuts) -> None:
        self._shape = shape
        m = shape.layout.shape[1]
        station = skin.station[cuts.which]
        pieces = np.concatenate([skin.pieces[station], cuts.pieces])
        parts = np.concatenate([skin.parts[station], cuts.parts])
        self._split = split = Split(shape, pieces, parts)
        count = len(cuts.which)
        self._point, self._section = split.frames[:count], split.frames[count:]
        self._arms = np.column_stack([skin.places[cuts.which], np.zeros(count)])
        frames = split.fine.frames
        self._rotation = frames[self._section, :, :3]
        x = frames[self._point, :, 3] + np.einsum(
            "qij,qj->qi", frames[self._point, :, :3], self._arms
        )
        self._apart = x - frames[self._section, :, 3]
        y = cuts.y
        near = region.near(y[:, :2])
        # by the part along the rod, a unit of which is a mm at rest
        full = shape.layout.full(shape.strains)[cuts.pieces]
        spin = full[:, 3:]
        rate = -(full[:, :3] + cross(spin, y))
        down = np.sum(near.normal * rate[:, :2], axis=1)
        self._psi = np.column_stack([near.normal, -down / rate[:, 2]])
        self._bend = np.zeros((count, 3, 3))
        self._bend[:, :2, :2] = near.bend
        self._screws()
        by = np.einsum("qji,qjk->qik", self._rotation, self._way)
        self._by = by
        self.first: Floats = np.einsum("qi,qik->qk", self._psi, by)
        self._along = -by[:, 2] / rate[:, 2, None]
        # ∂(dy/ds)/∂ε: with the motion of y, and with the strains of the piece itself
        mixed = -np.einsum("qij,qjk->qik", cross_matrix(spin), by)
        own = np.zeros((count, 3, 6))
        own[:, :, :3] = -np.eye(3)
        own[:, :, 3:] = cross_matrix(y)
        place = cuts.pieces[:, None] * m + np.arange(m)
        rows = np.arange(count)[:, None]
        mixed = np.ascontiguousarray(mixed)
        mixed[rows, :, place] += np.swapaxes(own[:, :, list(shape.layout.columns)], 1, 2)
        bent = np.einsum("qij,qj->qi", self._bend, rate)
        self._mixed = np.einsum("qi,qik->qk", self._psi, mixed) + np.einsum("qi,qik->qk", bent, by)
        second = -cross(spin, rate)
        self._twice = np.sum(self._psi * second, axis=1) + np.sum(rate * bent, axis=1)

    def _screws(self) -> None:
        """How y's vector moves as seen from the section, and how the section turns, (q, 3, n m)."""
        fine = self._split.fine
        moves, turns = [], []
        for point, section, arm, apart in zip(
            self._point, self._section, self._arms, self._apart, strict=True
        ):
            (moved, spun), (there, omega) = fine.jacobian(int(point)), fine.jacobian(int(section))
            out = fine.rotations[point] @ arm
            moves.append(moved - cross_matrix(out) @ spun - there + cross_matrix(apart) @ omega)
            turns.append(omega)
        self._way, self._turn = self._whole(np.array(moves)), self._whole(np.array(turns))

    def _whole(self, columns: Floats) -> Floats:
        """By strains of the whole pieces, (q, 3, n m)."""
        m = self._shape.layout.shape[1]
        flat = columns.reshape(len(columns) * 3, -1, m)
        gathered = np.stack([self._split.gathered(each) for each in flat])
        return gathered.reshape(len(columns), 3, -1)

    def second(self, weights: Floats) -> Floats:
        """Σ w ∂²φ/∂ε², (n m, n m)."""
        fine = self._split.fine
        force = np.einsum("qij,qj->qi", self._rotation, self._psi) * weights[:, None]
        loads = np.zeros_like(fine.frames)
        arms = np.concatenate([self._arms, np.ones((len(weights), 1))], axis=1)
        np.add.at(loads, self._point, force[:, :, None] * arms[:, None, :])
        turning = self._apart[:, :, None] * (weights[:, None] * self._psi)[:, None, :]
        np.add.at(loads[:, :, :3], self._section, turning)
        np.add.at(loads[:, :, 3], self._section, -force)
        out = self._split.matrix(fine.curved(loads))
        # f = R ψ turns with the section while x − r moves: as seen from the section less its spin
        spun = -np.einsum("qij,qjk->qik", cross_matrix(force), self._turn)
        moved = self._way - np.einsum("qij,qjk->qik", cross_matrix(self._apart), self._turn)
        mixed = np.einsum("qik,qil->kl", spun, moved)
        out = out + mixed + mixed.T
        bent = np.einsum("q,qij,qjk->qik", weights, self._bend, self._by)
        out += np.einsum("qik,qil->kl", self._by, bent)
        cross_part = (weights[:, None] * self._mixed).T @ self._along
        along = (weights * self._twice)[:, None] * self._along
        out += cross_part + cross_part.T + self._along.T @ along
        return out
