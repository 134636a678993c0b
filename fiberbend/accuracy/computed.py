"""The error of a run that asks for an accuracy: what can be computed is, beside the table's."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.accuracy.budget import FINE, Estimate, State, estimate, percent
from fiberbend.accuracy.numbers import curvature
from fiberbend.accuracy.words import MISSED, entry
from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.effects.effect import TURNS
from fiberbend.effects.pressure import inflate
from fiberbend.effects.straight import straight_of
from fiberbend.models.choice import MODELS, meshed
from fiberbend.models.model import MeshedModel
from fiberbend.models.result import RunResult
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import show

_SAME = 1e-6
_FLAT = 0.05
"""Relative rise of the pressure for that of the angle, below which no pressure gives an angle."""

_BEYOND = 1.05
"""Part of the greatest pressure of a calibration up to which that is trusted."""

Solve = Callable[[Case], RunResult]


def estimated(
    case: Case,
    status: str,
    rows: Sequence[dict[str, Any]],
    entries: Mapping[str, Any],
    solve: Solve,
    phase: Callable[[str], None],
) -> dict[str, Any]:
    """The entry `accuracy` of run.json, where a case asks for one; no collective.

    Args:
        case: of the run.
        status: how it ended.
        rows: its history.
        entries: of run.json so far: how good the calibration of its winding is.
        solve: solves a case on this rank alone.
        phase: takes the name of the phase that begins.
    """
    if case.accuracy is None:
        return {}
    phase("accuracy")
    calibration = entries.get("calibration") or {}
    found = _estimate(case, meshed(case), status, rows, calibration, solve)
    return {"accuracy": entry(case, found)}


def missed(run: Mapping[str, Any]) -> list[str]:
    """A warning of a run that misses its accuracy; none elsewhere."""
    block = run.get("accuracy")
    if not block or block["promised"]:
        return []
    asked = show(block["asked"], "accuracy")
    known = block["estimated"]
    estimated = "nothing" if known is None else f"{percent(known)} %"
    return [f"accuracy: {asked} {MISSED}, {estimated} is estimated: {block['reason']}"]


def _estimate(
    case: Case,
    model: MeshedModel,
    status: str,
    rows: Sequence[dict[str, Any]],
    calibration: Mapping[str, Any],
    solve: Solve,
) -> Estimate:
    doubts = [] if status == "converged" else [f"the run {status}"]
    asked = _asked(case, rows)
    if not asked:
        return estimate(case, model, (), [*doubts, "it has no answer"])
    winding: dict[int, float] = {}
    turns = case.turns
    if "left_percent" in calibration:
        winding = {row[col.STEP]: calibration["left_percent"] for row, _ in asked}
        most = max(row[col.PRESSURE] for row, _ in asked)
        if most > _BEYOND * calibration["up_to_kPa"]:
            doubts.append(f"its calibration goes up to {calibration['up_to_kPa']:.4g} kPa")
    elif turns is not None and not turns.discrete and not (case.straight and model.ends):
        try:
            winding = _of_winding(case, [row for row, _ in asked], solve)
        except CaseError as error:
            doubts.append(f"no cell beside it: {error.problems[0].text}")
        if len(winding) < len(asked):
            doubts.append("no cell beside it reaches all that is asked for")
    states = []
    for row, by_pressure in asked:
        factor = _factor(rows, row) if by_pressure and not case.straight else 1.0
        if factor is None:
            doubts.append("near its greatest pressure no angle follows from the pressure")
            factor = 1 / _FLAT
        states.append(State(_curvature(case, row), winding.get(row[col.STEP]), factor))
    return estimate(case, model, states, doubts)


def _curvature(case: Case, row: Mapping[str, Any]) -> float:
    return 0.0 if case.straight else curvature(case, math.radians(row[col.ANGLE]))


def _asked(case: Case, rows: Sequence[dict[str, Any]]) -> list[tuple[dict[str, Any], bool]]:
    """Rows that the case asks for, and whether by their pressure; the last one always."""
    load, loaded, found = case.inflation, rows[1:], {}
    if not loaded or load is None:
        return []
    for row in loaded:
        for angle in case.output.at_angles:
            if abs(row[col.ANGLE] - math.degrees(angle)) <= _SAME * max(1, abs(row[col.ANGLE])):
                found[row[col.STEP]] = (row, False)
        for pressure in case.output.at_pressures:
            if abs(row[col.PRESSURE] - 1e3 * pressure) <= _SAME * abs(row[col.PRESSURE]):
                found[row[col.STEP]] = (row, True)
    found.setdefault(loaded[-1][col.STEP], (loaded[-1], load.angle is None))
    moved = (key for key in found.values() if key[0][col.PRESSURE] != 0)
    return [each for each in moved if case.straight or each[0][col.ANGLE] != 0]


def _factor(rows: Sequence[dict[str, Any]], row: dict[str, Any]) -> float | None:
    """Percent of the angle for a percent of the pressure; None near a limit of the pressure."""
    angle = np.array([each[col.ANGLE] for each in rows], dtype=float)
    pressure = np.array([each[col.PRESSURE] for each in rows], dtype=float)
    index = next(i for i, each in enumerate(rows) if each[col.STEP] == row[col.STEP])
    kept = np.concatenate([[True], np.diff(angle) != 0])
    if not kept[index] or kept.sum() < 2:
        return None
    slope = np.gradient(pressure[kept], angle[kept])[int(kept[:index].sum())]
    rise = slope * angle[index] / pressure[index]
    return None if rise < _FLAT else float(1 / rise)


def _of_winding(case: Case, rows: Sequence[dict[str, Any]], solve: Solve) -> dict[int, float]:
    """Percent of P, or of the force, that a spread winding costs at rows, by their steps.

    The section has the elements through each thickness that the case has: their error is part of
    what is found, whatever of it the cell shares, and the table's comes on top.
    """
    spread = _beside(case, rows)
    cell = _in_turns(spread)
    key, value = (col.PRESSURE, col.TIP_FORCE) if case.straight else (col.ANGLE, col.PRESSURE)
    smooth, bulged = (_column(solve(each), key, value) for each in (spread, cell))
    found = {}
    for row in rows:
        at = round(row[key], 6)
        if at in smooth and at in bulged:
            found[row[col.STEP]] = 100 * abs(smooth[at] / bulged[at] - 1)
    return found


def _in_turns(section: Case) -> Case:
    """The cell of a section, with every turn.

    Raises:
        CaseError: it cannot be.
    """
    turns = section.turns
    assert turns is not None
    model = next(kind for kind in MODELS.values() if TURNS in kind.offers)
    wound = (effect.in_cell() if effect.winds() else effect for effect in section.effects)
    axial = turns.spacing / 2 / FINE.layers
    cell = section.model_copy(
        update={
            "model": model.name,
            "mesh": section.mesh.model_copy(update={"section": FINE.section, "axial": axial}),
            "effects": tuple(effect for effect in wound if effect is not None),
        }
    )
    found = [Problem(path, text) for path, text in model.refuses(cell)]
    if found:
        raise CaseError(found)
    return cell


def _beside(case: Case, rows: Sequence[dict[str, Any]]) -> Case:
    """The section of a case that stops at the states of rows."""
    if case.straight:
        pressures = [1e-3 * row[col.PRESSURE] for row in rows]
        section = as_section(case, inflate(to=max(pressures, key=abs)))
        effects = (*section.effects, straight_of(case.effects))
        stops: dict[str, Any] = {"at_pressures": tuple(pressures)}
    else:
        angles = [math.radians(row[col.ANGLE]) for row in rows]
        section = as_section(case, inflate(angle=max(angles, key=abs)))
        effects, stops = section.effects, {"at_angles": tuple(angles)}
    output = section.output.model_copy(update=stops)
    mesh = section.mesh.model_copy(update={"section": case.mesh.section})
    return section.model_copy(update={"mesh": mesh, "effects": effects, "output": output})


def _column(result: RunResult, key: str, value: str) -> dict[float, float]:
    """A column by another one, of all rows under load."""
    rows = (row for row in result.rows[1:] if row.get(value))
    return {round(row[key], 6): float(row[value]) for row in rows}
