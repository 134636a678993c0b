"""A case under feedback control: filter, controller, plant, their figure and files."""

from __future__ import annotations

import dataclasses
import functools
import math
from pathlib import Path
from typing import Any

import numpy as np

from analytic.bending import Hemicircle
from analytic.calibration import calibrate
from analytic.control.filter import AngleFilter, LinearTable
from analytic.control.loop import Trace, simulate
from analytic.control.metrics import (
    PAPER,
    SineMetrics,
    StepMetrics,
    sine_metrics,
    step_metrics,
)
from analytic.control.plant import ActuatorCurve, ArcCurve, Plant
from analytic.stress import effective
from fiberbend import __version__
from fiberbend.case.case import Case
from fiberbend.control.export import (
    short_table,
    shown_time,
    table_csv,
    table_header,
    trace_csv,
)
from fiberbend.control.settings import Settings, refusals
from fiberbend.models.closed_form import analytic_curves, no_analytic
from fiberbend.run import launch
from fiberbend.run.folder import RunFolder
from fiberbend.schema.problems import CaseError, Problem

CONTROL_FILE = "control.json"


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
    """

    settings: Settings
    fit: FilterFit
    table: LinearTable
    steps: Trace
    sine: Trace
    step_metrics: StepMetrics
    sine_metrics: SineMetrics

    def lines(self) -> list[str]:
        """The result as lines of text, beside the paper's numbers."""
        step, sine = self.step_metrics, self.sine_metrics
        low, high = np.degrees(self.settings.steps.levels)
        bottom, *_, top = np.degrees(self.settings.sine.levels)
        return [
            f"filter:  {self.fit.source}",
            f"         up to {math.degrees(self.fit.departure):.1f}° off the plant's own curve",
            f"         table of {len(self.table.angle)} points, error {self.table.error:.1e} rad",
            f"steps:   {low:g} and {high:g}°: filling {shown_time(step.fill_s)} "
            f"(paper {shown_time(PAPER['fill_s'])}), emptying {shown_time(step.vent_s)} "
            f"({shown_time(PAPER['vent_s'])})",
            f"         undesired switching {_percent(step.undesired)} of the time "
            f"({_percent(PAPER['undesired_steps'])})",
            f"sine:    {bottom:g} to {top:g}°, {self.settings.sine.frequency:g} Hz: delay "
            f"{shown_time(sine.delay_s)} ({shown_time(PAPER['delay_s'])})",
            f"         undesired switching {_percent(sine.undesired)} of the time "
            f"({_percent(PAPER['undesired_sine'])})",
        ]

    def report(self) -> dict[str, Any]:
        """Content of control.json."""
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
            "paper": {
                "fill_ms": 1e3 * PAPER["fill_s"],
                "vent_ms": 1e3 * PAPER["vent_s"],
                "steps_undesired_percent": 100 * PAPER["undesired_steps"],
                "delay_ms": 1e3 * PAPER["delay_s"],
                "sine_undesired_percent": 100 * PAPER["undesired_sine"],
            },
        }
        return {name: _rounded(value) for name, value in content.items()}


def run_control(
    case: Case, settings: Settings, out: Path | None = None, overwrite: bool = False
) -> ControlResult:
    """Run a case's actuator through steps and a sine under feedback control; collective.

    Args:
        case: actuator, materials and winding; its loads and its model are not used.
        settings: plant, filter, controller and references.
        out: folder for control.csv, control.json, control.png, filter.csv and angle_filter.h.
        overwrite: replace the folder of an earlier control run.

    Raises:
        CaseError: a case, settings or a folder that cannot be used.
    """
    comm = _world()
    if out is not None:
        _check_folder(out, overwrite)
    if comm is not None:
        # nobody makes the folder before everybody has looked for it
        comm.barrier()
    curve, ended = plant_curve(case, settings)
    with refusals(ended):
        fit = fit_filter(case, curve, settings)
        plant = Plant(curve, settings.pneumatics)
        loop = functools.partial(simulate, plant, fit.filter, settings.controller)
        steps = loop(settings.steps, settings.sensor)
        sine = loop(settings.sine, settings.sensor)
        table = short_table(fit.filter, settings.pneumatics.supply)
    result = ControlResult(
        settings,
        fit,
        table,
        steps,
        sine,
        step_metrics(steps, settings.steps),
        sine_metrics(sine, settings.sine),
    )
    if out is not None:
        _write(result, case, RunFolder.create(out, case, overwrite, comm))
    return result


def plant_curve(case: Case, settings: Settings) -> tuple[ActuatorCurve, str]:
    """The actuator's own P, θ and V: of the section model, or of eq. (19) with the paper's μ̄.

    Returns:
        The curve, to 360° or a third beyond the references; why it ends before, or nothing.
    """
    highest = max(settings.steps.high, settings.sine.high)
    end = max(2 * math.pi, 4 / 3 * highest)
    if settings.plant == "analytic":
        return ArcCurve.of(_closed_form(case), np.linspace(0.0, end, 73)), ""
    from fiberbend.case.section_beside import load
    from fiberbend.control.plant_curve import section_curve

    curve = section_curve(case, load(angle=end))
    return curve, curve.reason


def fit_filter(case: Case, curve: ActuatorCurve, settings: Settings) -> FilterFit:
    """The filter that the settings ask for, μ̄ fitted to the plant's curve as in section IV-B.

    Raises:
        ValueError: no filter can be made; says why.
    """
    factor = 1 + settings.mismatch
    modulus = error = math.nan
    if settings.filter == "curve":
        angle_filter = AngleFilter.from_curve(factor * curve.pressure, curve.angle)
        source = f"the plant's curve{_off(settings.mismatch)}"
    else:
        model = _closed_form(case)
        if settings.modulus is not None:
            modulus, source = settings.modulus, "as given"
        else:
            bent = curve.angle > 0
            fitted = calibrate(curve.pressure[bent], curve.angle[bent], model)
            modulus, error = fitted.modulus, fitted.error
            source = f"± {error:.4f} MPa fitted to the plant's curve"
        modulus *= factor
        model = dataclasses.replace(model, stress=effective(modulus))
        angle_filter = AngleFilter.from_model(model)
        source = f"eq. (19), μ̄ = {modulus:.4f} MPa {source}{_off(settings.mismatch)}"
    departure = np.abs(angle_filter.angles(curve.pressure) - curve.angle).max()
    return FilterFit(angle_filter, source, modulus, error, float(departure))


def _closed_form(case: Case) -> Hemicircle:
    why = no_analytic(case)
    if why is not None:
        raise CaseError([Problem("case", f"{why}; --plant section --filter curve go without it")])
    return analytic_curves(case)["paper"]


def _world() -> Any:
    """All ranks under mpirun, else None."""
    if launch.size() == 1:
        return None
    from mpi4py import MPI

    return MPI.COMM_WORLD


def _check_folder(out: Path, overwrite: bool) -> None:
    """Before anything is computed; never replaces the folder of another kind of run."""
    if not out.exists():
        return
    if not overwrite:
        raise CaseError([Problem(str(out), "exists, expected a new folder, or --overwrite")])
    if out.is_dir() and any(out.iterdir()) and not (out / CONTROL_FILE).exists():
        raise CaseError([Problem(str(out), f"holds no {CONTROL_FILE}, expected a control run")])


def _write(result: ControlResult, case: Case, folder: RunFolder) -> None:
    from fiberbend.control.plot import plot_control

    folder.write_text("control.csv", trace_csv({"steps": result.steps, "sine": result.sine}))
    folder.write_text("filter.csv", table_csv(result.table))
    folder.write_text("angle_filter.h", table_header(result.table, case.title, result.fit.source))
    folder.write("control.png", functools.partial(plot_control, result, title=case.title))
    folder.write_json(CONTROL_FILE, result.report())


def _off(mismatch: float) -> str:
    return f", {100 * mismatch:+g} % off" if mismatch else ""


def _percent(part: float) -> str:
    return f"{100 * part:.2f} %"


def _rounded(value: Any) -> Any:
    """Numbers to nine digits, none as null: JSON has no nan."""
    if isinstance(value, dict):
        return {name: _rounded(inner) for name, inner in value.items()}
    if isinstance(value, float):
        return None if math.isnan(value) else float(f"{value:.9g}")
    return value
