"""The convex hull of a section's outline, and how deep a point lies in it."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from rod.functions import Floats

SHARPNESS = 500.0
"""β times the size of the outline: corners are rounded by ln 2/β, so that forces turn smoothly."""


@dataclasses.dataclass(frozen=True)
class Hull:
    """A convex polygon.

    Attributes:
        corners: x and y, (k, 2), mm, counter-clockwise; they are the points that touch as well.

    Raises:
        ValueError: fewer than three corners, or not convex and counter-clockwise.
    """

    corners: Floats

    def __post_init__(self) -> None:
        corners = np.asarray(self.corners, dtype=float)
        if corners.ndim != 2 or corners.shape[1:] != (2,) or len(corners) < 3:
            raise ValueError("hull: at least three corners x, y expected")
        before, after = self._edges, np.roll(self._edges, -1, axis=0)
        turns = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        if not turns.min() > -1e-9 * self.size**2 or not turns.sum() > 0:
            raise ValueError("hull: convex and counter-clockwise corners expected")

    @property
    def _edges(self) -> Floats:
        """From each corner to the next, (k, 2)."""
        out: Floats = np.roll(self.corners, -1, axis=0) - self.corners
        return out

    @functools.cached_property
    def size(self) -> float:
        """Greatest extent along x or y, mm."""
        return float(np.ptp(self.corners, axis=0).max())

    @functools.cached_property
    def reach(self) -> float:
        """Of the corner farthest from the line, mm."""
        return float(np.linalg.norm(self.corners, axis=1).max())

    @functools.cached_property
    def shares(self) -> Floats:
        """Length of the outline that each corner stands for, (k,), mm."""
        lengths = np.linalg.norm(self._edges, axis=1)
        out: Floats = (lengths + np.roll(lengths, 1)) / 2
        return out

    @functools.cached_property
    def sides(self) -> tuple[Floats, Floats]:
        """Outward normals, (s, 2), and their distances from the line, (s,), mm, of all sides.

        What corners divide is one side.
        """
        edges = self._edges
        normals = np.column_stack([edges[:, 1], -edges[:, 0]])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        apart = np.abs(normals - np.roll(normals, 1, axis=0)).max(axis=1) > 1e-6
        normals = normals[apart]
        return normals, np.sum(normals * self.corners[apart], axis=1)

    @property
    def sharpness(self) -> float:
        """β, 1/mm."""
        return SHARPNESS / self.size

    def distance(self, points: Floats) -> Floats:
        """From points, (p, 2), to the polygon, (p,), mm; below zero within it."""
        normals, offsets = self.sides
        within: Floats = (points @ normals.T - offsets).max(axis=1)
        edges = self._edges
        to = points[:, None] - self.corners
        along = np.sum(to * edges, axis=2) / np.sum(edges**2, axis=1)
        foot = to - np.clip(along, 0.0, 1.0)[..., None] * edges
        without = np.linalg.norm(foot, axis=2).min(axis=1)
        out: Floats = np.where(within > 0, without, within)
        return out


def greatest(values: Floats, slopes: Floats, sharpness: float) -> tuple[Floats, Floats, Floats]:
    """ln Σ exp(β v)/β, a smooth greatest of values that are linear in some coordinates.

    Args:
        values: v, (p, s), mm.
        slopes: of each value, (s, c).
        sharpness: β, 1/mm.

    Returns:
        It, (p,), its slope by the coordinates, (p, c), and their matrix of second derivatives,
        (p, c, c).
    """
    top = values.max(axis=1)
    powers = np.exp(sharpness * (values - top[:, None]))
    total = powers.sum(axis=1)
    shares = powers / total[:, None]
    slope = shares @ slopes
    square = np.einsum("ps,si,sj->pij", shares, slopes, slopes)
    curved = sharpness * (square - slope[:, :, None] * slope[:, None, :])
    return top + np.log(total) / sharpness, slope, curved
