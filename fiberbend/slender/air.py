"""The air of a chamber between two valves, for a rod that moves; a `rod.motion.air.Air`.

The plant of `analytic.control.plant` without its actuator: how the chamber swells is told by the
rod, and the pressure follows by classical Runge–Kutta in substeps that the valves need.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from analytic.control.controller import Valves
from analytic.control.plant import PlantParameters, inflow, substep
from rod.motion.air import Swelling

_SHUT = 1e-3
"""Longest substep of shut valves, s: air that is compressed alone is smooth."""


class ValveAir:
    """Valves that are commanded over time.

    Args:
        parameters: pneumatics.
        volume: least one of the chamber, mm³.
        commands: times in s, rising, and what is commanded from then on; shut before.

    Raises:
        ValueError: valves too large for the chamber.
    """

    def __init__(
        self,
        parameters: PlantParameters,
        volume: float,
        commands: Sequence[tuple[float, Valves]] = (),
    ) -> None:
        self._parameters = parameters
        self._longest = substep(parameters, volume)
        self._moves = [(time + parameters.dead_time, valves) for time, valves in commands]

    @property
    def corners(self) -> list[float]:
        """When the valves move, s."""
        return [time for time, _ in self._moves]

    def move(self, time: float, valves: Valves) -> None:
        """Move the valves now, whatever was commanded.

        Args:
            time: of now, s; the dead time is over.
            valves: from now on.
        """
        self._moves = [(time, valves)]

    def valves(self, time: float) -> Valves:
        """Which one is open at a time in s."""
        now = Valves.HOLD
        for begin, valves in self._moves:
            if begin > time:
                break
            now = valves
        return now

    def passed(
        self, time: float, step: float, pressure: float, swelling: Swelling
    ) -> tuple[float, float]:
        """See `rod.motion.air.Air`."""
        parameters = self._parameters
        valves = self.valves(time + step / 2)
        n, outside = parameters.exponent, parameters.atmosphere
        volume = swelling.volume + parameters.dead_volume - swelling.compliance * pressure
        growth, compliance = swelling.growth / step, swelling.compliance

        def rate(passed: float, now: float) -> float:
            absolute = now + outside
            air = inflow(parameters, valves, absolute)
            room = volume + growth * passed + compliance * now
            return n * (air - absolute * growth) / (room + n * absolute * compliance)

        longest = _SHUT if valves is Valves.HOLD else self._longest
        count = math.ceil(step / longest * (1 - 1e-9))
        h, now, total = step / count, pressure, 0.0
        for i in range(count):
            t = i * h
            k1 = rate(t, now)
            second = now + h / 2 * k1
            k2 = rate(t + h / 2, second)
            third = now + h / 2 * k2
            k3 = rate(t + h / 2, third)
            fourth = now + h * k3
            total += now + 2 * second + 2 * third + fourth
            now += h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(t + h, fourth))
        return now, total / (6 * count)
