"""Rows of history.csv of a rod in motion, and what its answer is made of."""

from __future__ import annotations

from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.slender.path import PRESSURE, Point
from fiberbend.slender.rows import STRIPS, Rows
from fiberbend.slender.timed import Timed
from rod.motion import Moving
from rod.statics import State


class TimedRows:
    """Makes the rows.

    Args:
        timed: the motion.
    """

    def __init__(self, timed: Timed) -> None:
        self._timed, self._rows = timed, Rows(timed.slender, tells=False)
        rod = timed.slender.rod
        rest = rod.shape(rod.layout.at_rest())
        amounts = timed.motion.level(0.0).amounts
        self._elastic, _ = timed.motion.stored(rest.strains, 0.0)
        self._potential = timed.motion.held(rest, amounts)
        self._first: float | None = None

    def point(self, moving: Moving) -> Point:
        """A state as one of a path, for what shows states."""
        slender = self._timed.slender
        level = self._timed.motion.level(moving.time)
        pairs = zip(slender.loads, level.amounts, strict=True)
        values = {name: amount for name, amount in pairs if name} | {PRESSURE: moving.pressure}
        angle = float(np.sum(slender.weights() * moving.strains))
        state = State(
            moving.shape, slender.level(values), 0.0, moving.iterations, 0, np.empty((0, 0))
        )
        return Point(state, values, angle, moving.iterations)

    def row(self, step: int, moving: Moving) -> dict[str, Any]:
        """The row of a state.

        Args:
            step: its number; 0 where the motion begins.
            moving: the state.
        """
        row = self._rows.row(step, self.point(moving))
        for key in (col.WORK, col.STORED):
            # of states at rest; a motion has more of them
            del row[key]
        row |= self._pushes(row, moving)
        energy, work = moving.energy, moving.work
        left = energy.total - work.gained
        self._first = left if self._first is None else self._first
        place = np.array([*self._timed.slender.site.tip, 1.0])
        return row | {
            col.ITERATIONS: moving.iterations,
            col.TIME: moving.time,
            col.SPEED: float(np.linalg.norm(moving.velocity[-1] @ place)),
            col.KINETIC: energy.kinetic,
            col.ELASTIC: energy.elastic - self._elastic,
            col.POTENTIAL: energy.potential - self._potential,
            col.AIR_WORK: work.air,
            col.LOADS_WORK: work.loads,
            col.DISSIPATED: work.lost,
            col.DRIFT: left - self._first,
        }

    def _pushes(self, row: dict[str, Any], moving: Moving) -> dict[str, float]:
        """Forces of what it touches, as means of the last step.

        Of a stiff contact the force at one time says little: it is the impulse that moves the rod.
        """
        slender, found = self._timed.slender, dict[str, float]()
        struck = [term for term in slender.rod.terms if id(term) in self._timed.motion.struck]
        named = {id(touch): name for name, touch in slender.obstacles}
        # a state with which it begins has none yet: it is at rest
        for term, push in zip(struck[: len(moving.pushes)], moving.pushes, strict=False):
            name = named[id(term)]
            if name in STRIPS:
                column, sign = STRIPS[name]
                found[column] = sign * float(push.force[1])
            values = (push.force[1], push.force[2], push.moment[0])
            for quantity, value in zip(col.CONTACT, values, strict=False):
                key = col.contact(name, quantity)
                if key in row:
                    found[key] = float(value)
        return found
