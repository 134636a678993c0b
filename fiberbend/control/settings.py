"""Options of `fiberbend control`: plain text with units into the settings of a loop."""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import functools
import math
import re
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Literal

from fiberbend.schema.units import KINDS, parse

if TYPE_CHECKING:
    from analytic.control.controller import Controller
    from analytic.control.loop import Sensor, Sine, Steps
    from analytic.control.plant import PlantParameters

STEPS = ("150 deg", "210 deg")
SINE = ("0 deg", "180 deg")


@dataclasses.dataclass(frozen=True)
class Settings:
    """What a loop is made of, beside the case.

    Attributes:
        plant: where the plant's curve comes from: the section model or eq. (19) itself.
        filter: what the filter inverts: eq. (19) with μ̄ fitted to the plant, or the plant's curve.
        modulus: μ̄ of the filter, MPa; None: fitted.
        mismatch: relative error put on the pressures that the filter expects (μ̄ scales them all).
        pneumatics: parameters of the plant.
        controller: controller.
        sensor: pressure sensor.
        steps: step response to run.
        sine: sine to run.
    """

    plant: Literal["section", "analytic"]
    filter: Literal["analytic", "curve"]
    modulus: float | None
    mismatch: float
    pneumatics: PlantParameters
    controller: Controller
    sensor: Sensor
    steps: Steps
    sine: Sine


@dataclasses.dataclass(frozen=True)
class _Option:
    """A quantity among the options; `value` is the default and shows how to write it."""

    kind: str
    value: str
    help: str


_QUANTITIES = {
    "supply": _Option("pressure", "207 kPa", "regulated supply pressure"),
    "inlet": _Option("conductance", "0.03 dm^3/(s*bar)", "sonic conductance of the inlet"),
    "outlet": _Option("conductance", "0.03 dm^3/(s*bar)", "sonic conductance of the outlet"),
    "dead-time": _Option("time", "2 ms", "from a command to the valve's motion"),
    "dead-volume": _Option("volume", "2 mL", "volume of tube and fittings"),
    "lag": _Option("time", "0 ms", "time constant of the angle behind the pressure"),
    "rate": _Option("frequency", "100 Hz", "sampling rate of the controller"),
    "dead-zone": _Option("angle", "0.07 rad", "θ_c of eq. (22)"),
    "noise": _Option("pressure", "0 kPa", "standard deviation of the pressure sensor"),
    "hold": _Option("time", "1 s", "time between steps"),
    "frequency": _Option("frequency", "0.2 Hz", "frequency of the sine"),
}
_NUMBERS = {
    "critical-ratio": (0.3, "critical pressure ratio of the valves"),
    "exponent": (1.0, "of the air in the chamber: 1 isothermal to 1.4 adiabatic"),
    "dead-zone-divisor": (50.0, "k of eq. (22)"),
}
NAMES = (*_QUANTITIES, *_NUMBERS, "steps", "sine", "plant", "filter", "modulus", "mismatch")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a loop to a command."""
    for name, option in _QUANTITIES.items():
        parser.add_argument(
            f"--{name}",
            default=option.value,
            metavar=KINDS[option.kind].name.split()[-1].upper(),
            help=f'{option.help}; "{option.value}"',
        )
    for name, (value, text) in _NUMBERS.items():
        parser.add_argument(f"--{name}", default=str(value), metavar="X", help=f"{text}; {value:g}")
    for name, values in (("steps", STEPS), ("sine", SINE)):
        parser.add_argument(
            f"--{name}",
            nargs=2,
            default=values,
            metavar=("LOW", "HIGH"),
            help='lower and upper angle; "{}" "{}"'.format(*values),
        )
    choices = {
        "plant": (("section", "analytic"), "model of the plant's curve"),
        "filter": (("analytic", "curve"), "what the filter inverts: eq. (19) or the plant's curve"),
        "inside": (("hold", "settle", "relay"), "what the valves do inside the dead zone"),
    }
    for name, (words, text) in choices.items():
        parser.add_argument(
            f"--{name}", choices=words, default=words[0], help=f"{text}; {words[0]}"
        )
    parser.add_argument("--modulus", metavar="MODULUS", help="μ̄ of the filter; fitted unless given")
    parser.add_argument(
        "--mismatch",
        default="0 %",
        metavar="PERCENT",
        help='error put on the filter\'s μ̄, such as "10 %%"; "0 %%"',
    )
    parser.add_argument("--seed", type=int, default=0, help="of the sensor's noise; 0")


def read_settings(options: argparse.Namespace) -> Settings:
    """Read the options.

    Raises:
        CaseError: one line for every option that cannot be read, or else the first that has no
            meaning.
    """
    from analytic.control.controller import Controller, DeadZone
    from analytic.control.loop import Sensor, Sine, Steps
    from analytic.control.plant import PlantParameters
    from fiberbend.schema.problems import CaseError, Problem

    problems: list[Problem] = []

    def read(name: str, text: Any, reader: Callable[[Any], float]) -> float:
        try:
            return reader(text)
        except ValueError as error:
            problems.append(Problem(f"--{name}", f'"{text}", {error}'))
            return math.nan

    def angles(name: str) -> tuple[float, float]:
        low, high = (read(name, text, _reader("angle")) for text in getattr(options, name))
        return low, high

    value = {
        name: read(name, _given(options, name), _reader(option.kind))
        for name, option in _QUANTITIES.items()
    }
    value |= {name: read(name, _given(options, name), _number) for name in _NUMBERS}
    mismatch = read("mismatch", options.mismatch, _fraction)
    modulus = None
    if options.modulus is not None:
        modulus = read("modulus", options.modulus, _reader("modulus"))
    steps, sine = angles("steps"), angles("sine")
    if problems:
        raise CaseError(problems)
    with refusals():
        if modulus is not None and modulus <= 0:
            raise ValueError(f"modulus: a positive number expected, not {modulus}")
        zone = DeadZone(value["dead-zone-divisor"], value["dead-zone"])
        return Settings(
            plant=options.plant,
            filter=options.filter,
            modulus=modulus,
            mismatch=mismatch,
            pneumatics=PlantParameters(
                supply=value["supply"],
                inlet=value["inlet"],
                outlet=value["outlet"],
                critical_ratio=value["critical-ratio"],
                dead_time=value["dead-time"],
                dead_volume=value["dead-volume"],
                exponent=value["exponent"],
                lag=value["lag"],
            ),
            controller=Controller(value["rate"], zone, options.inside),
            sensor=Sensor(value["noise"], options.seed),
            steps=Steps(*steps, value["hold"]),
            sine=Sine(*sine, value["frequency"]),
        )


@contextlib.contextmanager
def refusals(ended: str = "") -> Iterator[None]:
    """Turn a refusal, 'name: what is wrong', into wrong input.

    Args:
        ended: why the plant's curve ends early, told where the loop needs more of it.
    """
    from fiberbend.schema.problems import CaseError, Problem

    try:
        yield
    except ValueError as error:
        name, _, text = str(error).partition(": ")
        path = f"--{name}" if name in NAMES else name
        if name == "curve" and ended:
            text += f"; the section model stopped there: {ended}"
        raise CaseError([Problem(path, text)]) from None


def _given(options: argparse.Namespace, name: str) -> Any:
    return getattr(options, name.replace("-", "_"))


def _reader(kind: str) -> Callable[[Any], float]:
    return functools.partial(parse, kind=kind)


def _number(text: Any) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError("expected a number")
    return number


def _fraction(text: Any) -> float:
    match = re.fullmatch(r"\s*([+-]?[\d.]+(?:e[+-]?\d+)?)\s*%\s*", text, re.IGNORECASE)
    try:
        fraction = float(match[1]) / 100 if match else math.nan
    except ValueError:
        fraction = math.nan
    if not -1 < fraction < math.inf:
        raise ValueError('expected a percentage above -100 % such as "10 %"')
    return fraction
