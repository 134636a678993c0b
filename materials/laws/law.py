"""What a law is: one strain energy of an isochoric deformation, and its parameters.

A law's file has a function `energy(state, …)` and the table `LAW` of its parameters. The same
function takes numbers, numpy arrays (real or complex) and ufl expressions: it uses arithmetic and
what `Deformation` offers. Stresses, tangents, checks and the keys of a case all follow from it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Literal, Protocol

Unit = Literal["MPa", "1"]
Allowed = Literal["above zero", "other than zero", "any"]


class Deformation(Protocol):
    """What a law may ask of an isochoric deformation with the stretches λ1 λ2 λ3 = 1."""

    @property
    def i1(self) -> Any:
        """First invariant, λ1² + λ2² + λ3²; 3 at rest."""

    @property
    def i2(self) -> Any:
        """Second invariant, λ1⁻² + λ2⁻² + λ3⁻²; 3 at rest."""

    def power_sum(self, exponent: Any) -> Any:
        """λ1^a + λ2^a + λ3^a, smooth where stretches are equal; 3 at rest."""

    def ln(self, x: Any) -> Any:
        """Natural logarithm; NaN, with all its derivatives, where x is not positive."""

    def exp(self, x: Any) -> Any:
        """Exponential function."""


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A parameter of a law.

    Attributes:
        name: its key in a case, and the argument of the energy.
        meaning: what it is, in a few words.
        unit: MPa, or 1 for a pure number.
        allowed: which values are.
        most: greatest magnitude.
        default: value where it is left out; None: it must be given, or belongs to a term.
        term: coefficient of the term that it belongs to, where the law can do without the term;
            where that coefficient is zero or left out, the energy is not given the parameter.
        elsewhere: value in the regions of other laws, for one form covers all regions: with these
            values the energy and its derivatives are zero, whatever the deformation. None: 0 MPa,
            or 1.
    """

    name: str
    meaning: str
    unit: Unit = "MPa"
    allowed: Allowed = "any"
    most: float = math.inf
    default: float | None = None
    term: str | None = None
    elsewhere: float | None = None

    @property
    def neutral(self) -> float:
        """`elsewhere`, its default filled in."""
        return float(self.unit == "1") if self.elsewhere is None else self.elsewhere

    def refusal(self, value: float) -> str | None:
        """Why a value is refused, as 'expected …', or None."""
        if not math.isfinite(value):
            return "expected a finite number"
        if self.allowed == "above zero" and not value > 0:
            return "expected a number above zero"
        if self.allowed == "other than zero" and value == 0:
            return "expected a number other than zero"
        if abs(value) > self.most:
            return f"expected a number from {-self.most:g} to {self.most:g}"
        return None


@dataclasses.dataclass(frozen=True)
class Law:
    """A strain energy and its parameters.

    Attributes:
        name: name in a case.
        energy: strain energy in MPa, a function of a `Deformation` and the parameters by name.
        parameters: the parameters, in the order in which a user would write them.
        exhausted: part of its limiting stretch that a deformation has used, a function like the
            energy, which ends where this is 1; None: it has no limit.

    Raises:
        ValueError: two parameters of one name.
    """

    name: str
    energy: Callable[..., Any]
    parameters: tuple[Parameter, ...]
    exhausted: Callable[..., Any] | None = None

    def __post_init__(self) -> None:
        if len(set(self.names)) < len(self.names):
            raise ValueError(f"{self.name}: a parameter is there twice, {', '.join(self.names)}")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)

    def unknown(self, given: Iterable[str]) -> list[str]:
        """The given names that are no parameters."""
        return [name for name in given if name not in self.names]

    def missing(self, given: Mapping[str, float]) -> list[str]:
        """Parameters that must be given and are not."""
        return [
            parameter.name
            for parameter in self.parameters
            if parameter.name not in given
            and (given.get(parameter.term) if parameter.term else parameter.default is None)
        ]

    def idle(self, given: Mapping[str, float]) -> list[tuple[str, str]]:
        """Given parameters of a term whose coefficient is not given, each with that coefficient."""
        return [
            (parameter.name, parameter.term)
            for parameter in self.parameters
            if parameter.term and parameter.name in given and parameter.term not in given
        ]

    def complete(self, given: Mapping[str, float]) -> dict[str, float]:
        """All parameters in order, defaults filled in; of a term left out what vanishes."""
        values = {p.name: p.neutral if p.default is None else p.default for p in self.parameters}
        return values | {name: float(value) for name, value in given.items()}

    def plain(self, given: Mapping[str, float]) -> dict[str, float]:
        """The given values without those that say no more than leaving them out: zero terms."""
        default = {p.name: p.default for p in self.parameters}
        off = {p.name for p in self.parameters if p.term and not given.get(p.term)}
        return {
            name: value
            for name, value in given.items()
            if name not in off and value != default.get(name)
        }

    def used(self, rows: Iterable[Mapping[str, float]]) -> list[str]:
        """Parameters that the energy needs, by complete sets of values of one or more materials."""
        rows = list(rows)
        return [p.name for p in self.parameters if not p.term or any(row[p.term] for row in rows)]

    def refusals(self, given: Mapping[str, float]) -> Iterator[tuple[str, str]]:
        """Name and reason of every value that is not allowed."""
        for parameter in self.parameters:
            if parameter.name in given:
                reason = parameter.refusal(given[parameter.name])
                if reason is not None:
                    yield parameter.name, reason
