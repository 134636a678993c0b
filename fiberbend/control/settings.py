"""What a control loop is made of: its options with their units, and the parts made of them."""

from __future__ import annotations

import contextlib
import dataclasses
import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, ValidationError
from pydantic_core import PydanticCustomError

from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.quantities import Quantity, Spec
from fiberbend.schema.validation import from_pydantic

if TYPE_CHECKING:
    from analytic.control.controller import Controller
    from analytic.control.loop import Sensor, Sine, Steps
    from analytic.control.plant import PlantParameters


@dataclasses.dataclass(frozen=True)
class ControlSettings:
    """What a loop is made of, beside the case.

    Attributes:
        plant: where the plant's curve comes from: the section model, eq. (19) itself, or a rod,
            which then moves with its inertia.
        filter: what the filter inverts: eq. (19) with μ̄ fitted to the plant, or the plant's curve.
        modulus: μ̄ of the filter, MPa; None: fitted.
        mismatch: relative error put on the pressures that the filter expects (μ̄ scales them all).
        pneumatics: parameters of the plant.
        controller: controller.
        sensor: pressure sensor.
        steps: step response to run.
        sine: sine to run.
        retardation_time: τ of a rod's sections, s; None: that of the case.
        drag: of a rod, 1/s; None: that of the case.
    """

    plant: Literal["section", "analytic", "rod"]
    filter: Literal["analytic", "curve"]
    modulus: float | None
    mismatch: float
    pneumatics: PlantParameters
    controller: Controller
    sensor: Sensor
    steps: Steps
    sine: Sine
    retardation_time: float | None = None
    drag: float | None = None


def _fraction(text: Any) -> float:
    match = re.fullmatch(r"\s*([+-]?[\d.]+(?:e[+-]?\d+)?)\s*%\s*", str(text), re.IGNORECASE)
    try:
        fraction = float(match[1]) / 100 if match else -1.0
    except ValueError:
        fraction = -1.0
    if not -1 < fraction < float("inf"):
        message = 'expected a percentage above -100 % such as "10 %"'
        raise PydanticCustomError("fraction", "{message}", {"message": message})
    return fraction


# Signs and sizes are checked by the parts of the loop.
_Pressure = Annotated[float, Quantity("pressure", "any")]
_Modulus = Annotated[float, Quantity("modulus", "any")]
_Conductance = Annotated[float, Quantity("conductance", "any")]
_Time = Annotated[float, Quantity("time", "any")]
_Volume = Annotated[float, Quantity("volume", "any")]
_Rate = Annotated[float, Quantity("rate", "zero or above")]
_Frequency = Annotated[float, Quantity("frequency", "any")]
_Angle = Annotated[float, Quantity("angle", "any")]
_Fraction = Annotated[float, BeforeValidator(_fraction)]


def _option(text: Any) -> Any:
    """A default as it would be written on the command line."""
    return Field(default=text, strict=False)


class Options(Spec):
    """The options of a loop; text into numbers in mm, N, MPa, s and rad."""

    model_config = ConfigDict(
        alias_generator=lambda name: name.replace("_", "-"),
        validate_by_name=True,
        validate_default=True,
    )

    supply: _Pressure = _option("207 kPa")
    """Regulated supply pressure."""
    inlet: _Conductance = _option("0.03 dm^3/(s*bar)")
    """Sonic conductance of the inlet."""
    outlet: _Conductance = _option("0.03 dm^3/(s*bar)")
    """Sonic conductance of the outlet."""
    dead_time: _Time = _option("2 ms")
    """From a command to the valve's motion."""
    dead_volume: _Volume = _option("2 mL")
    """Volume of tube and fittings."""
    lag: _Time = _option("0 ms")
    """Time constant of the angle behind the pressure."""
    rate: _Frequency = _option("100 Hz")
    """Sampling rate of the controller."""
    dead_zone: _Angle = _option("0.07 rad")
    """θ_c of eq. (22)."""
    noise: _Pressure = _option("0 kPa")
    """Standard deviation of the pressure sensor."""
    hold: _Time = _option("1 s")
    """Time between steps."""
    frequency: _Frequency = _option("0.2 Hz")
    """Frequency of the sine."""
    critical_ratio: float = _option("0.3")
    """Critical pressure ratio of the valves."""
    exponent: float = _option("1")
    """Of the air in the chamber: 1 isothermal to 1.4 adiabatic."""
    dead_zone_divisor: float = _option("50")
    """k of eq. (22)."""
    steps: tuple[_Angle, _Angle] = _option(("150 deg", "210 deg"))
    """Lower and upper angle of the step response."""
    sine: tuple[_Angle, _Angle] = _option(("0 deg", "180 deg"))
    """Lower and upper angle of the sine."""
    plant: Literal["section", "analytic", "rod"] = "section"
    """Model of the plant's curve; a rod moves with its inertia, under the case's weight and
    loads."""
    retardation_time: _Time | None = None
    """τ of Kelvin and Voigt of a rod; that of the case's time, or none."""
    drag: _Rate | None = None
    """Rayleigh's part of a rod's mass; likewise."""
    filter: Literal["analytic", "curve"] = "analytic"
    """What the filter inverts: eq. (19) or the plant's curve."""
    inside: Literal["hold", "settle", "relay"] = "hold"
    """What the valves do inside the dead zone."""
    modulus: _Modulus | None = None
    """μ̄ of the filter; fitted unless given."""
    mismatch: _Fraction = _option("0 %")
    """Error put on the filter's μ̄, such as "10 %"."""
    seed: int = _option("0")
    """Of the sensor's noise."""


def read_settings(given: Mapping[str, Any]) -> ControlSettings:
    """Read the options of a loop.

    Args:
        given: text of each option by the name of its field; defaults for what is not given.

    Raises:
        CaseError: one line for every option that cannot be read, or else the first that has no
            meaning.
    """
    from analytic.control.controller import Controller, DeadZone
    from analytic.control.loop import Sensor, Sine, Steps
    from analytic.control.plant import PlantParameters

    try:
        options = Options.model_validate(given)
    except ValidationError as error:
        raise CaseError(
            Problem(f"--{problem.path.partition('.')[0].replace('_', '-')}", problem.text)
            for problem in from_pydantic(error, Options)
        ) from None
    with refusals():
        for name in ("retardation_time", "drag"):
            if getattr(options, name) is not None and options.plant != "rod":
                label = name.replace("_", "-")
                raise ValueError(f"{label}: no effect without --plant rod, expected no value")
        if options.retardation_time is not None and options.retardation_time < 0:
            raise ValueError(
                f"retardation-time: expected zero or above, not {options.retardation_time}"
            )
        if options.modulus is not None and options.modulus <= 0:
            raise ValueError(f"modulus: a positive number expected, not {options.modulus}")
        zone = DeadZone(options.dead_zone_divisor, options.dead_zone)
        return ControlSettings(
            plant=options.plant,
            filter=options.filter,
            modulus=options.modulus,
            mismatch=options.mismatch,
            pneumatics=PlantParameters(
                supply=options.supply,
                inlet=options.inlet,
                outlet=options.outlet,
                critical_ratio=options.critical_ratio,
                dead_time=options.dead_time,
                dead_volume=options.dead_volume,
                exponent=options.exponent,
                lag=options.lag,
            ),
            controller=Controller(options.rate, zone, options.inside),
            sensor=Sensor(options.noise, options.seed),
            steps=Steps(*options.steps, options.hold),
            sine=Sine(*options.sine, options.frequency),
            retardation_time=options.retardation_time,
            drag=options.drag,
        )


@contextlib.contextmanager
def refusals(ended: str = "") -> Iterator[None]:
    """Turn a refusal, 'name: what is wrong', into wrong input.

    Args:
        ended: why the plant's curve ends early, added where the loop needs more of it.
    """
    try:
        yield
    except ValueError as error:
        name, _, text = str(error).partition(": ")
        options = {field.alias for field in Options.model_fields.values()}
        path = f"--{name}" if name in options else name
        if name == "curve" and ended:
            text += f"; the section model stopped there: {ended}"
        raise CaseError([Problem(path, text)]) from None
