"""The section shapes; a new one is a file beside this one and a line in `SECTIONS`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from geometry.sections.blocks import Layout
from geometry.sections.circle import CircleActuator
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips, check_size, in_unit, own_unit

SECTIONS: dict[str, type[ShapedActuator]] = {
    HemicircleActuator.section: HemicircleActuator,
    RectangleActuator.section: RectangleActuator,
    CircleActuator.section: CircleActuator,
}
"""The actuators by the name of their section."""


def _shape(given: Mapping[str, Any]) -> tuple[type[ShapedActuator], dict[str, float | None]]:
    """The class that "section" names, and the dimensions beside it."""
    section = given["section"]
    if section not in SECTIONS:
        raise ValueError(f"section {section!r} is unknown: expected one of {', '.join(SECTIONS)}")
    return SECTIONS[section], {name: value for name, value in given.items() if name != "section"}


def inconsistencies(given: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Contradictions between dimensions that are valid one by one.

    Args:
        given: "section", and the dimensions of an actuator by name; None where one is absent.

    Yields:
        Name of a dimension and what is wrong with it.

    Raises:
        ValueError: an unknown section.
    """
    shape, dimensions = _shape(given)
    yield from shape.inconsistencies(dimensions)


def make_actuator(given: Mapping[str, Any]) -> ShapedActuator:
    """The actuator of a section that is given by its name.

    Args:
        given: "section", and the dimensions in mm by name; None where one is absent.

    Raises:
        ValueError: an unknown section, or dimensions without meaning or that it cannot have.
    """
    shape, dimensions = _shape(given)
    for name, text in shape.inconsistencies(dimensions):
        raise ValueError(f"{name}: {text}")
    return shape(**{name: value for name, value in dimensions.items() if value is not None})


def section_layout(
    actuator: ShapedActuator, size: MeshSize, strips: Strips | None = None
) -> Layout:
    """Lay out a section, with the blocks that fill the chamber in the caps.

    The point "pin" is (0, 0), on the lowest line of wall and floor, "crown" the highest point of
    the winding. Regions are "wall", "floor",
    "layer", "sheath"; named sides "chamber", "winding", "outer", "symmetry" (half only), and with
    `strips` "roof" and "post". Every surface inside the body is listed once, from the region that
    comes first.

    Args:
        actuator: dimensions.
        size: fineness; half or full section.
        strips: strips of roof and post, or None.

    Raises:
        ValueError: dimensions that this mesh cannot resolve.
    """
    check_size(actuator, size, strips)
    unit = own_unit(actuator)
    own = in_unit(actuator, unit)
    layout = own.layout(in_unit(size, unit), in_unit(strips, unit) if strips else None)
    layout.name_point("pin", (0.0, 0.0))
    layout.name_point("crown", (0.0, own.outline_top))
    return (layout if size.half else layout.mirrored()).scaled(unit)
