"""Helical fibers on the outside of wall and floor (and layer)."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import Floats
from geometry.winding.families import Family, helix
from geometry.winding.outline import position, tangent
from geometry.winding.patterns import PATTERNS
from geometry.winding.ribbons import Ribbons


@dataclasses.dataclass(frozen=True)
class Winding:
    """The helices of a pattern, wound around the whole length.

    On the developed surface (arc length s of the outline, z) a helix is a straight line that rises
    by the pitch over one perimeter. s runs clockwise seen from +z, so a right-handed helix is
    z = −pitch s / S + (start + k) pitch. A fiber is a ribbon: parallel lines spread over its width.

    Attributes:
        pattern: name in `geometry.winding.patterns.PATTERNS`.
        pitch: rise of a turn in mm.
        width: width of the ribbon in mm; 0 gives a single line.
        lines: number of lines of a ribbon.

    Raises:
        ValueError: an unknown pattern, or a number without meaning.
    """

    pattern: str
    pitch: float
    width: float
    lines: int = 5

    def __post_init__(self) -> None:
        if self.pattern not in PATTERNS:
            raise ValueError(f"pattern {self.pattern!r}: expected one of {', '.join(PATTERNS)}")
        if not (math.isfinite(self.pitch) and self.pitch > 0):
            raise ValueError(f"pitch {self.pitch} mm: expected a positive length")
        if not (math.isfinite(self.width) and self.width >= 0):
            raise ValueError(f"width {self.width} mm: expected a length, 0 or more")
        if self.lines < 1:
            raise ValueError(f"lines {self.lines}: expected at least 1")

    @property
    def hands(self) -> tuple[int, ...]:
        """Hand of each helix."""
        return tuple(helix.hand for helix in PATTERNS[self.pattern].helices)

    @property
    def mirrored(self) -> bool:
        """Whether the planes of symmetry of the actuator are its own."""
        return PATTERNS[self.pattern].mirrored

    def ribbons(self, actuator: Actuator) -> Ribbons:
        """A family for every helix."""
        perimeter = actuator.winding_perimeter
        families: list[Family] = []
        for one in PATTERNS[self.pattern].helices:
            family = helix(perimeter, self.pitch, one.hand, phase=one.start)
            families.append(dataclasses.replace(family, width=self.width))
        return Ribbons(tuple(families), self.lines)

    @property
    def lines_per_fiber(self) -> int:
        """Number of lines of each ribbon; 1 when it has no width."""
        return 1 if self.width == 0 else self.lines

    @property
    def curves(self) -> int:
        """Number of curves: helices × lines; curve = helix number × lines + line."""
        return len(self.hands) * self.lines_per_fiber

    def rises(self, actuator: Actuator, helix: int) -> Floats:
        """z at s = 0 in mm of each line of a ribbon, (lines,): its offset is perpendicular.

        Args:
            actuator: dimensions.
            helix: number of the helix in the pattern.
        """
        n, s = self.lines_per_fiber, actuator.winding_perimeter
        offsets = (np.arange(n) - (n - 1) / 2) * self.width / n
        start = PATTERNS[self.pattern].helices[helix].start * self.pitch
        return start + offsets * math.hypot(s, self.pitch) / s

    def turn_length(self, actuator: Actuator) -> float:
        """Length of one turn in mm, √(S² + pitch²)."""
        return math.hypot(actuator.winding_perimeter, self.pitch)

    def density(self, actuator: Actuator) -> float:
        """Fiber length per area and helix in 1/mm, √(S² + pitch²) / (S pitch)."""
        return self.turn_length(actuator) / (actuator.winding_perimeter * self.pitch)

    def points(self, actuator: Actuator, curve: int, number: int) -> tuple[Floats, Floats]:
        """Exact points and unit tangents of a curve from z = 0 to z = L.

        Args:
            actuator: dimensions.
            curve: number of the curve, see `curves`.
            number: number of points, evenly spaced in arc length.

        Returns:
            Points (number, 3) in mm and unit tangents (number, 3) toward growing z.
        """
        helix, line = divmod(curve, self.lines_per_fiber)
        hand, rise = self.hands[helix], self.rises(actuator, helix)[line]
        perimeter = actuator.winding_perimeter
        z = np.linspace(0.0, actuator.length, number)
        s = -hand * (z - rise) * perimeter / self.pitch
        turn = self.turn_length(actuator)
        along = -hand * perimeter / turn * tangent(actuator, s)
        upward = np.full((number, 1), self.pitch / turn)
        return np.column_stack([position(actuator, s), z]), np.hstack([along, upward])
