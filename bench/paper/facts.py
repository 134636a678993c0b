"""What Polygerinos et al. 2015 state as numbers, each with where they do; nothing is computed here.

P. Polygerinos, Z. Wang, J. T. B. Overvelde, K. C. Galloway, R. J. Wood, K. Bertoldi, C. J. Walsh,
Modeling of Soft Fiber-Reinforced Bending Actuators, IEEE Transactions on Robotics 31(3), 778-789,
2015, doi 10.1109/TRO.2015.2428504. A place is a section (III-C), an equation, a figure or a table.
What a figure shows as a curve or a point without a number is not stated.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

FALLS, RISES, STAYS = "↓", "↑", "—"
"""Signs of Table II."""


@dataclasses.dataclass(frozen=True)
class Stated:
    """A number, a range or a sign that the paper states.

    Attributes:
        key: by which a part of the page finds it.
        what: of what it is.
        printed: as the paper prints it.
        place: where.
        value: the number; nan where it is none.
        unit: of the number.
    """

    key: str
    what: str
    printed: str
    place: str
    value: float = float("nan")
    unit: str = ""


@dataclasses.dataclass(frozen=True)
class Size:
    """An actuator of Table I, with its simulation.

    Attributes:
        radius: of the chamber a, mm.
        length: L, mm.
        wall: t, mm.
        nodes: of the paper's mesh.
        elements: B32 and C3D10H together.
    """

    radius: float
    length: float
    wall: float
    nodes: int
    elements: int

    @property
    def key(self) -> tuple[float, float, float]:
        """(a, L, t) in mm."""
        return self.radius, self.length, self.wall

    @property
    def name(self) -> str:
        """The same in words."""
        return f"a = {self.radius:g}, L = {self.length:g}, t = {self.wall:g} mm"


def grouped(count: int) -> str:
    """A count in groups of three digits."""
    return f"{count:,}".replace(",", " ")


BASELINE = (8.0, 160.0, 2.0)
"""(a, L, t) in mm of the actuator of Figs. 6 and 9; section V-A."""
TABLE_I = (
    Size(6, 100, 2, 71309, 44465),
    Size(6, 130, 2, 95061, 59108),
    Size(6, 160, 2, 118708, 73614),
    Size(8, 100, 2, 98113, 62301),
    Size(8, 130, 2, 128787, 81219),
    Size(8, 160, 1, 90449, 55141),
    Size(8, 160, 2, 160711, 101097),
    Size(8, 160, 3, 185274, 118557),
    Size(10, 160, 2, 192650, 121106),
    Size(12, 160, 2, 208921, 131646),
)
FIG_8 = {"radius": (6.0, 12.0), "length": (80.0, 180.0), "wall": (1.0, 3.0)}
"""Ranges of the analytical lines, mm; the simulations are those of Table I."""
ANGLES = (90.0, 180.0, 360.0)
"""Of Fig. 8, °."""
FIG_10 = ((8, 160, 2), (8, 130, 2), (8, 100, 2), (6, 160, 2), (6, 130, 2), (6, 100, 2))
"""(a, L, t) in mm of (a) to (f)."""
FIG_11 = ((8, 160, 2), (8, 130, 2), (6, 160, 2))
"""(a, L, t) in mm of (b) to (d)."""

MODULUS = Stated("modulus", "effective shear modulus μ̄", "0.314 MPa", "IV-B", 0.314, "MPa")
CAP = Stated("cap", "silicone cap at either end", "15-mm-thick", "II", 15, "mm")

_GEOMETRY = (
    Stated("length", "length of the baseline", "160.0 mm", "V-A", 160, "mm"),
    Stated("wall", "its wall", "2.0 mm", "V-A", 2, "mm"),
    Stated("radius", "its radius", "8.0 mm", "V-A", 8, "mm"),
    CAP,
    Stated("sheath", "silicone around wall and fibers", "1.0-mm-thick", "II", 1, "mm"),
    Stated("thread", "diameter of the Kevlar fiber", "0.38 mm", "II", 0.38, "mm"),
    Stated(
        "sizes",
        "radii, lengths and walls of the simulations",
        "ten sizes",
        "Table I, Fig. 8",
    ),
    Stated(
        "ranges",
        "ranges of the analytical lines",
        "a 6.0 to 12.0, L 80.0 to 180.0, t 1.0 to 3.0 mm",
        "Fig. 8",
    ),
    Stated("diameter", "size of the third actuator of Fig. 11", "6.0-mm diameter", "V-C", 6, "mm"),
)
_MATERIALS = (
    Stated("c1", "Elastosil M4601, C1", "0.11 MPa", "III-C", 0.11, "MPa"),
    Stated("c2", "Elastosil M4601, C2", "0.02 MPa", "III-C", 0.02, "MPa"),
    Stated("soft_c1", "Ecoflex 00-30, C1", "0.012662 MPa", "III-C", 0.012662, "MPa"),
    Stated("soft_c2", "Ecoflex 00-30, C2", "0 MPa", "III-C", 0.0, "MPa"),
    Stated("base", "floor with its layer, C combined", "7.9 MPa", "III-C", 7.9, "MPa"),
    Stated("young", "Young's modulus of the fiber", "31,076 MPa", "III-C", 31076, "MPa"),
    Stated("poisson", "Poisson's ratio of the fiber", "0.36", "III-C", 0.36),
    Stated("halved", "radius of the beams", "reduced by a factor of 2", "III-C", 0.5),
    Stated("insignificant", "effect of halving it", "insignificant change", "III-C"),
    Stated("twice", "initial shear modulus of a Yeoh rubber", "μ̄ = 2 C1", "III-C", 2.0),
    Stated("rubber", "Young's modulus of soft materials", "~10² to 10⁶ Pa", "I"),
    MODULUS,
)
_SECTIONS = (
    Stated("box", "M_a of the rectangle", "0.5/v a³ P", "eq. (1)"),
    Stated("half", "M_a of the hemicircle", "0.34 a³ P", "eq. (2)", 0.34, "a³ P"),
    Stated("full", "M_a of the circle", "0.72 a³ P", "eq. (3)", 0.72, "a³ P"),
    Stated("box_a", "M_a of the rectangle", "(1 + 0.5 v)/(2 v) a³ P", "eq. (A2)"),
    Stated("half_a", "M_a of the hemicircle", "0.59 a³ P", "eq. (A5)", 0.59, "a³ P"),
    Stated("full_a", "M_a of the circle", "0.80 a³ P", "eq. (A8)", 0.80, "a³ P"),
    Stated("aspect", "v", "1.46", "eq. (A10)", 1.46),
    Stated("aspect_text", "v", "1.47", "III-A", 1.47),
    Stated("half_radius", "radius of the hemicircle", "0.80 a", "Appendix", 0.80, "a"),
    Stated("full_radius", "radius of the circle", "0.56 a", "Appendix", 0.56, "a"),
    Stated("half_width", "width of the hemicircle", "1.6 a", "Appendix", 1.6, "a"),
    Stated("box_width", "width of the rectangle", "1.46 a", "Appendix", 1.46, "a"),
    Stated("box_height", "height of the rectangle", "0.68 a", "Appendix", 0.68, "a"),
    Stated("share", "walls of the three shapes", "t = a/4", "III-A", 0.25, "a"),
    Stated("easiest", "easiest to bend up to 360°", "hemicircle", "III-A, Fig. 4(b)"),
    Stated("alike", "rectangle and circle", "similar bending resistance", "III-A, Fig. 4(b)"),
)
_BENDING = (
    Stated("full_circle", "pressure of the simulation at 360°", "196 kPa", "Fig. 6", 196, "kPa"),
    Stated("around", "pressure of the baseline at 360°", "around 200 kPa", "V-A", 200, "kPa"),
    Stated("psi", "the same in psi", "~30 PSI", "V-A", 30, "psi"),
    Stated("stretch", "stretch of the application", "1 ≤ λ < 1.5", "III-B", 1.5),
    Stated("hoop", "circumferential stress", "s2 < s1/2", "eq. (9)", 0.5),
    Stated("path", "greatest error of the tip's place", "3.7 %", "V-B, Fig. 9", 0.037),
    Stated("pressure", "greatest error of the pressure", "10.9 %", "V-B, Fig. 9", 0.109),
)
_FORCE = (
    Stated("force_closed", "greatest force error, analytical", "4.3 %", "V-C", 0.043),
    Stated("force_solid", "greatest force error, simulation", "10.3 %", "V-C", 0.103),
    Stated("force_length", "influence of the length on the force", "small", "V-C, Fig. 11"),
)
_TRENDS = (
    Stated("radius_pressure", "radius up: pressure at 360°", FALLS, "Table II"),
    Stated("length_pressure", "length up: pressure at 360°", FALLS, "Table II"),
    Stated("wall_pressure", "wall up: pressure at 360°", RISES, "Table II"),
    Stated("radius_force", "radius up: force at 0°", RISES, "Table II"),
    Stated("length_force", "length up: force at 0°", STAYS, "Table II"),
    Stated("wall_force", "wall up: force at 0°", "n/a", "Table II"),
    Stated("length_text", "length up: pressure at 360°", "higher", "V-A"),
)
_CONTROL = (
    Stated("rate", "sampling rate", "100 Hz", "VI", 100, "Hz"),
    Stated("divisor", "k of the dead zone", "50", "eq. (22)", 50),
    Stated("offset", "θ_c of the dead zone", "0.07 rad", "eq. (22)", 0.07, "rad"),
    Stated("sine", "frequency of the sine", "0.2 Hz", "VI, Fig. 13(b)", 0.2, "Hz"),
    Stated("fill", "time to converge, steps", "91 ms", "VI, Fig. 13(a)", 91, "ms"),
    Stated("vent", "time to converge, emptying", "124 ms", "VI, Fig. 13(a)", 124, "ms"),
    Stated("switching", "undesired switching, steps", "0.85 %", "VI, Fig. 13(a)", 0.0085),
    Stated("delay", "delay of the sine", "60 ms", "VI, Fig. 13(b)", 60, "ms"),
    Stated("switching_sine", "undesired switching, sine", "0.5 %", "VI, Fig. 13(b)", 0.005),
)
_PROTOCOL = (
    Stated("specimens", "rate of the material tests", "500 mm/min", "III-C", 500, "mm/min"),
    Stated("trials", "trials of the calibration", "five", "IV-B", 5),
    Stated("blocked", "trials of each force experiment", "three", "IV-A", 3),
    Stated("repeats", "trials of each bending experiment", "five", "V-B", 5),
    Stated("slow", "rate of the bending experiments", "0.2 Hz", "V-B", 0.2, "Hz"),
)
_MESHES = tuple(
    Stated(
        f"mesh_{size.radius:g}_{size.length:g}_{size.wall:g}",
        f"mesh of {size.name}",
        f"{grouped(size.nodes)} nodes, {grouped(size.elements)} elements",
        "Table I",
        size.nodes,
    )
    for size in TABLE_I
)


def by_key(facts: Iterable[Stated]) -> dict[str, Stated]:
    """Facts by their keys.

    Raises:
        ValueError: two facts have one key.
    """
    found: dict[str, Stated] = {}
    for fact in facts:
        if fact.key in found:
            raise ValueError(f"two facts are {fact.key!r}")
        found[fact.key] = fact
    return found


STATED = by_key(
    (
        *_GEOMETRY,
        *_MATERIALS,
        *_SECTIONS,
        *_BENDING,
        *_FORCE,
        *_TRENDS,
        *_CONTROL,
        *_PROTOCOL,
        *_MESHES,
    )
)
"""Everything that the page has a verdict on."""
