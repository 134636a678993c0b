"""Round tubes with one family of fibers as a case of the section model, and as the exact tube."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from analytic.tube import Family, Tube
from fiberbend import run
from materials.material import Material

DIAMETER = 0.36
"""Of a thread in a case, mm: only its EA matters to a section."""


def exact(mu: float, inner: float, outer: float, *families: Family) -> Tube:
    """The exact tube of a neo-Hookean rubber."""
    return Tube(Material("neo-hooke", {"mu": mu}).principal, inner, outer, families)


def per_width(stiffness: float, outer: float, degrees: float) -> float:
    """EA of one thread a helix over its pitch, across the threads, N/mm.

    Args:
        stiffness: EA, N.
        outer: radius of the helix, mm.
        degrees: its lean from the axis.
    """
    return stiffness / (2 * math.pi * outer * math.cos(math.radians(degrees)))


def section(
    tube: tuple[float, float, float, float],
    winding: tuple[str, float, float],
    pressures: Sequence[float],
    refinement: int = 2,
) -> list[dict[str, Any]]:
    """Rows of the section model at some pressures.

    Args:
        tube: μ in MPa, inner and outer radius and length in mm.
        winding: pattern, its lean from the axis in degrees, and EA of a thread in N.
        pressures: MPa, rising.
        refinement: elements through the wall.

    Raises:
        RuntimeError: the run did not reach the last one.
    """
    mu, inner, outer, length = tube
    pattern, degrees, stiffness = winding
    pitch = 2 * math.pi * outer / math.tan(math.radians(degrees))
    modulus = stiffness / (math.pi * DIAMETER**2 / 4)
    result = run(
        {
            "title": "A tube beside the exact one",
            "actuator": {
                "section": "circle",
                "radius": f"{inner!r} mm",
                "length": f"{length!r} mm",
                "wall": f"{outer - inner!r} mm",
            },
            "materials": {"wall": {"law": "neo-hooke", "mu": f"{mu!r} MPa"}},
            "effects": [
                {"pressure": {"to": f"{pressures[-1]!r} MPa"}},
                {
                    "winding": {
                        "pattern": pattern,
                        "pitch": f"{pitch!r} mm",
                        "fiber": {"modulus": f"{modulus!r} MPa", "diameter": f"{DIAMETER} mm"},
                        "as": "smeared",
                    }
                },
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
        raise RuntimeError(f"{pattern} at {degrees}°: {result.reason}")
    return [
        min(result.rows, key=lambda row: abs(row["pressure_kPa"] - 1e3 * pressure))
        for pressure in pressures
    ]
