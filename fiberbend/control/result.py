"""What a control run has found, as text and as the content of control.json."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from analytic.control.filter import AngleFilter, LinearTable
from analytic.control.loop import Trace
from analytic.control.metrics import PAPER, SineMetrics, StepMetrics
from fiberbend.control.export import shown_time
from fiberbend.control.settings import ControlSettings
from fiberbend.version import __version__


@dataclasses.dataclass(frozen=True)
class FilterFit:
    """The filter of a loop and how it came about.

    Attributes:
        filter: the filter.
        source: what it inverts, one line.
        modulus: μ̄, MPa, or nan where it inverts a curve.
        modulus_error: standard error of the fit of μ̄, MPa, or nan.
        departure: greatest |filter(P) − θ| over the plant's curve, rad.
    """

    filter: AngleFilter
    source: str
    modulus: float
    modulus_error: float
    departure: float


@dataclasses.dataclass(frozen=True)
class Pace:
    """How quick a plant with inertia was.

    Attributes:
        steps: in time.
        step_ms: processor time of one.
        real: processor time over the time that passed in the loops.
    """

    steps: int
    step_ms: float
    real: float

    @classmethod
    def of(cls, steps: int, seconds: float, *traces: Trace) -> Pace:
        """Of so many steps that took so long, s, in loops with these traces."""
        passed = sum(float(trace.time[-1] - trace.time[0]) for trace in traces)
        return cls(steps, 1e3 * seconds / steps, seconds / passed)


@dataclasses.dataclass(frozen=True)
class ControlResult:
    """What a control run has found.

    Attributes:
        settings: what was asked.
        fit: the filter.
        table: the filter as a short table.
        steps: trace of the step response.
        sine: trace of the sine.
        step_metrics: measures of the first.
        sine_metrics: measures of the second.
        pace: of a plant with inertia, else None.
    """

    settings: ControlSettings
    fit: FilterFit
    table: LinearTable
    steps: Trace
    sine: Trace
    step_metrics: StepMetrics
    sine_metrics: SineMetrics
    pace: Pace | None = None

    def lines(self, paper: bool = False) -> list[str]:
        """The result as lines of text.

        Args:
            paper: beside the paper's numbers.
        """
        step, sine = self.step_metrics, self.sine_metrics
        low, high = np.degrees(self.settings.steps.levels)
        bottom, *_, top = np.degrees(self.settings.sine.levels)

        def beside(text: str, name: str = "") -> str:
            return f" ({name}{text})" if paper else ""

        return [
            f"filter:  {self.fit.source}",
            f"         up to {math.degrees(self.fit.departure):.1f}° off the plant's own curve",
            f"         table of {len(self.table.angle)} points, error {self.table.error:.1e} rad",
            f"steps:   {low:g} and {high:g}°: filling {shown_time(step.fill_s)}"
            f"{beside(shown_time(PAPER['fill_s']), 'paper ')}, emptying {shown_time(step.vent_s)}"
            f"{beside(shown_time(PAPER['vent_s']))}",
            f"         undesired switching {_percent(step.undesired)} of the time"
            f"{beside(_percent(PAPER['undesired_steps']))}",
            f"sine:    {bottom:g} to {top:g}°, {self.settings.sine.frequency:g} Hz: delay "
            f"{shown_time(sine.delay_s)}{beside(shown_time(PAPER['delay_s']))}",
            f"         undesired switching {_percent(sine.undesired)} of the time"
            f"{beside(_percent(PAPER['undesired_sine']))}",
            *([] if self.pace is None else [_paced(self.pace)]),
        ]

    def report(self, paper: bool = False) -> dict[str, Any]:
        """Content of control.json.

        Args:
            paper: beside the paper's numbers.
        """
        settings, step, sine = self.settings, self.step_metrics, self.sine_metrics
        p, zone = settings.pneumatics, settings.controller.zone
        low, high = np.degrees(settings.steps.levels)
        bottom, *_, top = np.degrees(settings.sine.levels)
        content = {
            "version": __version__,
            "plant": {
                "curve": settings.plant,
                "supply_kPa": 1e3 * p.supply,
                "atmosphere_kPa": 1e3 * p.atmosphere,
                "inlet_dm3_per_s_bar": p.inlet,
                "outlet_dm3_per_s_bar": p.outlet,
                "critical_ratio": p.critical_ratio,
                "dead_time_ms": 1e3 * p.dead_time,
                "dead_volume_mm3": p.dead_volume,
                "exponent": p.exponent,
                "lag_ms": 1e3 * p.lag,
            },
            "filter": {
                "inverts": settings.filter,
                "source": self.fit.source,
                "modulus_MPa": self.fit.modulus,
                "modulus_error_MPa": self.fit.modulus_error,
                "mismatch_percent": 100 * settings.mismatch,
                "error_rad": self.fit.filter.error,
                "departure_from_plant_deg": math.degrees(self.fit.departure),
                "table_points": len(self.table.angle),
                "table_error_rad": self.table.error,
            },
            "controller": {
                "rate_Hz": settings.controller.rate,
                "dead_zone_rad": zone.offset,
                "dead_zone_divisor": zone.divisor,
                "inside": settings.controller.inside,
            },
            "sensor": {"noise_kPa": 1e3 * settings.sensor.noise, "seed": settings.sensor.seed},
            "steps": {
                "low_deg": low,
                "high_deg": high,
                "hold_s": settings.steps.hold,
                "cycles": settings.steps.cycles,
                "fill_ms": 1e3 * step.fill_s,
                "vent_ms": 1e3 * step.vent_s,
                "undesired_percent": 100 * step.undesired,
                "openings": step.openings,
                "plant_error_deg": math.degrees(step.error_rad),
            },
            "sine": {
                "low_deg": bottom,
                "high_deg": top,
                "frequency_Hz": settings.sine.frequency,
                "cycles": settings.sine.cycles,
                "delay_ms": 1e3 * sine.delay_s,
                "plant_delay_ms": 1e3 * sine.plant_delay_s,
                "undesired_percent": 100 * sine.undesired,
                "openings": sine.openings,
                "error_rms_deg": math.degrees(sine.error_rad),
                "plant_error_rms_deg": math.degrees(sine.plant_error_rad),
            },
        }
        if self.pace is not None:
            content["motion"] = dataclasses.asdict(self.pace)
        if paper:
            content["paper"] = {
                "fill_ms": 1e3 * PAPER["fill_s"],
                "vent_ms": 1e3 * PAPER["vent_s"],
                "steps_undesired_percent": 100 * PAPER["undesired_steps"],
                "delay_ms": 1e3 * PAPER["delay_s"],
                "sine_undesired_percent": 100 * PAPER["undesired_sine"],
            }
        return {name: _rounded(value) for name, value in content.items()}


def _paced(pace: Pace) -> str:
    return (
        f"motion:  {pace.steps} steps of {pace.step_ms:.1f} ms of the processor, "
        f"{pace.real:.2f} of real time"
    )


def _percent(part: float) -> str:
    return f"{100 * part:.2f} %"


def _rounded(value: Any) -> Any:
    """Numbers to nine digits, none as null: JSON has no nan."""
    if isinstance(value, dict):
        return {name: _rounded(inner) for name, inner in value.items()}
    if isinstance(value, float):
        return None if math.isnan(value) else float(f"{value:.9g}")
    return value
