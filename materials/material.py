"""Materials: a law with its numbers, and what follows from them; MPa."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from materials.laws.table import LAWS

Floats = NDArray[np.float64]
ROUND_OFF = 1e-9
"""Part of the parameters by which a shear modulus may cancel: no modulus is left then."""
_STEP = 1e-30
_CIRCLE = 0.02 * np.exp(2j * np.pi * np.arange(16) / 16)


class Stretches:
    """A deformation by its principal stretches: a `materials.laws.law.Deformation` in numpy.

    Args:
        stretches: λ1, λ2, λ3, arrays of one shape, real or complex.
    """

    def __init__(self, *stretches: Any) -> None:
        self._stretches = stretches

    @property
    def i1(self) -> Any:
        """λ1² + λ2² + λ3²."""
        a, b, c = self._stretches
        return a * a + b * b + c * c

    @property
    def i2(self) -> Any:
        """λ1² λ2² + λ2² λ3² + λ3² λ1²."""
        a, b, c = (stretch * stretch for stretch in self._stretches)
        return a * b + b * c + c * a

    def power_sum(self, exponent: Any) -> Any:
        """λ1^a + λ2^a + λ3^a."""
        a, b, c = self._stretches
        return a**exponent + b**exponent + c**exponent

    def ln(self, x: Any) -> Any:
        """Natural logarithm; NaN where the real part is not positive."""
        good = np.real(x) > 0
        # of a complex number both parts: the imaginary one carries a derivative
        none = np.nan if np.isrealobj(x) else complex(np.nan, np.nan)
        return np.where(good, np.log(np.where(good, x, 1.0)), none)

    def exp(self, x: Any) -> Any:
        """Exponential function."""
        return np.exp(x)


@dataclasses.dataclass(frozen=True)
class Material:
    """A law with its numbers.

    Attributes:
        law: name of the law, a key of `materials.laws.table.LAWS`.
        parameters: values of its parameters in their units; those with a default may be left out.
        density: density in kg/m³, 0 of what has no weight, or None.
        bulk: bulk modulus in MPa of a nearly incompressible material, or None for incompressible.
        source: where the numbers come from.

    Raises:
        ValueError: an unknown law, parameters that are unknown, missing or not allowed, or a
            material without stiffness at rest.
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
        names = ", ".join(law.names)
        for name in law.unknown(self.parameters):
            raise ValueError(f"{self.law} has no parameter {name!r}: expected {names}")
        for name in law.missing(self.parameters):
            raise ValueError(f"{self.law} needs {name!r}: expected {names}")
        for name, term in law.idle(self.parameters):
            raise ValueError(f"{name} has no effect without {term}")
        for name, reason in law.refusals(self.parameters):
            unit = {p.name: "" if p.unit == "1" else f" {p.unit}" for p in law.parameters}[name]
            raise ValueError(f"{name} {self.parameters[name]}{unit}: {reason}")
        if self.bulk is not None and not (math.isfinite(self.bulk) and self.bulk > 0):
            raise ValueError(f"bulk {self.bulk}: expected a positive number")
        if self.density is not None and not (math.isfinite(self.density) and self.density >= 0):
            raise ValueError(f"density {self.density}: expected a number, 0 or more")
        stresses = (p.name for p in law.parameters if p.unit != "1")
        scale = sum(abs(self.values[name]) for name in stresses)
        if not self.initial_shear_modulus > ROUND_OFF * scale:
            raise ValueError(
                f"initial shear modulus {self.initial_shear_modulus:g} MPa: expected more than 0"
            )

    @property
    def values(self) -> dict[str, float]:
        """All parameters in the law's order, defaults filled in."""
        return LAWS[self.law].complete(self.parameters)

    @property
    def initial_shear_modulus(self) -> float:
        """Shear modulus at rest in MPa: W = 2 μ ε² for the stretches exp(ε), exp(−ε), 1.

        The second derivative by Cauchy's formula on a circle of ε, good to 3e-13 of the law's
        parameters.
        """
        energy = self.energy(np.exp(_CIRCLE), np.exp(-_CIRCLE), np.ones_like(_CIRCLE))
        return float(np.mean(energy / _CIRCLE**2).real) / 2

    @property
    def mass_density(self) -> float | None:
        """Density in t/mm³, consistent with mm, N, MPa; or None."""
        return None if self.density is None else self.density * 1e-12

    def energy(self, *stretches: Any) -> Any:
        """Strain energy in MPa of principal stretches λ1, λ2, λ3 whose product is 1.

        Args:
            stretches: arrays of one shape, real or complex.

        Returns:
            Array of this shape; NaN where the law has no value.
        """
        law, values = LAWS[self.law], self.values
        used = {name: values[name] for name in law.used([values])}
        return law.energy(Stretches(*stretches), **used)

    def principal(self, *stretches: Floats) -> tuple[Floats, Floats, Floats]:
        """λi ∂W/∂λi in MPa, exact to round-off by a complex step.

        They are the principal Cauchy stresses of an incompressible material but for a pressure
        that they share, so that only their differences have a meaning.

        Args:
            stretches: principal stretches λ1, λ2, λ3, arrays of one shape; their product is 1.

        Returns:
            Three arrays of this shape; NaN where the law has no value.
        """

        def slope(i: int) -> Floats:
            moved = [np.asarray(s, dtype=complex) for s in stretches]
            moved[i] = moved[i] * (1 + 1j * _STEP)
            return np.asarray(np.imag(self.energy(*moved)) / _STEP, dtype=float)

        return slope(0), slope(1), slope(2)
