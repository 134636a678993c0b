"""Pressures and moments over all that is open, between sections that are solved.

P(360°) of every section of Table I is solved on a grid of pitch and thickness with the winding
spread. The cell's correction, calibrated over spread, is solved on a coarser grid. In between both
are polynomials of their logarithms; `bench.paper.assumed.confirm` measures what that costs.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bench.paper.assumed.solving import Solved, blocked, section
from bench.paper.assumptions import DEFAULT, LAYER, PITCH, THICKNESS, Combination, Readings
from bench.paper.facts import BASELINE, CAP
from geometry.mesh.data import Floats

Section = tuple[float, float]
"""(a, t) in mm."""
LONG = (160.0, 130.0)
"""Chambers in mm of what is 160 mm long, without and with its caps."""
ALL = (160.0, 130.0, 100.0, 70.0)
"""The same of 160, 130 and 100 mm."""
SECTIONS: dict[Section, tuple[float, ...]] = {
    (6.0, 2.0): ALL,
    (8.0, 2.0): ALL,
    (10.0, 2.0): LONG,
    (12.0, 2.0): LONG,
    (8.0, 1.0): LONG,
    (8.0, 3.0): LONG,
}
"""Chambers by the sections of Table I."""
PITCHES = (PITCH.low, PITCH.default, PITCH.high)
FLOORS = (THICKNESS.low, 2.0, 2.5, THICKNESS.high)
LAYERS = (LAYER.low, 1.0, LAYER.high)
CORRECTED = (6.0, 8.0, 12.0)
"""Radii in mm whose cells are solved, t = 2 mm; a wall of 1 or 3 mm has the correction of 2 mm."""
FLOORS_CORRECTED = (THICKNESS.low, 2.0, THICKNESS.high)
LAYERS_CORRECTED = (1.0,)
_ALL: Any = [...]
MOMENT = "moment"


@dataclasses.dataclass(frozen=True)
class Table:
    """Numbers above zero on a grid, between which their logarithms are polynomials.

    Attributes:
        axes: values along each dimension.
        values: one number for each of their combinations.
    """

    axes: tuple[tuple[float, ...], ...]
    values: Floats

    @functools.cached_property
    def _logarithms(self) -> Floats:
        return np.log(self.values)

    def __call__(self, *at: Floats | float) -> Floats:
        """The numbers at places that are broadcast against each other."""
        if not self.axes:
            return self.values
        terms: list[Any] = [self._logarithms, [*range(len(self.axes))]]
        for place, (axis, x) in enumerate(zip(self.axes, at, strict=True)):
            terms += [_weights(axis, np.asarray(x)), [place, ...]]
        total: Floats = np.einsum(*terms, _ALL)
        return np.exp(total)

    def entries(self) -> dict[str, Any]:
        """For a JSON file."""
        rounded = [float(f"{value:.6g}") for value in self.values.ravel()]
        return {"axes": [list(axis) for axis in self.axes], "values": rounded}

    @classmethod
    def read(cls, entries: dict[str, Any]) -> Table:
        """From a JSON file."""
        axes = tuple(tuple(axis) for axis in entries["axes"])
        return cls(axes, np.reshape(entries["values"], [len(axis) for axis in axes]))


def _weights(nodes: Sequence[float], x: Floats) -> Floats:
    """Lagrange's polynomials of some nodes, a row each."""
    if len(nodes) == 1:
        return np.ones((1, *x.shape))
    away = [x - node for node in nodes]
    rows = []
    for place, node in enumerate(nodes):
        row: Any = 1.0
        for other, value in enumerate(nodes):
            if other != place:
                row = row * away[other] / (node - value)
        rows.append(row)
    return np.array(rows)


@dataclasses.dataclass(frozen=True)
class Grid:
    """Everything that is solved for the part, before anything is optimised.

    Attributes:
        tables: by what they are of; see `name`.
        guided: F times the length of the cap, of a body that a strip along its crown holds, over
            the moment of its section that is kept straight; at 200 kPa.
        seconds: of processor time that they took.
    """

    tables: dict[str, Table]
    guided: float = 1.0
    seconds: float = 0.0

    def pressure(
        self, readings: Readings, at: Section, chamber: float, pitch: Floats, thickness: Floats
    ) -> Floats:
        """P in kPa at 360°.

        Args:
            readings: of what is open between two.
            at: (a, t), mm.
            chamber: its length, mm.
            pitch: of the winding, mm.
            thickness: of what has C = 7.9 MPa, mm.
        """
        return self._value(readings, at, f"{chamber:g}", "pressure", pitch, thickness)

    def moment(self, readings: Readings, radius: float, pitch: Floats, thickness: Floats) -> Floats:
        """Moment in N mm that keeps it straight at 200 kPa, wall 2 mm."""
        return self._value(readings, (radius, 2.0), MOMENT, MOMENT, pitch, thickness)

    def _value(
        self,
        readings: Readings,
        at: Section,
        quantity: str,
        kind: str,
        pitch: Floats,
        thickness: Floats,
    ) -> Floats:
        base = "layered" if readings.layered else "combined"
        found = self.tables[name(base, at, quantity)](pitch, thickness)
        found = found * self.tables[f"cell {base} {kind}"](at[0], pitch, thickness)
        if readings.whole:
            found = found * self.tables[name(f"whole {base}", at, kind)](pitch)
        if readings.bare:
            found = found * self.tables[name(f"bare {base}", at, kind)]()
        return found

    def entries(self) -> dict[str, Any]:
        """For a JSON file."""
        tables = {key: table.entries() for key, table in self.tables.items()}
        return {"guided": self.guided, "seconds": round(self.seconds), "tables": tables}

    @classmethod
    def read(cls, entries: dict[str, Any]) -> Grid:
        """From a JSON file."""
        tables = {key: Table.read(table) for key, table in entries["tables"].items()}
        return cls(tables, entries["guided"], entries["seconds"])


def name(what: str, at: Section, quantity: str) -> str:
    """Of a table: what it is of, a and t in mm, and the chamber's length in mm or "moment"."""
    return f"{what} a={at[0]:g} t={at[1]:g} {quantity}"


def solved(tell: Callable[[str], None]) -> Grid:
    """Solve everything.

    Args:
        tell: takes a line about what is being solved.
    """
    tables: dict[str, Table] = {}
    seconds = 0.0
    for base, nodes, corrected in (
        ("combined", FLOORS, FLOORS_CORRECTED),
        ("layered", LAYERS, LAYERS_CORRECTED),
    ):
        for at, chambers in SECTIONS.items():
            tell(f"{base}, a = {at[0]:g}, t = {at[1]:g} mm")
            found = [
                [section(_given(base, p, h), *at, chambers, "smeared") for h in nodes]
                for p in PITCHES
            ]
            seconds += sum(one.seconds for row in found for one in row)
            tables |= _smeared(base, at, chambers, (PITCHES, nodes), found)
            ends = (PITCHES[0], PITCHES[-1])
            half = [found[0][1], found[-1][1]]
            whole = [
                section(_given(base, p, nodes[1], whole=True), *at, LONG[:1], "smeared")
                for p in ends
            ]
            usual = _given(base, PITCH.default, nodes[1])
            bare = section(dataclasses.replace(usual, bare=True), *at, LONG[:1], "smeared")
            seconds += sum(one.seconds for one in (*whole, bare))
            middle = found[1][1]
            for kind in ("pressure", MOMENT):
                ratio = [_of(w, kind) / _of(b, kind) for w, b in zip(whole, half, strict=True)]
                tables[name(f"whole {base}", at, kind)] = Table((ends,), np.array(ratio))
                bare_ratio = np.array(_of(bare, kind) / _of(middle, kind))
                tables[name(f"bare {base}", at, kind)] = Table((), bare_ratio)
        ratios, spent = _ratios(base, corrected, tell)
        tables |= ratios
        seconds += spent
    tell("body that a strip holds")
    force, spent = blocked(DEFAULT, BASELINE[0])
    straight = section(DEFAULT, BASELINE[0], BASELINE[2], LONG[:1], "smeared")
    seconds += spent + straight.seconds
    return Grid(tables, force * CAP.value / straight.moment, seconds)


def _ratios(
    base: str, nodes: tuple[float, ...], tell: Callable[[str], None]
) -> tuple[dict[str, Table], float]:
    """The cell's correction over radius, pitch and thickness."""
    shape = (len(CORRECTED), len(PITCHES), len(nodes))
    values = {kind: np.ones(shape) for kind in ("pressure", MOMENT)}
    seconds = 0.0
    for i, j, k in np.ndindex(shape):
        tell(f"{base}, cell of a = {CORRECTED[i]:g} mm, pitch {PITCHES[j]:g} mm, {nodes[k]:g} mm")
        given = _given(base, PITCHES[j], nodes[k])
        pair = [
            section(given, CORRECTED[i], 2.0, LONG[:1], winding)
            for winding in ("calibrated", "smeared")
        ]
        seconds += sum(one.seconds for one in pair)
        for kind, into in values.items():
            into[i, j, k] = _of(pair[0], kind) / _of(pair[1], kind)
    axes = (CORRECTED, PITCHES, nodes)
    return {f"cell {base} {kind}": Table(axes, into) for kind, into in values.items()}, seconds


def _smeared(
    base: str,
    at: Section,
    chambers: Sequence[float],
    axes: tuple[tuple[float, ...], ...],
    found: Sequence[Sequence[Solved]],
) -> dict[str, Table]:
    tables = {
        name(base, at, f"{chamber:g}"): Table(
            axes, np.array([[one.pressures[place] for one in row] for row in found])
        )
        for place, chamber in enumerate(chambers)
    }
    moments = np.array([[one.moment for one in row] for row in found])
    return tables | {name(base, at, MOMENT): Table(axes, moments)}


def _of(one: Solved, kind: str) -> float:
    return one.moment if kind == MOMENT else one.pressures[0]


def _given(base: str, pitch: float, thickness: float, whole: bool = False) -> Combination:
    given = dataclasses.replace(DEFAULT, pitch=pitch, whole=whole)
    if base == "layered":
        return dataclasses.replace(given, layered=True, layer=thickness)
    return dataclasses.replace(given, floor=thickness)
