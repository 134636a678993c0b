"""What of a motion does not go together with the rest of its case."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.case.timed.spec import PressureSpec, TimeSpec
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show

if TYPE_CHECKING:
    from fiberbend.case.case import Output
    from fiberbend.effects.effect import Inflation

_END = 1 + 1e-9
"""A value at an end is within it: units are factors, and a quotient rounds."""
_MOST_STEPS = 100_000
_A_PERIOD = 10
"""Fewest steps in a period of a sine."""
_NO_ENDS = ("at_angles", "at_pressures", "stop_at_angle", "measured")
"""What is asked of states at rest."""


def problems(
    time: TimeSpec, inflation: Inflation | None, output: Output | None
) -> Iterator[Problem]:
    """Every problem that a motion has with the rest of its case.

    Args:
        time: the motion.
        inflation: how the chamber is loaded, or None where it is not.
        output: what the case asks for, or None where that is wrong in itself.
    """
    yield from _steps(time)
    if inflation is None:
        yield Problem("time.pressure", "no effect without pressure, expected an effect pressure")
    elif inflation.to is None:
        text = "the pressure is found, expected pressure.to: motion has a pressure over time"
        yield Problem("time.pressure", text)
    else:
        yield from _pressures(time.pressure, inflation.to)
    yield from _ends(time)
    for key in _NO_ENDS if output is not None else ():
        if getattr(output, key) not in (None, ()):
            yield Problem(
                f"output.{key}", "no effect in motion, which has no such states, expected no value"
            )


def _steps(time: TimeSpec) -> Iterator[Problem]:
    step, duration = show(time.step, "time"), show(time.duration, "time")
    if time.step > time.duration * _END:
        yield Problem("time.step", f'"{step}", expected at most the duration, "{duration}"')
    if time.duration > _MOST_STEPS * time.step:
        text = f'"{step}", expected at least a {_MOST_STEPS}th of "{duration}"'
        yield Problem("time.step", text)
    sine = time.pressure.sine
    if sine is not None and _A_PERIOD * time.step * sine.frequency > _END:
        yield Problem(
            "time.step",
            f'"{step}", expected at most a {_A_PERIOD}th of a period of '
            f'"{show(sine.frequency, "frequency")}"',
        )


def _pressures(pressure: PressureSpec, to: float) -> Iterator[Problem]:
    """Pressures beyond those between zero and the effect's, for which the section is known."""
    if pressure.given is None:
        if to < 0:
            text = f'"{show(to, "pressure")}" of pressure.to, expected above zero: valves inflate'
            yield Problem("time.pressure.plant", text)
        return
    for key, value in pressure.given.bounds():
        slack = 1e-9 * abs(to)
        if not min(to, 0.0) - slack <= value <= max(to, 0.0) + slack:
            path = f"time.pressure.{pressure.way}.{key}"
            yield Problem(
                path,
                f'a pressure of "{1e3 * value:.6g} kPa", expected from zero to pressure.to, '
                f'"{show(to, "pressure")}"',
            )


def _ends(time: TimeSpec) -> Iterator[Problem]:
    """Points that end before the motion does, and commands and ramps that it never meets."""
    points, plant, ramp = time.pressure.points, time.pressure.plant, time.pressure.ramp
    duration = show(time.duration, "time")
    if points is not None and points.times[-1] * _END < time.duration:
        last, source = show(points.times[-1], "time"), points.source
        where = "" if source is None else f"{source}: "
        yield Problem(
            "time.duration",
            f'{where}pressures end at "{last}", expected a duration of no more, not "{duration}"',
        )
    if ramp is not None and ramp.start >= time.duration:
        yield Problem(
            "time.pressure.ramp.start",
            f'"{show(ramp.start, "time")}", expected below the duration, "{duration}"',
        )
    for number, command in enumerate(() if plant is None else plant.commands):
        if command.at >= time.duration:
            yield Problem(
                f"time.pressure.plant.commands.{number}.at",
                f'"{show(command.at, "time")}", expected below the duration, "{duration}"',
            )
