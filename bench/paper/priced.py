"""What each open matter costs, one at a time from our own values: P(360°), force, Table II's signs.

Values come from `bench.paper.assumed.grid`, whose sections have the cell's correction.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from bench.paper.assumed.grid import Grid
from bench.paper.assumptions import (
    CHOICES,
    DEFAULT,
    LAYER,
    LEVER,
    PITCH,
    THICKNESS,
    Combination,
    Range,
    changed,
)
from bench.paper.combination import (
    RADII,
    SERIES,
    Predicted,
    alone,
    predict,
    values_of,
)
from bench.paper.facts import BASELINE
from bench.paper.verdict import sign_of
from geometry.mesh.data import Floats

POINTS = 25
"""Of a line."""
SIGNS: dict[str, Callable[[Predicted], list[float]]] = {
    "radius_pressure": lambda p: [float(p.pressures[key]) for key in SERIES["radius"]],
    "length_pressure": lambda p: [float(p.pressures[key]) for key in SERIES["length"]],
    "wall_pressure": lambda p: [float(p.pressures[key]) for key in SERIES["wall"]],
    "radius_force": lambda p: [float(p.forces[radius]) for radius in RADII],
}
"""Values over rising dimensions, by the sign of Table II. The force's sign over the length is not
among them: a section does not know the length."""


@dataclasses.dataclass(frozen=True)
class Price:
    """The baseline under one combination.

    Attributes:
        what: is open.
        reading: value or reading, in words.
        given: the combination.
        pressure: P in kPa at 360°.
        force: F in N of the simulation at 200 kPa and 0°.
        formula: the same of eq. (20).
        signs: of Table II, by their keys.
    """

    what: str
    reading: str
    given: Combination
    pressure: float
    force: float
    formula: float
    signs: dict[str, str]


@dataclasses.dataclass(frozen=True)
class Line:
    """The baseline over the range of one open matter, all others as ours.

    Attributes:
        of: what is open.
        across: its values.
        pressure: P in kPa at 360°.
        force: F in N of the simulation at 200 kPa and 0°.
        formula: the same of eq. (20).
        lever: L_f, mm.
        radius: greatest step of P over the radius, a part; below zero where it falls throughout.
    """

    of: Range
    across: Floats
    pressure: Floats
    force: Floats
    formula: Floats
    lever: Floats
    radius: Floats


def around(given: Range) -> Combination:
    """Ours, in the reading in which a matter is open at all."""
    return dataclasses.replace(DEFAULT, layered=given is LAYER)


def line(grid: Grid, given: Range) -> Line:
    """Price an open matter over its bounds."""
    across = np.linspace(*given.bounds, POINTS)
    base = around(given)
    pitch, thickness, lever = (np.full(POINTS, value) for value in values_of(base))
    if given is PITCH:
        pitch = across
    elif given is LEVER:
        lever = across
    else:
        thickness = across
    found = predict(grid, base.readings, (pitch, thickness, lever))
    return Line(
        given,
        across,
        found.pressures[BASELINE],
        found.forces[BASELINE[0]],
        found.formula[BASELINE[0]],
        lever,
        found.steps("radius").max(axis=0),
    )


def price(grid: Grid, given: Combination, what: str, reading: str) -> Price:
    """The baseline under a combination."""
    found = alone(grid, given)
    return Price(
        what,
        reading,
        given,
        float(found.pressures[BASELINE]),
        float(found.forces[BASELINE[0]]),
        float(found.formula[BASELINE[0]]),
        {key: sign_of(values(found)) for key, values in SIGNS.items()},
    )


def prices(grid: Grid) -> list[Price]:
    """Ours, then every open matter at both ends of its bounds, or in its other reading."""
    found = [price(grid, DEFAULT, "ours", "as elsewhere on this page")]
    for each in (PITCH, THICKNESS, LEVER):
        for value in each.bounds:
            given = changed(DEFAULT, each.key, value)
            found.append(price(grid, given, each.what, each.words(value)))
    for value in LAYER.bounds:
        given = dataclasses.replace(DEFAULT, layered=True, layer=value)
        found.append(price(grid, given, "floor of rubber over a layer", LAYER.words(value)))
    for choice in CHOICES:
        if choice.key != "layered":
            given = changed(DEFAULT, choice.key, True)
            found.append(price(grid, given, choice.what, choice.words(True)))
    return found
