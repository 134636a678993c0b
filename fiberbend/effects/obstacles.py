"""Rigid bodies that a body may touch, as a case gives them."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from pydantic import Field

from fiberbend.schema.quantities import Coordinate, Length, LengthOrZero, Spec

if TYPE_CHECKING:
    from fem.effects.contact import Obstacle
    from fiberbend.states.obstacles import Shape
    from geometry.actuator import Actuator
    from rod.contact.obstacles import Obstacle as Rigid

_ROOF_HEIGHT, _POST_HEIGHT = 2.0, 8.0
"""Heights in mm in which pictures show what has a lower or an upper face only."""
_POST_BEYOND = 0.08
"""By how much of the chamber's length a picture's post reaches beyond the tip at rest: the strip
that rests on it moves outward under pressure."""
EVERYWHERE = ("outer", "tip")
"""Surfaces that may touch an obstacle anywhere in space."""


class ObstacleSpec(Spec):
    """Anything rigid that a body may touch."""

    @property
    def surfaces(self) -> tuple[str, ...]:
        """Named surfaces of the body that may touch it."""
        return EVERYWHERE

    @abstractmethod
    def placed(self, actuator: Actuator) -> Obstacle:
        """The obstacle in space, beside an actuator at rest."""

    @abstractmethod
    def met(self, actuator: Actuator) -> Rigid:
        """The obstacle in space, as a rod meets it."""

    def strip(self) -> tuple[float, int] | None:
        """Width in mm of the strip under it, and beside how many of its sides the sheath goes on.

        None: what touches it is no strip.
        """
        return None

    @abstractmethod
    def shape(self, actuator: Actuator) -> Shape:
        """What a picture shows of it."""


class RoofSpec(ObstacleSpec):
    """A rigid, straight bar over the chamber."""

    gap: LengthOrZero = 0.0
    """Clearance at rest over the highest line of the body."""
    width: Length = 4.0
    """Width of the strip along the crown that may touch it."""

    @property
    def surfaces(self) -> tuple[str, ...]:
        """The strip along the crown."""
        return ("roof",)

    def placed(self, actuator: Actuator) -> Obstacle:
        """A plane above the crown."""
        from fem.effects.contact import Plane

        return Plane((0.0, actuator.outer_top + self.gap, 0.0), (0.0, -1.0, 0.0))

    def met(self, actuator: Actuator) -> Rigid:
        """The same plane."""
        return over_crown(actuator, self.gap)

    def strip(self) -> tuple[float, int]:
        """Along the crown."""
        return self.width, 2

    def shape(self, actuator: Actuator) -> Shape:
        """A bar along the chamber."""
        return roof_shape(actuator, self.width, self.gap)


class PostSpec(ObstacleSpec):
    """A rigid plane under the end of the tip cap."""

    gap: LengthOrZero = 0.0
    """Clearance at rest under the cap."""
    length: Length = 2.0
    """Length of the strip at the end of the tip cap's underside that may rest on it."""

    @property
    def surfaces(self) -> tuple[str, ...]:
        """The strip at the end of the tip cap."""
        return ("post",)

    def placed(self, actuator: Actuator) -> Obstacle:
        """A plane under the cap."""
        from fem.effects.contact import Plane

        return Plane((0.0, actuator.outer_bottom - self.gap, 0.0), (0.0, 1.0, 0.0))

    def met(self, actuator: Actuator) -> Rigid:
        """The same plane."""
        return under_cap(actuator, self.gap)

    def strip(self) -> tuple[float, int]:
        """Beyond its inner side the sheath goes on."""
        return self.length, 1

    def shape(self, actuator: Actuator) -> Shape:
        """A block under the end of the cap."""
        return post_shape(actuator, self.length, self.gap)


class PlaneSpec(ObstacleSpec):
    """A rigid plane; the body stays on the side to which its normal points."""

    point: tuple[Coordinate, Coordinate, Coordinate] = Field(strict=False)
    """x, y and z of one of its points; z = 0 is the root end of the chamber, y = 0 the lower face
    of the floor, and the body bends toward -y."""
    normal: tuple[float, float, float] = Field(strict=False)
    """Direction out of the obstacle, of any length; [0, 1, 0] is a table under the body."""

    def placed(self, actuator: Actuator) -> Obstacle:
        """The plane."""
        from fem.effects.contact import Plane

        return Plane(self.point, self.normal)

    def met(self, actuator: Actuator) -> Rigid:
        """The same plane."""
        from rod.contact.obstacles import Plane

        return Plane(self.point, self.normal)

    def shape(self, actuator: Actuator) -> Shape:
        """A sheet."""
        from fiberbend.states.obstacles import Sheet

        return Sheet(self.point, self.normal)


class CylinderSpec(ObstacleSpec):
    """A rigid round bar across the body, along x."""

    center: tuple[Coordinate, Coordinate] = Field(strict=False)
    """y and z of its axis."""
    radius: Length
    """Radius of the bar, at least half the length of an element."""

    def placed(self, actuator: Actuator) -> Obstacle:
        """The bar."""
        from fem.effects.contact import Cylinder

        return Cylinder(self.center, self.radius)

    def met(self, actuator: Actuator) -> Rigid:
        """The same bar."""
        from rod.contact.obstacles import Cylinder

        return Cylinder((0.0, *self.center), (1.0, 0.0, 0.0), self.radius)

    def shape(self, actuator: Actuator) -> Shape:
        """A bar."""
        from fiberbend.states.obstacles import Bar

        return Bar(self.center, self.radius)


def over_crown(actuator: Actuator, gap: float = 0.0) -> Rigid:
    """The plane of a roof, as a rod meets it; mm."""
    from rod.contact.obstacles import Plane

    return Plane((0.0, actuator.outer_top + gap, 0.0), (0.0, -1.0, 0.0))


def under_cap(actuator: Actuator, gap: float = 0.0) -> Rigid:
    """The plane of a post, as a rod meets it; mm."""
    from rod.contact.obstacles import Plane

    return Plane((0.0, actuator.outer_bottom - gap, 0.0), (0.0, 1.0, 0.0))


def roof_shape(actuator: Actuator, width: float, gap: float = 0.0) -> Shape:
    """A bar over the whole chamber, 0 ≤ z ≤ L, as wide as the strip that touches it; mm."""
    from fiberbend.states.obstacles import Box

    low = actuator.outer_top + gap
    return Box((-width / 2, low, 0.0), (width / 2, low + _ROOF_HEIGHT, actuator.length))


def post_shape(actuator: Actuator, length: float, gap: float = 0.0) -> Shape:
    """A block under the last piece of the tip cap wherever that moves, as wide as the body; mm."""
    from fiberbend.states.obstacles import Box

    half, end = actuator.outer_half_width, actuator.length + actuator.cap
    top, beyond = actuator.outer_bottom - gap, _POST_BEYOND * actuator.length
    return Box((-half, top - _POST_HEIGHT, end - length), (half, top, end + beyond))
