"""Rigid obstacles by their signed distances, with exact first and second derivatives.

All are distances proper, |∇g| = 1: from a point far away follows how much of a rod may touch. They
are smooth but on the axis of a cylinder, at the centre of a sphere, and along edges inside a body.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from rod.functions import Floats

_EYE = np.eye(3)
Vector = Sequence[float] | Floats
_LEAST = 1e-9
"""Part of a radius: nearer to an axis a direction away from it is taken as it comes."""


class Gap(NamedTuple):
    """Signed distances of points."""

    value: Floats
    """g, (p,), mm; negative inside."""
    normal: Floats
    """∇g, (p, 3): out of the obstacle."""
    bend: Floats
    """∇∇g, (p, 3, 3), 1/mm."""


class Obstacle(Protocol):
    """A rigid body that keeps its place."""

    @property
    def thickness(self) -> float:
        """Half of its least extent, mm: what moves by less in a step does not pass through it."""

    def gap(self, x: Floats) -> Floats:
        """Signed distance of points to its surface, (p,), mm; negative inside.

        Args:
            x: points, (p, 3), mm.
        """

    def near(self, x: Floats) -> Gap:
        """The same with its derivatives."""


def _unit(vector: Vector, what: str) -> Floats:
    v = np.asarray(vector, dtype=float)
    size = float(np.linalg.norm(v))
    if v.shape != (3,) or not (math.isfinite(size) and size > 0):
        raise ValueError(f"{what}: a direction in space expected, not {vector}")
    return v / size


def _positive(length: float, what: str) -> None:
    if not length > 0:
        raise ValueError(f"{what} {length} mm: expected a positive length")


@dataclasses.dataclass(frozen=True)
class Plane:
    """The half space behind a plane.

    Attributes:
        point: one of its points, mm.
        normal: out of the obstacle, of any length above zero.

    Raises:
        ValueError: no normal.
    """

    point: Vector
    normal: Vector

    def __post_init__(self) -> None:
        _unit(self.normal, "normal of a plane")

    @property
    def thickness(self) -> float:
        """See `Obstacle`: there is no other side."""
        return math.inf

    def gap(self, x: Floats) -> Floats:
        """See `Obstacle`."""
        out: Floats = (x - np.asarray(self.point, dtype=float)) @ _unit(self.normal, "normal")
        return out

    def near(self, x: Floats) -> Gap:
        """See `Obstacle`."""
        normal = np.broadcast_to(_unit(self.normal, "normal"), x.shape)
        return Gap(self.gap(x), normal, np.zeros((len(x), 3, 3)))


@dataclasses.dataclass(frozen=True)
class Sphere:
    """A ball.

    Attributes:
        center: mm.
        radius: mm.

    Raises:
        ValueError: a radius that is not positive.
    """

    center: Vector
    radius: float

    def __post_init__(self) -> None:
        _positive(self.radius, "radius of a sphere")

    @property
    def thickness(self) -> float:
        """See `Obstacle`."""
        return self.radius

    def gap(self, x: Floats) -> Floats:
        """See `Obstacle`."""
        away: Floats = np.linalg.norm(x - np.asarray(self.center, dtype=float), axis=1)
        return away - self.radius

    def near(self, x: Floats) -> Gap:
        """See `Obstacle`."""
        away = x - np.asarray(self.center, dtype=float)
        distance, normal = _split(away, np.array([0.0, 1.0, 0.0]), self.radius)
        bend = (_EYE - _square(normal)) / distance[:, None, None]
        return Gap(distance - self.radius, normal, bend)


@dataclasses.dataclass(frozen=True)
class Cylinder:
    """A round bar of any axis, endless or with flat ends.

    Attributes:
        center: a point of its axis; the middle where it ends, mm.
        axis: direction of it, of any length above zero.
        radius: mm.
        length: from end to end, mm.

    Raises:
        ValueError: no axis, a radius or a length that is not positive.
    """

    center: Vector
    axis: Vector
    radius: float
    length: float = math.inf

    def __post_init__(self) -> None:
        _unit(self.axis, "axis of a cylinder")
        _positive(self.radius, "radius of a cylinder")
        _positive(self.length, "length of a cylinder")

    @property
    def thickness(self) -> float:
        """See `Obstacle`."""
        return min(self.radius, self.length / 2)

    def gap(self, x: Floats) -> Floats:
        """See `Obstacle`."""
        return self.near(x).value

    def near(self, x: Floats) -> Gap:
        """See `Obstacle`."""
        axis = _unit(self.axis, "axis")
        away = x - np.asarray(self.center, dtype=float)
        along = away @ axis
        across = away - along[:, None] * axis
        distance, out = _split(across, _beside(axis), self.radius)
        round_ = (_EYE - np.outer(axis, axis) - _square(out)) / distance[:, None, None]
        side = distance - self.radius
        if math.isinf(self.length):
            return Gap(side, out, round_)
        end = np.abs(along) - self.length / 2
        outward = np.where(along < 0, -1.0, 1.0)[:, None] * axis
        value = np.maximum(side, end)
        normal = np.where((side >= end)[:, None], out, outward)
        bend = np.where((side >= end)[:, None, None], round_, 0.0)
        rim = (side > 0) & (end > 0)
        if rim.any():
            s, e = side[rim], end[rim]
            d = np.hypot(s, e)
            n = (s[:, None] * out[rim] + e[:, None] * outward[rim]) / d[:, None]
            t = (e[:, None] * out[rim] - s[:, None] * outward[rim]) / d[:, None]
            value[rim], normal[rim] = d, n
            # around the rim, and along it
            bend[rim] = _square(t) / d[:, None, None] + (s / d)[:, None, None] * round_[rim]
        return Gap(value, normal, bend)


def _split(away: Floats, otherwise: Floats, radius: float) -> tuple[Floats, Floats]:
    """Lengths and directions of vectors; `otherwise` where there is none."""
    distance = np.linalg.norm(away, axis=1)
    none = distance < _LEAST * radius
    distance = np.where(none, _LEAST * radius, distance)
    direction = np.where(none[:, None], otherwise, away / distance[:, None])
    return distance, direction


def _beside(axis: Floats) -> Floats:
    """A direction across an axis."""
    other = np.zeros(3)
    other[int(np.argmin(np.abs(axis)))] = 1.0
    across: Floats = other - axis * (axis @ other)
    return across / np.linalg.norm(across)


def _square(vectors: Floats) -> Floats:
    out: Floats = vectors[:, :, None] * vectors[:, None, :]
    return out
