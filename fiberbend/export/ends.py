"""What the caps make of a rod's pieces, for a file: turns by the pressure, and a stiffer root."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from fiberbend.case.case import Case
from fiberbend.sectionlaw.ends import PARTS, Ends, ends_of
from rod.functions import Floats

KEYS = tuple(part.replace(" ", "_") for part in PARTS)
"""Of the parts in a file, from the root on."""
ADDED = ("lengthening_mm", "turn_rad", "side_turn_rad", "twist_rad")
"""What each part has beside what its forces make of it, by the line of the centroids."""
_NONE, _LEAST = 1e-6, 1e-3
"""Part of the greatest turn or length below which it is zero by symmetry; and what that is at
least, rad or mm."""


@dataclasses.dataclass(frozen=True)
class Caps:
    """Turns of the chamber's ends, and how much stiffer than a beam the root's cap is.

    Attributes:
        ends: by pressure.
        root: stiffness of the root's cap over that of a cap as a beam.
    """

    ends: Ends
    root: float

    def added(self, pressures: Floats) -> Floats:
        """Lengths in mm and turns in rad of each part, (4, n, 4)."""
        found = np.array([[self.ends.added(part, float(p)) for p in pressures] for part in PARTS])
        for columns in (slice(0, 1), slice(1, 4)):
            own = found[..., columns]
            own[np.abs(own) < _NONE * np.abs(own).max(initial=_LEAST)] = 0.0
        return found

    def record(self, pressures: Floats) -> dict[str, Any]:
        """As rod.json has it; pressures in MPa."""
        parts = zip(KEYS, self.added(pressures), strict=True)
        return {
            "zone_mm": self.ends.zone,
            "root_cap_over_cap_stiffness": self.root,
            **{key: dict(zip(ADDED, added.T, strict=True)) for key, added in parts},
        }


def caps_of(alone: Case, cap: Floats, farthest: float) -> Caps:
    """Of the section of a case, by a short body of it.

    Args:
        alone: the section under its pressure.
        cap: stiffness of a cap as a beam, (4, 4).
        farthest: pressure of the file, MPa.

    Raises:
        CaseError: the short body does not come to the pressure.
    """
    ends = ends_of(alone, farthest)
    beam = alone.actuator.cap * float(np.linalg.inv(cap)[1, 1])
    return Caps(ends, beam / ends.flexibility)
