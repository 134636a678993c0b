"""Points on one rod that press on the surface of another.

The hull of a section's outline, carried along a rod, is a tube. A point p between its frames a and
b has the place η = Rᵀ (p − r) in each of them, and in the tube, with u = z_a/(z_a − z_b),

    y = y_a + w(u) (y_b − y_a),      w = u² (3 − 2 u):

where the point passes from one piece to the next nothing jumps, not even the direction of the
force. Its depth D in the hull gives the potential ½ κ A D² of a surface that yields by κ in MPa/mm,
A the area that the point stands for. All of it is a function of η alone, which moves with the
frames of both rods: forces come in pairs, without a resultant force or moment.

Beyond its tip a tube fades out, as the edges of two tips that meet lie on each other's end. What
comes at the end head on is soon deep in the hull: see `Pressing.deepest`.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import numpy.typing as npt

from rod.contact.hull import Hull, greatest
from rod.functions import Floats, Ints, cross_matrix
from rod.shape import Shape

FADE = 0.05
"""Length of the fade beyond the tip, as a part of the hull's size."""


@dataclasses.dataclass(frozen=True)
class Tube:
    """The surface of a rod.

    Attributes:
        hull: of all its sections.
        lengths: of the pieces at rest, (n,), mm.
    """

    hull: Hull
    lengths: Floats

    @property
    def areas(self) -> Floats:
        """That each corner of each frame stands for, (n + 1, k), mm²."""
        along = np.zeros(len(self.lengths) + 1)
        along[:-1] += self.lengths / 2
        along[1:] += self.lengths / 2
        out: Floats = along[:, None] * self.hull.shares
        return out

    def points(self, shape: Shape) -> Floats:
        """Its corners in space, (n + 1, k, 3), mm."""
        flat = shape.rotations[:, None, :, :2] @ self.hull.corners[None, :, :, None]
        out: Floats = shape.places[:, None] + flat[..., 0]
        return out


class Pressing:
    """The corners of one rod in the tube of another.

    Within Newton's method pressures of the corners are unknowns beside the strains, as those of
    `rod.contact.touch.Pressed`: corners that are pressed touch wherever they are, and the tangent
    takes their pressures in place of κ D.

    Args:
        tubes: of the rod whose corners are looked at, and of the other one.
        shapes: of both.
        stiffness: κ, MPa/mm.
        pressures: p of each corner of the first rod, (n + 1, k), MPa; None: κ D.

    Attributes:
        potential: ½ Σ κ A D², N mm.
        deepest: greatest D, mm; 0 where nothing touches.
        points: corners that touch, (p, 3), mm.
    """

    def __init__(
        self,
        tubes: tuple[Tube, Tube],
        shapes: tuple[Shape, Shape],
        stiffness: float,
        pressures: Floats | None = None,
    ) -> None:
        (own, tube), (shape, other) = tubes, shapes
        self._shape, self._other, self._stiffness = shape, other, stiffness
        self._size = own.areas.shape
        frames, corners, pieces = _near(tubes, shapes)
        flat = own.hull.corners[corners]
        arm = (shape.rotations[frames, :, :2] @ flat[..., None])[..., 0]
        points = shape.places[frames] + arm
        ends = pieces[:, None] + np.arange(2)
        arms = points[:, None] - other.places[ends]
        local = _within(other.rotations[ends], arms)
        value, slope, curved = _signed(local, tube.hull)
        touch = value < 0 if pressures is None else (value < 0) | (pressures[frames, corners] > 0)
        touch = touch & _deepest(frames * self._size[1] + corners, value)
        depth, self._slope, self._curved = -value[touch], -slope[touch], -curved[touch]
        self.deepest = float(depth.max(initial=0.0))
        self.points, self._where = points[touch], (frames[touch], corners[touch])
        self._arm, self._place = arm[touch], np.zeros((len(depth), 4))
        self._place[:, :2], self._place[:, 3] = flat[touch], 1.0
        self._ends, self._arms = ends[touch], arms[touch]
        self._turns = other.rotations[self._ends]
        beyond = FADE * tube.hull.size
        fade = _smooth(1.0 - local[touch, 1, 2] / beyond)
        self._fade = fade[0], -fade[1] / beyond, fade[2] / beyond**2
        self._weights = stiffness * own.areas[self._where]
        self._depth = depth
        self._felt = depth if pressures is None else pressures[self._where] / stiffness
        inside = np.maximum(depth, 0.0)
        self.potential = float(self._weights @ (fade[0] * inside**2)) / 2

    @property
    def forces(self) -> Floats:
        """On the points, by the tube, (p, 3), N; on the tube their opposites."""
        out: Floats = -self._pulls(self._by(self._depth)).sum(axis=1)
        return out

    @property
    def pressures(self) -> Floats:
        """κ D of the corners of the first rod, (n + 1, k), MPa."""
        out = np.zeros(self._size)
        out[self._where] = self._stiffness * np.maximum(self._depth, 0.0)
        return out

    def _by(self, depth: Floats) -> Floats:
        """Derivatives of the potential by η of both frames, (p, 2, 3); the fade is one of z_b."""
        by = (self._fade[0] * depth)[:, None] * self._slope
        by[:, 5] += self._fade[1] * depth**2 / 2
        return (self._weights[:, None] * by).reshape(-1, 2, 3)

    def _twice(self, depth: Floats) -> Floats:
        """Second derivatives, (p, 6, 6)."""
        square = self._slope[:, :, None] * self._slope[:, None, :]
        twice = self._fade[0][:, None, None] * (square + depth[:, None, None] * self._curved)
        mixed = (self._fade[1] * depth)[:, None] * self._slope
        twice[:, 5] += mixed
        twice[:, :, 5] += mixed
        twice[:, 5, 5] += self._fade[2] * depth**2 / 2
        out: Floats = self._weights[:, None, None] * twice
        return out

    def _pulls(self, by: Floats) -> Floats:
        """Derivatives by the points, through each of the two frames, (p, 2, 3)."""
        out: Floats = (self._turns @ by[..., None])[..., 0]
        return out

    def _loads(self, depth: Floats) -> tuple[Floats, Floats]:
        """Conjugates of the frames of both rods, (n + 1, 3, 4); see `Shape.pulled`."""
        by = self._by(depth)
        pulls = self._pulls(by)
        mine, its = np.zeros_like(self._shape.frames), np.zeros_like(self._other.frames)
        pull = pulls.sum(axis=1)
        np.add.at(mine, self._where[0], pull[:, :, None] * self._place[:, None, :])
        dyad = self._arms[..., :, None] * by[..., None, :]
        np.add.at(its, self._ends, np.concatenate([dyad, -pulls[..., None]], axis=-1))
        return mine, its

    def residual(self) -> tuple[Floats, Floats]:
        """Derivatives of the potential by the strains of both rods, (n, m) each."""
        if not len(self.points):
            return np.zeros(self._shape.layout.shape), np.zeros(self._other.layout.shape)
        mine, its = self._loads(self._depth)
        return self._shape.pulled(mine), self._other.pulled(its)

    def tangent(self) -> tuple[Floats, Floats, Floats]:
        """Second derivatives: by the first rod, by both and by the second, flat matrices."""
        a, b = self._shape.strains.size, self._other.strains.size
        if not len(self.points):
            return np.zeros((a, a)), np.zeros((a, b)), np.zeros((b, b))
        mine, its = self._loads(self._felt)
        moved, turned = _jacobians(self._shape, self._where[0])
        point = moved - cross_matrix(self._arm) @ turned
        shift, spin = _jacobians(self._other, self._ends)
        carried = shift - cross_matrix(self._arms) @ spin
        # δη by the strains of the first rod, and less that by those of the second
        back = np.swapaxes(self._turns, -1, -2)
        first = (back @ point[:, None]).reshape(-1, 6, a)
        second = (back @ carried).reshape(-1, 6, b)
        twice = self._twice(self._felt)
        weighed = (twice @ second).reshape(-1, b)
        one = first.reshape(-1, a).T @ (twice @ first).reshape(-1, a)
        both = -first.reshape(-1, a).T @ weighed
        two = second.reshape(-1, b).T @ weighed
        # c · δRᵀ δ(p − r): what turns a force is not the force's own second derivative
        force = cross_matrix(self._pulls(self._by(self._felt)))
        turning = spin.reshape(-1, b).T @ (force @ shift).reshape(-1, b)
        across = (np.swapaxes(force, -1, -2) @ spin).sum(axis=1)
        both += point.reshape(-1, a).T @ across.reshape(-1, b)
        one += self._shape.curved(mine)
        two += self._other.curved(its) - turning - turning.T
        return one, both, two

    def stepped(self, changes: tuple[Floats, Floats]) -> Floats:
        """Pressures of the corners after a step, by the first order of their depths, (n + 1, k).

        Args:
            changes: of the strains of both rods, (n, m) each.
        """
        pressures = np.zeros(self._size)
        if len(self.points):
            moved = self._shape.moved(changes[0])[self._where[0]]
            point = (moved @ self._place[..., None])[:, None, :, 0]
            rates = self._other.moved(changes[1])[self._ends]
            # δη = Rᵀ (δp − δr) + δRᵀ (p − r)
            local = _within(self._turns, point - rates[..., 3])
            local += _within(rates[..., :3], self._arms)
            deeper = self._depth + np.sum(self._slope * local.reshape(-1, 6), axis=1)
            pressures[self._where] = self._stiffness * np.maximum(deeper, 0.0)
        return pressures


def gap(tubes: tuple[Tube, Tube], shapes: tuple[Shape, Shape]) -> float:
    """Least distance of the corners of one rod to the tube of another, mm; below zero within it.

    Corners that are beyond the ends of the tube have none: infinite where all are.
    """
    points = tubes[0].points(shapes[0]).reshape(-1, 3)
    other = shapes[1]
    found, pieces = _between(points, other, 0.0)
    if not len(found):
        return math.inf
    ends = pieces[:, None] + np.arange(2)
    local = _within(other.rotations[ends], points[found, None] - other.places[ends])
    w = _smooth(local[:, 0, 2] / (local[:, 0, 2] - local[:, 1, 2]))[0]
    flat = local[:, 0, :2] + w[:, None] * (local[:, 1, :2] - local[:, 0, :2])
    return float(tubes[1].hull.distance(flat).min())


def _within(turns: Floats, arms: Floats) -> Floats:
    """η = Rᵀ (p − r), (p, 2, 3)."""
    out: Floats = (np.swapaxes(turns, -1, -2) @ arms[..., None])[..., 0]
    return out


def _near(tubes: tuple[Tube, Tube], shapes: tuple[Shape, Shape]) -> tuple[Ints, Ints, Ints]:
    """Frames and corners that may be in the tube, and the pieces between whose ends they are."""
    none = np.zeros(0, dtype=np.intp)
    (own, tube), (shape, other) = tubes, shapes
    away = shape.places[:, None] - other.places
    reach = own.hull.reach + tube.hull.reach + other.arcs.max()
    close = np.sum(away**2, axis=2) < reach**2
    frames = np.flatnonzero(close.any(axis=1))
    if not len(frames):
        return none, none, none
    count, fade = len(own.hull.corners), FADE * tube.hull.size
    found, pieces = _between(own.points(shape)[frames].reshape(-1, 3), other, fade)
    frames, corners = frames[found // count], found % count
    keep = close[frames, pieces] | close[frames, pieces + 1]
    return frames[keep], corners[keep], pieces[keep]


def _between(points: Floats, other: Shape, beyond: float) -> tuple[Ints, Ints]:
    """Points with the pieces between the planes of whose ends they are; so far beyond the tip."""
    axes = other.rotations[:, :, 2]
    ahead = points @ axes.T - np.sum(axes * other.places, axis=1)
    ahead[:, -1] -= beyond
    found, pieces = np.nonzero((ahead[:, :-1] >= 0) & (ahead[:, 1:] < 0))
    return found, pieces


def _deepest(points: Ints, values: Floats) -> npt.NDArray[np.bool_]:
    """Of each point that is between the ends of several pieces, where it is deepest."""
    order = np.lexsort((values, points))
    first = np.zeros(len(points), dtype=bool)
    if len(points):
        ordered = points[order]
        first[order[np.concatenate([[True], ordered[1:] != ordered[:-1]])]] = True
    return first


def _smooth(u: Floats) -> tuple[Floats, Floats, Floats]:
    """w = u² (3 − 2 u) and its two derivatives; constant beyond 0 and 1."""
    u = np.clip(u, 0.0, 1.0)
    inner = (u > 0) & (u < 1)
    return u * u * (3 - 2 * u), 6 * u * (1 - u), np.where(inner, 6 - 12 * u, 0.0)


def _signed(local: Floats, hull: Hull) -> tuple[Floats, Floats, Floats]:
    """Distance of points from the surface, below zero within, and its two derivatives.

    Args:
        local: η in both frames, (p, 2, 3), mm.
        hull: of the tube.

    Returns:
        (p,), mm; (p, 6) and (p, 6, 6) by η.
    """
    a, b = local[:, 0, 2], local[:, 1, 2]
    size = a - b
    w, w1, w2 = _smooth(a / size)
    by = np.stack([-b / size**2, a / size**2], axis=1)
    both = -(a + b) / size**3
    twice = np.stack([2 * b / size**3, both, both, 2 * a / size**3], axis=1).reshape(-1, 2, 2)
    step = local[:, 1, :2] - local[:, 0, :2]
    flat = local[:, 0, :2] + w[:, None] * step
    normals, offsets = hull.sides
    value, slope, curved = greatest(flat @ normals.T - offsets, normals, hull.sharpness)
    # derivatives of y by η
    count = len(local)
    first = np.zeros((count, 2, 2, 3))
    for axis in range(2):
        first[:, axis, 0, axis], first[:, axis, 1, axis] = 1 - w, w
    first[..., 2] = w1[:, None, None] * step[:, :, None] * by[:, None, :]
    first = first.reshape(count, 2, 6)
    out = np.swapaxes(first, 1, 2) @ curved @ first
    # slope of y times its second derivatives
    bent = out.reshape(count, 2, 3, 2, 3)
    along = np.sum(slope * step, axis=1)[:, None, None]
    second = w2[:, None, None] * by[:, :, None] * by[:, None, :] + w1[:, None, None] * twice
    bent[:, :, 2, :, 2] += along * second
    for frame, sign in ((0, -1.0), (1, 1.0)):
        # by y of this frame, (p, 2), and by z of either, (p, 2)
        mixed = sign * w1[:, None, None] * slope[:, :, None] * by[:, None, :]
        bent[:, frame, :2, :, 2] += mixed
        bent[:, :, 2, frame, :2] += np.swapaxes(mixed, 1, 2)
    return value, (slope[:, None] @ first)[:, 0], out


def _jacobians(shape: Shape, frames: Ints) -> tuple[Floats, Floats]:
    """δr and spin of frames by all strains, (..., 3, n m) each, mm and rad."""
    every, where = np.unique(frames, return_inverse=True)
    pairs = [shape.jacobian(frame) for frame in every.tolist()]
    moved, turned = (np.stack(part) for part in zip(*pairs, strict=True))
    where = where.reshape(frames.shape)
    return moved[where], turned[where]
