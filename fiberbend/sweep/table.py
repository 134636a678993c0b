"""The table of a sweep: a row a point, from the run folders alone."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from analytic.bending import Hemicircle
from analytic.stress import CALIBRATED_MODULUS
from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.models import lines
from fiberbend.models.closed_form import analytic_curves, lever_arm
from fiberbend.results.folder import BLOCKED
from fiberbend.schema.units import show
from fiberbend.sweep.file import ReportSpec
from fiberbend.sweep.points import Point, Sweep
from fiberbend.sweep.store import MARK, Store

History = Sequence[Mapping[str, float | None]]
TableRow = dict[str, Any]

LINES = {lines.PAPER: "paper", lines.ZERO_FIT: "zero_fit", lines.WINDING: "winding"}
"""Analytical lines in the table, with their names in it."""
CAPTIONS = {
    "paper": f"analytical, eq. (19), μ̄ = {CALIBRATED_MODULUS:g} MPa",
    "uniform": "analytical, λ = 1 + h θ/L",
    "paper_force": "analytical, eq. (20)",
    "winding_force": "analytical, pressure acting up to the winding",
}
"""Captions of the analytical lines that are drawn."""
MODEL_STRETCH = col.CROWN_STRETCH
"""Column of history.csv with the axial stretch of the wall's crown."""
BLOCKED_COLUMNS = {
    "blocked_force_N": col.TIP_FORCE,
    col.MOMENT: col.MOMENT,
    "blocked_axis_stretch": col.AXIS_STRETCH,
}
"""Columns of the table from the history of the body kept straight."""
_SAME = 1e-6
NOT_RUN = "not run"


@dataclasses.dataclass(frozen=True)
class ReportedQuantity:
    """A quantity of the table that is drawn and has its trends listed.

    Attributes:
        kind: an entry of `ReportSpec.maps`.
        name: name of its picture without the ending.
        label: its name in words.
        unit: its unit, or empty.
        lines: columns of the table by their captions, the run first, then analytical models.
    """

    kind: str
    name: str
    label: str
    unit: str
    lines: dict[str, str]

    @property
    def axis(self) -> str:
        """Label of an axis."""
        return f"{self.label} ({self.unit})" if self.unit else self.label


def quantities(report: ReportSpec, rows: Sequence[TableRow]) -> list[ReportedQuantity]:
    """Quantities of the table of a sweep that can be drawn; columns without values are left out."""
    solved = sorted({row["solved_by"] for row in rows if row["solved_by"]})
    run = " and ".join(solved) + " model"
    result = []
    for angle in report.angles:
        lines = {run: pressure_column(angle), CAPTIONS["paper"]: pressure_column(angle, "paper")}
        label = f"pressure at {math.degrees(angle):.6g}°"
        result.append(
            ReportedQuantity("pressure", f"pressure_{degrees(angle)}", label, "kPa", lines)
        )
    at = f" at {math.degrees(max(report.angles, key=abs)):.6g}°" if report.angles else ""
    lines = {run: "greatest_stretch", CAPTIONS["uniform"]: "paper_stretch"}
    result.append(
        ReportedQuantity("stretch", "stretch", f"greatest axial stretch λ{at}", "", lines)
    )
    if report.force_at is not None:
        lines = {run: "blocked_force_N"}
        lines |= {CAPTIONS[line]: f"{line}_N" for line in ("paper_force", "winding_force")}
        label = f"blocked force at {show(report.force_at, 'pressure')}"
        result.append(ReportedQuantity("blocked-force", "blocked_force", label, "N", lines))
    known = {name for row in rows for name, value in row.items() if value is not None}
    filled = (
        dataclasses.replace(
            quantity, lines={c: name for c, name in quantity.lines.items() if name in known}
        )
        for quantity in result
    )
    return [quantity for quantity in filled if quantity.lines]


def degrees(angle: float) -> str:
    """An angle in rad as part of a column's name, 360deg."""
    return f"{math.degrees(angle):.6g}deg"


def pressure_column(angle: float, line: str = "") -> str:
    """Column of the pressure at an angle, of the run or of an analytical line."""
    return f"{line and line + '_'}pressure_{degrees(angle)}_kPa"


def collect(sweep: Sweep, store: Store) -> list[TableRow]:
    """One row a point, in the order of the sweep; what is not known is None."""
    rows = []
    for index, point in enumerate(sweep.points):
        row: TableRow = {"point": point.name}
        row |= {column.name: column.values[index] for column in sweep.columns}
        rows.append(row | _results(point, sweep.report, store))
    return rows


def as_csv(rows: Sequence[TableRow]) -> str:
    """The table as CSV; None is an empty cell."""
    names = list(dict.fromkeys(key for row in rows for key in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: _cell(value) for key, value in row.items()} for row in rows)
    return text.getvalue()


def _results(point: Point, report: ReportSpec, store: Store) -> TableRow:
    run = store.result(point)
    history = store.history(point) if run is not None else []
    end = history[-1] if history else {}
    row: TableRow = {
        "status": run["status"] if run else NOT_RUN,
        "reason": run["reason"] if run else None,
        "solved_by": run["model"] if run else None,
    }
    for angle in report.angles:
        row[pressure_column(angle)] = where(history, col.ANGLE, math.degrees(angle), col.PRESSURE)
    row["end_pressure_kPa"] = end.get(col.PRESSURE)
    row["end_angle_deg"] = end.get(col.ANGLE)
    row["greatest_stretch"] = _stretch(history, report)
    row[col.TIP_FORCE] = end.get(col.TIP_FORCE)
    if report.force_at is not None:
        straight = store.history(point, BLOCKED) if run is not None and point.blocked else history
        for name, column in BLOCKED_COLUMNS.items():
            row[name] = where(straight, col.PRESSURE, 1e3 * report.force_at, column)
    row |= {name: end.get(name) for name in report.history}
    row |= _analytic(point.case, report)
    for key in ("unknowns", "newton_iterations"):
        row[key] = run[key] if run else None
    row["wall_s"] = run[MARK]["wall_s"] if run else None
    return row


def where(history: History, along: str, goal: float, column: str) -> float | None:
    """A column where another one first reaches a value; between steps on a line.

    Args:
        history: rows of history.csv.
        along: the column that reaches a value.
        goal: the value.
        column: the column that is read.
    """
    before: tuple[float, float] | None = None
    for row in history:
        x, y = row.get(along), row.get(column)
        if x is None or y is None:
            continue
        if abs(x - goal) < _SAME:
            return y
        if before is not None and (before[0] - goal) * (x - goal) < 0:
            return before[1] + (goal - before[0]) / (x - before[0]) * (y - before[1])
        before = (x, y)
    return None


def _stretch(history: History, report: ReportSpec) -> float | None:
    """Stretch at the greatest reported angle, at the end where none is reported."""
    if report.angles:
        angle = math.degrees(max(report.angles, key=abs))
        return where(history, col.ANGLE, angle, MODEL_STRETCH)
    return history[-1].get(MODEL_STRETCH) if history else None


def _analytic(case: Case, report: ReportSpec) -> TableRow:
    row: TableRow = {}
    models = analytic_curves(case)
    for key, name in LINES.items():
        for angle in report.angles:
            row[pressure_column(angle, name)] = _pressure(models.get(key), angle)
    paper = models.get("paper")
    if paper is not None and report.angles:
        angle = max(report.angles, key=abs)
        crown = paper.floor + paper.radius + paper.wall + (case.actuator.sheath or 0.0)
        row["paper_stretch"] = 1 + crown * angle / paper.length
    if report.force_at is not None:
        for key in ("paper", "winding"):
            model = models.get(key)
            force = None if model is None else model.force(report.force_at, lever_arm(case))
            row[f"{key}_force_N"] = None if force is None else float(force)
    return row


def _pressure(model: Hemicircle | None, angle: float) -> float | None:
    """Pressure at an angle in kPa, None beyond what a closed form can bend."""
    if model is None:
        return None
    try:
        pressure = 1e3 * float(model.pressure(angle))
    except ValueError:
        return None
    return pressure if math.isfinite(pressure) else None


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return f"{value:.10g}"
    return "" if value is None else value if isinstance(value, str | int) else json.dumps(value)
