"""Shapes of rigid obstacles: as surfaces in space, and as the plane of bending, x = 0, cuts them.

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
_NEAR = 1.0
"""So many mm on either side of a nearest point are near, too."""
_STRIP = 0.03
"""Thickness of the strip that stands for a plane, as a part of what is shown."""
_PIECES = 81
_CIRCLE = np.linspace(0.0, 2 * np.pi, 181)

Extent = tuple[Floats, Floats]
"""Least and greatest z and y, (2,) each, mm."""


class Shape(Protocol):
    """Shape of a rigid obstacle."""

    def surface(self, around: Floats) -> Any:
        """Its surface as a pyvista.PolyData, mm.

        Args:
            around: points of the body in all of its states, (n, 3), mm; what has no end of its own
                reaches a little beyond them.
        """

    def cut(self, size: Floats) -> Floats | None:
        """Corners of what x = 0 cuts, z and y, (n, 2), mm; None where it cuts nothing.

        What has no end is longer than all that is shown; its first two corners are the ends of its
        surface.

        Args:
            size: of what is shown, z and y, (2,), mm.
        """

    def nearest(self, path: Floats) -> Extent | None:
        """What of it is to be seen beside points in x = 0; None where x = 0 cuts nothing.

        Args:
            path: z and y, (n, 2), mm.
        """

    def wires(self, limits: Floats) -> list[Floats]:
        """Lines along its edges, x, y and z, (n, 3), mm, finely divided.

        Args:
            limits: least and greatest x, y, z that are shown, (2, 3), mm.
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

    @property
    def _extent(self) -> Extent:
        return np.array(self.low[:0:-1]), np.array(self.high[:0:-1])

    def surface(self, around: Floats) -> Any:
        """Six faces."""
        import pyvista as pv

        pairs = zip(self.low, self.high, strict=True)
        return pv.Box(bounds=[value for pair in pairs for value in pair], quads=True)

    def cut(self, size: Floats) -> Floats:
        """A rectangle."""
        (z0, y0), (z1, y1) = self._extent
        return np.array([[z0, y0], [z1, y0], [z1, y1], [z0, y1]])

    def nearest(self, path: Floats) -> Extent:
        """Its point nearest to the middle of the path."""
        point = np.clip(path.mean(axis=0), *self._extent)
        return point - _NEAR, point + _NEAR

    def wires(self, limits: Floats) -> list[Floats]:
        """Its twelve edges."""
        ends = np.array([self.low, self.high])
        lines = []
        for axis in range(3):
            a, b = (other for other in range(3) if other != axis)
            for i in (0, 1):
                for j in (0, 1):
                    pair = np.empty((2, 3))
                    pair[:, axis], pair[:, a], pair[:, b] = ends[:, axis], ends[i, a], ends[j, b]
                    lines.append(_divided(*pair))
        return lines


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

    def cut(self, size: Floats) -> Floats | None:
        """A strip on its far side."""
        line = self._line()
        if line is None:
            return None
        point, normal = line
        along = np.array([-normal[1], normal[0]]) * 10 * (np.abs(point).max() + size.max())
        thick = -_STRIP * size.min() * normal
        ends = np.stack([point - along, point + along])
        return np.concatenate([ends, ends[::-1] + thick])

    def nearest(self, path: Floats) -> Extent | None:
        """The foot of the point of the path that is nearest to it, or deepest in it."""
        line = self._line()
        if line is None:
            return None
        point, normal = line
        above = (path - point) @ normal
        foot = path[above.argmin()] - above.min() * normal
        return foot - _NEAR, foot + _NEAR

    def wires(self, limits: Floats) -> list[Floats]:
        """A grid of six lines each way."""
        low, high = limits
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        # the coordinate that the plane gives from the two others
        axis = int(np.abs(normal).argmax())
        others = [other for other in range(3) if other != axis]
        lines = []
        for across in others:
            for part in np.linspace(0.0, 1.0, 6):
                line = _divided(low, high)
                line[:, across] = low[across] + part * (high[across] - low[across])
                rest = (line[:, others] - np.array(self.point)[others]) @ normal[others]
                line[:, axis] = self.point[axis] - rest / normal[axis]
                lines.append(line)
        return lines

    def _line(self) -> tuple[Floats, Floats] | None:
        """A point and the normal, z and y each, of where it meets x = 0; None if it does not."""
        whole = np.array(self.normal) / np.linalg.norm(self.normal)
        normal, length = whole[:0:-1], float(np.linalg.norm(whole[1:]))
        if length < 1e-6:
            return None
        # n · (p − point) = 0 with x = 0
        point = np.array(self.point[:0:-1]) + normal * whole[0] * self.point[0] / length**2
        return point, normal / length


@dataclasses.dataclass(frozen=True)
class Bar:
    """A round bar along x.

    Attributes:
        center: y and z of its axis, mm.
        radius: mm.
    """

    center: tuple[float, float]
    radius: float

    @property
    def _extent(self) -> Extent:
        center = np.array(self.center[::-1])
        return center - self.radius, center + self.radius

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

    def cut(self, size: Floats) -> Floats:
        """A circle."""
        circle = np.column_stack([np.cos(_CIRCLE), np.sin(_CIRCLE)])
        return np.array(self.center[::-1]) + self.radius * circle

    def nearest(self, path: Floats) -> Extent:
        """All of it."""
        return self._extent

    def wires(self, limits: Floats) -> list[Floats]:
        """Both rims and four lines along it, as long as what is shown."""
        z, y = self.cut(np.ptp(limits, axis=0)).T
        rims = [np.column_stack([np.full_like(y, x), y, z]) for x in limits[:, 0]]
        return [*rims, *(_divided(rims[0][i], rims[1][i]) for i in (0, 45, 90, 135))]


def _divided(start: Floats, end: Floats) -> Floats:
    return np.linspace(start, end, _PIECES)
