"""Rectangle, hemicircle and circle of the same chamber area compared. mm, N, MPa, rad.

Appendix of Polygerinos et al. 2015, doi 10.1109/TRO.2015.2428504: chamber area a², wall and floor
t = a/4, the inextensible line along the lower face, stretch λ = 1 + y θ/L at height y.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Literal

import numpy as np

from analytic.section_parts import SectionPart, rectangle, ring
from analytic.stress import Floats, Stress, effective

Shape = Literal["rectangle", "hemicircle", "circle"]
SHAPES: tuple[Shape, ...] = ("rectangle", "hemicircle", "circle")

ROUNDED_RADII = (0.80, 0.56)
"""r_HC/a and r_FC/a as printed; exactly √(2/π) = 0.7979 and 1/√π = 0.5642."""
PRINTED_ASPECT = 1.46
"""v of eq. (A10), computed with r_HC = 0.80 a; section III-A has 1.47, and exactly it is 1.4765."""
PRINTED_TORQUES = (0.59, 0.80)
"""M_a/(a³ P) of hemicircle and circle, eqs. (A5) and (A8); exactly 0.5886 and 0.8142."""


def text_torques(aspect: float) -> dict[Shape, float]:
    """M_a/(a³ P) of eqs. (1)–(3), which contradict the appendix.

    (1) and (2) leave out the floor between chamber and fulcrum: without it the appendix gives
    0.5/v and 0.34 too. For the circle it gives 0.55 then and 0.80 with it: (3) is neither.

    Args:
        aspect: v, √(width/height) of the rectangle.
    """
    return {"rectangle": 0.5 / aspect, "hemicircle": 0.34, "circle": 0.72}


@dataclasses.dataclass(frozen=True)
class EqualArea:
    """The three shapes at one chamber area.

    Attributes:
        side: a, mm; the area is a², the wall a/4.
        length: length L of the inextensible line, mm.
        stress: nominal axial stress of the rubber as a function of the stretch.
        rounded: take the printed radii 0.80 a and 0.56 a and v = 1.46, and compute with these.
        paper: evaluate the printed equations, errors included: `rounded`, the torques 0.59 a³ P
            and 0.80 a³ P, the extra factor L of (A12), (A13) and (A15), which makes the moments
            N mm², and (A15)'s exchanged dφ and dc, which is an integral over another body.

    Raises:
        ValueError: a dimension that is not positive and finite.
    """

    side: float
    length: float
    stress: Stress = dataclasses.field(default_factory=effective)
    rounded: bool = False
    paper: bool = False

    def __post_init__(self) -> None:
        for name in ("side", "length"):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name}: positive mm expected, not {getattr(self, name)}")

    @property
    def wall(self) -> float:
        """t = a/4, of walls and floor, mm."""
        return self.side / 4

    @property
    def radii(self) -> tuple[float, float]:
        """r_HC and r_FC, mm."""
        if self.rounded or self.paper:
            return ROUNDED_RADII[0] * self.side, ROUNDED_RADII[1] * self.side
        return math.sqrt(2 / math.pi) * self.side, self.side / math.sqrt(math.pi)

    @property
    def aspect(self) -> float:
        """v, from eq. (A9): the rectangle v a × a/v has the hemicircle's torque."""
        if self.rounded or self.paper:
            return PRINTED_ASPECT
        return 0.5 / (self.torque("hemicircle") / self.side**3 - 0.25)

    def torque(self, shape: Shape) -> float:
        """M_a/P in mm³, the chamber's first moment about the lower face: (A2), (A5), (A8)."""
        a, (half, full) = self.side, self.radii
        if shape == "rectangle":
            return (1 + 0.5 * self.aspect) / (2 * self.aspect) * a**3
        if shape == "hemicircle":
            exact, printed = 2 / 3 * half**3 + math.pi / 8 * half**2 * a, PRINTED_TORQUES[0]
        elif shape == "circle":
            exact, printed = math.pi * full**2 * (full + a / 4), PRINTED_TORQUES[1]
        else:
            raise ValueError(f"shape: one of {', '.join(SHAPES)} expected, not {shape!r}")
        return printed * a**3 if self.paper else exact

    @functools.cached_property
    def _layers(self) -> dict[Shape, SectionPart]:
        """Walls and floor of each shape, as (A12), (A13) and (A15) integrate them."""
        a, t, v, (half, full) = self.side, self.wall, self.aspect, self.radii
        top = t + a / v
        return {
            "rectangle": rectangle(v * a, top, top + t)
            + rectangle(v * a, 0.0, t)
            + rectangle(2 * t, 0.0, top + t),
            "hemicircle": ring(t, half, half + t, 0.0) + rectangle(2 * (half + t), 0.0, t),
            "circle": self._exchanged() if self.paper else ring(full + t, full, full + t),
        }

    def _exchanged(self) -> SectionPart:
        """(A15) read literally: c from 0 to π mm, and φ, which starts at the floor, to t rad."""
        full, t = self.radii[1], self.wall
        return ring(full + t, full, full + math.pi, -math.pi / 2, t - math.pi / 2)

    def moment(self, shape: Shape, angle: Floats | float) -> Floats:
        """Moment of the stretched rubber about the lower face: (A12), (A13), (A15).

        Args:
            shape: one of `SHAPES`.
            angle: bending angles of any shape from zero on, rad.

        Returns:
            Moments in the shape of `angle`, N mm (N mm² with `paper`).

        Raises:
            ValueError: an unknown shape, or an angle that is negative or not finite.
        """
        if shape not in SHAPES:
            raise ValueError(f"shape: one of {', '.join(SHAPES)} expected, not {shape!r}")
        angle = np.asarray(angle, dtype=float)
        if not np.all((angle >= 0) & (angle < math.inf)):
            raise ValueError(f"angle: zero or positive rad expected, not {angle}")
        moment = self._layers[shape].moment(angle, self.length, self.stress)
        return np.asarray(moment * self.length if self.paper else moment)

    def resistance(self, shape: Shape, angle: Floats | float) -> Floats:
        """Eq. (A16), Fig. 4(b): M_θ/(M_a/P), the pressure in MPa that holds the angles (rad)."""
        return self.moment(shape, angle) / self.torque(shape)
