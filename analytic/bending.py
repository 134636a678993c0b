"""Free bending and blocked force of a hemicircular actuator in closed form. mm, N, MPa, rad.

Polygerinos et al. 2015, doi 10.1109/TRO.2015.2428504, eqs. (12)–(21). The floor's lower face y = 0
is inextensible and is the fulcrum; the section keeps its shape.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Literal

import numpy as np

from analytic.inverse import MonotoneInverse, angle_range, table_range
from analytic.section_parts import SectionPart, rectangle, ring
from analytic.stress import Floats, Stress, effective


@dataclasses.dataclass(frozen=True)
class Hemicircle:
    """The paper's actuator, with the pressure on the chamber or on all that the winding confines.

    `acts="chamber"` is the paper: the pressure acts on the chamber's area, eq. (13), and the
    rubber carries none of it, s3 = 0 in eq. (10).

    `acts="winding"` is a correction that none of the paper's models has. Rubber between chamber
    and winding is confined: the radial stress is −P at the chamber wall, and it is the winding,
    not the rubber, that takes P up. So −P is added to every normal stress inside the winding, the
    axial one too, and that leaves the stress difference that (8) computes, and M_θ, untouched.
    Balance about y = 0 over the section is then

        P κ + P ∫ y dA (wall and floor) = M_θ,   that is   P κ_w = M_θ,

    with κ_w the first moment of the whole area inside the winding: a half disk of radius a + t on
    the floor y = b, and the floor 2 (a + t) × b itself, since the winding surrounds both:

        κ_w = 2/3 (a + t)³ + π/2 (a + t)² b + (a + t) b².

    For (8, 2, 2) mm κ_w is 1020.8 mm³ against κ = 542.4 mm³. At 100 kPa and zero curvature that is
    102.1 N mm against 54.2 N mm. A finite-element model of the section, its axial stretch free, has
    94 N mm: the acting area closes the gap and passes it by 9 %, for it takes the stiff floor for
    a fluid as well and has no moment of the rubber that the end thrust stretches.

    Attributes:
        radius: chamber radius a, mm.
        floor: floor thickness b, mm.
        wall: wall thickness t, mm.
        length: length L of the inextensible line, mm.
        stress: axial stress of the wall as a function of the stretch, by default eq. (16) with the
            paper's μ̄; `stress.wound` makes it from a measured law: the 'zero-fit' line.
        floor_stress: the same of the floor; None: as the wall. A floor that is itself the
            inextensible layer belongs below y = 0, not in here with its full stiffness.
        sheath: thickness of a sheath around wall and floor, outside the winding, mm.
        sheath_stress: axial stress of the sheath.
        acts: area that the pressure acts on.
        paper: evaluate eq. (14) as printed, with its extra factor L: moments in N mm², pressures
            L times too high (38 MPa at 360° for the paper's baseline).

    Raises:
        ValueError: a dimension that is not positive, a sheath without a stress or the reverse, or
            `paper` with something that the printed equations do not have.
    """

    radius: float
    floor: float
    wall: float
    length: float
    stress: Stress = dataclasses.field(default_factory=effective)
    floor_stress: Stress | None = None
    sheath: float = 0.0
    sheath_stress: Stress | None = None
    acts: Literal["chamber", "winding"] = "chamber"
    paper: bool = False

    def __post_init__(self) -> None:
        for name in ("radius", "floor", "wall", "length"):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name}: positive mm expected, not {getattr(self, name)}")
        if not 0 <= self.sheath < math.inf:
            raise ValueError(f"sheath: zero or positive mm expected, not {self.sheath}")
        if (self.sheath > 0) != (self.sheath_stress is not None):
            raise ValueError("sheath: its thickness and its stress go together")
        if self.acts not in ("chamber", "winding"):
            raise ValueError(f"acts: chamber or winding expected, not {self.acts!r}")
        if self.paper and (self.acts != "chamber" or self.sheath > 0):
            raise ValueError("paper: the printed equations have no sheath and no other acting area")

    @property
    def kappa(self) -> float:
        """κ = M_a/P in mm³: eq. (21), or κ_w when the pressure acts up to the winding."""
        a, b, outer = self.radius, self.floor, self.radius + self.wall
        if self.acts == "winding":
            return 2 / 3 * outer**3 + math.pi / 2 * outer**2 * b + outer * b**2
        return (4 * a**3 + 3 * math.pi * a**2 * b) / 6

    @functools.cached_property
    def _section_parts(self) -> list[tuple[SectionPart, Stress]]:
        """Every part of the section with its stress."""
        a, b, outer, s = self.radius, self.floor, self.radius + self.wall, self.sheath
        wall, floor = ring(b, a, outer, 0.0), rectangle(2 * outer, 0.0, b)
        if self.floor_stress is None:
            parts = [(wall + floor, self.stress)]
        else:
            parts = [(wall, self.stress), (floor, self.floor_stress)]
        if self.sheath_stress is not None:
            around = ring(b, outer, outer + s, 0.0) + rectangle(2 * s, 0.0, b)
            parts.append((around + rectangle(2 * (outer + s), -s, 0.0), self.sheath_stress))
        return parts

    @property
    def roof(self) -> float:
        """Height of the highest line above the fulcrum, mm."""
        return self.floor + self.radius + self.wall + self.sheath

    @property
    def angles(self) -> tuple[float, float]:
        """Least and greatest angle at which a pressure is looked for, rad."""
        return angle_range(self.length, self.roof, self.sheath)

    @functools.cached_property
    def tabulated(self) -> tuple[float, float]:
        """Least and greatest angle that `angle` returns, rad: rubber may meet its limit before."""
        return table_range(self._pressure, *self.angles)

    @functools.cached_property
    def _inverse(self) -> MonotoneInverse:
        return MonotoneInverse(self._pressure, *self.tabulated)

    def _pressure(self, angle: Floats) -> Floats:
        return self._moment(angle) / self.kappa

    def _moment(self, angle: Floats) -> Floats:
        total = sum(part.moment(angle, self.length, stress) for part, stress in self._section_parts)
        return np.asarray(self.length * total if self.paper else total)

    def pressure_moment(self, pressure: Floats | float) -> Floats:
        """Eq. (13): moment M_a = κ P about the fulcrum, N mm, of a pressure in MPa."""
        return self.kappa * np.asarray(pressure, dtype=float)

    def moment(self, angle: Floats | float) -> Floats:
        """Eqs. (14)–(18): moment M_θ of the stretched rubber about the fulcrum.

        Args:
            angle: bending angles of any shape, rad; negative ones bend away from the floor.

        Returns:
            Moments in the same shape, N mm (N mm² with `paper`).

        Raises:
            ValueError: an angle at which the stretch reaches zero somewhere in the section.
        """
        angle = np.asarray(angle, dtype=float)
        low, high = -self.length / self.roof, self.length / self.sheath if self.sheath else math.inf
        if not np.all((angle > low) & (angle < high)):
            raise ValueError(f"angle: between {low:.4g} and {high:.4g} rad expected, not {angle}")
        return self._moment(angle)

    def pressure(self, angle: Floats | float) -> Floats:
        """Eq. (19): pressure P(θ) in MPa at bending angles in rad, of any shape."""
        return self.moment(angle) / self.kappa

    def angle(self, pressure: Floats | float) -> Floats:
        """Inverse of eq. (19), θ(P), to round-off; the first call tabulates.

        Args:
            pressure: pressures of any shape, MPa; negative ones, such as noise about zero, bend
                the actuator away from its floor.

        Returns:
            Bending angles in the same shape, rad, from about −π/2 to 4π, or to where rubber meets
            its limiting stretch.

        Raises:
            ValueError: a pressure that is not finite or beyond the tabulated angles, or a stress
                so soft that pressure does not rise with the angle.
        """
        return self._inverse(np.asarray(pressure, dtype=float))

    def force(self, pressure: Floats | float, cap_length: float) -> Floats:
        """Eq. (20): contact force F = κ P/L_f in N of the actuator kept straight.

        Args:
            pressure: pressures of any shape, MPa.
            cap_length: length L_f of the distal cap, the lever arm of the contact force, mm.

        Raises:
            ValueError: a cap length that is not positive.
        """
        if not 0 < cap_length < math.inf:
            raise ValueError(f"cap_length: positive mm expected, not {cap_length}")
        return self.pressure_moment(pressure) / cap_length
