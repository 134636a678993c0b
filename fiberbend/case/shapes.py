"""The shapes of elements that `mesh.element` takes, with what others ask of them."""

from __future__ import annotations

import dataclasses


@dataclasses.dataclass(frozen=True)
class Shape:
    """A shape of elements.

    Attributes:
        plural: in words.
        short: on a picture; empty for the usual one.
        one_size: it has one size in all directions, `mesh.axial` over `mesh.section`; else
            section and axis are refined each by itself.
    """

    plural: str
    short: str
    one_size: bool


SHAPES = {
    "hexahedron": Shape("hexahedra", "", one_size=False),
    "tetrahedron": Shape("tetrahedra", "tets", one_size=True),
}
"""By the names in a case; the usual one first, whose limits others are compared with."""
