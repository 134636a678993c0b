"""Materials: a law with its numbers, and what follows from them; MPa."""

from __future__ import annotations

import cmath
import dataclasses
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from materials.invariants import Invariants
from materials.laws.table import LAWS

if TYPE_CHECKING:
    from materials.stretches import Floats

ROUND_OFF = 1e-9
"""Part of the parameters by which a shear modulus may cancel: no modulus is left then."""
_CIRCLE = [0.02 * cmath.exp(2j * math.pi * i / 16) for i in range(16)]


class _Number(Invariants):
    """At one point, in complex numbers: whoever only checks a material loads no numpy."""

    def ln(self, x: Any) -> Any:
        """Natural logarithm; NaN where the real part is not positive."""
        return cmath.log(x) if complex(x).real > 0 else complex(math.nan, math.nan)

    def exp(self, x: Any) -> Any:
        """Exponential function."""
        return cmath.exp(x)


@dataclasses.dataclass(frozen=True)
class Material:
    """A law with its numbers.

    Attributes:
        law: name of the law, a key of `materials.laws.table.LAWS`.
        parameters: values of its parameters in their units; those with a default may be left out.
        density: density in kg/m³, 0 of what has no weight, or None.
        bulk: bulk modulus in MPa of a nearly incompressible material, or None for incompressible.
        source: where the numbers come from.
        tested: least and greatest stretch of the tests behind them, or None where nobody says.

    Raises:
        ValueError: an unknown law, parameters that are unknown, missing or not allowed, or a
            material without stiffness at rest.
    """

    law: str
    parameters: Mapping[str, float]
    density: float | None = None
    bulk: float | None = None
    source: str = ""
    tested: tuple[float, float] | None = None

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
        least, most = self.tested or (1.0, 2.0)
        if not 0 < least <= 1 <= most or least == most:
            raise ValueError(f"tested {least:g} to {most:g}: expected stretches with 1 within")
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
        energies = (self._energy(_Number(cmath.exp(e), cmath.exp(-e), 1.0)) for e in _CIRCLE)
        slopes = [(energy / e**2).real for energy, e in zip(energies, _CIRCLE, strict=True)]
        return float(sum(slopes)) / len(slopes) / 2

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
        from materials.stretches import Stretches

        return self._energy(Stretches(*stretches))

    def _energy(self, state: Invariants) -> Any:
        law, values = LAWS[self.law], self.values
        return law.energy(state, **{name: values[name] for name in law.used([values])})

    def principal(self, *stretches: Floats) -> tuple[Floats, Floats, Floats]:
        """λi ∂W/∂λi in MPa, exact to round-off by a complex step.

        They are the principal Cauchy stresses of an incompressible material but for a pressure
        that they share, so that only their differences have a meaning.

        Args:
            stretches: principal stretches λ1, λ2, λ3, arrays of one shape; their product is 1.

        Returns:
            Three arrays of this shape; NaN where the law has no value.
        """
        from materials.stretches import slopes

        return slopes(self.energy, stretches)
