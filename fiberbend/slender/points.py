"""States on the path of a rod, and how it is stepped."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping

from rod.statics import State

PRESSURE = "pressure"
SAME = 1e-9
"""Part of an angle, or rad, by which one that is asked for may be missed."""


@dataclasses.dataclass(frozen=True)
class Point:
    """A state on the path.

    Attributes:
        state: of the rod.
        values: of the loads; pressure in MPa, of others the share that acts.
        angle: by which it bends, z = 0 to L, rad.
        iterations: of Newton's method.
    """

    state: State
    values: Mapping[str, float]
    angle: float
    iterations: int


Listen = Callable[[Point, float], None]
"""Takes every new state and the part of all loads that is done."""


@dataclasses.dataclass(frozen=True)
class Limits:
    """How the path is stepped.

    Attributes:
        turn: greatest turn of a step, rad.
        cutbacks: failed steps in a row after which it gives up.
    """

    turn: float
    cutbacks: int


class EndedError(Exception):
    """The run ends where it was to end early."""
