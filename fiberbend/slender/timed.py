"""The rod of a case in motion: what acts over time, what damps, and from where it begins."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from typing import Protocol, runtime_checkable

from analytic.control.controller import Valves
from analytic.control.plant import PlantParameters
from fiberbend.case.case import Case
from fiberbend.case.timed.spec import PlantSpec, PressureSpec, TimeSpec
from fiberbend.effects.records import Requests
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.slender.actuator import Slender
from fiberbend.slender.air import ValveAir
from fiberbend.slender.path import PRESSURE, Course, Limits, Point
from rod.motion import Motion
from rod.motion.course import Course as Passage
from rod.motion.course import Passed, Watch
from rod.motion.motion import retarded
from rod.rod import Level
from rod.shape import Shape

_TURN = math.radians(10)
_CUTBACKS = 8
_COMMANDS = {"fill": Valves.FILL, "hold": Valves.HOLD, "vent": Valves.VENT}


@runtime_checkable
class Gapped(Protocol):
    """A term with a distance to what it may touch."""

    def gap(self, shape: Shape, amount: float) -> float:
        """Least distance, mm; below zero in contact."""


@dataclasses.dataclass(frozen=True)
class Timed:
    """A rod that moves.

    Attributes:
        slender: the rod of the case.
        motion: its equations of motion.
        start: the equilibrium from which it begins.
        times: of the rows, s, from the first step on.
        watches: gaps whose sign is an event.
        corners: times at which steps end, s.
    """

    slender: Slender
    motion: Motion
    start: Point
    times: tuple[float, ...]
    watches: tuple[Watch, ...]
    corners: tuple[float, ...]

    def run(self) -> Iterator[Passed]:
        """States from the start on: at the times, and at the events between them.

        Raises:
            rod.statics.NoEquilibriumError: a step does not converge.
        """
        first = self.motion.at(
            self.start.state.shape.strains, pressure=self.start.values.get(PRESSURE, 0.0)
        )
        yield Passed(first)
        yield from Passage(self.motion, first, self.watches, self.corners).through(self.times)


def timed(case: Case, slender: Slender) -> Timed:
    """The motion that a case asks for.

    Args:
        case: of model rod, with `time`.
        slender: its rod.

    Raises:
        fiberbend.schema.problems.CaseError: what has no motion, or no equilibrium to begin with.
    """
    time = case.time
    assert time is not None, "a case at rest does not move"
    for index, ramp in enumerate(slender.ramps):
        if ramp.drive != "value":
            text = f"the {ramp.load} is found, expected one that is given: motion has no such"
            raise CaseError([Problem(f"effects.{index}", text)])
    air, corners = _air(time.pressure.plant, slender)
    if air is None:
        corners = _corners(time.pressure)
    begin = 0.0 if time.pressure.given is None else time.pressure.given.at(0.0)
    start = equilibrium(slender, begin)
    level = _level(slender, time.pressure)
    damping = time.damping
    parts = retarded(slender.rod, damping.retardation_time), damping.drag
    motion = Motion(slender.rod, level, *parts, air, damping.retardation_time)
    names = {id(term): name for name, term in slender.obstacles}
    watches = tuple(
        Watch(
            names.get(id(term), "contact"),
            _gap(term, number, level),
            Motion(slender.rod, _without(level, number), *parts, air, damping.retardation_time),
        )
        for number, term in enumerate(slender.rod.terms)
        if isinstance(term, Gapped)
    )
    return Timed(slender, motion, start, _times(time), watches, tuple(corners))


def _times(time: TimeSpec) -> tuple[float, ...]:
    """Ends of the steps; the last one is at the duration."""
    count = math.ceil(time.duration / time.step * (1 - 1e-9))
    return (*(time.step * number for number in range(1, count)), time.duration)


def _gap(term: Gapped, number: int, level: Callable[[float], Level]) -> Callable[..., float]:
    return lambda moving: term.gap(moving.shape, level(moving.time).amounts[number])


def _without(level: Callable[[float], Level], number: int) -> Callable[[float], Level]:
    """What acts over time but for one term."""

    def left(time: float) -> Level:
        whole = level(time)
        amounts = tuple(0.0 if i == number else each for i, each in enumerate(whole.amounts))
        return dataclasses.replace(whole, amounts=amounts)

    return left


def _level(slender: Slender, pressure: PressureSpec) -> Callable[[float], Level]:
    """What acts over time: loads that are put on whole, and the pressure."""
    whole = {ramp.load: ramp.target for ramp in slender.ramps if ramp.load != PRESSURE}
    amounts = slender.level(whole).amounts
    given = pressure.given
    if given is None:
        return lambda time: Level(0.0, amounts)
    return lambda time: Level(given.at(time), amounts)


def _corners(pressure: PressureSpec) -> list[float]:
    """Times at which a given pressure has no slope."""
    if pressure.ramp is not None:
        return [pressure.ramp.start, pressure.ramp.start + pressure.ramp.over]
    return [] if pressure.points is None else list(pressure.points.times)


def _air(plant: PlantSpec | None, slender: Slender) -> tuple[ValveAir | None, list[float]]:
    """The air behind valves, and when these move."""
    if plant is None:
        return None, []
    parameters = PlantParameters(
        supply=plant.supply,
        inlet=plant.inlet,
        outlet=plant.outlet,
        critical_ratio=plant.critical_ratio,
        dead_time=plant.dead_time,
        dead_volume=plant.dead_volume,
        exponent=plant.exponent,
    )
    commands = [(command.at, _COMMANDS[command.valve]) for command in plant.commands]
    rest = slender.rod.layout.at_rest()
    try:
        air = ValveAir(parameters, slender.rod.volume(rest, 0.0), commands)
    except ValueError as error:
        text = str(error).removeprefix("plant: ")
        raise CaseError([Problem("time.pressure.plant", text)]) from None
    return air, air.corners


def equilibrium(slender: Slender, pressure: float) -> Point:
    """The state at rest under all loads and a pressure.

    Args:
        slender: the rod.
        pressure: in MPa.

    Raises:
        fiberbend.schema.problems.CaseError: there is none.
    """
    ramps = tuple(
        dataclasses.replace(ramp, target=pressure) if ramp.load == PRESSURE else ramp
        for ramp in slender.ramps
        if ramp.load != PRESSURE or pressure
    )
    still = dataclasses.replace(slender, ramps=ramps)
    course = Course(still, Requests(None, None, (), (), None), Limits(_TURN, _CUTBACKS), 0)
    report = course.run()
    if report.status != "converged":
        text = f"no equilibrium to begin from at {1e3 * pressure:.6g} kPa: {report.reason}"
        raise CaseError([Problem("time", text)])
    return course.points[-1]


def rest_angle(timed: Timed, pressure: float) -> float | None:
    """Bending angle of the equilibrium under all loads and a pressure, °; None: there is none.

    Args:
        timed: the motion.
        pressure: in MPa.
    """
    try:
        found = equilibrium(timed.slender, pressure)
    except CaseError:
        return None
    return math.degrees(found.angle)
