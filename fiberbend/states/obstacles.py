"""Rigid obstacles as surfaces that pictures and files show.

pyvista is imported where it is used: a run without output does without it.
"""

from __future__ import annotations

import dataclasses
from typing import Any, Protocol

import numpy as np

from geometry.mesh.data import Floats

_MARGIN = 0.15
"""By how much of the body's extent a sheet or a bar reaches beyond it."""
_FACETS = 64


class Shape(Protocol):
    """Shape of a rigid obstacle."""

    def surface(self, around: Floats) -> Any:
        """Its surface as a pyvista.PolyData, mm.

        Args:
            around: points of the body in all of its states, (n, 3), mm; what has no end of its own
                reaches a little beyond them.
        """


@dataclasses.dataclass(frozen=True)
class Box:
    """A block with its edges along the axes.

    Attributes:
        low: its corner of least x, y, z, mm.
        high: of greatest, mm.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def surface(self, around: Floats) -> Any:
        """Six faces."""
        import pyvista as pv

        pairs = zip(self.low, self.high, strict=True)
        return pv.Box(bounds=[value for pair in pairs for value in pair], quads=True)


@dataclasses.dataclass(frozen=True)
class Sheet:
    """A plane, of which a rectangle is shown.

    Attributes:
        point: one of its points, mm.
        normal: out of the obstacle, of any length above zero.
    """

    point: tuple[float, float, float]
    normal: tuple[float, float, float]

    def surface(self, around: Floats) -> Any:
        """A rectangle under the whole body."""
        import pyvista as pv

        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        # one edge along the axis of the body as nearly as the plane allows
        along = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
        if np.linalg.norm(along) < 1e-6:
            along = np.array([0.0, 1.0, 0.0])
        along /= np.linalg.norm(along)
        axes = np.stack([along, np.cross(normal, along)])
        flat = (around - self.point) @ axes.T
        reach = _MARGIN * np.ptp(around, axis=0).max()
        (a0, b0), (a1, b1) = flat.min(axis=0) - reach, flat.max(axis=0) + reach
        corners = np.array([[a0, b0], [a1, b0], [a1, b1], [a0, b1]])
        return pv.PolyData(np.array(self.point) + corners @ axes, faces=[4, 0, 1, 2, 3])


@dataclasses.dataclass(frozen=True)
class Bar:
    """A round bar along x.

    Attributes:
        center: y and z of its axis, mm.
        radius: mm.
    """

    center: tuple[float, float]
    radius: float

    def surface(self, around: Floats) -> Any:
        """A cylinder somewhat longer than the body is wide."""
        import pyvista as pv

        half = (1 + 2 * _MARGIN) * float(np.abs(around[:, 0]).max())
        return pv.Cylinder(
            center=(0.0, *self.center),
            direction=(1.0, 0.0, 0.0),
            radius=self.radius,
            height=2 * half,
            resolution=_FACETS,
        )
