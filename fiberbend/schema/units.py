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
    # whole: of "85" the 5 is no unit
    r"((?>[+-]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|nan|inf(?:inity)?)))\s*(\S.*)",
    re.IGNORECASE,
)
_UNIT = re.compile(
    r"""(?>
        (?>[^\W\d¹²³⁰⁴-⁹]|[%°‰]) (?>[^\W¹²³⁰⁴-⁹]|[°])*                # a name, such as mm or H2O
        (?>⁻?[¹²³⁴-⁹] | \s*(?>\*\*|\^)\s*[+-]?[0-9](?:\.[0-9]{1,3})?)?  # its exponent, of one digit
        | [*/()\s·]
    )+""",
    re.VERBOSE,
)
"""A product of names with small exponents: pint, asked for more, computes m**9**9 and takes a
comment or a semicolon for the end."""
_LONGEST = 100
"""Characters of a quantity."""
_LEAST, _MOST = 1e-100, 1e100
"""What a quantity other than zero lies between: with squares of it a computer still computes."""


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
    "angle": Kind(
        "an angle",
        "rad",
        "deg",
        "90 deg",
        {"rad": "1"} | dict.fromkeys(("deg", "degree", "degrees", "°"), repr(math.pi / 180)),
    ),
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
    "moment": Kind(
        "a moment", "N*mm", "N*mm", "5 N*mm", {"N*mm": "1", "mN*m": "1", "N*m": "1e3", "N mm": "1"}
    ),
    "mass": Kind("a mass", "t", "g", "20 g", {"g": "1e-6", "kg": "1e-3", "mg": "1e-9"}),
    "strain": Kind("a strain", "percent", "%", "60 %", {"%": "1", "percent": "1"}),
    "energy": Kind("an energy", "mJ", "mJ", "20 mJ", {"mJ": "1", "J": "1e3", "N*mm": "1"}),
    "curvature": Kind(
        "a curvature", "1/mm", "1/m", "20 1/m", {"1/mm": "1", "1/cm": "0.1", "1/m": "1e-3"}
    ),
    "accuracy": Kind("an accuracy", "percent", "%", "1 %", {"%": "1", "percent": "1"}),
    "time": Kind("a time", "s", "ms", "5 ms", {"s": "1", "ms": "1e-3"}),
    "frequency": Kind("a frequency", "Hz", "Hz", "100 Hz", {"Hz": "1", "kHz": "1e3"}),
    "rate": Kind("a rate", "1/s", "1/s", "0.5 1/s", {"1/s": "1", "1/ms": "1e3"}),
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
    if not isinstance(text, str) or len(text) > _LONGEST:
        raise ValueError(f"expected {wanted}")
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        raise ValueError(f"expected {wanted}")
    number, unit = match.groups()
    size = abs(float(number))
    if not math.isfinite(size):
        raise ValueError(f"expected {what.name} that is finite")
    if size == 0:
        if re.search("[1-9]", re.split("[eE]", number)[0]):
            raise ValueError(_beyond(what))
        number = "0"
    if unit in what.factors:
        value = float(Decimal(number) * Decimal(what.factors[unit]))
    else:
        value = _convert(float(number), unit, what, wanted)
    if value != 0 and not _LEAST <= abs(value) <= _MOST:
        raise ValueError(_beyond(what))
    return value


def factor(unit: str, kind: str) -> float:
    """What one of a unit is in the internal unit of a kind.

    Args:
        unit: such as "psi".
        kind: a key of `KINDS`.

    Raises:
        ValueError: no unit of that kind.
    """
    what = KINDS[kind]
    try:
        return parse(f"1 {unit}", kind)
    except ValueError:
        raise ValueError(f"expected a unit of {what.name} such as {what.shown}") from None


def show(value: float, kind: str) -> str:
    """Write a value so that `parse` returns exactly it, in the usual unit if that is possible."""
    what = KINDS[kind]
    scaled = Decimal(repr(value)) / Decimal(what.factors[what.shown])
    for digits in (15, 16, 17):
        text = f"{_plain(float(f'{scaled:.{digits}g}'))} {what.shown}"
        if parse(text, kind) == value:
            return text
    return f"{_plain(value)} {what.unit}"


def _beyond(what: Kind) -> str:
    return f"expected {what.name} from {_LEAST:g} to {_MOST:g} {what.unit}, or zero"


def _plain(value: float) -> str:
    text = repr(value)
    return text.removesuffix(".0")


def _convert(number: float, unit: str, what: Kind, wanted: str) -> float:
    if any(unit in kind.factors for kind in KINDS.values()):
        raise ValueError(f"expected {wanted}")
    unknown = f"expected {wanted}; there is no unit {unit[:40]!r}"
    if not _UNIT.fullmatch(unit):
        raise ValueError(unknown)
    registry = _registry()
    try:
        units, target = registry.parse_units(unit), registry.parse_units(what.unit)
        # To pint an angle is a pure number, and so is a percentage.
        angular = [registry.get_root_units(u)[1] == registry.radian for u in (units, target)]
        if units.dimensionality != target.dimensionality or angular[0] != angular[1]:
            raise ValueError(f"expected {wanted}")
        return float(registry.Quantity(number, units).to(target).magnitude)
    except ValueError:
        raise
    except Exception:
        raise ValueError(unknown) from None


@functools.cache
def _registry() -> Any:
    # Half a second: only a case with an unusual unit pays for it.
    import pint

    return pint.UnitRegistry()
