"""How the sheath of an actuator yields under a strip that presses on it.

A layer of incompressible rubber of thickness h and Young's modulus E, bonded below, goes on beside
a rigid strip of width w without friction: mean pressure over mean depth is f E/h. The factors f are
those of plane strain and small strains, solved by elements (tests/slender/layer.py), for a layer
that goes on at both sides of the strip and for one that ends where the strip ends. Of a wide strip
f = (w/h)²/12, which is lubrication's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from geometry.actuator import Actuator
from materials.material import Material

WIDTHS = (0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0)
"""w/h."""
FACTORS = {
    2: (4.683, 3.635, 3.439, 4.161, 5.231, 6.507, 7.965, 9.585, 13.36, 17.81, 22.93, 35.17),
    1: (2.300, 1.960, 1.973, 2.446, 3.152, 4.046, 5.117, 6.355, 9.350, 13.02, 17.36, 28.04),
}
"""f by the number of sides to which the layer goes on."""


class Sheathed(Protocol):
    """An actuator and what it is of."""

    @property
    def actuator(self) -> Actuator:
        """Its dimensions."""

    @property
    def materials(self) -> Mapping[str, Material]:
        """Of its parts."""


def layer_factor(width: float, sides: int) -> float:
    """f, in logarithms between those that are known.

    Beyond them it is lubrication's, of a strip that is wider by as much as the last one shows.

    Args:
        width: w/h.
        sides: to which the layer goes on, 1 or 2.
    """
    if width > WIDTHS[-1]:
        wider = math.sqrt(12 * FACTORS[sides][-1]) - WIDTHS[-1]
        return (width + wider) ** 2 / 12
    known, found = np.log(WIDTHS), np.log(FACTORS[sides])
    at = math.log(width)
    place = min(max(int(np.searchsorted(known, at)), 1), len(known) - 1)
    part = (at - known[place - 1]) / (known[place] - known[place - 1])
    return math.exp((1 - part) * found[place - 1] + part * found[place])


def under_strip(site: Sheathed, width: float, sides: int, obstacle: float) -> tuple[float, float]:
    """Stiffness of obstacle and sheath one behind the other.

    Args:
        site: the actuator with its materials.
        width: of the strip, mm.
        sides: to which the sheath goes on beside it, 1 or 2.
        obstacle: stiffness of the obstacle, MPa/mm.

    Returns:
        Pressure per depth, MPa/mm, and the part of a depth that is in the obstacle.
    """
    thickness = site.actuator.sheath
    if thickness is None:
        return obstacle, 1.0
    rubber = site.materials.get("sheath", site.materials["wall"])
    young = 3 * rubber.initial_shear_modulus
    sheath = layer_factor(width / thickness, sides) * young / thickness
    both = 1 / (1 / obstacle + 1 / sheath)
    return both, both / obstacle
