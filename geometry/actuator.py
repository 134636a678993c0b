"""Dimensions of an actuator and the closed forms that follow from them.

y = 0 is the lowest line of wall and floor together; a separate layer and the sheath lie below it.
"""

from __future__ import annotations

import abc
import dataclasses
import functools
import math
from typing import ClassVar, NamedTuple

Point = tuple[float, float]


class Side(NamedTuple):
    """A straight line or an arc of less than half a turn, a piece of the winding's outline."""

    name: str
    """For labels."""
    start: Point
    """First end in mm."""
    end: Point
    """Last end in mm."""
    center: Point | None = None
    """Centre of the circle, or None for a straight line."""


@dataclasses.dataclass(frozen=True)
class Profile:
    """Lengths in mm and areas in mm² of a section.

    Attributes:
        half_width: half of the chamber's greatest width.
        bottom: y of the chamber's lowest line.
        top: y of its highest line.
        outline_bottom: y of the winding's lowest line.
        chamber_area: area of the chamber.
        chamber_centroid: y of the chamber's centroid.
        outer_centroid: y of the centroid of the area inside the outer surface.
        inlays: area of each region inside the outline beside chamber and wall, that is of "floor"
            and "layer" where the section has them.
        outline_area: area inside the winding's outline.
        outer_area: area inside the outer surface.
        perimeter: perimeter of the winding's outline.
        widest_roof: half widths of a roof on the top of the section lie below this.
    """

    half_width: float
    bottom: float
    top: float
    outline_bottom: float
    chamber_area: float
    chamber_centroid: float
    outer_centroid: float
    inlays: dict[str, float]
    outline_area: float
    outer_area: float
    perimeter: float
    widest_roof: float


@dataclasses.dataclass(frozen=True, kw_only=True)
class Actuator(abc.ABC):
    """A soft bending actuator; all lengths in mm.

    x is lateral, y points up from the lower face of the floor, z runs along the axis; the section
    is symmetric about x = 0. The chamber reaches over 0 ≤ z ≤ `length`. The shape of the section
    is a subclass, which adds its own dimensions; a region (floor, sheath, …) is named after the
    dimension that is its thickness.

    Attributes:
        length: length of the chamber, L.
        wall: thickness of the wall around the chamber, t.
        sheath: thickness of the sheath around everything, s, or None.
        cap: length of each of the two solid end caps.

    Raises:
        ValueError: a dimension that is not a positive finite number.
    """

    section: ClassVar[str]
    """Name of the section's shape."""

    length: float
    wall: float
    sheath: float | None = None
    cap: float

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if value is None and field.default is None:
                continue
            if value is None or not (math.isfinite(value) and value > 0):
                raise ValueError(f"{field.name} {value} mm: expected a positive length")

    @abc.abstractmethod
    def closed_forms(self) -> Profile:
        """Lengths and areas of the section."""

    @abc.abstractmethod
    def outline(self) -> tuple[Side, ...]:
        """The line on which the winding lies: its half x ≥ 0, from the top to the bottom."""

    @functools.cached_property
    def profile(self) -> Profile:
        """Closed forms of the section, computed once."""
        return self.closed_forms()

    @property
    def alike_around(self) -> bool:
        """Every line through the section's centre is an axis of its symmetry."""
        return False

    @property
    def wall_above_floor(self) -> float:
        """Thickness in mm of the wall between the chamber and a floor that is part of the wall."""
        return 0.0

    @property
    def outline_half_width(self) -> float:
        """Half width of the winding's outline; of round parts the radius a + t."""
        return self.profile.half_width + self.wall

    @property
    def outer_half_width(self) -> float:
        """Half width of the whole section; of round parts the outer radius a + t + s."""
        return self.outline_half_width + (self.sheath or 0.0)

    @property
    def outline_bottom(self) -> float:
        """Y of the winding's lowest line."""
        return self.profile.outline_bottom

    @property
    def outline_top(self) -> float:
        """Y of the winding's highest line."""
        return self.profile.top + self.wall

    @property
    def outer_bottom(self) -> float:
        """Y of the lowest line."""
        return self.outline_bottom - (self.sheath or 0.0)

    @property
    def outer_top(self) -> float:
        """Y of the highest line."""
        return self.outline_top + (self.sheath or 0.0)

    @property
    def total_length(self) -> float:
        """Length with both caps."""
        return self.length + 2 * self.cap

    @property
    def winding_perimeter(self) -> float:
        """Perimeter S of the winding's outline."""
        return self.profile.perimeter

    @property
    def chamber_area(self) -> float:
        """Area of the chamber's section in mm²."""
        return self.profile.chamber_area

    @property
    def chamber_moment(self) -> float:
        """First moment κ of the chamber's section about y = 0 in mm³: torque per pressure."""
        return self.profile.chamber_area * self.profile.chamber_centroid

    @property
    def face_height(self) -> float:
        """Y in mm of the centroid of a cap's outer face."""
        return self.profile.outer_centroid

    @property
    def chamber_volume(self) -> float:
        """Volume of the chamber in mm³."""
        return self.chamber_area * self.length

    def region_areas(self) -> dict[str, float]:
        """Area in mm² of each region of a section between the caps."""
        p = self.profile
        areas = {"wall": p.outline_area - p.chamber_area - sum(p.inlays.values()), **p.inlays}
        if self.sheath is not None:
            areas["sheath"] = p.outer_area - p.outline_area
        return areas

    def region_volumes(self) -> dict[str, float]:
        """Volume in mm³ of each region of the whole body; the caps' fill belongs to the wall."""
        volumes = {name: area * self.total_length for name, area in self.region_areas().items()}
        volumes["wall"] += 2 * self.cap * self.chamber_area
        return volumes
