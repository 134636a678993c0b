"""A convex section by its signed distance in its own plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rod.contact.obstacles import Gap
from rod.functions import Floats

_EYE = np.eye(2)


class Region:
    """A convex polygon whose corners are rounded.

    The distance is that from a polygon further in, less the way in: its first derivative is
    continuous from there outward, and its second one jumps where an arc becomes a line.

    Args:
        corners: x, y in turn, either way, (k, 2), mm.
        rounding: radius of the corners, mm; a right angle loses 0.41 of it.

    Raises:
        ValueError: corners that are not convex, or a rounding that leaves nothing.
    """

    def __init__(self, corners: Sequence[Sequence[float]] | Floats, rounding: float) -> None:
        places = np.asarray(corners, dtype=float)
        if places.ndim != 2 or places.shape[1] != 2 or len(places) < 3 or not rounding > 0:
            raise ValueError("region: three corners or more and a positive rounding expected")
        x, y = places.T
        if float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) < 0:
            places = places[::-1]
        along = np.roll(places, -1, axis=0) - places
        size = np.linalg.norm(along, axis=1)
        if not size.min() > 0:
            raise ValueError("region: two corners are one")
        normal = np.column_stack([along[:, 1], -along[:, 0]]) / size[:, None]
        turn = _cross(np.roll(normal, 1, axis=0), normal)
        if turn.min() < -1e-9:
            raise ValueError("region: its corners are not convex")
        offset = np.sum(normal * places, axis=1) - rounding
        before, far = np.roll(normal, 1, axis=0), np.roll(offset, 1)
        straight = turn < 1e-9
        safe = np.where(straight, 1.0, turn)
        inner = np.column_stack(
            [far * normal[:, 1] - offset * before[:, 1], offset * before[:, 0] - far * normal[:, 0]]
        )
        inner = np.where(straight[:, None], places - rounding * normal, inner / safe[:, None])
        self._first, self._way = inner, np.roll(inner, -1, axis=0) - inner
        if np.sum(self._way * along, axis=1).min() <= 0:
            raise ValueError(f"region: a rounding of {rounding:g} mm leaves nothing of a side")
        self._normal, self._rounding = normal, rounding

    def near(self, y: Floats) -> Gap:
        """Distances of points, (q, 2), with derivatives in the plane."""
        from_first = y[:, None] - self._first
        part = np.sum(from_first * self._way, axis=2) / np.sum(self._way**2, axis=1)
        held = np.clip(part, 0.0, 1.0)
        apart = from_first - held[..., None] * self._way
        distance = np.linalg.norm(apart, axis=2)
        height = np.sum(from_first * self._normal, axis=2)
        inside = height.max(axis=1) <= 0
        nearest = np.where(inside, np.argmax(height, axis=1), np.argmin(distance, axis=1))
        row = np.arange(len(y))
        on_side = inside | ((part[row, nearest] >= 0) & (part[row, nearest] <= 1))
        away = np.where(on_side, height[row, nearest], distance[row, nearest])
        safe = np.where(on_side, 1.0, away)
        corner = apart[row, nearest] / safe[:, None]
        normal = np.where(on_side[:, None], self._normal[nearest], corner)
        bend = (_EYE - normal[:, :, None] * normal[:, None, :]) / safe[:, None, None]
        bend = np.where(on_side[:, None, None], 0.0, bend)
        return Gap(away - self._rounding, normal, bend)


def _cross(a: Floats, b: Floats) -> Floats:
    out: Floats = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return out
