"""Measured points whose columns hold another unit than their names say.

The run itself is the measure: a model and an experiment differ by tens of per cent, units by a
factor of four and more.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from analytic.stress import Floats
from fiberbend import columns as col
from fiberbend.compare.others import through_rows
from fiberbend.drawing.overlay import Points
from fiberbend.schema.units import factor

_TENS = {10.0**n: f"{10.0**n:g} times too large" for n in (1, 2, 4, 5, 6)} | {
    10.0**-n: f"{10.0**n:g} times too small" for n in (1, 4, 5, 6)
}
PRESSURES = {
    "tens": _TENS,
    "units": {
        1e3: "Pa",
        10.0: "mbar",
        7.50062: "mmHg",
        0.1450377: "psi",
        1e-2: "bar",
        1e-3: "MPa",
    },
}
ANGLES = {
    "tens": _TENS
    | {1e-2: "100 times too small", 1e-3: "1000 times too small", 1e3: "1000 times too large"},
    "units": {math.pi / 180: "radians", 1 / 360: "turns"},
}
FORCES = {
    "tens": _TENS | {1e-2: "100 times too small"},
    "units": {1e3: "mN", 101.97: "gf", 0.2248: "lbf", 1e-3: "kN"},
}
"""What a value is in kPa, degrees or N, times a factor, and what it then looks like: so many times
too large or too small, or in another unit."""
_LEAST = 2.5
"""No unit differs by less from the right one."""
_NEAR = 1.35
"""Factor within which a model and an experiment agree in the median."""
_SCATTER = 1.6
"""Factor within which all points must tell the same."""
_SMALL = 0.1
"""Part of the greatest value below which a point's zero error counts."""


def unit_remark(
    rows: Sequence[dict[str, Any]],
    points: Points,
    blocked: bool,
    units: tuple[str, str] | None = None,
) -> str:
    """What the columns of a file look like, where that is not their unit; empty where they fit.

    Args:
        rows: the history of the run.
        points: the measured ones, in kPa and in degrees or N.
        blocked: forces were measured and not angles.
        units: in which the file is said to have them, such as "psi" and "deg"; kPa, and degrees or
            N, unless given.
    """
    kinds = ("pressure", "force" if blocked else "angle")
    usual = ("kPa", "N" if blocked else "deg")
    said = units or usual
    # of one of the units that are said, in the usual one
    sizes = [
        factor(unit, kind) / factor(own, kind)
        for unit, own, kind in zip(said, usual, kinds, strict=True)
    ]
    value, name, known = (
        (col.TIP_FORCE, "forces", FORCES) if blocked else (col.ANGLE, "angles", ANGLES)
    )
    pressures = np.abs([row[col.PRESSURE] for row in rows])
    rising = rows[: int(np.argmax(pressures)) + 1]
    counts = (np.abs(points.across) > _SMALL * np.abs(points.across).max()) & (
        np.abs(points.up) > _SMALL * np.abs(points.up).max()
    )
    across, up = points.across[counts], points.up[counts]
    with np.errstate(divide="ignore", invalid="ignore"):
        looks = {
            "pressures": _unit(
                across / through_rows(rows, value, col.PRESSURE)(up),
                _seen(PRESSURES, "kPa", sizes[0]),
            ),
            name: _unit(
                up / through_rows(rising, col.PRESSURE, value)(across),
                _seen(known, "N" if blocked else "degrees", sizes[1]),
            ),
        }
    texts = [f"{what} look like {unit}" for what, unit in looks.items() if unit]
    texts = [text.replace("look like 1", "look 1") for text in texts]
    if not texts:
        return ""
    wanted = f"expected {said[0]} and {'degrees' if said[1] == 'deg' else said[1]}"
    return f"{points.label}: {' or '.join(texts)} beside the run, {wanted}"


def _seen(known: Mapping[str, Mapping[float, str]], usual: str, size: float) -> dict[float, str]:
    """What a value looks like, by what it is times too large where it is read in a unit.

    Args:
        known: what it is by the factor on a value in the usual unit.
        usual: the usual unit.
        size: of the unit in which it is read, in the usual one.
    """
    units = {k * size: name for k, name in known["units"].items()}
    return {**known["tens"], size: usual, **units}


def _unit(factors: Floats, known: Mapping[float, str]) -> str:
    """The unit that explains the factors between measured values and the run's, or nothing."""
    valid = factors[np.isfinite(factors) & (factors > 0)]
    if len(valid) < max(2, len(factors) / 2):
        return ""
    logs = np.log(valid)
    middle = float(np.median(logs))
    if abs(middle) < math.log(_LEAST) or np.abs(logs - middle).max() > math.log(_SCATTER):
        return ""
    nearest = min(known, key=lambda factor: abs(math.log(factor) - middle))
    return known[nearest] if abs(math.log(nearest) - middle) < math.log(_NEAR) else ""
