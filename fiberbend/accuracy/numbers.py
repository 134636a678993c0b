"""Dimensionless numbers of an actuator, by which what is known of one is carried to another."""

from __future__ import annotations

import math

from fiberbend.case import convert
from fiberbend.case.case import Case

STIFF = "floor's modulus"
"""Of the stiffer of floor and layer."""
PITCH = "pitch"
SOFT = "thread"
"""The one number with a lower limit only: a stiffer thread is no other actuator."""


def radius(case: Case) -> float:
    """Half the chamber's width, mm: the length by which all others are divided."""
    return convert.dimensions(case.actuator).profile.half_width


def curvature(case: Case, angle: float) -> float:
    """Radius times the curvature of an actuator that bends uniformly to an angle in rad."""
    return abs(angle) * radius(case) / case.actuator.length


def numbers(case: Case) -> dict[str, float]:
    """What a section and its winding are like; zero for what is not there.

    Thicknesses, height and pitch are over the radius r, shear moduli at rest over the wall's μ;
    `thread` is E A / (μ p r), how hard the thread stretches beside the rubber that it holds.
    """
    spec = case.actuator
    profile = convert.dimensions(spec).profile
    r = profile.half_width
    moduli = {
        part: convert.material(material).initial_shear_modulus
        for part, material in dict(case.materials).items()
        if material is not None
    }
    wall = moduli["wall"]
    found = {
        "height": (profile.top - profile.bottom) / r,
        "wall": spec.wall / r,
        "floor": ((spec.floor or 0.0) + (spec.layer or 0.0)) / r,
        "sheath": (spec.sheath or 0.0) / r,
        STIFF: max((moduli.get(p, 0.0) for p in ("floor", "layer")), default=0) / wall,
        "sheath's modulus": moduli.get("sheath", 0.0) / wall,
    }
    turns = case.turns
    if turns is not None:
        found[PITCH] = turns.spacing / r
        found[SOFT] = turns.stiffness / (wall * turns.spacing * r)
    return {name: float(f"{value:.6g}") for name, value in found.items() if math.isfinite(value)}
