"""The closed line around a section on which the winding lies, by its arc length.

s = 0 at the top (x = 0), first toward +x, clockwise seen from +z, to the lowest point on x = 0 at
s = S/2, and back by the mirror image to s = S.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from geometry.actuator import Actuator, Point, Side
from geometry.mesh.data import Floats


class Piece(Side):
    """A side of the outline as a curve."""

    @property
    def radius(self) -> float:
        """Radius of an arc in mm; infinite for a straight line."""
        return math.inf if self.center is None else math.dist(self.start, self.center)

    def _angles(self, center: Point) -> tuple[float, float]:
        """Polar angle of the start, and the turn to the end."""
        first, last = (math.atan2(y - center[1], x - center[0]) for x, y in (self.start, self.end))
        return first, (last - first + math.pi) % (2 * math.pi) - math.pi

    @property
    def length(self) -> float:
        """Length in mm."""
        if self.center is None:
            return math.dist(self.start, self.end)
        return self.radius * abs(self._angles(self.center)[1])

    def frame(self, s: Floats) -> tuple[Floats, Floats]:
        """Points and unit tangents (n, 2) at arc lengths s (n,) from the start, in mm."""
        part = (s / self.length)[:, None]
        if self.center is None:
            ends = np.array([self.start, self.end])
            along = (ends[1] - ends[0]) / self.length
            return (1 - part) * ends[0] + part * ends[1], np.tile(along, (len(s), 1))
        first, turn = self._angles(self.center)
        angle = first + turn * part[:, 0]
        arm = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        ahead = math.copysign(1, turn) * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
        return np.array(self.center) + self.radius * arm, ahead

    def project(self, points: Floats) -> tuple[Floats, Floats]:
        """Arc length in mm of the nearest point of the piece, and its distance, (n,) each."""
        if self.center is None:
            along = (np.array(self.end) - self.start) / self.length
            s = (points - self.start) @ along
        else:
            first, turn = self._angles(self.center)
            arm = points - np.array(self.center)
            angle = np.arctan2(arm[:, 1], arm[:, 0]) - first - turn / 2
            middle = (angle + math.pi) % (2 * math.pi) - math.pi
            s = self.radius * (middle * math.copysign(1, turn) + abs(turn) / 2)
        s = np.clip(s, 0.0, self.length)
        return s, np.linalg.norm(points - self.frame(s)[0], axis=1)


def pieces(actuator: Actuator) -> list[Piece]:
    """The half x ≥ 0 of the outline, from the top to the bottom."""
    return [Piece(*side) for side in actuator.outline()]


def position(actuator: Actuator, s: Floats) -> Floats:
    """Points of the outline.

    Args:
        actuator: dimensions.
        s: arc length in mm, (n,), any real number (taken modulo S).

    Returns:
        Array (n, 2) of x, y in mm.
    """
    return _frame(actuator, s)[0]


def tangent(actuator: Actuator, s: Floats) -> Floats:
    """Unit tangents (n, 2) of the outline toward growing s; see `position`."""
    return _frame(actuator, s)[1]


def curvature(actuator: Actuator, s: Floats) -> Floats:
    """Curvature of the outline in 1/mm, (n,): 1/radius on its arcs, zero on its straight lines.

    A corner between two pieces has no length, so no curvature either.

    Args:
        actuator: dimensions.
        s: arc length in mm, (n,), any real number (taken modulo S).
    """
    along_half, ends, half, _ = _halved(actuator, s)
    bent = np.array([1 / piece.radius for piece in along_half])
    return bent[np.searchsorted(ends[:-1], half)]


def _halved(
    actuator: Actuator, s: Floats
) -> tuple[list[Piece], Floats, Floats, npt.NDArray[np.bool_]]:
    """Pieces of the half x ≥ 0, their ends in s, s on that half, and what is on the other one."""
    along_half = pieces(actuator)
    ends = np.cumsum([piece.length for piece in along_half])
    perimeter = actuator.winding_perimeter
    around = np.mod(np.asarray(s, dtype=float), perimeter)
    back = around > perimeter / 2
    return along_half, ends, np.where(back, perimeter - around, around), back


def _frame(actuator: Actuator, s: Floats) -> tuple[Floats, Floats]:
    along_half, ends, half, back = _halved(actuator, s)
    number = np.searchsorted(ends[:-1], half)
    xy, along = np.empty((len(half), 2)), np.empty((len(half), 2))
    for i, piece in enumerate(along_half):
        here = number == i
        xy[here], along[here] = piece.frame(half[here] - (ends[i] - piece.length))
    # the half x < 0 mirrors x and runs upward: t = (t_x, −t_y)
    xy[back, 0] *= -1
    along[back, 1] *= -1
    return xy, along


def arc_length(actuator: Actuator, points: Floats, negative: np.ndarray) -> Floats:
    """Arc length of points on the outline.

    Args:
        actuator: dimensions.
        points: x, y in mm on the outline (else the nearest point counts), (..., 2).
        negative: True for points that belong to the side x < 0, (...); it decides where x = 0.

    Returns:
        s in mm, (...): in [0, S/2], or in [S/2, S] on the negative side.
    """
    flat = points.reshape(-1, 2) * np.where(points[..., :1].reshape(-1, 1) < 0, [-1.0, 1.0], 1.0)
    best, half, start = np.full(len(flat), np.inf), np.zeros(len(flat)), 0.0
    for piece in pieces(actuator):
        s, distance = piece.project(flat)
        nearer = distance < best
        best, half = np.where(nearer, distance, best), np.where(nearer, start + s, half)
        start += piece.length
    half = half.reshape(points.shape[:-1])
    return np.where(negative, actuator.winding_perimeter - half, half)
