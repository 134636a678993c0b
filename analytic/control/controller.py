"""Two valves, switched by the sign of the angle error outside a dead zone. rad, Hz.

Section VI of Polygerinos et al. 2015 (doi 10.1109/TRO.2015.2428504).
"""

from __future__ import annotations

import dataclasses
import enum
import math
from typing import Literal

Inside = Literal["hold", "settle", "relay"]


class Valves(enum.IntEnum):
    """Inlet and outlet valve together; never both open."""

    VENT = -1
    HOLD = 0
    FILL = 1


@dataclasses.dataclass(frozen=True)
class DeadZone:
    """Eq. (22): θ_DDZ = ±(θ_d/k + θ_c).

    Attributes:
        divisor: k, 50 in the paper.
        offset: θ_c, 0.07 rad in the paper.

    Raises:
        ValueError: a zone without width at θ_d = 0 or anywhere above.
    """

    divisor: float = 50.0
    offset: float = 0.07

    def __post_init__(self) -> None:
        if not self.divisor > 0:
            raise ValueError(f"dead-zone-divisor: a positive number expected, not {self.divisor}")
        if not 0 < self.offset < math.inf:
            raise ValueError(
                f"dead-zone: a positive angle expected, not {self.offset} rad: without a "
                "dead zone the valves never rest"
            )

    def __call__(self, desired: float) -> float:
        """Half the width of the zone at a desired angle of zero or more, rad."""
        return desired / self.divisor + self.offset


@dataclasses.dataclass(frozen=True)
class Controller:
    """Fill below the dead zone, vent above it.

    The paper says of the inside that the zone 'allowed the state of the valves to remain unchanged
    until the input was changed adequately', which can be read in three ways:

    * `hold`: outside the zone a valve is open, inside both are closed, and that state remains until
      the error leaves the zone. The default: 'unchanged' is the state of a loop at rest, and the
      measured delay of the sine is what this reading gives, see docs/control.md.
    * `settle`: a valve that is open on entering stays open until the error changes sign; then both
      are closed until the error leaves the zone.
    * `relay`: to the letter: the valves keep their state all through the zone. Then one is always
      open and the angle cycles for ever from edge to edge, against the measured 0.85 % of undesired
      switching.

    Attributes:
        rate: sampling rate, Hz; 100 in the paper.
        zone: dead zone.
        inside: reading of the dead zone.

    Raises:
        ValueError: a rate that is not positive, or an unknown reading.
    """

    rate: float = 100.0
    zone: DeadZone = dataclasses.field(default_factory=DeadZone)
    inside: Inside = "hold"

    def __post_init__(self) -> None:
        if not 0 < self.rate < math.inf:
            raise ValueError(f"rate: positive Hz expected, not {self.rate}")
        if self.inside not in ("hold", "settle", "relay"):
            raise ValueError(f"inside: hold, settle or relay expected, not {self.inside!r}")

    def command(self, desired: float, angle: float, last: Valves) -> Valves:
        """What the valves shall do until the next sample.

        Args:
            desired: θ_d, rad.
            angle: θ_a from the filter, rad.
            last: the command of the sample before.
        """
        error, half = desired - angle, self.zone(desired)
        if error > half:
            return Valves.FILL
        if error < -half:
            return Valves.VENT
        if self.inside == "relay" or (self.inside == "settle" and last * error > 0):
            return last
        return Valves.HOLD
