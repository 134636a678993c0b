"""How far the cell of a calibration is bent, in few classes, so that like cases share one."""

from __future__ import annotations

import dataclasses
import math

from fiberbend.calibration.record import Calibration
from fiberbend.case import convert
from fiberbend.case.case import Case

LEAST = 0.5
"""k H of the first class: 382° of the baseline."""
GROWTH = 1.3
"""From one class to the next."""
CLASSES = 5
"""Beyond the last one rubber is three times as long; no cell comes so far."""
_SLACK = 1.02
"""Part by which a case may go beyond the states of its calibration."""


@dataclasses.dataclass(frozen=True)
class Reach:
    """A class of curvature.

    Attributes:
        number: from zero on.
        strain: k H at its end: curvature times height of the winding.
    """

    number: int
    strain: float

    @classmethod
    def of(cls, number: int) -> Reach:
        """A class by its number."""
        return cls(number, round(LEAST * GROWTH**number, 6))


def first(case: Case) -> Reach:
    """The class that holds the angles of a case; the least where it asks for none."""
    strain = asked_strain(case)
    return next(
        (reach for reach in map(Reach.of, range(CLASSES)) if strain <= _SLACK * reach.strain),
        Reach.of(CLASSES - 1),
    )


def asked_strain(case: Case) -> float:
    """k H at the greatest angle that a case asks for; zero where it asks for none."""
    load, output = case.inflation, case.output
    asked = [*output.at_angles, output.stop_at_angle, None if load is None else load.angle]
    angle = max((abs(angle) for angle in asked if angle is not None), default=0.0)
    return angle / case.actuator.length * height(case)


def height(case: Case) -> float:
    """Height of the winding's outline, mm."""
    actuator = convert.dimensions(case.actuator)
    return actuator.outline_top - actuator.outline_bottom


def short_of(case: Case, found: Calibration) -> str:
    """What of a case lies beyond the states of a calibration, in words; empty for nothing."""
    load, output = case.inflation, case.output
    strain = asked_strain(case)
    if strain > _SLACK * found.strain:
        angle = math.degrees(found.strain / height(case) * case.actuator.length)
        return f"bent further than {angle:.0f}°"
    if load is None or output.stop_at_angle is not None or load.angle is not None:
        return ""
    if load.to is not None and abs(load.to) > _SLACK * found.pressure:
        return f"beyond {1e3 * found.pressure:.4g} kPa"
    if load.volume is not None:
        rest = convert.dimensions(case.actuator).chamber_volume
        if load.volume > _SLACK * found.growth * rest:
            return f"beyond {found.growth * rest / 1e3:.4g} mL"
    return ""
