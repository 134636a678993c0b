"""rod.json: the rod as one file, whose fields say their units; rod.schema.json is its schema."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from fiberbend.export.section import Axis, Handed, Section, axis_of
from rod.functions import Floats
from rod.inertia import SectionMass

FORMAT, VERSION = "fiberbend-rod", 2
_KG = 1e3
"""In a tonne."""
_KPA = 1e3
"""In a MPa."""
_DIGITS = 10
_CONVENTIONS = {
    "frame": (
        "x lateral, y from floor to crown, z along the rod; the root's outer face is at z = -cap "
        "length and is clamped, the chamber reaches from 0 to its length, the tip's outer face is "
        "a cap length beyond"
    ),
    "line": "strains and stiffness under 'section' are of the line through the centroids",
    "strains": (
        "stretch: length over length at rest; curvature, side_curvature, twist: angle of the "
        "section about its own x, y and z, in rad per mm of length at rest; curvature > 0 bends "
        "toward -y, side_curvature > 0 toward +x"
    ),
    "stiffness": (
        "second derivatives of the energy per length at rest by the strains, at constant pressure, "
        "where no force acts"
    ),
    "ends": (
        "what a pressure makes of caps and of the chamber's ends beside their forces, by the line "
        "of the centroids: of each cap, and of the chamber within zone from either cap; turn, "
        "side_turn and twist have the signs of the strains, and are spread evenly over their part"
    ),
    "damping": (
        "of Kelvin and Voigt: retardation time times the stiffness of the straight section "
        "without pressure, against the rates of the strains of the line of the centroids"
    ),
    "shear": (
        "stiffness along x and y of sections that move past each other, by the pressure; a force "
        "along x that does not twist acts at the centre of shear, from the centroids"
    ),
    "axis": (
        "the same section by a line at x, y from the centroids, on which a force bends it least; "
        "its stretch is that of the centroids + y curvature - x side_curvature"
    ),
}


def record_of(handed: Handed) -> dict[str, Any]:
    """What the file says, as plain numbers."""
    section, axis = handed.section, axis_of(handed.section)
    return {
        "format": FORMAT,
        "version": VERSION,
        **_plain(handed.about),
        "conventions": _CONVENTIONS,
        "geometry": {
            "chamber_length_mm": handed.length,
            "cap_length_mm": handed.cap_length,
            "outline_mm": _plain(handed.outline),
            "radius_mm": _digits(_radius(handed.outline)),
        },
        "section": {
            "pressure_kPa": _plain(_KPA * section.pressures),
            **_rest(section.rest),
            "stiffness_N_mm": _plain(section.stiffness),
            "chamber_area_mm2": _plain(section.areas),
        },
        "axis": _axis(axis),
        "cap": {"stiffness_N_mm": _plain(handed.cap), **_cap(handed.cap)},
        "ends": _plain(handed.caps.record(section.pressures)),
        "shear": {
            "section_N": _plain(handed.shear),
            "cap_N": _plain(handed.cap_shear),
            "centre_y_mm": _digits(handed.shear_centre),
        },
        "mass": _masses(handed),
        "damping": _damping(handed),
    }


def text(record: dict[str, Any]) -> str:
    """The file: a number a line would be long, so rows of numbers are kept together."""
    return json.dumps(record, indent=1, ensure_ascii=False) + "\n"


def _axis(axis: Axis) -> dict[str, Any]:
    return {
        "x_mm": _digits(axis.x),
        "y_mm": _digits(axis.y),
        **_rest(axis.rest),
        "axial_stiffness_N": _plain(axis.axial),
        "bending_stiffness_N_mm2": _plain(axis.bending),
        "centre_off_mm": _digits(axis.off),
        "coupling_of_stretch_and_twist": _digits(axis.twisted),
        "coupling_of_bending": _digits(axis.mixed),
    }


def _cap(stiffness: Floats) -> dict[str, Any]:
    """A cap by the line through its own centre, which is beside the rod's axis."""
    one = Section(np.zeros(1), np.array([[1.0, 0.0, 0.0, 0.0]]), stiffness[None], np.zeros(1))
    own = axis_of(one)
    return {
        "x_mm": _digits(own.x),
        "y_mm": _digits(own.y),
        "axial_stiffness_N": _digits(own.axial[0]),
        "bending_stiffness_N_mm2": _plain(own.bending[0]),
    }


def _rest(rest: Floats) -> dict[str, Any]:
    names = ("stretch", "curvature_1_per_mm", "side_curvature_1_per_mm", "twist_1_per_mm")
    columns = zip(names, rest.T, strict=True)
    return {f"rest_{name}": _plain(column) for name, column in columns}


def _damping(handed: Handed) -> dict[str, Any] | None:
    """τ, and τ times the stiffness of the section without pressure, which is straight."""
    section = handed.section
    if not handed.retardation or section.pressures[0]:
        return None
    return {
        "retardation_time_s": _digits(handed.retardation),
        "section_N_mm_s": _plain(handed.retardation * section.stiffness[0]),
        "cap_N_mm_s": _plain(handed.retardation * handed.cap),
    }


def _masses(handed: Handed) -> dict[str, Any]:
    if handed.mass is None or handed.cap_mass is None:
        return {"known": False, "missing": handed.no_mass}
    return {"known": True, "section": _mass(handed.mass), "cap": _mass(handed.cap_mass)}


def _mass(mass: SectionMass) -> dict[str, Any]:
    return {
        "per_length_kg_per_mm": _digits(_KG * mass.mass),
        "centre_x_mm": _digits(mass.centre[0]),
        "centre_y_mm": _digits(mass.centre[1]),
        "second_xx_yy_xy_kg_mm": _plain(_KG * np.array(mass.second)),
    }


def _radius(outline: Floats) -> float:
    """Of the circle of the same area, mm."""
    x, y = outline.T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    return float(np.sqrt(area / np.pi))


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return [_plain(row) for row in value]
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    return _digits(value) if isinstance(value, float) else value


def _digits(value: float) -> float:
    return float(f"{float(value):.{_DIGITS}g}")
