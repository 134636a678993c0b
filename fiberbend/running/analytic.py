"""`model: analytic`: the closed form of a case as a run."""

from __future__ import annotations

import math
import platform
import resource
from typing import Any

import numpy as np
from scipy.optimize import brentq

from analytic.bending import BACKWARD, FORWARD, Hemicircle
from analytic.path import tip
from analytic.stress import Floats
from fiberbend.case.case import Case
from fiberbend.case.measured import read_measured
from fiberbend.compare.check import crosscheck
from fiberbend.effects.table import PressureEffect
from fiberbend.models.closed_form import (
    analytic_curves,
    assumptions,
    chamber_moment,
    face_height,
    held,
    lever_arm,
    no_analytic,
)
from fiberbend.models.result import Curve, RunResult
from fiberbend.running import launch
from fiberbend.running.folder import RunFolder
from fiberbend.running.progress import Progress
from fiberbend.version import __version__

_STEPS = 40
_GRID = 181


def run_analytic(
    case: Case, folder: RunFolder | None, progress: Progress, section: Curve | None = None
) -> RunResult:
    """Answer a case by its zero-fit line; every rank computes, the folder's own rank writes.

    Args:
        case: a case that `no_analytic` has no objection to.
        folder: where history.csv, run.json and the plots go, or None.
        progress: what is told meanwhile.
        section: P(θ) of the section model, to be put beside it.

    Raises:
        ValueError: the closed form does not hold the case; says why.
    """
    why = no_analytic(case)
    if why is not None:
        raise ValueError(why)
    progress.phase("solve")
    model = analytic_curves(case)["zero-fit"]
    if held(case):
        rows, status, reason = _blocked_rows(case, model), "converged", ""
    else:
        rows, status, reason = _free_rows(case, model)
    check = crosscheck(case, "analytic", rows, section, read_measured(case))
    rows = check.beside(rows)
    progress.phase("output")
    last = rows[-1]
    run: dict[str, Any] = {
        "status": status,
        "reason": reason,
        "model": "analytic",
        "unknowns": 0,
        "load_steps": len(rows) - 1,
        "newton_iterations": 0,
        "cutbacks": 0,
        "wall_s": {name: round(value, 6) for name, value in progress.wall_s.items()},
        "peak_memory_MB": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1),
        "ranks": launch.size(),
        "versions": {
            "fiberbend": __version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
        },
        "analytic": {
            "line": "zero-fit",
            "kappa_mm3": model.kappa,
            "assumptions": assumptions(case),
        },
        "crosscheck": check.entry(),
    }
    if "tip_force_N" in last:
        run["blocked_tip"] = {
            "L_f_mm": lever_arm(case),
            "tip_force_N": last["tip_force_N"],
            "F_L_f_Nmm": last["tip_force_N"] * lever_arm(case),
        }
    if folder is not None:
        folder.write_history(rows)
        folder.write_run(**run)
        if case.output.pictures and folder.writes:
            from fiberbend.running.report import draw_curves

            draw_curves(
                folder, case, rows, f"{status}: {reason}" if reason else None, check, "analytic"
            )
    for line in check.lines():
        progress.message(line)
    return RunResult(status, reason, rows, run, folder.path if folder is not None else None)


def _row(step: int, pressure: float, angle: float, case: Case, model: Hemicircle) -> dict[str, Any]:
    """A row of history.csv; the section keeps its shape, so that V = A L + θ ∫ y dA."""
    along, down = tip(angle, model.length, case.actuator.cap, face_height(case))
    volume = math.pi * model.radius**2 / 2 * model.length + chamber_moment(model) * angle
    return {
        "step": step,
        "pressure_kPa": 1e3 * pressure,
        "angle_deg": math.degrees(angle),
        "tip_y_mm": -float(down),
        "tip_z_mm": float(along),
        "chamber_mm3": volume,
        "newton_iterations": 0,
        "uniform_angle_deg": math.degrees(angle),
    }


def _blocked_rows(case: Case, model: Hemicircle) -> list[dict[str, Any]]:
    """Held straight: eq. (20)."""
    pressure = case.find(PressureEffect)
    assert pressure is not None
    assert pressure.to is not None
    steps = _merged(np.linspace(0.0, pressure.to, 11), case.output.at_pressures)
    rows = []
    for step, value in enumerate(steps):
        row = _row(step, float(value), 0.0, case, model)
        row["tip_force_N"] = float(model.force(value, lever_arm(case)))
        rows.append(row)
    return rows


def _free_rows(case: Case, model: Hemicircle) -> tuple[list[dict[str, Any]], str, str]:
    """Free bending: angles that grow evenly, and every angle and pressure that is asked for."""
    effect, output = case.find(PressureEffect), case.output
    assert effect is not None
    status, reason, end = "converged", "", effect.angle
    if end is None:
        assert effect.to is not None
        end, reason = _angle_at(model, effect.to)
    elif not np.isfinite(model.pressure(end)):
        end, reason = _angle_at(model, math.copysign(math.inf, end))
    if reason:
        status = "stopped"
    stop = output.stop_at_angle
    if stop is not None and stop * end > 0 and abs(stop) <= abs(end):
        status, reason, end = "converged", "", stop
    wanted = [angle for angle in output.at_angles if 0 < angle / end <= 1]
    pressures = {}
    for pressure in (*output.at_pressures, *([effect.to] if effect.to is not None else [])):
        angle, beyond = _angle_at(model, pressure)
        if 0 < angle / end <= 1 and not beyond:
            pressures[angle] = pressure
    angles = _merged(np.linspace(0.0, end, _STEPS + 1), [*wanted, *pressures])
    rows = []
    for step, angle in enumerate(angles):
        pressure = pressures.get(float(angle), float(model.pressure(angle)))
        rows.append(_row(step, pressure, float(angle), case, model))
    asked = dict.fromkeys(a for a in (*output.at_angles, stop) if a is not None)
    missed = [f"{math.degrees(a):g}°" for a in asked if not 0 < a / end <= 1 + 1e-9]
    if status == "converged" and missed:
        status = "stopped"
        reason = f"the loads end at {math.degrees(end):.4g}°: {', '.join(missed)} not reached"
    return rows, status, reason


def _angle_at(model: Hemicircle, pressure: float) -> tuple[float, str]:
    """The angle that a pressure holds, and why it is not reached, or nothing.

    Unlike `Hemicircle.angle` it goes as far as it can where the pressure is not reached.
    """
    roof = model.floor + model.radius + model.wall + model.sheath
    bound = FORWARD if pressure > 0 else max(BACKWARD, -model.length / roof / 2)
    if model.sheath:
        bound = min(bound, 0.99 * model.length / model.sheath)
    angles = np.linspace(0.0, bound, _GRID)
    values = np.abs(model.pressure(angles))
    falls = np.flatnonzero(~(np.diff(values) > 0))
    last = int(falls[0]) if len(falls) else _GRID - 1
    beyond = np.flatnonzero(values[: last + 1] >= abs(pressure))
    degrees = math.degrees(angles[last])
    reached = f"{1e3 * math.copysign(values[last], pressure):.4g} kPa at {degrees:.4g}°"
    if len(beyond):
        first = int(beyond[0])
        angle = brentq(
            lambda x: float(model.pressure(x)) - pressure, angles[first - 1], angles[first]
        )
        return float(angle), ""
    if len(falls) and not np.isfinite(values[last + 1]):
        return float(angles[last]), f"the rubber meets its limiting stretch beyond {reached}"
    if len(falls):
        return float(angles[last]), f"the pressure has its greatest value, {reached}"
    return float(angles[last]), f"the closed form ends with {reached}"


def _merged(even: Floats, exact: Any) -> Floats:
    """Even steps and exact ones, by size, without even ones that all but repeat an exact one."""
    exact = np.asarray(list(exact), dtype=float)
    size = abs(even[-1])
    kept = [x for x in even if not np.any(np.abs(exact - x) < 1e-6 * size)]
    both = np.unique(np.concatenate([kept, exact]))
    return np.asarray(both[np.argsort(np.abs(both))])
