"""Physical quantities with their unit, read into mm, N, MPa, s, t and rad.

In these units a density is in t/mm³, an acceleration in mm/s² and a volume in mm³, and a density
times an acceleration is a force density in N/mm³ without further factors.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import re
from decimal import Decimal
from typing import Any

_NUMBER = re.compile(
    r"\s*([+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan|inf(?:inity)?))\s*(.*?)\s*$",
    re.IGNORECASE,
)


@dataclasses.dataclass(frozen=True)
class Kind:
    """A kind of physical quantity.

    Attributes:
        name: what a message calls it, with its article.
        unit: the internal unit.
        shown: the unit in which values are written back.
        example: a value as one would write it.
        factors: what common units are in the internal unit, so that most cases need no pint.
    """

    name: str
    unit: str
    shown: str
    example: str
    factors: dict[str, str]


_STRESS = {"MPa": "1", "kPa": "1e-3", "Pa": "1e-6", "GPa": "1e3", "bar": "0.1", "mbar": "1e-4"}

KINDS = {
    "length": Kind(
        "a length", "mm", "mm", "8 mm", {"mm": "1", "cm": "10", "m": "1000", "um": "1e-3"}
    ),
    "pressure": Kind("a pressure", "MPa", "kPa", "200 kPa", _STRESS),
    "modulus": Kind("a modulus", "MPa", "MPa", "0.11 MPa", _STRESS),
    "angle": Kind("an angle", "rad", "deg", "90 deg", {"rad": "1", "deg": repr(math.pi / 180)}),
    "volume": Kind(
        "a volume", "mm^3", "mL", "45 mL", {"mm^3": "1", "mL": "1e3", "cm^3": "1e3", "L": "1e6"}
    ),
    "density": Kind(
        "a density",
        "t/mm^3",
        "g/cm^3",
        "1.1 g/cm^3",
        {"t/mm^3": "1", "g/cm^3": "1e-9", "kg/m^3": "1e-12"},
    ),
    "acceleration": Kind(
        "an acceleration",
        "mm/s^2",
        "m/s^2",
        "9.81 m/s^2",
        {"mm/s^2": "1", "m/s^2": "1e3"},
    ),
    "penalty stiffness": Kind(
        "a pressure per depth",
        "MPa/mm",
        "MPa/mm",
        "60 MPa/mm",
        {"MPa/mm": "1", "kPa/mm": "1e-3", "N/mm^3": "1"},
    ),
    "force": Kind("a force", "N", "N", "0.1 N", {"N": "1", "mN": "1e-3", "kN": "1e3"}),
    "time": Kind("a time", "s", "ms", "5 ms", {"s": "1", "ms": "1e-3"}),
    "frequency": Kind("a frequency", "Hz", "Hz", "100 Hz", {"Hz": "1", "kHz": "1e3"}),
    "conductance": Kind(
        "a sonic conductance",
        "dm^3/(s*bar)",
        "dm^3/(s*bar)",
        "0.03 dm^3/(s*bar)",
        {"dm^3/(s*bar)": "1", "L/(s*bar)": "1"},
    ),
}
"""The kinds of quantity that a case or an option can give."""


def parse(text: Any, kind: str) -> float:
    """Read a quantity into the internal unit of its kind.

    Args:
        text: as the case gives it, such as "8 mm".
        kind: a key of `KINDS`.

    Returns:
        The value in the internal unit.

    Raises:
        ValueError: not a quantity of this kind, or not finite.
    """
    what = KINDS[kind]
    wanted = f'{what.name} with its unit such as "{what.example}"'
    match = _NUMBER.match(text) if isinstance(text, str) else None
    if match is None or not match[2]:
        raise ValueError(f"expected {wanted}")
    number, unit = match.groups()
    if not math.isfinite(float(number)):
        raise ValueError(f"expected {what.name} that is finite")
    if unit in what.factors:
        value = float(Decimal(number) * Decimal(what.factors[unit]))
    else:
        value = _convert(float(number), unit, what, wanted)
    if not math.isfinite(value):
        raise ValueError(f"expected {what.name} that is finite")
    return value


def show(value: float, kind: str) -> str:
    """Write a value so that `parse` returns exactly it, in the usual unit if that is possible."""
    what = KINDS[kind]
    scaled = float(Decimal(repr(value)) / Decimal(what.factors[what.shown]))
    text = f"{_plain(scaled)} {what.shown}"
    return text if parse(text, kind) == value else f"{_plain(value)} {what.unit}"


def _plain(value: float) -> str:
    text = repr(value)
    return text.removesuffix(".0")


def _convert(number: float, unit: str, what: Kind, wanted: str) -> float:
    if any(unit in kind.factors for kind in KINDS.values()):
        raise ValueError(f"expected {wanted}")
    registry = _registry()
    try:
        quantity = registry.Quantity(number, registry.parse_units(unit))
    except Exception:
        raise ValueError(f"expected {wanted}; there is no unit {unit!r}") from None
    target = registry.parse_units(what.unit)
    # To pint an angle is a pure number, and so is a percentage.
    angular = [registry.get_root_units(u)[1] == registry.radian for u in (quantity.units, target)]
    if quantity.dimensionality != target.dimensionality or angular[0] != angular[1]:
        raise ValueError(f"expected {wanted}")
    return float(quantity.to(target).magnitude)


@functools.cache
def _registry() -> Any:
    # Half a second: only a case with an unusual unit pays for it.
    import pint

    return pint.UnitRegistry()
