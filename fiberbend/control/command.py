"""A case under feedback control: filter, controller, plant, their figure and files."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic.bending import Hemicircle
from analytic.calibration import calibrate
from analytic.control.filter import AngleFilter
from analytic.control.loop import simulate
from analytic.control.metrics import (
    sine_metrics,
    step_metrics,
)
from analytic.control.plant import ActuatorCurve, ArcCurve, Plant
from analytic.stress import effective
from fiberbend.case.case import Case
from fiberbend.control.export import (
    short_table,
    table_csv,
    table_header,
    trace_csv,
)
from fiberbend.control.result import ControlResult, FilterFit, Pace
from fiberbend.control.settings import ControlSettings, refusals
from fiberbend.models.closed_form import analytic_curves, no_analytic
from fiberbend.results.folder import RunFolder
from fiberbend.running import launch
from fiberbend.schema.problems import CaseError, Problem

if TYPE_CHECKING:
    from fiberbend.control.rod_plant import RodPlant

CONTROL_FILE = "control.json"


def run_control(
    case: Case, settings: ControlSettings, out: Path | None = None, overwrite: bool = False
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
    problems = [] if settings.plant == "rod" else list(left_out(case))
    if problems:
        raise CaseError(problems)
    comm = _world()
    if out is not None:
        _check_folder(out, overwrite)
    if comm is not None:
        # nobody makes the folder before everybody has looked for it
        comm.barrier()
    moving: RodPlant | None = None
    if settings.plant == "rod":
        curve, ended, moving = _rod(case, settings)
    else:
        curve, ended = plant_curve(case, settings)
    with refusals(ended):
        fit = fit_filter(case, curve, settings)
        plant = Plant(curve, settings.pneumatics)
        loop = functools.partial(simulate, plant, fit.filter, settings.controller)
        steps = loop(settings.steps, settings.sensor, moving)
        sine = loop(settings.sine, settings.sensor, moving)
        table = short_table(fit.filter, settings.pneumatics.supply)
    result = ControlResult(
        settings,
        fit,
        table,
        steps,
        sine,
        step_metrics(steps, settings.steps),
        sine_metrics(sine, settings.sine),
        None if moving is None else Pace.of(moving.steps, moving.seconds, steps, sine),
    )
    if out is not None:
        with RunFolder.create(out, case, overwrite, comm) as folder:
            _write(result, case, folder)
    return result


def left_out(case: Case) -> Iterator[Problem]:
    """Effects of a case that neither plant has: the loop inflates a chamber that bends freely."""
    for index, effect in enumerate(case.effects):
        known = effect.inflation() or effect.beside() or effect.fixes_circumference()
        if not known:
            text = "control bends the actuator freely, without it: leave it out"
            yield Problem(f"effects.{index}.{effect.name}", text)


def plant_curve(case: Case, settings: ControlSettings) -> tuple[ActuatorCurve, str]:
    """The actuator's own P, θ and V: of the section model, or of eq. (19) with the paper's μ̄.

    Returns:
        The curve, to 360° or a third beyond the references; why it ends before, or nothing.
    """
    highest = max(settings.steps.high, settings.sine.high)
    end = max(2 * math.pi, 4 / 3 * highest)
    if settings.plant == "analytic":
        return ArcCurve.of(_closed_form(case), np.linspace(0.0, end, 73)), ""
    from fiberbend.compare.beside import section_curve
    from fiberbend.running.runner import run_case

    curve = section_curve(case, end, lambda section: run_case(section, None))
    return curve, curve.reason


def _rod(case: Case, settings: ControlSettings) -> tuple[ActuatorCurve, str, RodPlant]:
    """The rod's curve at rest, why it ends early, and the rod that moves."""
    from fiberbend.control.rod_plant import Damping, RodPlant, rod_curve, rod_of

    rod = rod_of(case, max(settings.steps.high, settings.sine.high))
    curve, ended = rod_curve(rod)
    own = None if case.time is None else case.time.damping
    retardation, drag = (0.0, 0.0) if own is None else (own.retardation_time, own.drag)
    damping = Damping(
        retardation if settings.retardation_time is None else settings.retardation_time,
        drag if settings.drag is None else settings.drag,
    )
    with refusals():
        return curve, ended, RodPlant(rod, settings.pneumatics, damping)


def fit_filter(case: Case, curve: ActuatorCurve, settings: ControlSettings) -> FilterFit:
    """The filter that the settings ask for, μ̄ fitted to the plant's curve as in section IV-B.

    Args:
        case: has the dimensions of eq. (19).
        curve: P, θ and V of the plant.
        settings: what the filter inverts, μ̄ and mismatch.

    Raises:
        ValueError: no filter can be made.
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
        raise CaseError([Problem(str(out), f"contains no {CONTROL_FILE}, expected a control run")])


def _write(result: ControlResult, case: Case, folder: RunFolder) -> None:
    from fiberbend.control.plot import plot_control
    from fiberbend.drawing.page import own_style

    folder.write_text("control.csv", trace_csv({"steps": result.steps, "sine": result.sine}))
    folder.write_text("filter.csv", table_csv(result.table))
    folder.write_text("angle_filter.h", table_header(result.table, case.title, result.fit.source))
    with own_style():
        folder.write("control.png", functools.partial(plot_control, result, title=case.title))
    folder.write_json(CONTROL_FILE, result.report("paper" in case.compare))


def _off(mismatch: float) -> str:
    return f", {100 * mismatch:+g} % off" if mismatch else ""
