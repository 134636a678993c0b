"""Motion of a case: how long, in which steps, the chamber's pressure over time, and what damps."""

from __future__ import annotations

import bisect
import itertools
import math
from typing import Annotated, Any, Literal, Protocol

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from fiberbend.schema.quantities import Quantity, Spec

Time = Annotated[float, Quantity("time")]
TimeOrZero = Annotated[float, Quantity("time", "zero or above")]
AnyPressure = Annotated[float, Quantity("pressure", "any")]
Supply = Annotated[float, Quantity("pressure")]
Frequency = Annotated[float, Quantity("frequency")]
Conductance = Annotated[float, Quantity("conductance")]
VolumeOrZero = Annotated[float, Quantity("volume", "zero or above")]
RateOrZero = Annotated[float, Quantity("rate", "zero or above")]
ValveName = Literal["fill", "hold", "vent"]

WAYS = ("ramp", "sine", "file", "points", "plant")
"""How a pressure over time may be given."""


class Given(Protocol):
    """A pressure that is given over time."""

    def at(self, time: float) -> float:
        """P in MPa at a time in s."""

    def bounds(self) -> tuple[tuple[str, float], ...]:
        """Pressures between which it stays, MPa, with the keys that say them."""


class RampSpec(Spec):
    """A pressure that changes evenly from one value to another."""

    from_: AnyPressure = Field(default=0.0, alias="from")
    """Pressure until it begins."""
    to: AnyPressure
    """Pressure from its end on."""
    start: TimeOrZero = 0.0
    """When it begins."""
    over: TimeOrZero
    """How long it takes; of none at all it is a jump."""

    def at(self, time: float) -> float:
        """See `Given`."""
        if time <= self.start:
            return self.from_
        share = (time - self.start) / self.over if time < self.start + self.over else 1.0
        return self.from_ + share * (self.to - self.from_)

    def bounds(self) -> tuple[tuple[str, float], ...]:
        """See `Given`."""
        return ("from", self.from_), ("to", self.to)


class SineSpec(Spec):
    """P = mean + amplitude sin(2π frequency t)."""

    mean: AnyPressure
    """About which it swings, and from which it begins."""
    amplitude: Annotated[float, Quantity("pressure")]
    """Greatest distance from the mean."""
    frequency: Frequency
    """Periods in a second."""

    def at(self, time: float) -> float:
        """See `Given`."""
        return self.mean + self.amplitude * math.sin(2 * math.pi * self.frequency * time)

    def bounds(self) -> tuple[tuple[str, float], ...]:
        """See `Given`."""
        return ("mean", self.mean - self.amplitude), ("amplitude", self.mean + self.amplitude)


class PointsSpec(Spec):
    """Pressures at rising times, straight lines between them."""

    times: tuple[TimeOrZero, ...] = Field(min_length=2, strict=False)
    """Times, the first one zero."""
    pressures: tuple[AnyPressure, ...] = Field(min_length=2, strict=False)
    """Pressures at these times."""
    source: str | None = None
    """The file that they are from."""

    @model_validator(mode="after")
    def _rising(self) -> PointsSpec:
        wrong = points_refusal(self.times, self.pressures)
        if wrong is not None:
            raise PydanticCustomError("points", "{text}", {"text": wrong})
        return self

    def at(self, time: float) -> float:
        """See `Given`; beyond the last time, of which a reader sees that there is none, its own."""
        after = bisect.bisect_right(self.times, time)
        if after == len(self.times):
            return self.pressures[-1]
        start, end = self.times[after - 1 : after + 1]
        share = (time - start) / (end - start)
        return (1 - share) * self.pressures[after - 1] + share * self.pressures[after]

    def bounds(self) -> tuple[tuple[str, float], ...]:
        """See `Given`."""
        return ("pressures", min(self.pressures)), ("pressures", max(self.pressures))


def points_refusal(times: tuple[float, ...], pressures: tuple[float, ...]) -> str | None:
    """Why points are no pressure over time, or None."""
    if len(times) != len(pressures):
        return f"{len(times)} times and {len(pressures)} pressures, expected as many of both"
    if times[0] != 0:
        return f"times begin at {times[0]:g} s, expected 0 s"
    for number, (before, after) in enumerate(itertools.pairwise(times)):
        if after <= before:
            return f"time {number + 2}, {after:g} s, after {before:g} s, expected rising times"
    return None


class CommandSpec(Spec):
    """A command to the two valves."""

    at: TimeOrZero
    """When it is given; the valves move after their dead time."""
    valve: ValveName
    """fill opens the inlet, vent the outlet, hold neither."""


class PlantSpec(Spec):
    """A supply, two valves and the air in the chamber, as in `fiberbend control`."""

    commands: tuple[CommandSpec, ...] = Field(min_length=1, strict=False)
    """Commands to the valves in turn; until the first one both are shut, and the pressure is
    that outside."""
    supply: Supply = 0.207
    """Regulated supply pressure."""
    inlet: Conductance = 0.03
    """Sonic conductance of the inlet."""
    outlet: Conductance = 0.03
    """Sonic conductance of the outlet."""
    critical_ratio: float = Field(default=0.3, ge=0, lt=1)
    """Critical pressure ratio of the valves."""
    dead_time: TimeOrZero = 0.002
    """From a command to the valve's motion."""
    dead_volume: VolumeOrZero = 2000.0
    """Volume of tube and fittings."""
    exponent: float = Field(default=1.0, ge=1, le=1.4)
    """Of the air in the chamber: 1 isothermal to 1.4 adiabatic."""

    @model_validator(mode="after")
    def _in_turn(self) -> PlantSpec:
        for before, after in itertools.pairwise(self.commands):
            if after.at <= before.at:
                text = f"command at {after.at:g} s after one at {before.at:g} s, expected them in "
                raise PydanticCustomError("plant", "{text}", {"text": f"{text}turn"})
        return self


class PressureSpec(Spec):
    """The chamber's pressure over time, in one of several ways."""

    ramp: RampSpec | None = None
    """It changes evenly from one value to another."""
    sine: SineSpec | None = None
    """It swings about a mean."""
    file: str | None = None
    """CSV file with columns of times and pressures and their units, such as time_s and
    pressure_kPa, relative to the case file; straight lines between its rows."""
    points: PointsSpec | None = None
    """The same in the case itself; what a run keeps of a file."""
    plant: PlantSpec | None = None
    """It follows from two valves and the air that they let in and out."""

    @model_validator(mode="before")
    @classmethod
    def _one(cls, data: Any) -> Any:
        given = [key for key in WAYS if isinstance(data, dict) and data.get(key) is not None]
        known = not isinstance(data, dict) or set(data) <= set(WAYS)
        if known and isinstance(data, dict) and len(given) != 1:
            said = " and ".join(given) if given else "nothing"
            text = f"{said}, expected one of {', '.join(WAYS)}"
            raise PydanticCustomError("pressures", "{text}", {"text": text})
        return data

    @property
    def given(self) -> Given | None:
        """The pressure where it is given over time; None where valves make it."""
        return self.ramp or self.sine or self.points

    @property
    def way(self) -> str:
        """Which of the ways it is given in."""
        return next(key for key in WAYS if getattr(self, key) is not None)


class DampingSpec(Spec):
    """What takes energy out of a motion."""

    retardation_time: TimeOrZero = 0.0
    """τ of Kelvin and Voigt: viscous forces of every section are τ times its stiffness at rest
    without pressure, times the rate of its strains."""
    drag: RateOrZero = 0.0
    """Rayleigh's part of the mass: a force against the velocity of every mass, this times its
    momentum."""


class TimeSpec(Spec):
    """Motion from the equilibrium at time zero on."""

    duration: Time
    """How long."""
    step: Time = 0.005
    """Length of the steps in time; the last one ends at the duration."""
    pressure: PressureSpec
    """The chamber's pressure over time."""
    damping: DampingSpec = DampingSpec.model_construct()
    """What damps; nothing unless given."""
