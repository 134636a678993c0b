"""A rubber of every law, with the textbook stresses of simple deformations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from materials.material import Material

Floats = NDArray[np.float64]

RUBBERS = {
    "neo-hooke": Material("neo-hooke", {"mu": 0.3}),
    "mooney-rivlin": Material("mooney-rivlin", {"c10": 0.1, "c01": 0.04}),
    "yeoh": Material("yeoh", {"c1": 0.11, "c2": 0.02, "c3": 0.001}),
    "gent": Material("gent", {"mu": 0.3, "jm": 25.0}),
    "ogden": Material(
        "ogden",
        {"mu1": 0.42, "alpha1": 1.3, "mu2": 0.006, "alpha2": 5.0, "mu3": 0.01, "alpha3": -2.0},
    ),
}
"""By the name of the law; Ogden's numbers are near his own for Treloar's rubber."""
MODULI = {
    "neo-hooke": 0.3,
    "mooney-rivlin": 0.28,
    "yeoh": 0.22,
    "gent": 0.3,
    "ogden": 0.436,
}
"""Shear moduli at rest, MPa."""


def slopes(material: Material, i1: Floats, i2: Floats) -> tuple[Floats, Floats]:
    """∂W/∂I1 and ∂W/∂I2 by hand, for the laws of the invariants."""
    v, zero = material.values, np.zeros_like(i1)
    return {
        "neo-hooke": lambda: (zero + v["mu"] / 2, zero),
        "mooney-rivlin": lambda: (zero + v["c10"], zero + v["c01"]),
        "yeoh": lambda: (v["c1"] + 2 * v["c2"] * (i1 - 3) + 3 * v["c3"] * (i1 - 3) ** 2, zero),
        "gent": lambda: (v["mu"] / 2 * v["jm"] / (v["jm"] - i1 + 3), zero),
    }[material.law]()


def _ogden(material: Material, stretch: Floats, across: float) -> Floats:
    """Σ 2 μ/α (λ^(α−1) − λ^(c α − 1)), λ^c the stretch of the free direction."""
    v = material.values
    terms = [(v[f"mu{i}"], v[f"alpha{i}"]) for i in (1, 2, 3)]
    return np.asarray(
        sum(2 * mu / a * (stretch ** (a - 1) - stretch ** (across * a - 1)) for mu, a in terms)
    )


def uniaxial_stress(material: Material, stretch: Floats) -> Floats:
    """Nominal stress of a bar, 2 (λ − λ⁻²) (W1 + W2/λ), MPa."""
    if material.law == "ogden":
        return _ogden(material, stretch, -0.5)
    first, second = slopes(material, stretch**2 + 2 / stretch, 2 * stretch + 1 / stretch**2)
    return np.asarray(2 * (stretch - stretch**-2.0) * (first + second / stretch))


def equibiaxial_stress(material: Material, stretch: Floats) -> Floats:
    """Nominal stress of a sheet, 2 (λ − λ⁻⁵) (W1 + λ² W2), MPa."""
    if material.law == "ogden":
        return _ogden(material, stretch, -2.0)
    first, second = slopes(material, 2 * stretch**2 + stretch**-4.0, stretch**4 + 2 * stretch**-2.0)
    return np.asarray(2 * (stretch - stretch**-5.0) * (first + stretch**2 * second))


def shear_stress(material: Material, stretch: Floats) -> Floats:
    """Nominal stress of a sheet in pure shear, 2 (λ − λ⁻³) (W1 + W2), MPa."""
    if material.law == "ogden":
        return _ogden(material, stretch, -1.0)
    invariant = 1 + stretch**2 + stretch**-2.0
    first, second = slopes(material, invariant, invariant)
    return np.asarray(2 * (stretch - stretch**-3.0) * (first + second))
