"""Rigid bodies that a body may touch, as a case gives them."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from pydantic import Field

from fiberbend.schema.quantities import Length, Model, Position, Width

if TYPE_CHECKING:
    from fem.effects.contact import Obstacle as Placed
    from geometry.actuator import Actuator

EVERYWHERE = ("outer", "tip")
"""Surfaces that may touch an obstacle anywhere in space."""


class Obstacle(Model):
    """Anything rigid that a body may touch."""

    @property
    def surfaces(self) -> tuple[str, ...]:
        """Named surfaces of the body that may touch it."""
        return EVERYWHERE

    @abstractmethod
    def placed(self, actuator: Actuator) -> Placed:
        """The obstacle in space, beside an actuator at rest."""


class Roof(Obstacle):
    """A rigid, straight bar over the chamber."""

    gap: Width = 0.0
    """Clearance at rest over the highest line of the body."""
    width: Length = 4.0
    """Width of the strip along the crown that may touch it."""

    @property
    def surfaces(self) -> tuple[str, ...]:
        """The strip along the crown."""
        return ("roof",)

    def placed(self, actuator: Actuator) -> Placed:
        """A plane above the crown."""
        from fem.effects.contact import Plane as Face

        return Face((0.0, actuator.outer_top + self.gap, 0.0), (0.0, -1.0, 0.0))


class Post(Obstacle):
    """A rigid plane under the end of the tip cap."""

    gap: Width = 0.0
    """Clearance at rest under the cap."""
    length: Length = 2.0
    """Length of the strip at the end of the tip cap's underside that may rest on it."""

    @property
    def surfaces(self) -> tuple[str, ...]:
        """The strip at the end of the tip cap."""
        return ("post",)

    def placed(self, actuator: Actuator) -> Placed:
        """A plane under the cap."""
        from fem.effects.contact import Plane as Face

        return Face((0.0, actuator.outer_bottom - self.gap, 0.0), (0.0, 1.0, 0.0))


class Plane(Obstacle):
    """A rigid plane; the body stays on the side to which its normal points."""

    point: tuple[Position, Position, Position] = Field(strict=False)
    """x, y and z of one of its points; z = 0 is the root end of the chamber, y = 0 the lower face
    of the floor, and the body bends toward -y."""
    normal: tuple[float, float, float] = Field(strict=False)
    """Direction out of the obstacle, of any length; [0, 1, 0] is a table under the body."""

    def placed(self, actuator: Actuator) -> Placed:
        """The plane."""
        from fem.effects.contact import Plane as Face

        return Face(self.point, self.normal)


class Cylinder(Obstacle):
    """A rigid round bar across the body, along x."""

    center: tuple[Position, Position] = Field(strict=False)
    """y and z of its axis."""
    radius: Length
    """Radius of the bar."""

    def placed(self, actuator: Actuator) -> Placed:
        """The bar."""
        from fem.effects.contact import Cylinder as Bar

        return Bar(self.center, self.radius)
