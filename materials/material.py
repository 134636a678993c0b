"""Materials: a law with its numbers, and what follows from them; MPa."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from materials.laws import LAWS


@dataclasses.dataclass(frozen=True)
class Material:
    """A law with its numbers.

    Attributes:
        law: name of the law, a key of `LAWS`.
        parameters: values in MPa; those with a default may be left out.
        density: density in kg/m³, or None.
        bulk: bulk modulus in MPa of a nearly incompressible material, or None for incompressible.
        source: where the numbers come from.

    Raises:
        ValueError: an unknown law, unknown, missing or infinite parameters, or a material without
            stiffness at rest.
    """

    law: str
    parameters: Mapping[str, float]
    density: float | None = None
    bulk: float | None = None
    source: str = ""

    def __post_init__(self) -> None:
        if self.law not in LAWS:
            raise ValueError(f"law {self.law!r}: expected one of {', '.join(LAWS)}")
        law = LAWS[self.law]
        names = ", ".join(law.parameters)
        unknown = sorted(set(self.parameters) - set(law.parameters))
        if unknown:
            raise ValueError(f"{self.law} has no parameter {unknown[0]!r}: expected {names}")
        missing = [n for n in law.parameters if n not in {**law.defaults, **self.parameters}]
        if missing:
            raise ValueError(f"{self.law} needs {missing[0]!r}: expected {names}")
        for name, value in self.parameters.items():
            if not math.isfinite(value):
                raise ValueError(f"{name} {value} MPa: expected a finite number")
        for name in ("density", "bulk"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} {value}: expected a positive number")
        if not self.initial_shear_modulus > 0:
            raise ValueError(
                f"initial shear modulus {self.initial_shear_modulus:g} MPa: expected more than 0"
            )

    @property
    def values(self) -> tuple[float, ...]:
        """Parameters in the law's order, defaults filled in; MPa."""
        law = LAWS[self.law]
        return tuple({**law.defaults, **self.parameters}[name] for name in law.parameters)

    @property
    def initial_shear_modulus(self) -> float:
        """Shear modulus at rest in MPa, 2 (∂W/∂I1 + ∂W/∂I2)."""
        return float(2 * sum(energy_slopes(self, np.array(3.0), np.array(3.0))))

    @property
    def mass_density(self) -> float | None:
        """Density in t/mm³, consistent with mm, N, MPa; or None."""
        return None if self.density is None else self.density * 1e-12

    def energy(self, i1: Any, i2: Any) -> Any:
        """Strain energy in MPa of numpy arrays or ufl expressions."""
        return LAWS[self.law].energy(i1, i2, *self.values)


def energy_slopes(
    material: Material, i1: NDArray[np.float64], i2: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """∂W/∂I1 and ∂W/∂I2 in MPa, exact to round-off by a complex step."""
    step = 1e-30
    first = np.imag(material.energy(i1 + 1j * step, i2 + 0j)) / step
    second = np.imag(material.energy(i1 + 0j, i2 + 1j * step)) / step
    return first, second


def uniaxial_stress(material: Material, stretch: NDArray[np.float64]) -> NDArray[np.float64]:
    """Nominal stress in MPa of a bar, 2 (λ − λ⁻²) (∂W/∂I1 + ∂W/∂I2 / λ), incompressible.

    Args:
        material: the material.
        stretch: λ, (n,).

    Returns:
        Force per undeformed area, (n,).
    """
    i1, i2 = stretch**2 + 2 / stretch, 2 * stretch + 1 / stretch**2
    first, second = energy_slopes(material, i1, i2)
    return np.asarray(2 * (stretch - 1 / stretch**2) * (first + second / stretch), dtype=float)
