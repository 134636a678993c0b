"""Air in the chamber of a rod that moves: what makes its pressure where that is not given."""

from __future__ import annotations

import dataclasses
from typing import Protocol


@dataclasses.dataclass(frozen=True)
class Swelling:
    """How the chamber's volume changes during a step, as the pressure is found.

    V(t, P) = volume + growth t/Δt + compliance (P − P₀): what the strains do goes evenly with time.

    Attributes:
        volume: V of the chamber when the step begins, mm³.
        growth: by the strains in all of the step, mm³.
        compliance: by the pressure while the strains are held, mm³/MPa.
    """

    volume: float
    growth: float
    compliance: float


class Air(Protocol):
    """What lets air into a chamber and out of it, and how the air is compressed."""

    def passed(
        self, time: float, step: float, pressure: float, swelling: Swelling
    ) -> tuple[float, float]:
        """The gauge pressure a step later, and its mean in the step, MPa.

        Args:
            time: when the step begins, s.
            step: Δt, s.
            pressure: P₀ when it begins, MPa.
            swelling: of the chamber in the step.
        """
