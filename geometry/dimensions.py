"""Dimensions of an actuator and the closed forms that follow from them."""

from __future__ import annotations

import dataclasses
import math


@dataclasses.dataclass(frozen=True)
class Actuator:
    """A soft bending actuator with a hemicircular section; all lengths in mm.

    x is lateral, y points up from the lower face of the floor, z runs along the axis. The chamber
    is the half disk of radius `radius` on the line y = `floor`, for 0 ≤ z ≤ `length`.

    Attributes:
        radius: radius of the chamber, a.
        length: length of the chamber, L.
        wall: thickness of the wall around the half disk, t.
        floor: thickness of the floor, b; it reaches from y = 0 to b over |x| ≤ a + t.
        sheath: thickness of the sheath around everything, s, or None.
        cap: length of each of the two solid end caps.
        layer: thickness of a separate strain-limiting layer below y = 0, h, or None.
        section: shape of the section; "hemicircle".

    Raises:
        ValueError: a dimension that is not a positive finite number, or an unknown section.
    """

    radius: float
    length: float
    wall: float
    floor: float
    sheath: float | None
    cap: float
    layer: float | None = None
    section: str = "hemicircle"

    def __post_init__(self) -> None:
        if self.section != "hemicircle":
            raise ValueError(f"section {self.section!r} is unknown: expected 'hemicircle'")
        for name in ("radius", "length", "wall", "floor", "sheath", "cap", "layer"):
            value = getattr(self, name)
            if value is None:
                continue
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} {value} mm: expected a positive length")

    @property
    def outline_radius(self) -> float:
        """Radius of the winding's arc, a + t."""
        return self.radius + self.wall

    @property
    def outer_radius(self) -> float:
        """Radius of the outermost arc, a + t + s."""
        return self.outline_radius + (self.sheath or 0.0)

    @property
    def outline_bottom(self) -> float:
        """Y of the winding's lower side, −h."""
        return -(self.layer or 0.0)

    @property
    def outer_bottom(self) -> float:
        """Y of the lowest points, −h − s."""
        return self.outline_bottom - (self.sheath or 0.0)

    @property
    def outline_height(self) -> float:
        """Height of the winding's outline, h + b + a + t."""
        return self.floor + self.outline_radius - self.outline_bottom

    @property
    def outer_height(self) -> float:
        """Height of the whole section."""
        return self.floor + self.outer_radius - self.outer_bottom

    @property
    def total_length(self) -> float:
        """Length with both caps."""
        return self.length + 2 * self.cap

    @property
    def winding_perimeter(self) -> float:
        """Perimeter S of the winding's outline: arc, two sides, bottom."""
        r = self.outline_radius
        return math.pi * r + 2 * (self.floor - self.outline_bottom) + 2 * r

    @property
    def chamber_area(self) -> float:
        """Area of the chamber's section in mm²."""
        return math.pi * self.radius**2 / 2

    @property
    def chamber_volume(self) -> float:
        """Volume of the chamber in mm³."""
        return self.chamber_area * self.length

    def region_areas(self) -> dict[str, float]:
        """Area in mm² of each region of a section between the caps."""
        r, outer = self.outline_radius, self.outer_radius
        areas = {"wall": math.pi * (r**2 - self.radius**2) / 2, "floor": 2 * r * self.floor}
        if self.layer is not None:
            areas["layer"] = 2 * r * self.layer
        if self.sheath is not None:
            sides = 2 * self.sheath * (self.floor - self.outline_bottom)
            bottom = 2 * outer * self.sheath
            areas["sheath"] = math.pi * (outer**2 - r**2) / 2 + sides + bottom
        return areas

    def region_volumes(self) -> dict[str, float]:
        """Volume in mm³ of each region of the whole body; the caps' fill belongs to the wall."""
        volumes = {name: area * self.total_length for name, area in self.region_areas().items()}
        volumes["wall"] += 2 * self.cap * self.chamber_area
        return volumes
