"""Names of the states that are asked for, as files bear them; no two alike."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

_DIGITS = 9
"""Decimals beyond which two angles are one."""
_NOTHING = 5e-3
"""Degrees, kPa or newtons that are round-off to who looks at a picture."""


def angle_labels(angles: Sequence[float]) -> dict[float, str]:
    """Labels of bending angles in rad: whole degrees, decimals where two would be alike."""
    degrees = {angle: math.degrees(angle) for angle in angles}
    labels = {}
    for angle, value in degrees.items():
        others = [other for key, other in degrees.items() if key != angle]
        digits = 0
        while digits < _DIGITS and any(
            f"{other:.{digits}f}" == f"{value:.{digits}f}" for other in others
        ):
            digits += 1
        width = 3 if digits == 0 else 4 + digits
        labels[angle] = f"{value:0{width}.{digits}f}deg"
    return labels


def pressure_labels(pressures: Sequence[float]) -> dict[float, str]:
    """Labels of pressures in MPa: kPa with six digits, all where two would be alike."""
    short = {pressure: f"{1e3 * pressure:g}kPa" for pressure in pressures}
    texts = list(short.values())
    return {
        pressure: label if texts.count(label) == 1 else f"{1e3 * pressure!r}kPa"
        for pressure, label in short.items()
    }


def unused(label: str, taken: Collection[str]) -> str:
    """A label, or its next repetition where the state is met again: 090deg, 090deg-2."""
    found, times = label, 1
    while found in taken:
        times += 1
        found = f"{label}-{times}"
    return found


def short_number(value: float) -> str:
    """A number for a caption: to a tenth, below ten to three digits; 0 for less than 0.005."""
    if abs(value) < _NOTHING:
        return "0"
    text = f"{value:.1f}".removesuffix(".0") if abs(value) >= 9.995 else f"{value:.3g}"
    return text.replace("-", "−")
