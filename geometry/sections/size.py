"""How fine a mesh is, and whether it can resolve the dimensions of an actuator."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any, TypeVar

from geometry.actuator import Actuator

MAX_ASPECT = 25.0
ROUND_OFF = 1e-9
"""Part of a length by which a quotient or a product of lengths may miss it."""
_DIGITS = 14
"""Digits of a length in an actuator's own unit: one fewer than a quotient keeps."""

Lengths = TypeVar("Lengths", bound="Actuator | MeshSize | Strips")


@dataclasses.dataclass(frozen=True)
class MeshSize:
    """Fineness of a mesh.

    Attributes:
        axial: target length of the elements along z in mm.
        section: refinement of the section; n gives n quads through wall, floor and sheath, 4 n
            along a quarter arc, 3 n along the half floor of a hemicircle and along the shorter of
            half width and height of a rectangle; tetrahedra have edges of axial / n.
        element: "hexahedron" or "tetrahedron".
        half: mesh x ≥ 0 only.
        borders: z in mm of planes across the chamber that no element crosses, in order.

    Raises:
        ValueError: a value outside these meanings.
    """

    axial: float = 1.5
    section: int = 1
    element: str = "hexahedron"
    half: bool = True
    borders: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not (math.isfinite(self.axial) and self.axial > 0):
            raise ValueError(f"axial {self.axial} mm: expected a positive length")
        if self.section < 1:
            raise ValueError(f"section refinement {self.section}: expected at least 1")
        if self.element not in ("hexahedron", "tetrahedron"):
            raise ValueError(f"element {self.element!r}: expected 'hexahedron' or 'tetrahedron'")

    def of_edges(self) -> MeshSize:
        """The same for tetrahedra: blocks as coarse as they may be, in edges of axial / section."""
        return dataclasses.replace(self, section=1, axial=self.axial / self.section)


@dataclasses.dataclass(frozen=True)
class Strips:
    """Strips of the outer surface on which a blocked tip is fixed; lengths in mm.

    Attributes:
        roof_half_width: the roof is |x| ≤ this on the top of the outer surface, 0 ≤ z ≤ L.
        post_length: the post is the last part of the tip cap's underside, this long. The underside
            of a circle is |x| ≤ roof_half_width.
    """

    roof_half_width: float
    post_length: float


def elements_through(thickness: str, size: MeshSize) -> int:
    """Number of quads through a "wall", "floor", "sheath" or "layer"."""
    return 1 if thickness == "layer" else size.section


def too_thin(actuator: Actuator, size: MeshSize) -> Iterator[tuple[str, str]]:
    """Thicknesses whose elements would be too flat.

    Yields:
        Name of the dimension, and a message with the least value it can have with this mesh.
    """
    above = actuator.wall_above_floor
    for name in actuator.region_areas():
        thickness = getattr(actuator, name)
        least = size.axial * elements_through(name, size) / MAX_ASPECT
        if thickness < least * (1 - ROUND_OFF):
            yield (
                name,
                f"{thickness:g} mm is too thin for elements {size.axial:g} mm long: "
                f"expected at least {least:g} mm",
            )
        elif name == "floor" and 0 < above < least * (1 - ROUND_OFF):
            most = f"{actuator.wall - least:g} mm or all of the wall, {actuator.wall:g} mm"
            yield (
                name,
                f"{thickness:g} mm leaves {above:.3g} mm of the wall, too thin for elements "
                f"{size.axial:g} mm long: expected at most {most}",
            )


def check_size(actuator: Actuator, size: MeshSize, strips: Strips | None = None) -> None:
    """Refuse a mesh whose elements would be too flat, or strips that do not fit.

    Args:
        actuator: dimensions.
        size: fineness.
        strips: strips of roof and post, or None.

    Raises:
        ValueError: names the dimension, and the least value it can have with this mesh.
    """
    for name, text in too_thin(actuator, size):
        raise ValueError(f"{name} {text}")
    if strips is None:
        return
    widest = actuator.profile.widest_roof
    if not 0 < strips.roof_half_width < widest:
        raise ValueError(
            f"roof half width {strips.roof_half_width:g} mm: expected more than 0 and less than "
            f"{widest:.4g} mm"
        )
    if not 0 < strips.post_length < actuator.cap:
        raise ValueError(
            f"post length {strips.post_length:g} mm: expected more than 0 and less than the cap, "
            f"{actuator.cap:g} mm"
        )


def own_unit(actuator: Actuator) -> float:
    """The power of ten in mm in which the half width of an actuator is about 3 to 30.

    Corners and nodes are found by their coordinates, and gmsh has tolerances of its own: in this
    unit a section of 8 µm or 8 m is laid out and meshed as one of 8 mm is.
    """
    return 10.0 ** round(math.log10(actuator.outer_half_width / 10))


def in_unit(lengths: Lengths, unit: float) -> Lengths:
    """Dimensions, a fineness or strips measured in a unit (mm), the same digits for every unit."""
    if unit == 1.0:  # exact: a power of ten, and mm themselves
        return lengths
    given = {field.name: getattr(lengths, field.name) for field in dataclasses.fields(lengths)}
    scaled: dict[str, Any] = {
        name: _in_unit(value, unit) for name, value in given.items() if isinstance(value, float)
    }
    scaled |= {
        name: tuple(_in_unit(part, unit) for part in value)
        for name, value in given.items()
        if isinstance(value, tuple)
    }
    return dataclasses.replace(lengths, **scaled)


def _in_unit(length: float, unit: float) -> float:
    return float(f"{length / unit:.{_DIGITS}g}")


def divisions(length: float, target: float) -> int:
    """Number of elements not longer than `target` that fill a length."""
    return max(1, math.ceil(length / target - ROUND_OFF))
