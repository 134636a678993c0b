"""The best combination solved anew: sections, cells with every turn, and a body with a held tip."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from bench.paper.assumed import solving
from bench.paper.assumed.grid import SECTIONS, Grid
from bench.paper.assumptions import DEFAULT, Combination
from bench.paper.combination import alone
from bench.paper.facts import TABLE_I
from bench.paper.runs import Key

HELD_OUT: tuple[tuple[Combination, Key], ...] = (
    (DEFAULT, (10.0, 160.0, 2.0)),
    (dataclasses.replace(DEFAULT, pitch=4.5, floor=2.25), (8.0, 160.0, 2.0)),
    (dataclasses.replace(DEFAULT, pitch=2.25, floor=2.75), (6.0, 130.0, 2.0)),
    (dataclasses.replace(DEFAULT, pitch=4.0, floor=2.25), (8.0, 160.0, 3.0)),
    (dataclasses.replace(DEFAULT, pitch=2.0, floor=2.25, whole=True), (12.0, 160.0, 2.0)),
    (dataclasses.replace(DEFAULT, layered=True, layer=0.5), (8.0, 160.0, 2.0)),
)
"""Where the grid is held to a section that is calibrated for itself."""
FORCES = (8.0, 6.0)
"""Radii in mm of the bodies."""


@dataclasses.dataclass(frozen=True)
class Confirmed:
    """A size of Table I under a combination.

    Attributes:
        key: (a, L, t), mm.
        grid: P in kPa at 360° with which the combination was found.
        cell: the same of the cell, every turn by itself.
    """

    key: Key
    grid: float
    cell: float


@dataclasses.dataclass(frozen=True)
class Held:
    """A force under a combination.

    Attributes:
        radius: mm.
        grid: F in N at 200 kPa with which the combination was found.
        body: the same of a body.
    """

    radius: float
    grid: float
    body: float


def cells(
    grid: Grid, given: Combination, tell: Callable[[str], None]
) -> tuple[list[Confirmed], float]:
    """Table I by the cell, sheath all around; with the seconds of processor time."""
    given = dataclasses.replace(given, bare=False)
    expected = alone(grid, given).pressures
    found, seconds = [], 0.0
    for radius, wall in SECTIONS:
        keys = [size.key for size in TABLE_I if (size.radius, size.wall) == (radius, wall)]
        keys.sort(key=lambda key: -key[1])
        tell(f"cell of a = {radius:g}, t = {wall:g} mm")
        chambers = [given.chamber(key[1]) for key in keys]
        done = solving.cell(given, radius, wall, chambers)
        seconds += done.seconds
        found += [
            Confirmed(key, round(float(expected[key]), 3), round(pressure, 3))
            for key, pressure in zip(keys, done.pressures, strict=True)
        ]
    order = [size.key for size in TABLE_I]
    return sorted(found, key=lambda one: order.index(one.key)), seconds


def bodies(grid: Grid, given: Combination, tell: Callable[[str], None]) -> tuple[list[Held], float]:
    """The tip's force of two bodies, sheath all around; with the seconds of processor time."""
    expected = alone(grid, dataclasses.replace(given, guided=True, bare=False)).forces
    found, seconds = [], 0.0
    for radius in FORCES:
        tell(f"body of a = {radius:g} mm")
        force, spent = solving.blocked(given, radius)
        seconds += spent
        found.append(Held(radius, round(float(expected[radius]), 4), round(force, 4)))
    return found, seconds


def held_out(grid: Grid, tell: Callable[[str], None]) -> tuple[list[float], float]:
    """Parts by which the grid's P is off, where it was not solved; CPU seconds."""
    found, seconds = [], 0.0
    for given, key in HELD_OUT:
        tell(f"held out: {key}, {given.pitch:g}, {given.thickness:g} mm")
        done = solving.section(given, key[0], key[2], (key[1],), "calibrated")
        seconds += done.seconds
        ours = float(alone(grid, given).pressures[key])
        found.append(round(ours / done.pressures[0] - 1, 6))
    return found, seconds
