"""Dimensions of an actuator and the closed forms that follow from them."""

from __future__ import annotations

import dataclasses
import functools
import math

from geometry.sections.profiles import PROFILES, Profile, misfits

SECTIONS = tuple(PROFILES)
"""Names of the section shapes."""


@dataclasses.dataclass(frozen=True)
class Actuator:
    """A soft bending actuator; all lengths in mm.

    x is lateral, y points up from the lower face of the floor, z runs along the axis; the section
    is symmetric about x = 0. The chamber reaches over 0 ≤ z ≤ `length`. Its section is

    - hemicircle: the half disk of radius `radius` on the line y = `floor`; the wall goes around
      the arc, the floor reaches from y = 0 to `floor` over the width of chamber and walls;
    - rectangle: `width` × `height` on the line y = `floor`; walls at both sides and on top, the
      floor as above; all corners are sharp;
    - circle: the disk of radius `radius` about (0, `radius` + `wall`), in a concentric wall that
      touches y = 0. The floor is the outer `floor` of the wall's thickness over the lowest quarter
      of the ring, |angle from −y| ≤ 45°; without it the section is a plain tube.

    Attributes:
        radius: radius of a hemicircle or circle, a; None for a rectangle.
        length: length of the chamber, L.
        wall: thickness of the wall around the chamber, t.
        floor: thickness of the floor, b; None for a plain tube only.
        sheath: thickness of the sheath around everything, s, or None.
        cap: length of each of the two solid end caps.
        layer: thickness of a separate strain-limiting layer below the flat floor, h, or None.
        section: shape of the section, one of `SECTIONS`.
        width: width of a rectangle's chamber, else None.
        height: height of a rectangle's chamber, else None.

    Raises:
        ValueError: a dimension that is not a positive finite number, that the section misses or
            has no use for, or an unknown section.
    """

    radius: float | None
    length: float
    wall: float
    floor: float | None
    sheath: float | None
    cap: float
    layer: float | None = None
    section: str = "hemicircle"
    width: float | None = None
    height: float | None = None

    def __post_init__(self) -> None:
        if self.section not in SECTIONS:
            raise ValueError(
                f"section {self.section!r} is unknown: expected one of {', '.join(SECTIONS)}"
            )
        given = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        for name, value in given.items():
            if isinstance(value, float | int) and not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} {value} mm: expected a positive length")
        for name, text in misfits(given):
            raise ValueError(f"{name}: {text}")

    @functools.cached_property
    def profile(self) -> Profile:
        """Closed forms of the section."""
        return PROFILES[self.section](self)

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
        """Y of the winding's lowest line, −h."""
        return -(self.layer or 0.0)

    @property
    def outline_top(self) -> float:
        """Y of the winding's highest line."""
        return self.profile.top + self.wall

    @property
    def outer_bottom(self) -> float:
        """Y of the lowest line, −h − s."""
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
        areas = {"wall": p.outline_area - p.chamber_area - p.floor_area - p.layer_area}
        if self.floor is not None:
            areas["floor"] = p.floor_area
        if self.layer is not None:
            areas["layer"] = p.layer_area
        if self.sheath is not None:
            areas["sheath"] = p.outer_area - p.outline_area
        return areas

    def region_volumes(self) -> dict[str, float]:
        """Volume in mm³ of each region of the whole body; the caps' fill belongs to the wall."""
        volumes = {name: area * self.total_length for name, area in self.region_areas().items()}
        volumes["wall"] += 2 * self.cap * self.chamber_area
        return volumes
