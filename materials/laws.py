"""Isochoric strain energies as pure functions of invariants; MPa.

The functions use arithmetic only, so the same definition takes numpy arrays and ufl expressions.
i1 and i2 are the invariants of the unimodular right Cauchy–Green tensor; for an incompressible
material those of C itself.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


def neo_hooke(i1: Any, i2: Any, mu: Any) -> Any:
    """W = μ/2 (I1 − 3)."""
    return mu / 2 * (i1 - 3)


def mooney_rivlin(i1: Any, i2: Any, c10: Any, c01: Any) -> Any:
    """W = C10 (I1 − 3) + C01 (I2 − 3)."""
    return c10 * (i1 - 3) + c01 * (i2 - 3)


def yeoh(i1: Any, i2: Any, c1: Any, c2: Any, c3: Any) -> Any:
    """W = C1 (I1 − 3) + C2 (I1 − 3)² + C3 (I1 − 3)³."""
    return c1 * (i1 - 3) + c2 * (i1 - 3) ** 2 + c3 * (i1 - 3) ** 3


@dataclasses.dataclass(frozen=True)
class Law:
    """A strain energy and its parameters.

    Attributes:
        name: name in a case.
        energy: strain energy in MPa, a function of i1, i2 and the parameters in order.
        parameters: names of the parameters, all in MPa.
        defaults: values of the parameters that may be left out.
    """

    name: str
    energy: Callable[..., Any]
    parameters: tuple[str, ...]
    defaults: Mapping[str, float]


LAWS: dict[str, Law] = {
    law.name: law
    for law in (
        Law("neo-hooke", neo_hooke, ("mu",), {}),
        Law("mooney-rivlin", mooney_rivlin, ("c10", "c01"), {"c01": 0.0}),
        Law("yeoh", yeoh, ("c1", "c2", "c3"), {"c2": 0.0, "c3": 0.0}),
    )
}


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
