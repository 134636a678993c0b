"""Natural frequencies and modes of an actuator as a rod, at pressures that are asked for."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.slender.actuator import Slender, slender
from fiberbend.slender.timed import equilibrium
from rod.functions import Floats
from rod.modes import modes

SHOWN = 0.1
"""Part of the length by which a mode that is drawn moves its farthest section."""


@dataclasses.dataclass(frozen=True)
class Vibration:
    """Small undamped vibrations about a state at rest.

    Attributes:
        pressure: P, MPa.
        angle: by which it bends, rad.
        frequencies: the lowest ones, (k,), Hz; below zero where a mode is unstable: it grows by
            exp(2π |f| t).
        line: places of its sections, (n, 3), mm.
        moved: of the same in each mode, at an amplitude of `SHOWN`, (k, n, 3), mm.
    """

    pressure: float
    angle: float
    frequencies: Floats
    line: Floats
    moved: Floats


def vibrations(case: Case, pressures: Sequence[float], count: int) -> list[Vibration]:
    """The lowest modes of a case at pressures.

    Args:
        case: of model rod; its loads beside the pressure act whole.
        pressures: in MPa, none above that of the case.
        count: modes at each.

    Raises:
        CaseError: a material without density, a load without a potential, no equilibrium, or a
            pressure beyond that of the case.
    """
    _refuse(case, pressures)
    rod = slender(case)
    return [_about(rod, pressure, count) for pressure in pressures]


def _refuse(case: Case, pressures: Sequence[float]) -> None:
    problems = [
        Problem(f"materials.{name}.density", "missing, expected one: what vibrates has mass")
        for name, material in convert.site(case).materials.items()
        if material.mass_density is None
    ]
    load = case.inflation
    if load is None or load.to is None:
        text = "no pressure to reach, expected one: the law of the section is known up to it"
        problems.append(Problem("effects", text))
    else:
        slack = 1e-9 * abs(load.to)
        problems += [
            Problem("--at", f"{1e3 * p:.6g} kPa, expected from 0 to {1e3 * load.to:.6g} kPa")
            for p in pressures
            if not min(load.to, 0.0) - slack <= p <= max(load.to, 0.0) + slack
        ]
    if problems:
        raise CaseError(problems)


def _about(rod: Slender, pressure: float, count: int) -> Vibration:
    point = equilibrium(rod, pressure)
    shape, level = point.state.shape, point.state.level
    try:
        found = modes(rod.rod, shape, level, count)
    except ValueError as error:
        raise CaseError([Problem("effects", str(error))]) from None
    length = float(rod.rod.layout.lengths.sum())
    moved = []
    for strains in found.strains:
        rates = shape.moved(strains)[..., 3]
        size = SHOWN * length / float(np.linalg.norm(rates, axis=1).max())
        # the tip's own direction first: a picture and its mirror image are one mode
        moved.append(math.copysign(size, rates[-1, 1]) * rates)
    return Vibration(pressure, point.angle, found.frequencies, shape.places, np.array(moved))
