"""Rigid bodies that a hand grasps or rests on; they keep their place."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pydantic import Field

from fiberbend.hand.pose import Mirror, Triple, dot, unit
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Coordinate, Length, Spec

if TYPE_CHECKING:
    from geometry.mesh.data import Floats
    from rod.contact.obstacles import Obstacle

_FACETS = 64
_BEYOND = 0.25
"""By how much of the hand's extent a picture shows more of what has no end."""

_PARALLEL = 1e-12
"""Of the cosine of an angle of a millionth."""

Direction = tuple[float, float, float]


class ObjectSpec(Spec):
    """Anything rigid."""

    def problems(self, path: str) -> Iterator[Problem]:
        """What is wrong with it beyond single values."""
        yield from ()

    @property
    @abstractmethod
    def middle(self) -> Triple:
        """The point about which its moment is, mm."""

    @abstractmethod
    def mirrored(self, mirror: Mirror) -> bool:
        """Whether it is the same in a mirror."""

    @abstractmethod
    def rigid(self) -> Obstacle:
        """Its distance from points."""

    @abstractmethod
    def surface(self, around: Floats) -> Any:
        """A pyvista.PolyData, mm.

        Args:
            around: points of all fingers, (n, 3), mm; what has no end reaches beyond them.
        """


class PlaneSpec(ObjectSpec):
    """A plane: a table, a wall."""

    point: tuple[Coordinate, Coordinate, Coordinate] = Field(strict=False)
    """x, y and z of one of its points, in the axes of the hand."""
    normal: Direction = Field(strict=False)
    """Direction out of it, toward the fingers, of any length."""

    def problems(self, path: str) -> Iterator[Problem]:
        """A direction is needed."""
        if not any(self.normal):
            yield Problem(f"{path}.normal", "[0, 0, 0], expected a direction")

    @property
    def middle(self) -> Triple:
        """Its point."""
        return self.point

    def mirrored(self, mirror: Mirror) -> bool:
        """Where its normal lies in the mirror."""
        return mirror.keeps(unit(self.normal))

    def rigid(self) -> Obstacle:
        """The half space behind it."""
        from rod.contact.obstacles import Plane

        return Plane(self.point, self.normal)

    def surface(self, around: Floats) -> Any:
        """A thin plate below the fingers."""
        import numpy as np
        import pyvista as pv

        normal = np.array(unit(self.normal))
        along = np.eye(3)[int(np.abs(normal).argmin())]
        along -= normal * (normal @ along)
        along /= np.linalg.norm(along)
        axes = np.stack([along, np.cross(normal, along)])
        flat = (around - self.point) @ axes.T
        reach = _BEYOND * np.ptp(around, axis=0).max()
        (a0, b0), (a1, b1) = flat.min(axis=0) - reach, flat.max(axis=0) + reach
        corners = np.array([[a0, b0], [a1, b0], [a1, b1], [a0, b1]])
        sheet = pv.PolyData(np.array(self.point) + corners @ axes, faces=[4, 0, 1, 2, 3])
        thick = 0.02 * float(np.linalg.norm(np.ptp(around, axis=0)))
        return sheet.extrude(-thick * normal, capping=True).triangulate()


class CylinderSpec(ObjectSpec):
    """A round bar of any direction."""

    center: tuple[Coordinate, Coordinate, Coordinate] = Field(strict=False)
    """x, y and z of a point of its axis, of the middle where it has ends."""
    axis: Direction = Field(strict=False)
    """Direction of its axis, of any length."""
    radius: Length
    """Radius of the bar."""
    length: Length | None = None
    """From one flat end to the other; without it the bar has no end."""

    def problems(self, path: str) -> Iterator[Problem]:
        """A direction is needed."""
        if not any(self.axis):
            yield Problem(f"{path}.axis", "[0, 0, 0], expected a direction")

    @property
    def middle(self) -> Triple:
        """Its center."""
        return self.center

    def mirrored(self, mirror: Mirror) -> bool:
        """Where its axis lies in the mirror, or stands on it and is cut in the middle."""
        axis = unit(self.axis)
        if mirror.keeps(axis):
            return mirror.holds(self.center, self.radius)
        across = abs(abs(dot(axis, mirror.normal)) - 1) < _PARALLEL
        return across and (self.length is None or mirror.holds(self.center, self.radius))

    def rigid(self) -> Obstacle:
        """The bar."""
        import math

        from rod.contact.obstacles import Cylinder

        length = math.inf if self.length is None else self.length
        return Cylinder(self.center, self.axis, self.radius, length)

    def surface(self, around: Floats) -> Any:
        """A cylinder, beyond the fingers where it has no end."""
        import numpy as np
        import pyvista as pv

        axis, center = np.array(unit(self.axis)), np.array(self.center)
        length = self.length
        if length is None:
            along = (around - center) @ axis
            reach = _BEYOND * float(np.ptp(along)) + 2 * self.radius
            low, high = float(along.min()) - reach, float(along.max()) + reach
            center, length = center + (low + high) / 2 * axis, high - low
        return pv.Cylinder(
            center=center, direction=axis, radius=self.radius, height=length, resolution=_FACETS
        ).triangulate()


class SphereSpec(ObjectSpec):
    """A ball."""

    center: tuple[Coordinate, Coordinate, Coordinate] = Field(strict=False)
    """x, y and z of its center."""
    radius: Length
    """Radius of the ball."""

    @property
    def middle(self) -> Triple:
        """Its center."""
        return self.center

    def mirrored(self, mirror: Mirror) -> bool:
        """Where its center lies in the mirror."""
        return mirror.holds(self.center, self.radius)

    def rigid(self) -> Obstacle:
        """The ball."""
        from rod.contact.obstacles import Sphere

        return Sphere(self.center, self.radius)

    def surface(self, around: Floats) -> Any:
        """A sphere."""
        import pyvista as pv

        return pv.Sphere(
            radius=self.radius,
            center=self.center,
            theta_resolution=_FACETS,
            phi_resolution=_FACETS // 2,
        )


class Objects(Spec):
    """What the fingers may touch; at most one of each kind."""

    plane: PlaneSpec | None = None
    """A table or a wall."""
    cylinder: CylinderSpec | None = None
    """A round bar."""
    sphere: SphereSpec | None = None
    """A ball."""

    @property
    def each(self) -> dict[str, ObjectSpec]:
        """Those that are there, by name."""
        every: dict[str, ObjectSpec | None] = {
            "plane": self.plane,
            "cylinder": self.cylinder,
            "sphere": self.sphere,
        }
        return {name: item for name, item in every.items() if item is not None}
