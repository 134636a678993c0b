"""The actuators of the examples, as mappings of plain values with units."""

from __future__ import annotations

from typing import Any

MATERIALS = {"wall": "elastosil-m4601", "floor": "combined-base", "sheath": "ecoflex-0030"}
WINDING = {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}}
SMEARED = {"winding": WINDING["winding"] | {"as": "smeared"}}


def hemicircle(length_mm: float, cap_mm: float = 15.0) -> dict[str, str]:
    """The baseline of Polygerinos et al. 2015 in another length."""
    return {
        "section": "hemicircle",
        "radius": "8 mm",
        "length": f"{length_mm:g} mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "sheath": "1 mm",
        "cap": f"{cap_mm:g} mm",
    }


def case(
    title: str, actuator: dict[str, str], *effects: dict[str, Any], **rest: Any
) -> dict[str, Any]:
    """A case of the actuator with effects, and what else it says."""
    return {
        "title": title,
        "actuator": actuator,
        "materials": MATERIALS,
        "effects": list(effects),
        **rest,
    }
