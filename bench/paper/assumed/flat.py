"""Which open matters are determined by what is stated, and which are not."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.paper.assumed.grid import Grid
from bench.paper.assumptions import RANGES, Combination, changed, ranges
from bench.paper.combination import (
    Statement,
    alone,
    every_reading,
    misfit,
    predict,
    values_of,
)
from geometry.mesh.data import Floats

SLACK = 1.0
"""Of misfit² above the least: one scale of one statement."""
FINE = (46, 61, 31)
"""Places along pitch, thickness and L_f."""
_STEP = 1e-3
"""Difference by which a slope is taken, a part of the bounds."""


@dataclasses.dataclass(frozen=True)
class Profile:
    """Least misfit at each value of an open matter, over all others and over all readings.

    Attributes:
        key: of the open matter.
        across: its values.
        misfit: at each.
    """

    key: str
    across: tuple[float, ...]
    misfit: tuple[float, ...]

    def allowed(self, least: float, slack: float = SLACK) -> tuple[float, float] | None:
        """Least and greatest value whose misfit² is no more than `slack` above the best one's.

        Args:
            least: misfit of the best combination.
            slack: of misfit².

        Returns:
            None where no value is.
        """
        pairs = zip(self.across, self.misfit, strict=True)
        inside = [value for value, left in pairs if left**2 <= least**2 + slack]
        return (min(inside), max(inside)) if inside else None

    @classmethod
    def read(cls, entries: dict[str, Any]) -> Profile:
        """From a JSON file."""
        return cls(entries["key"], tuple(entries["across"]), tuple(entries["misfit"]))


def profiles(grid: Grid, stated: Sequence[Statement]) -> list[Profile]:
    """A profile of everything that is open between numbers."""
    found: dict[str, Floats] = {}
    axes: dict[str, Floats] = {}
    for readings in every_reading():
        opened = ranges(readings)
        places = [
            np.linspace(*each.bounds, number) for each, number in zip(opened, FINE, strict=True)
        ]
        pitch, thickness, lever = np.meshgrid(*places, indexing="ij", sparse=True)
        left = np.broadcast_to(
            misfit(predict(grid, readings, (pitch, thickness, lever)), stated), FINE
        )
        for place, each in enumerate(opened):
            others = tuple(axis for axis in range(len(opened)) if axis != place)
            least = left.min(axis=others)
            axes[each.key] = places[place]
            found[each.key] = np.minimum(found.get(each.key, least), least)
    return [Profile(each.key, _short(axes[each.key]), _short(found[each.key])) for each in RANGES]


def _short(values: Floats) -> tuple[float, ...]:
    return tuple(float(f"{value:.5g}") for value in values)


@dataclasses.dataclass(frozen=True)
class Directions:
    """How much the stated numbers move with the open ones, at a combination.

    Attributes:
        keys: of the open matters.
        moves: singular values of the slopes of all numbers, in their scales, by the open matters,
            each in its whole range: how many scales the numbers move along a direction.
        vectors: the directions, a row each.
    """

    keys: tuple[str, ...]
    moves: tuple[float, ...]
    vectors: tuple[tuple[float, ...], ...]

    @classmethod
    def read(cls, entries: dict[str, Any]) -> Directions:
        """From a JSON file."""
        vectors = tuple(tuple(row) for row in entries["vectors"])
        return cls(tuple(entries["keys"]), tuple(entries["moves"]), vectors)


def directions(grid: Grid, given: Combination, stated: Sequence[Statement]) -> Directions:
    """Directions in which a combination is determined, the best first and the flattest last."""
    opened = ranges(given.readings)
    at = np.array(values_of(given))
    slopes = []
    for place, each in enumerate(opened):
        step = _STEP * (each.high - each.low)
        ends = [min(max(at[place] + sign * step, each.low), each.high) for sign in (-1, 1)]
        values = []
        for end in ends:
            moved = changed(given, each.key, float(end))
            found = alone(grid, moved)
            values.append(np.array([float(one.of(found)) / one.scale for one in stated]))
        slopes.append((values[1] - values[0]) / (ends[1] - ends[0]) * (each.high - each.low))
    _, moves, vectors = np.linalg.svd(np.array(slopes).T)
    return Directions(
        tuple(each.key for each in opened),
        _short(moves),
        tuple(_short(row * np.sign(row[np.argmax(np.abs(row))])) for row in vectors),
    )
