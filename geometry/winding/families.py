"""Families of parallel threads on the winding's developed surface; no numpy, for case checks.

Unrolled, the surface has the coordinates X = (s, z), s modulo the perimeter S. At the angle α from
the axis a thread is a straight line with the unit tangent t and the unit normal n,

    t = (∓sin α, cos α),   n = (±cos α, sin α),   n · X = c,

the upper sign right-handed. A family is the lines c = offset + k · spacing, k any whole number.
n threads of the pitch p = S / tan α close around the body where spacing = S cos α / n.
"""

from __future__ import annotations

import dataclasses
import math

from geometry.actuator import Actuator, Side

UPRIGHT = math.pi / 2
"""Angle of hoops."""


@dataclasses.dataclass(frozen=True)
class Family:
    """Threads side by side at one angle, on an outline of one perimeter.

    Attributes:
        angle: α from the axis, rad: 0 along the axis, π/2 of hoops.
        hand: 1 right-handed about +z, −1 left-handed; 0 of hoops and along the axis.
        spacing: distance of neighbours perpendicular to them, mm.
        offset: n · X of one of them, the middle of its ribbon, mm.
        threads: lines after which a thread that goes around comes again; 0: each is its own.
        width: of the ribbon, mm; 0 gives single lines.
        thread: number of what it is made of.
        reach: threads lie where |s| ≤ reach only, s from the top to both sides, mm; inf: all
            around.
        place: one thread along the axis that stays where it is, also where others are smeared.

    Raises:
        ValueError: an angle, hand, spacing or width without meaning.
    """

    angle: float
    hand: int
    spacing: float
    offset: float = 0.0
    threads: int = 1
    width: float = 0.0
    thread: int = 0
    reach: float = math.inf
    place: bool = False

    def __post_init__(self) -> None:
        if not 0 <= self.angle <= UPRIGHT:
            raise ValueError(f"angle {self.angle} rad: expected one from 0 to π/2")
        if self.hand not in ((0,) if self.angle in (0.0, UPRIGHT) else (1, -1)):
            raise ValueError(
                f"hand {self.hand} at {self.angle} rad: hoops and axial threads have 0"
            )
        if not (math.isfinite(self.spacing) and self.spacing > 0):
            raise ValueError(f"spacing {self.spacing} mm: expected a positive length")
        if not (math.isfinite(self.width) and self.width >= 0):
            raise ValueError(f"width {self.width} mm: expected a length, 0 or more")

    @property
    def sine(self) -> float:
        """Part of a thread's length around the body."""
        return math.sin(self.angle)

    @property
    def cosine(self) -> float:
        """Part of a thread's length along the axis; exactly zero of hoops."""
        return 0.0 if self.angle == UPRIGHT else math.cos(self.angle)

    @property
    def tangent(self) -> tuple[float, float]:
        """t in (s, z), toward growing z; of hoops toward growing s."""
        return (-self.hand or 1) * self.sine, self.cosine

    @property
    def normal(self) -> tuple[float, float]:
        """n in (s, z)."""
        return (self.hand or 1) * self.cosine, self.sine

    @property
    def density(self) -> float:
        """Length of thread per area, 1/mm."""
        return 1 / self.spacing

    @property
    def period(self) -> float:
        """Distance along the axis after which it repeats, mm; inf along the axis: always alike."""
        return self.spacing / self.sine if self.angle else math.inf

    def turned(self, origin: float) -> Family:
        """The family on a surface whose z begins at `origin`, mm."""
        return dataclasses.replace(self, offset=self.offset - self.sine * origin)


def helix(perimeter: float, pitch: float, hand: int, starts: int = 1, phase: float = 0.0) -> Family:
    """Threads that rise by a pitch over a turn.

    Args:
        perimeter: S, mm.
        pitch: p, mm.
        hand: 1 right-handed, −1 left-handed.
        starts: number n of them, side by side.
        phase: z of one of them at the top (s = 0), over the pitch.
    """
    turn = math.hypot(perimeter, pitch)
    sine = perimeter / turn
    return Family(
        math.atan2(perimeter, pitch),
        hand,
        pitch / starts * sine,
        phase * pitch * sine,
        threads=starts,
    )


def hoops(spacing: float, phase: float = 0.0) -> Family:
    """Closed threads across the axis; phase: z of one of them over the spacing."""
    return Family(UPRIGHT, 0, spacing, phase * spacing, threads=0)


def along(perimeter: float, starts: int, phase: float = 0.0) -> Family:
    """Straight threads along the axis, evenly around; phase: s of one of them over S."""
    return Family(0.0, 0, perimeter / starts, phase * perimeter, threads=starts)


def placed(perimeter: float, s: float) -> Family:
    """One straight thread along the axis at a place of its own, s from the top, mm."""
    return Family(0.0, 0, perimeter, s, place=True)


def pitch_at(angle: float, perimeter: float) -> float:
    """Pitch of a thread at an angle from the axis, S / tan α, mm; 0 of hoops, inf along it."""
    if angle == 0:
        return math.inf
    return 0.0 if angle == UPRIGHT else perimeter / math.tan(angle)


def angle_at(pitch: float, perimeter: float) -> float:
    """Angle from the axis of a thread with a pitch, rad."""
    return math.atan2(perimeter, pitch)


def side_length(side: Side) -> float:
    """Length of a straight line or an arc of less than half a turn, mm."""
    if side.center is None:
        return math.dist(side.start, side.end)
    (x, y), radius = side.center, math.dist(side.start, side.center)
    first, last = (math.atan2(b - y, a - x) for a, b in (side.start, side.end))
    return radius * abs((last - first + math.pi) % (2 * math.pi) - math.pi)


def wall_reach(actuator: Actuator) -> float | None:
    """Length of the outline from the top to where the floor begins, mm; None without a floor."""
    sides = actuator.outline()
    floor = next((i for i, side in enumerate(sides) if side.name == "floor"), None)
    return None if floor is None else sum(map(side_length, sides[:floor]))
