"""Strain energies against independent formulas, and the refusals of bad parameters."""

from __future__ import annotations

import math

import numpy as np
import pytest

from materials.laws import LAWS
from materials.material import Material, energy_slopes, uniaxial_stress
from materials.named import NAMED, named_material

MATERIALS = [
    Material("neo-hooke", {"mu": 0.3}),
    Material("mooney-rivlin", {"c10": 0.1, "c01": 0.04}),
    Material("yeoh", {"c1": 0.11, "c2": 0.02, "c3": 0.001}),
]


@pytest.mark.parametrize("material", MATERIALS)
def test_uniaxial_stress_is_the_derivative_of_the_energy(material: Material) -> None:
    # finite differences of the energy itself, so that law and slopes cannot err together
    stretch, step = np.linspace(0.6, 3.0, 25), 1e-6

    def energy(x: np.ndarray) -> np.ndarray:
        return np.asarray(material.energy(x**2 + 2 / x, 2 * x + 1 / x**2))

    slope = (energy(stretch + step) - energy(stretch - step)) / (2 * step)
    assert uniaxial_stress(material, stretch) == pytest.approx(slope, abs=1e-8)


@pytest.mark.parametrize(
    ("material", "modulus"), list(zip(MATERIALS, (0.3, 0.28, 0.22), strict=True))
)
def test_initial_shear_modulus(material: Material, modulus: float) -> None:
    assert material.initial_shear_modulus == pytest.approx(modulus)
    stretch = np.array([1 + 1e-7])
    young = uniaxial_stress(material, stretch) / 1e-7
    assert young == pytest.approx(3 * modulus, rel=1e-5)


def test_yeoh_value() -> None:
    # by hand at I1 = 4: C1 + C2 + C3
    material = Material("yeoh", {"c1": 0.11, "c2": 0.02, "c3": 0.003})
    assert material.energy(4.0, 3.0) == pytest.approx(0.133)
    assert material.energy(3.0, 3.0) == 0


def test_defaults_and_slopes() -> None:
    material = Material("yeoh", {"c1": 0.11})
    assert material.values == (0.11, 0.0, 0.0)
    first, second = energy_slopes(material, np.array([3.0, 5.0]), np.array([3.0, 4.0]))
    assert first == pytest.approx(0.11)
    assert second == pytest.approx(0.0)


def test_the_same_law_takes_ufl() -> None:
    # one definition for both worlds is the point of this package
    ufl = pytest.importorskip("ufl")
    for law in LAWS.values():
        i1 = ufl.variable(ufl.as_ufl(3.5))
        energy = law.energy(i1, ufl.as_ufl(3.2), *[ufl.as_ufl(0.1) for _ in law.parameters])
        number = law.energy(3.5, 3.2, *[0.1 for _ in law.parameters])
        assert float(ufl.algorithms.apply_algebra_lowering.apply_algebra_lowering(energy)(())) == (
            pytest.approx(number)
        )


@pytest.mark.parametrize(
    ("law", "parameters", "message"),
    [
        ("ogden", {"mu": 1.0}, "law 'ogden': expected one of"),
        ("yeoh", {"c1": 1.0, "mu": 1.0}, "no parameter 'mu'"),
        ("yeoh", {"c2": 1.0}, "needs 'c1'"),
        ("neo-hooke", {"mu": math.nan}, "mu nan MPa"),
        ("neo-hooke", {"mu": 0.0}, "initial shear modulus"),
    ],
)
def test_bad_materials_are_refused(law: str, parameters: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Material(law, parameters)


def test_named_materials_are_the_papers() -> None:
    # the paper: Elastosil 0.11, 0.02; Ecoflex 0.012662, 0; combined base 7.9
    assert NAMED["elastosil-m4601"].values == (0.11, 0.02, 0.0)
    assert NAMED["ecoflex-0030"].values == (0.012662, 0.0, 0.0)
    assert named_material("combined-base").values == (7.9, 0.0, 0.0)
    assert all(material.source for material in NAMED.values())
    assert NAMED["elastosil-m4601"].mass_density == pytest.approx(1.13e-9)
    with pytest.raises(ValueError, match="elastosil-m4601"):
        named_material("elastosil")
