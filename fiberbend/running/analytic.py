"""`model: analytic`: the closed form of a case as a run."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from analytic.bending import Hemicircle
from analytic.inverse import first_angle
from analytic.path import tip
from analytic.stress import Floats
from fiberbend import columns as col
from fiberbend.answer.answer import answer
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.measured import read_measured
from fiberbend.compare.check import crosscheck
from fiberbend.models.choice import choose_model
from fiberbend.models.closed_form import (
    analytic_curves,
    assumptions,
    lever_arm,
    no_analytic,
)
from fiberbend.models.result import Curve, RunResult
from fiberbend.plan.doubts import doubts
from fiberbend.results.folder import RunFolder
from fiberbend.running import messages
from fiberbend.running.outputs import draw_at_rest, draw_curves, write_page
from fiberbend.running.progress import Progress
from fiberbend.running.record import beside, entries, peak_memory_mb

_STEPS = 40
_END = 1 + 1e-9
"""An angle at the end of a run is within it, whatever a quotient rounds to."""


def run_analytic(
    case: Case,
    folder: RunFolder | None,
    progress: Progress,
    ranks: int = 1,
    section: Curve | None = None,
) -> RunResult:
    """Answer a case by its model's line; every rank computes, the folder's own rank writes.

    Args:
        case: a case that `no_analytic` has no objection to.
        folder: where history.csv, run.json and the plots go, or None.
        progress: reports to the user.
        ranks: how many wait for it, for run.json.
        section: P(θ) of the section model, to be put beside it.

    Raises:
        ValueError: the closed form does not support the case.
        NotImplementedError: the case's model has no closed form.
    """
    why = no_analytic(case)
    if why is not None:
        raise ValueError(why)
    kind, _ = choose_model(case)
    if not kind.line:
        raise NotImplementedError(f"model {kind.name} has neither elements nor a closed form")
    progress.phase("solve")
    model = analytic_curves(case)[kind.line]
    missed: list[str] = []
    if case.straight:
        rows, status, reason = _blocked_rows(case, model), "converged", ""
    else:
        rows, status, reason, missed = _free_rows(case, model)
    check = crosscheck(case, kind, rows, section, read_measured(case))
    rows = check.beside(rows)
    for row in rows:
        col.check(row, kind)
    progress.phase("output")
    last = rows[-1]
    run = entries(
        status,
        reason,
        kind.name,
        {
            "unknowns": 0,
            "load_steps": len(rows) - 1,
            "newton_iterations": 0,
            "cutbacks": 0,
            "warnings": [
                *doubts(case),
                *check.doubts(),
                *([messages.missed(missed)] if missed else []),
            ],
        },
        {name: round(value, 6) for name, value in progress.wall_s.items()},
        peak_memory_mb(),
        ranks,
        {"numpy": np.__version__},
    )
    run["analytic"] = {
        "line": kind.line,
        "kappa_mm3": model.kappa,
        "assumptions": assumptions(case),
    }
    run |= beside(check)
    if col.TIP_FORCE in last:
        run["blocked_tip"] = {
            "L_f_mm": lever_arm(case),
            col.TIP_FORCE: last[col.TIP_FORCE],
            "F_L_f_Nmm": last[col.TIP_FORCE] * lever_arm(case),
        }
    if folder is not None:
        folder.write_history(rows)
        folder.write_run(**run)
        if case.output.pictures and folder.writes:
            draw_at_rest(folder, case, progress.message)
            draw_curves(
                folder,
                case,
                rows,
                f"{status}: {reason}" if reason else None,
                (check.angles, check.forces),
                kind.name,
                progress.message,
            )
        if case.output.report and folder.writes:
            progress.phase("report")
            write_page(folder, case, rows, run, progress.message)
        progress.close()
        run["wall_s"] = {name: round(value, 6) for name, value in progress.wall_s.items()}
        folder.write_run(**run)
    progress.answer(answer(case, rows, run))
    return RunResult(status, reason, rows, run, folder.path if folder is not None else None)


def _row(step: int, pressure: float, angle: float, case: Case, model: Hemicircle) -> dict[str, Any]:
    """A row of history.csv; the section keeps its shape, so that V = A L + θ ∫ y dA."""
    body = convert.dimensions(case.actuator)
    along, down = tip(angle, model.length, body.cap, body.face_height)
    volume = body.chamber_volume + body.chamber_moment * angle
    return {
        col.STEP: step,
        col.PRESSURE: 1e3 * pressure,
        col.ANGLE: math.degrees(angle),
        col.TIP_Y: -float(down),
        col.TIP_Z: float(along),
        col.VOLUME: volume,
        col.ITERATIONS: 0,
        col.TIP_X: 0.0,
        col.UNIFORM_ANGLE: math.degrees(angle),
    }


def _blocked_rows(case: Case, model: Hemicircle) -> list[dict[str, Any]]:
    """Kept straight: eq. (20)."""
    load = case.inflation
    assert load is not None
    assert load.to is not None
    steps = _merged(np.linspace(0.0, load.to, 11), case.output.at_pressures)
    rows = []
    for step, value in enumerate(steps):
        row = _row(step, float(value), 0.0, case, model)
        row[col.TIP_FORCE] = float(model.force(value, lever_arm(case)))
        rows.append(row)
    return rows


def _free_rows(case: Case, model: Hemicircle) -> tuple[list[dict[str, Any]], str, str, list[str]]:
    """Free bending: angles that grow evenly, and every angle and pressure that is asked for.

    Returns:
        Rows, status, reason, and what is asked for and not reached.
    """
    load, output = case.inflation, case.output
    assert load is not None
    status, reason, end = "converged", "", load.angle
    if end is None:
        assert load.to is not None
        end, reason = _angle_at(model, load.to)
    elif not np.isfinite(model.pressure(end)):
        end, reason = _angle_at(model, math.copysign(math.inf, end))
    if reason:
        status = "stopped"
    stop = output.stop_at_angle
    if stop is not None and stop * end > 0 and abs(stop) <= _END * abs(end):
        status, reason, end = "converged", "", stop
    wanted = [angle for angle in output.at_angles if 0 < angle / end <= _END]
    pressures = {}
    for pressure in (*output.at_pressures, *([load.to] if load.to is not None else [])):
        angle, beyond = _angle_at(model, pressure)
        if 0 < angle / end <= _END and not beyond:
            pressures[angle] = pressure
    angles = _merged(np.linspace(0.0, end, _STEPS + 1), [*wanted, *pressures])
    rows = []
    for step, angle in enumerate(angles):
        pressure = pressures.get(float(angle), float(model.pressure(angle)))
        rows.append(_row(step, pressure, float(angle), case, model))
    asked = dict.fromkeys(a for a in (*output.at_angles, stop) if a is not None)
    missed = [f"{math.degrees(a):g}°" for a in asked if not 0 < a / end <= _END]
    missed += [
        f"{1e3 * pressure:.6g} kPa"
        for pressure in dict.fromkeys(output.at_pressures)
        if pressure not in pressures.values()
    ]
    if status == "converged" and missed:
        status = "stopped"
        reason = f"the loads end at {math.degrees(end):.4g}°: {', '.join(missed)} not reached"
    return rows, status, reason, missed


def _angle_at(model: Hemicircle, pressure: float) -> tuple[float, str]:
    """The angle at a pressure, and why it is not reached, or nothing.

    Unlike `Hemicircle.angle` it goes as far as it can where the pressure is not reached.
    """
    low, high = model.angles
    bound = high if pressure > 0 else low
    found = first_angle(model.pressure, pressure, bound)
    degrees = math.degrees(found.angle)
    reached = f"{1e3 * math.copysign(found.pressure, pressure):.4g} kPa at {degrees:.4g}°"
    why = {
        "": "",
        "peak": f"the pressure has its greatest value, {reached}",
        "limit": f"the rubber meets its limiting stretch beyond {reached}",
        "bound": f"the closed form ends with {reached}",
    }
    return found.angle, why[found.end]


def _merged(even: Floats, exact: Any) -> Floats:
    """Even steps and exact ones, by size, without even ones that all but repeat an exact one."""
    exact = np.asarray(list(exact), dtype=float)
    size = abs(even[-1])
    kept = [x for x in even if not np.any(np.abs(exact - x) < 1e-6 * size)]
    both = np.unique(np.concatenate([kept, exact]))
    return np.asarray(both[np.argsort(np.abs(both))])
