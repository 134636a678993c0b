"""Rows of history.csv of a rod: the same quantities as those of a body."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.effects.records import RodRamp
from fiberbend.slender.actuator import Slender
from fiberbend.slender.path import PRESSURE, Point
from rod.functions import Floats
from rod.shape import Shape

_MIDDLE = 0.25
"""Part of the length on either side of the middle whose rate is that without ends."""

STRIPS = {"post": (col.TIP_FORCE, 1.0), "roof": (col.ROOF_FORCE, -1.0)}
"""Columns of the obstacles that press along y alone, and the sign of their force."""


class Rows:
    """Makes the rows.

    Args:
        slender: the rod.
        tells: unstable modes are counted.
    """

    def __init__(self, slender: Slender, tells: bool) -> None:
        self._slender, self._tells = slender, tells
        rod = slender.rod
        self._rest = rod.shape(rod.layout.at_rest())
        self._stored_at_rest = rod.elastic(self._rest.strains, 0.0)
        self._loads = [ramp for ramp in slender.ramps if ramp.load != PRESSURE]

    def row(self, step: int, point: Point) -> dict[str, Any]:
        """The row of a state, but for the work of the loads.

        Args:
            step: its number; 0 at rest.
            point: the state.
        """
        slender, shape = self._slender, point.state.shape
        strains, layout = shape.strains, shape.layout
        pressure = point.values.get(PRESSURE, 0.0)
        x, y, z = slender.tip(shape).tolist()
        volume = slender.rod.volume(strains, pressure)
        row: dict[str, Any] = {
            col.STEP: step,
            col.PRESSURE: 1e3 * pressure,
            col.ANGLE: math.degrees(point.angle),
            col.TIP_Y: y,
            col.TIP_Z: z,
            col.VOLUME: volume,
            col.ITERATIONS: point.iterations if step else 0,
            col.TIP_X: x,
        }
        for name, strain in ((col.SIDE_ANGLE, "side_curvature"), (col.TWIST, "twist")):
            if strain in layout.strains:
                row[name] = math.degrees(float(np.sum(slender.weights(strain) * strains)))
        if len(slender.zones) > 1:
            row |= self._zones(strains)
        else:
            row[col.UNIFORM_ANGLE] = math.degrees(self._middle(strains))
        length = slender.site.actuator.length
        row[col.AXIS_STRETCH] = float(np.sum(slender.weights("stretch") * strains)) / length
        row[col.WORK] = 0.0
        row[col.STORED] = self._stored(point, pressure * volume)
        for ramp in self._loads:
            value, conjugate = col.load_columns(ramp.load, *ramp.units)
            row[value] = point.values.get(ramp.load, 0.0)
            if ramp.potential:
                row[conjugate] = self._conjugate(ramp, shape)
        row |= self._contacts(shape)
        if step and self._tells:
            row[col.MODES] = point.state.unstable
        return row

    def _contacts(self, shape: Shape) -> dict[str, float]:
        """Force of every obstacle on the rod, what touches it, and how far or deep."""
        row: dict[str, float] = {}
        for name, touch in self._slender.obstacles:
            found = touch.touched(shape, 1.0)
            if name in STRIPS:
                column, sign = STRIPS[name]
                row[column] = sign * float(found.force[1])
            if touch.keeps:
                continue
            values = (found.force[1], found.force[2], found.moment[0], found.area, found.gap)
            row |= {
                col.contact(name, quantity): float(value)
                for quantity, value in zip(col.CONTACT, values, strict=True)
            }
        return row

    def loads(self, rows: Sequence[dict[str, Any]]) -> tuple[Floats, Floats]:
        """Values of the loads with a potential in all rows, and of their conjugates, (n, m) both.

        In MPa and mm³ of the pressure, and so that their products are in N mm.
        """
        keys = [(col.PRESSURE, col.VOLUME, 1e3)]
        for ramp in self._loads:
            if ramp.potential:
                keys.append((*col.load_columns(ramp.load, *ramp.units), 1.0))
        values = np.array([[row[value] / shown for value, _, shown in keys] for row in rows])
        return values, np.array([[row[name] for _, name, _ in keys] for row in rows])

    def _middle(self, strains: Floats) -> float:
        """L times the mean rate of the middle half, rad."""
        slender = self._slender
        layout, length = slender.rod.layout, slender.site.actuator.length
        ends = np.cumsum(layout.lengths) - slender.site.actuator.cap
        middle = ends - layout.lengths / 2
        near = np.abs(middle - length / 2) <= _MIDDLE * length
        weights = layout.weights("curvature")[near]
        return length * float(np.sum(weights * strains[near])) / float(layout.lengths[near].sum())

    def _zones(self, strains: Floats) -> dict[str, float]:
        """Angle, twist and stretch of every zone."""
        slender, row = self._slender, dict[str, float]()
        ends = slender.chamber.start + np.cumsum([0, *slender.zones])
        for number, (start, stop) in enumerate(itertools.pairwise(ends.tolist())):
            for name, strain in (("angle_deg", "curvature"), ("twist_deg", "twist")):
                if strain in slender.rod.layout.strains:
                    turn = slender.weights(strain)[start:stop] * strains[start:stop]
                    row[col.zone(number, name)] = math.degrees(float(turn.sum()))
            weights = slender.weights("stretch")[start:stop]
            stretched = float(np.sum(weights * strains[start:stop]) / weights.sum())
            row[col.zone(number, "stretch")] = stretched
        return row

    def _stored(self, point: Point, inflated: float) -> float:
        """Energy of the sections, and of what acts without a load, N mm."""
        rod, shape = self._slender.rod, point.state.shape
        energy = rod.elastic(shape.strains, point.state.level.pressure) + inflated
        for term, load in zip(rod.terms, self._slender.loads, strict=True):
            if not load:
                energy += term.potential(shape, 1.0) - term.potential(self._rest, 1.0)
        return energy - self._stored_at_rest

    def _conjugate(self, ramp: RodRamp, shape: Shape) -> float:
        """What a load has done work on since rest, N mm a unit of it."""
        return sum(
            term.potential(self._rest, 1.0) - term.potential(shape, 1.0)
            for term, load in zip(self._slender.rod.terms, self._slender.loads, strict=True)
            if load == ramp.load
        )
