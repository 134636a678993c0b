"""The table of a sweep: a row a point, from the run folders alone."""

from __future__ import annotations

import csv
import io
import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from analytic.bending import Hemicircle
from analytic.inverse import first_angle
from fiberbend import columns as col
from fiberbend.answer.motion import BEND, Reading
from fiberbend.answer.moves import bends, moves
from fiberbend.case.case import Case
from fiberbend.models.choice import MODELS
from fiberbend.models.closed_form import analytic_curves, lever_arm
from fiberbend.results.folder import BLOCKED
from fiberbend.sweep.fields import VariedField, shown
from fiberbend.sweep.file import ReportSpec
from fiberbend.sweep.points import Point, Sweep
from fiberbend.sweep.quantities import (
    FORCE,
    FORCE_MODEL,
    LINES,
    MOTIONS,
    STRETCH,
    ReportedQuantity,
    TableRow,
    angle_column,
    motion_column,
    pressure_column,
)
from fiberbend.sweep.store import MARK, NOT_RUN, Store
from fiberbend.sweep.trends import extremes, in_words

History = Sequence[Mapping[str, float | None]]

MODEL_STRETCH = col.CROWN_STRETCH
"""Column of history.csv with the axial stretch of the wall's crown."""
BLOCKED_COLUMNS = {
    "blocked_force_N": col.TIP_FORCE,
    col.MOMENT: col.MOMENT,
    "blocked_axis_stretch": col.AXIS_STRETCH,
}
"""Columns of the table from the history of the body kept straight."""
PAPER = "paper"
"""Entry of a case's `compare` that asks for the figures of the paper."""
_SAME = 1e-6
_NO_ANGLE = 1e-6
"""Degrees below which a body does not turn: solvers leave 1e-9."""
_MOST_ROWS = 20
"""More points than this are not listed one by one."""


def collect(sweep: Sweep, store: Store) -> list[TableRow]:
    """One row a point, in the order of the sweep; what is not known is None."""
    rows, motions = [], _motions(sweep.points)
    for index, point in enumerate(sweep.points):
        row: TableRow = {"point": point.name}
        row |= {column.name: column.values[index] for column in sweep.columns}
        found = _results(point, sweep.report, store, motions)
        rows.append(row | {name: _settled(name, value) for name, value in found.items()})
    return rows


def _settled(name: str, value: Any) -> Any:
    """A result, zero where it is an angle of which there is none but for round-off.

    Trends would tell how it rises and falls.
    """
    angle = name.endswith("_deg") and isinstance(value, float)
    return 0.0 if angle and abs(value) < _NO_ANGLE else value


def as_csv(rows: Sequence[TableRow]) -> str:
    """The table as CSV; None is an empty cell."""
    names = list(dict.fromkeys(key for row in rows for key in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: _cell(value) for key, value in row.items()} for row in rows)
    return text.getvalue()


def as_json(
    title: str,
    columns: Sequence[VariedField],
    rows: Sequence[TableRow],
    quantities: Sequence[ReportedQuantity],
    pictures: Mapping[str, Sequence[str]],
    notes: Sequence[str],
) -> str:
    """What the table, the trends and the maps of a sweep are, for a program that shows them.

    Args:
        title: of the sweep.
        columns: the varied fields.
        rows: the table.
        quantities: those of the table, what was asked for first.
        pictures: files in maps/ of each quantity, by its name.
        notes: sentences for the reader.
    """
    content = {
        "title": title,
        "points": len(rows),
        "status": dict(Counter(row["status"] for row in rows)),
        "fields": [
            {"column": field.name, "label": in_words(field), "unit": field.unit, "path": field.path}
            for field in columns
        ],
        "quantities": [
            {
                "kind": quantity.kind,
                "label": quantity.label,
                "unit": quantity.unit,
                "column": quantity.column,
                "caption": quantity.caption,
                "lines": quantity.lines,
                "extremes": extremes(columns, rows, quantity),
                "remark": quantity.remark,
                "pictures": list(pictures.get(quantity.name, ())),
            }
            for quantity in quantities
        ],
        "notes": list(notes),
        "failed": {row["point"]: row["reason"] for row in rows if row["status"] == "failed"},
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def in_brief(
    columns: Sequence[VariedField], rows: Sequence[TableRow], quantities: Sequence[ReportedQuantity]
) -> list[str]:
    """What was asked for at every point, or at the first and the last of many, as lines of text.

    Args:
        columns: the varied fields.
        rows: the points to tell of.
        quantities: those of the table, what was asked for first.
    """
    asked = [quantity for quantity in quantities if quantity.kind != STRETCH] or list(quantities)
    if not asked:
        return []
    if len(rows) > _MOST_ROWS:
        found = [(quantity, extremes(columns, rows, quantity)) for quantity in asked]
        lines = [f"{q.label}, {q.caption}: {text}" for q, text in found if text]
    else:
        heads = [
            [
                *(column.heading for column in columns),
                *(_heading(quantity)[0] for quantity in asked),
            ],
            ["" for _ in columns] + [_heading(quantity)[1] for quantity in asked],
        ]
        content = [
            [
                *(shown(row[column.name]) for column in columns),
                *(_four(quantity.value(row)) for quantity in asked),
                "" if row["status"] == "converged" else row["status"],
            ]
            for row in rows
        ]
        lines = aligned([*([*head, ""] for head in heads), *content])
        lines += [
            f"{quantity.label}: {quantity.caption}"
            for quantity in asked
            if quantity.caption != asked[0].caption or quantity.kind == FORCE
        ]
    return lines + [f"note: {quantity.remark}" for quantity in asked if quantity.remark]


def _heading(quantity: ReportedQuantity) -> tuple[str, str]:
    """Two lines above a column, "pressure" and "at 90°, kPa"."""
    first, at, rest = quantity.label.partition(" at ")
    return first, ", ".join(part for part in (f"at {rest}" if at else "", quantity.unit) if part)


def _four(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of cells as lines of text whose columns stand under each other."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def _motions(points: Sequence[Point]) -> tuple[Reading, ...]:
    """What some point may do; where none bends no angle tells anything."""
    cases = [point.case for point in points]
    made = {motion for case in cases for motion in moves(case)}
    made |= {BEND} if bends(cases) else set()
    return tuple(motion for motion in MOTIONS if motion in made)


def _results(
    point: Point, report: ReportSpec, store: Store, motions: Sequence[Reading]
) -> TableRow:
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
    for pressure in report.pressures:
        for motion in motions:
            (column,), goal = motion.columns, 1e3 * pressure
            row[motion_column(motion, pressure)] = where(history, col.PRESSURE, goal, column)
    row["end_pressure_kPa"] = end.get(col.PRESSURE)
    row["end_angle_deg"] = end.get(col.ANGLE)
    for motion in motions:
        row[motion_column(motion, None)] = end.get(motion.columns[0])
    row["greatest_stretch"] = _stretch(history, report)
    row[col.TIP_FORCE] = end.get(col.TIP_FORCE)
    if report.force_at is not None:
        straight = store.history(point, BLOCKED) if run is not None and point.blocked else history
        for name, column in BLOCKED_COLUMNS.items():
            row[name] = where(straight, col.PRESSURE, 1e3 * report.force_at, column)
        known = run if row["blocked_force_N"] is not None else None
        row[FORCE_MODEL] = MODELS[known["model"]].force_named() if known else None
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
        if case.straight or (name == PAPER and PAPER not in case.compare):
            # the closed forms bend freely
            continue
        for angle in report.angles:
            row[pressure_column(angle, name)] = _pressure(models.get(key), angle)
        for pressure in report.pressures:
            row[angle_column(pressure, name)] = _angle(models.get(key), pressure)
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


def _angle(model: Hemicircle | None, pressure: float) -> float | None:
    """Angle at a pressure in degrees, None beyond what a closed form can bear."""
    if model is None:
        return None
    low, high = model.angles
    found = first_angle(model.pressure, pressure, high if pressure > 0 else low)
    return None if found.end else math.degrees(found.angle)


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return f"{value:.10g}"
    return "" if value is None else value if isinstance(value, str | int) else json.dumps(value)
