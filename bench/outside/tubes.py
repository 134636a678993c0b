"""Round tubes with families of fibers as a case of the section model, and as the exact tube."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

from analytic.tube import Family, Tube
from fiberbend import run
from materials.material import Material

DIAMETER = 0.36
"""Of a thread in a case, mm: only its EA matters to a section."""


@dataclasses.dataclass(frozen=True)
class Threads:
    """A family in a case.

    Attributes:
        degrees: lean from the axis, above zero: right-handed.
        stiffness: EA of a thread, N.
        starts: threads side by side.
    """

    degrees: float
    stiffness: float
    starts: int = 1

    def family(self, outer: float) -> Family:
        """The same spread over a radius in mm."""
        angle = math.radians(self.degrees)
        width = 2 * math.pi * outer * math.cos(angle)
        return Family(angle, self.starts * self.stiffness / width)

    def entry(self) -> dict[str, Any]:
        """The same in a case."""
        modulus = self.stiffness / (math.pi * DIAMETER**2 / 4)
        return {
            "angle_from_axis": f"{abs(self.degrees)!r} deg",
            "hand": "right" if self.degrees > 0 else "left",
            "starts": self.starts,
            "fiber": {"modulus": f"{modulus!r} MPa", "diameter": f"{DIAMETER} mm"},
        }


@dataclasses.dataclass(frozen=True)
class Rubber:
    """A neo-Hookean tube; μ in MPa, radii and length in mm."""

    mu: float
    inner: float
    outer: float
    length: float

    def wound(self, *families: Family) -> Tube:
        """The exact tube."""
        law = Material("neo-hooke", {"mu": self.mu}).principal
        return Tube(law, self.inner, self.outer, families)


def section(
    tube: Rubber,
    threads: Sequence[Threads],
    pressures: Sequence[float],
    refinement: int = 2,
    hold: Mapping[str, Any] | None = None,
) -> list[dict[str, Any]]:
    """Rows of the section model at some pressures.

    Args:
        tube: the rubber.
        threads: around it.
        pressures: MPa, rising.
        refinement: elements through the wall.
        hold: what is held, as in a case, before the pressure rises; None: the ends are free.

    Raises:
        RuntimeError: the run did not reach the last one.
    """
    result = run(
        {
            "title": "A tube beside the exact one",
            "actuator": {
                "section": "circle",
                "radius": f"{tube.inner!r} mm",
                "length": f"{tube.length!r} mm",
                "wall": f"{tube.outer - tube.inner!r} mm",
            },
            "materials": {"wall": {"law": "neo-hooke", "mu": f"{tube.mu!r} MPa"}},
            "effects": [
                *([] if hold is None else [{"hold": dict(hold)}]),
                {"pressure": {"to": f"{pressures[-1]!r} MPa"}},
                {"winding": {"families": [each.entry() for each in threads], "as": "smeared"}},
            ],
            "model": "section",
            "mesh": {"section": refinement},
            "output": {
                "pictures": False,
                "fields": False,
                "at_pressures": [f"{pressure!r} MPa" for pressure in pressures],
            },
        }
    )
    if result.status != "converged":
        raise RuntimeError(f"{threads}: {result.reason}")
    return [
        min(result.rows, key=lambda row: abs(row["pressure_kPa"] - 1e3 * pressure))
        for pressure in pressures
    ]
