"""Numbers as a person reads them: three or four significant digits and a unit."""

from __future__ import annotations

import math

_DECIMALS = {"kPa": 3, "°": 2, "mm": 2, "N": 4, "N mm": 3, "%": 1}
"""The most decimals of a value; what is smaller is round-off or of no use."""


def number(value: float, decimals: int = 4, digits: int = 4) -> str:
    """A number without an exponent and trailing zeros; digits before the point are never rounded.

    Args:
        value: any finite number.
        decimals: the most decimals.
        digits: significant digits.
    """
    if value == 0 or not math.isfinite(value):
        return f"{value + 0.0:g}"
    places = max(0, min(decimals, digits - 1 - math.floor(math.log10(abs(value)))))
    text = f"{value:.{places}f}"
    if places:
        text = text.rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def quantity(value: float, unit: str, digits: int = 4) -> str:
    """A value with its unit, such as "45.11 kPa" or "90°"; a ratio has none."""
    space = "" if unit in ("°", "") else " "
    return f"{number(value, _DECIMALS.get(unit, 4), digits)}{space}{unit}"
