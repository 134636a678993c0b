"""Filter, controller and plant in a closed loop. rad, MPa, s.

Fig. 12 of Polygerinos et al. 2015 (doi 10.1109/TRO.2015.2428504).
"""

from __future__ import annotations

import dataclasses
import math
from collections import deque
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from analytic.control.controller import Controller, Valves
from analytic.control.filter import AngleFilter
from analytic.control.plant import Plant, PlantParameters
from analytic.stress import Floats


class Reference(Protocol):
    """A desired angle θ_d over time; it starts from the lowest."""

    @property
    def levels(self) -> list[float]:
        """Angles at which it stays or through which it passes, from the lowest to the highest."""

    @property
    def duration(self) -> float:
        """How long a run lasts, s."""

    def __call__(self, time: float) -> float:
        """θ_d in rad at a time in s."""


class Controlled(Protocol):
    """What a loop controls: a `Plant`, or one whose actuator has inertia."""

    parameters: PlantParameters
    pressure: float
    """Gauge pressure in the chamber now, MPa."""
    angle: float
    """Bending angle now, rad."""

    def restart(self, pressure: float) -> None:
        """Come to rest under a gauge pressure in MPa."""

    def advance(self, valves: Valves, duration: float) -> None:
        """Let time pass with the valves as they are, s."""


@dataclasses.dataclass(frozen=True)
class Steps:
    """Steps up and down.

    Attributes:
        low: lower angle, rad.
        high: upper angle, rad.
        hold: time at each, s.
        cycles: number of steps up, and down.
    """

    low: float
    high: float
    hold: float = 1.0
    cycles: int = 4

    def __post_init__(self) -> None:
        _check_range("steps", self.low, self.high)
        if not 0 < self.hold < math.inf or self.cycles < 1:
            raise ValueError("steps: a positive time and at least one cycle expected")

    @property
    def levels(self) -> list[float]:
        """Both angles, rad."""
        return [self.low, self.high]

    @property
    def times(self) -> list[float]:
        """When it steps up, down, up and so on, s."""
        return [self.hold * (i + 1) for i in range(2 * self.cycles)]

    @property
    def duration(self) -> float:
        """How long a run lasts, s."""
        return self.hold * (2 * self.cycles + 1)

    def __call__(self, time: float) -> float:
        """θ_d in rad at a time in s."""
        return self.high if math.floor(time / self.hold + 1e-9) % 2 else self.low


@dataclasses.dataclass(frozen=True)
class Sine:
    """θ_d = mean − amplitude cos(2π f t).

    Attributes:
        low: lower angle, rad.
        high: upper angle, rad.
        frequency: f, Hz; 0.2 in the paper.
        cycles: number of periods, at least 2: the first one settles.
    """

    low: float
    high: float
    frequency: float = 0.2
    cycles: int = 3

    def __post_init__(self) -> None:
        _check_range("sine", self.low, self.high)
        if not 0 < self.frequency < math.inf or self.cycles < 2:
            raise ValueError("sine: a positive frequency and at least two periods expected")

    @property
    def levels(self) -> list[float]:
        """Angles from the lowest to the highest, rad."""
        levels: list[float] = np.linspace(self.low, self.high, 9).tolist()
        return levels

    @property
    def duration(self) -> float:
        """How long a run lasts, s."""
        return self.cycles / self.frequency

    def __call__(self, time: float) -> float:
        """θ_d in rad at a time in s."""
        turn = math.cos(2 * math.pi * self.frequency * time)
        return (self.high + self.low) / 2 - (self.high - self.low) / 2 * turn


@dataclasses.dataclass(frozen=True)
class Sensor:
    """Pressure sensor.

    Attributes:
        noise: standard deviation of independent normal errors of the samples, MPa.
        seed: of the random numbers.

    Raises:
        ValueError: a negative noise.
    """

    noise: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.noise < math.inf:
            raise ValueError(f"noise: zero or more MPa expected, not {self.noise}")


@dataclasses.dataclass(frozen=True)
class Trace:
    """What happened at the controller's samples; every array is (n,).

    Attributes:
        time: s.
        desired: θ_d, rad.
        filtered: θ_a, what the filter made of the measured pressure, rad.
        angle: what the plant really did, rad.
        half: half the dead zone, rad.
        valves: command from this sample to the next, −1 vent, 0 hold, 1 fill.
        pressure: true gauge pressure, MPa.
        measured: measured gauge pressure, MPa.
    """

    time: Floats
    desired: Floats
    filtered: Floats
    angle: Floats
    half: Floats
    valves: NDArray[np.int8]
    pressure: Floats
    measured: Floats

    @property
    def error(self) -> Floats:
        """θ_e = θ_d − θ_a, rad, (n,)."""
        return self.desired - self.filtered


def simulate(
    plant: Plant,
    angle_filter: AngleFilter,
    controller: Controller,
    reference: Reference,
    sensor: Sensor,
    inert: Controlled | None = None,
) -> Trace:
    """Run the loop from rest at the reference's lower angle, as the filter sees it.

    At every sample the pressure is measured and the valves are commanded; they move after the
    plant's dead time, which may be longer than a sample.

    Args:
        plant: what is controlled, and what `check` looks at; left in some state.
        angle_filter: θ from the measured pressure.
        controller: commands the valves.
        reference: θ_d over time.
        sensor: noise of the measured pressure.
        inert: what is controlled in place of it: the same actuator with its inertia.

    Raises:
        ValueError: what `check` refuses, or a pressure beyond the plant's curve.
    """
    check(plant, angle_filter, controller, reference)
    controlled: Controlled = plant if inert is None else inert
    controlled.restart(angle_filter.pressure(reference.levels[0]))
    random = np.random.default_rng(sensor.seed)
    count = math.ceil(reference.duration * controller.rate - 1e-9)
    noise = (sensor.noise * random.standard_normal(count)).tolist()
    period = 1 / controller.rate
    moving, command = Valves.HOLD, Valves.HOLD
    due: deque[tuple[float, Valves]] = deque()
    rows = []
    for i in range(count):
        time = i / controller.rate
        measured = controlled.pressure + noise[i]
        filtered, desired = angle_filter(measured), reference(time)
        wanted = controller.command(desired, filtered, command)
        if wanted is not command:
            command = wanted
            due.append((time + controlled.parameters.dead_time, command))
        half = controller.zone(desired)
        rows.append(
            (
                time,
                desired,
                filtered,
                controlled.angle,
                half,
                command,
                controlled.pressure,
                measured,
            )
        )
        now, end = time, time + period
        while due and due[0][0] < end - 1e-9 * period:
            switch, following = due.popleft()
            if switch > now:
                controlled.advance(moving, switch - now)
            now, moving = max(now, switch), following
        controlled.advance(moving, end - now)
    columns = list(np.array(rows, dtype=float).T)
    columns[5] = columns[5].astype(np.int8)
    return Trace(*columns)


def check(
    plant: Plant, angle_filter: AngleFilter, controller: Controller, reference: Reference
) -> None:
    """Refuse a loop that cannot work.

    The valves of a loop that is sampled too slowly can switch for ever: the angle must not cross
    the whole dead zone in the time that a valve stays open after the last sample outside it, which
    is a sample period and the dead time at worst. It is found by letting the plant do just that.
    Enough for rest, not always needed: with luck in its samples a loop rests at half the rate.

    Args:
        plant: what is controlled; its state is changed.
        angle_filter: θ from the measured pressure.
        controller: commands the valves.
        reference: θ_d over time.

    Raises:
        ValueError: a supply below the pressure that the upper angle needs, a curve that ends below
            it, a reference that the filter never reaches, or a rate that is too low.
    """
    highest = reference.levels[-1]
    needed = angle_filter.pressure(highest)
    if plant.parameters.supply <= needed:
        raise ValueError(
            f"supply: {1e3 * plant.parameters.supply:.4g} kPa, expected more than the "
            f"{1e3 * needed:.4g} kPa of {math.degrees(highest):.4g}°"
        )
    period, dead = 1 / controller.rate, plant.parameters.dead_time
    for desired in reference.levels:
        half = controller.zone(desired)
        for valves, edge in ((Valves.FILL, desired - half), (Valves.VENT, desired + half)):
            if edge < 0:
                # the actuator never is below zero, so that nothing opens the inlet there
                continue
            start = angle_filter.pressure(edge)
            longest = _time_to_cross(plant, angle_filter, start, valves, 2 * half, period + dead)
            if longest < period + dead:
                _refuse_rate(controller.rate, dead, longest, 2 * half, desired, valves)


def _time_to_cross(
    plant: Plant,
    angle_filter: AngleFilter,
    start: float,
    valves: Valves,
    limit: float,
    most: float,
) -> float:
    """Time in which an open valve turns the filter's angle by a limit, `most` if it takes longer.

    Args:
        plant: brought to rest at `start` first.
        angle_filter: filter.
        start: gauge pressure at which the valve opens, MPa.
        valves: which valve is open.
        limit: rad.
        most: s.
    """
    plant.restart(start)
    first, slice_ = angle_filter(start), most / 50
    moved = 0.0
    for i in range(50):
        plant.advance(valves, slice_)
        before, moved = moved, abs(angle_filter(plant.pressure) - first)
        if moved >= limit:
            return slice_ * (i + (limit - before) / (moved - before))
    return most


def _refuse_rate(
    rate: float, dead: float, longest: float, limit: float, desired: float, valves: Valves
) -> None:
    verb = "fills" if valves is Valves.FILL else "vents"
    crossing = (
        f"at {math.degrees(desired):.4g}° an open valve {verb} across the whole dead zone of "
        f"{limit:.3g} rad in {1e3 * longest:.3g} ms"
    )
    if longest <= dead:
        raise ValueError(
            f"dead-time: {1e3 * dead:.4g} ms, but {crossing}: the valves would never rest at any "
            "rate; a smaller conductance or a wider dead zone expected"
        )
    raise ValueError(
        f"rate: {rate:.4g} Hz, but {crossing}, {1e3 * dead:.3g} ms of it dead time: the valves "
        f"may never rest; more than {1 / (longest - dead):.4g} Hz or smaller "
        "conductances expected"
    )


def _check_range(name: str, low: float, high: float) -> None:
    if not 0 <= low < high < math.inf:
        raise ValueError(
            f"{name}: {math.degrees(low):.4g} and {math.degrees(high):.4g}°, expected two rising "
            "angles from zero up: vented to the atmosphere the actuator does not bend backward"
        )
