"""Families of threads as they are laid on an actuator: each thread a ribbon of parallel lines."""

from __future__ import annotations

import dataclasses
import math
from typing import Protocol

import numpy as np

from geometry.actuator import Actuator
from geometry.mesh.data import Floats
from geometry.winding.families import Family
from geometry.winding.outline import position

_END = 1e-9
"""Part of the spacing within which a line lies on an end of the surface."""


class Wound(Protocol):
    """What is wound around an actuator."""

    def ribbons(self, actuator: Actuator) -> Ribbons:
        """Its threads on the actuator's outline."""


@dataclasses.dataclass(frozen=True)
class Ribbons:
    """Families of threads around the whole length of an actuator with their outline's perimeter.

    Attributes:
        families: one or more.
        lines: number of lines of every ribbon that has a width.

    Raises:
        ValueError: no family, no line, or ribbons beside single lines.
    """

    families: tuple[Family, ...]
    lines: int = 5

    def __post_init__(self) -> None:
        if not self.families:
            raise ValueError("expected at least one family of threads")
        if self.lines < 1:
            raise ValueError(f"lines {self.lines}: expected at least 1")
        if len({family.width > 0 for family in self.families}) > 1:
            raise ValueError("some families have a width and some have none")

    def ribbons(self, actuator: Actuator) -> Ribbons:
        """As they are."""
        return self

    @property
    def lines_per_fiber(self) -> int:
        """Number of lines of each ribbon; 1 when it has no width."""
        return 1 if self.families[0].width == 0 else self.lines

    def offsets(self, family: Family) -> Floats:
        """n · X in mm of each line of one of its ribbons, (lines,)."""
        n = self.lines_per_fiber
        return family.offset + (np.arange(n) - (n - 1) / 2) * family.width / n

    def chosen(self, places: bool) -> Ribbons | None:
        """Those that stay at their places also where others are smeared, or the others, if any."""
        kept = tuple(family for family in self.families if family.place == places)
        return dataclasses.replace(self, families=kept) if kept else None

    def turned(self, origin: float) -> Ribbons:
        """The same on a surface whose z begins at `origin`, mm."""
        if not origin:
            return self
        return dataclasses.replace(self, families=tuple(f.turned(origin) for f in self.families))

    def lengths(self, actuator: Actuator) -> Floats:
        """Exact length in mm of each family over 0 ≤ z ≤ L, a mean over its ribbons' lines.

        Half of what lies on an end counts, as on a mesh.
        """
        size = actuator.winding_perimeter, actuator.length
        return np.array(
            [
                np.mean([_length(family, offset, *size) for offset in self.offsets(family)])
                for family in self.families
            ]
        )

    def curves(self, actuator: Actuator, number: int) -> list[Floats]:
        """Every line of every ribbon as a polyline in space, (n, 3), mm; hoops are closed.

        Args:
            actuator: dimensions.
            number: points of a polyline over a turn, or over the length of one along the axis.
        """
        found: list[Floats] = []
        size = actuator.winding_perimeter, actuator.length
        for family in self.families:
            lines = [dataclasses.replace(family, offset=c) for c in self.offsets(family).tolist()]
            for start, end in (ends for line in lines for ends in _threads(line, *size)):
                turns = abs(end[0] - start[0]) / size[0]
                count = max(2, math.ceil(number * max(turns, 0.25 if turns else 0.0)) + 1)
                s = np.linspace(start[0], end[0], count)
                z = np.linspace(start[1], end[1], count)
                found.append(np.column_stack([position(actuator, s), z]))
        return found


def _windows(family: Family, perimeter: float) -> list[tuple[float, float]]:
    """Ranges of s within [0, S] in which threads lie."""
    if family.reach >= perimeter / 2:
        return [(0.0, perimeter)]
    return [(0.0, family.reach), (perimeter - family.reach, perimeter)]


def _length(family: Family, offset: float, perimeter: float, length: float) -> float:
    """Length of the lines n · X = offset + k spacing in [0, S) × [0, L] within the window, mm."""
    (around, up), across = family.normal, family.tangent[0]
    if not family.angle:
        inside = min(offset % perimeter, -offset % perimeter) <= family.reach
        if family.place:
            return length * inside
        places = (offset + k * family.spacing for k in range(round(perimeter / family.spacing)))
        near = (min(s % perimeter, -s % perimeter) for s in places)
        return length * sum(s <= family.reach * (1 + _END) for s in near)
    total = 0.0
    for low, high in _windows(family, perimeter):
        corners = [around * s + up * z for s in (low, high) for z in (0.0, length)]
        first = math.ceil((min(corners) - offset) / family.spacing - _END)
        last = math.floor((max(corners) - offset) / family.spacing + _END)
        for k in range(first, last + 1):
            c = offset + k * family.spacing
            if not family.hand:
                end = min(abs(c), abs(c - length)) <= _END * family.spacing
                total += (high - low) * (0.5 if end else 1.0)
                continue
            # n · X = c with s as the parameter of the line
            ends = sorted((c - up * z) / around for z in (0.0, length))
            total += max(0.0, min(high, ends[1]) - max(low, ends[0])) / abs(across)
    return total


def _threads(
    family: Family, perimeter: float, length: float
) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Both ends in (s, z) of every thread, s as long as it goes on."""
    found = []
    reach = min(family.reach, perimeter / 2)
    whole = family.reach >= perimeter / 2
    if not family.angle:
        count = 1 if family.place else round(perimeter / family.spacing)
        for k in range(count):
            s = family.offset + k * family.spacing
            if min(s % perimeter, -s % perimeter) <= reach * (1 + _END):
                found.append(((s, 0.0), (s, length)))
        return found
    if not family.hand:
        first = math.ceil(-family.offset / family.spacing - _END)
        last = math.floor((length - family.offset) / family.spacing + _END)
        for k in range(first, last + 1):
            z = family.offset + k * family.spacing
            found.append(((-reach, z), (reach, z)))
        return found
    slope = family.tangent[1] / family.tangent[0]
    rise = family.period
    if whole:
        for k in range(family.threads):
            z = family.offset / family.sine + k * rise
            found.append(((-z / slope, 0.0), ((length - z) / slope, length)))
        return found
    # pieces over the window, each from side to side, cut at both ends of the length
    start = family.offset / family.sine
    high = abs(slope) * reach
    first = math.ceil((-high - start) / rise)
    last = math.floor((length + high - start) / rise)
    for k in range(first, last + 1):
        z = start + k * rise
        ends = sorted(((0.0 - z) / slope, (length - z) / slope))
        low_s, high_s = max(-reach, ends[0]), min(reach, ends[1])
        if high_s > low_s:
            found.append(((low_s, z + slope * low_s), (high_s, z + slope * high_s)))
    return found
