"""What the controller drives: supply, two valves, the air in the chamber, the actuator's curve.

mm, N, MPa, s, rad; air is counted as pressure times volume, MPa mm³ = mJ.

* Supply: a regulator that keeps its pressure at any flow.
* Valves: ISO 6358, each by its sonic conductance C and critical pressure ratio b,
      q = p0 C p_up ψ(p_down/p_up),  ψ(r) = 1 for r <= b, sqrt(1 − ((r − b)/(1 − b))²) above it,
  linear in p_up − p_down for r > 0.999 where the square root has an infinite slope, as simulators
  of pneumatics do (Sanville's formula with a laminar part). All air has one temperature.
* Chamber: ideal gas, p' = n (q − p V')/V. n = 1 is isothermal, n = 1.4 adiabatic (Richer and
  Hurmuzlu 2000, doi 10.1115/1.1286336, eq. for a chamber with one exponent for all parts).
* Actuator: θ and V follow P at once along a curve, as in the paper ('the dynamics associated with
  pressurization were neglected'); with a lag τ instead θ' = (θ(P) − θ)/τ and V belongs to θ.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Protocol

import numpy as np

from analytic.bending import Hemicircle
from analytic.control.controller import Valves
from analytic.control.cubic_table import CubicTable
from analytic.inverse import ROUND_OFF
from analytic.stress import Floats

REFERENCE_PRESSURE = 0.1
"""p0 of ISO 6358 (ISO 8778: 100 kPa, 20 °C), MPa."""
CONDUCTANCE = 1e7
"""mm³/(s MPa) in one dm³/(s bar)."""
LAMINAR = 0.999
"""Pressure ratio above which a valve's flow is linear."""
_SUBSTEP = 2.5e-4
_LEAST_SUBSTEP = 1e-6
_STATES = ("pressure", "angle", "volume")


class ActuatorCurve(Protocol):
    """How an actuator bends and swells: points of one rising curve."""

    @property
    def pressure(self) -> Floats:
        """Gauge pressures, (n,), MPa, rising from zero."""

    @property
    def angle(self) -> Floats:
        """Bending angles, (n,), rad, rising."""

    @property
    def volume(self) -> Floats:
        """Volumes of the whole chamber, (n,), mm³."""


@dataclasses.dataclass(frozen=True)
class ArcCurve:
    """A curve whose section keeps its shape, as the analytical model assumes.

    Attributes:
        pressure: pressures, (n,), MPa.
        angle: angles, (n,), rad.
        volume: volumes, (n,), mm³.
    """

    pressure: Floats
    angle: Floats
    volume: Floats

    @classmethod
    def of(cls, actuator: Hemicircle, angle: Floats) -> ArcCurve:
        """Curve of the analytical model at bending angles (n,), rad.

        The volume is Pappus': the chamber's area times the length of its centroid's path,
        V = π/2 a² (L + (b + 4a/(3π)) θ).
        """
        a, b = actuator.radius, actuator.floor
        centroid = b + 4 * a / (3 * math.pi)
        volume = math.pi / 2 * a**2 * (actuator.length + centroid * angle)
        return cls(actuator.pressure(angle), angle, volume)


@dataclasses.dataclass(frozen=True)
class PlantParameters:
    """Pneumatics of the plant; docs/control.md justifies the defaults.

    Attributes:
        supply: gauge pressure of the regulator, MPa.
        inlet: sonic conductance of the inlet path, dm³/(s bar), the unit of data sheets.
        outlet: the same of the outlet path.
        critical_ratio: b of both paths.
        dead_time: from a command to the valve's motion, opening or closing, s.
        dead_volume: volume of tube and fittings behind the valves, mm³.
        exponent: polytropic exponent of the air, 1 isothermal to 1.4 adiabatic.
        lag: time constant with which the angle follows the pressure, s.
        atmosphere: absolute pressure outside, MPa.

    Raises:
        ValueError: a value without meaning, by name.
    """

    supply: float = 0.207
    inlet: float = 0.03
    outlet: float = 0.03
    critical_ratio: float = 0.3
    dead_time: float = 0.002
    dead_volume: float = 2000.0
    exponent: float = 1.0
    lag: float = 0.0
    atmosphere: float = 0.101325

    def __post_init__(self) -> None:
        for name in ("supply", "inlet", "outlet", "atmosphere"):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name}: a positive number expected, not {getattr(self, name)}")
        for name in ("dead_time", "dead_volume", "lag"):
            if not 0 <= getattr(self, name) < math.inf:
                label = name.replace("_", "-")
                raise ValueError(f"{label}: zero or more expected, not {getattr(self, name)}")
        if not 0 <= self.critical_ratio < 1:
            raise ValueError(
                f"critical-ratio: expected from 0 to below 1, not {self.critical_ratio}"
            )
        if not 1 <= self.exponent <= 1.4:
            raise ValueError(
                f"exponent: expected from 1 (isothermal) to 1.4 (adiabatic), not {self.exponent}"
            )


def flow(conductance: float, upstream: float, downstream: float, critical_ratio: float) -> float:
    """Flow through a valve after ISO 6358, backward where the pressures are.

    Args:
        conductance: C, mm³/(s MPa).
        upstream: absolute pressure before it, MPa.
        downstream: absolute pressure behind it, MPa.
        critical_ratio: b.

    Returns:
        Pressure times volume of the air that passes, MPa mm³/s.
    """
    if downstream > upstream:
        return -flow(conductance, downstream, upstream, critical_ratio)
    ratio = downstream / upstream
    if ratio <= critical_ratio:
        part = 1.0
    elif ratio <= LAMINAR:
        part = math.sqrt(1 - ((ratio - critical_ratio) / (1 - critical_ratio)) ** 2)
    else:
        part = _laminar_slope(critical_ratio) * (1 - ratio)
    return REFERENCE_PRESSURE * conductance * upstream * part


def inflow(parameters: PlantParameters, valves: Valves, absolute: float) -> float:
    """Air that the valves let into the chamber, MPa mm³/s.

    Args:
        parameters: pneumatics.
        valves: which one is open.
        absolute: pressure in the chamber, MPa.
    """
    p = parameters
    if valves is Valves.FILL:
        return flow(CONDUCTANCE * p.inlet, p.supply + p.atmosphere, absolute, p.critical_ratio)
    if valves is Valves.VENT:
        return -flow(CONDUCTANCE * p.outlet, absolute, p.atmosphere, p.critical_ratio)
    return 0.0


def substep(parameters: PlantParameters, volume: float) -> float:
    """A fifth of the shortest time constant, and a quarter of a millisecond at most, s.

    Args:
        parameters: pneumatics.
        volume: least one of the chamber, mm³.

    Raises:
        ValueError: valves too large for the chamber.
    """
    p = parameters
    largest = CONDUCTANCE * max(p.inlet, p.outlet)
    steep = REFERENCE_PRESSURE * largest * _laminar_slope(p.critical_ratio)
    fastest = p.exponent * steep / (volume + p.dead_volume)
    step = min(_SUBSTEP, 0.2 / fastest, p.lag / 5 if p.lag else math.inf)
    if step < _LEAST_SUBSTEP:
        raise ValueError(
            f"plant: time constants below {5e6 * _LEAST_SUBSTEP:g} µs; smaller conductances or "
            "a longer lag expected"
        )
    return step


def _check(curve: ActuatorCurve, parameters: PlantParameters) -> None:
    sizes = {name: np.shape(getattr(curve, name)) for name in _STATES}
    if len(set(sizes.values())) > 1 or len(curve.pressure) < 2:
        raise ValueError(f"curve: three lists of one length of at least 2 expected, not {sizes}")
    for name in _STATES:
        if not np.isfinite(getattr(curve, name)).all():
            raise ValueError(f"curve: a {name} is not finite")
    steps = [np.diff(getattr(curve, name)) for name in _STATES]
    if not (np.all(steps[0] > 0) and np.all(steps[1] > 0)):
        rising = (steps[0] > 0) & (steps[1] > 0)
        where = math.degrees(curve.angle[int(np.argmin(rising))])
        raise ValueError(f"curve: pressure and angle do not both rise beyond {where:.4g}°")
    # d(p V^n) > 0: air let in raises the pressure
    p = curve.pressure + parameters.atmosphere
    volume = curve.volume + parameters.dead_volume
    if np.min(curve.volume) <= 0 or np.any(np.diff(p * volume**parameters.exponent) <= 0):
        raise ValueError("curve: a volume is not positive, or falls faster than air is compressed")


def _laminar_slope(critical_ratio: float) -> float:
    edge = (LAMINAR - critical_ratio) / (1 - critical_ratio)
    return math.sqrt(1 - edge**2) / (1 - LAMINAR) if edge > 0 else 1 / (1 - LAMINAR)


Rates = Callable[[Valves, float, float], tuple[float, float]]


class Plant:
    """Chamber and actuator between two valves, in time.

    Attributes:
        parameters: pneumatics.
        pressure: gauge pressure in the chamber now, MPa.
        angle: bending angle now, rad.
        highest: pressure at which the curve ends, MPa.
    """

    def __init__(
        self, curve: ActuatorCurve, parameters: PlantParameters, pressure: float = 0.0
    ) -> None:
        """At rest under a gauge pressure in MPa.

        Raises:
            ValueError: a curve that does not rise or whose volume falls too fast for a stable
                chamber, valves too large for the chamber, or a pressure off the curve.
        """
        _check(curve, parameters)
        self.parameters = parameters
        self._angle = CubicTable.monotone(curve.pressure, curve.angle)
        self._volume = CubicTable.monotone(curve.angle, curve.volume)
        self.highest = self._angle.high
        self.restart(pressure)
        self._step = substep(parameters, float(np.min(curve.volume)))

    def restart(self, pressure: float) -> None:
        """Come to rest under a gauge pressure in MPa.

        Raises:
            ValueError: the curve does not reach the pressure.
        """
        slack = ROUND_OFF * (self.highest - self._angle.low)
        if not self._angle.low - slack <= pressure <= self.highest + slack:
            raise ValueError(
                f"curve: it goes from {1e3 * self._angle.low:.4g} to {1e3 * self.highest:.4g} kPa, "
                f"{1e3 * pressure:.4g} kPa needed"
            )
        self.pressure, self.angle = pressure, self._angle(pressure)

    def air(self) -> float:
        """Pressure times volume of the air behind the valves, MPa mm³."""
        volume = self._volume(self.angle) + self.parameters.dead_volume
        return (self.pressure + self.parameters.atmosphere) * volume

    def advance(self, valves: Valves, duration: float) -> None:
        """Let time pass with the valves as they are: classical Runge–Kutta in equal substeps.

        Raises:
            ValueError: the pressure leaves the curve.
        """
        count = math.ceil(duration / self._step * (1 - 1e-9))
        rates = self._lagging if self.parameters.lag else self._following
        for _ in range(count):
            self._substep_once(rates, valves, duration / count)
        if not self.parameters.lag:
            self.angle = self._angle(self.pressure)
        if self.pressure > self.highest + ROUND_OFF * (self.highest - self._angle.low):
            raise ValueError(
                f"curve: it ends at {1e3 * self.highest:.4g} kPa, and the pressure went beyond"
            )

    def _substep_once(self, rates: Rates, valves: Valves, h: float) -> None:
        p, a = self.pressure, self.angle
        p1, a1 = rates(valves, p, a)
        p2, a2 = rates(valves, p + h / 2 * p1, a + h / 2 * a1)
        p3, a3 = rates(valves, p + h / 2 * p2, a + h / 2 * a2)
        p4, a4 = rates(valves, p + h * p3, a + h * a3)
        self.pressure = p + h / 6 * (p1 + 2 * p2 + 2 * p3 + p4)
        self.angle = a + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)

    def _following(self, valves: Valves, pressure: float, _: float) -> tuple[float, float]:
        """P' when θ is at its curve; θ is set from P afterwards."""
        n, absolute = self.parameters.exponent, pressure + self.parameters.atmosphere
        angle = self._angle(pressure)
        swelling = self._volume.slope(angle) * self._angle.slope(pressure)
        volume = self._volume(angle) + self.parameters.dead_volume
        air = inflow(self.parameters, valves, absolute)
        return n * air / (volume + n * absolute * swelling), 0.0

    def _lagging(self, valves: Valves, pressure: float, angle: float) -> tuple[float, float]:
        n, absolute = self.parameters.exponent, pressure + self.parameters.atmosphere
        turn = (self._angle(pressure) - angle) / self.parameters.lag
        volume = self._volume(angle) + self.parameters.dead_volume
        swell = self._volume.slope(angle) * turn
        return n * (inflow(self.parameters, valves, absolute) - absolute * swell) / volume, turn
