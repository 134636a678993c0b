"""Rows of history.csv of a hand."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.hand.assembled import Assembled
from fiberbend.hand.solved import Moment, Solved
from rod.functions import Floats

STEP, PRESSURE, WEIGHT = "step", "pressure_kPa", "weight"
ITERATIONS, MODES = "iterations", "unstable_modes"
_AXES = "xyz"


def rows(hand: Assembled, solved: Solved) -> list[dict[str, Any]]:
    """One for each moment, the first at rest."""
    pairs = zip(solved.moments, solved.iterations, strict=True)
    return [row(hand, step, moment, spent) for step, (moment, spent) in enumerate(pairs)]


def row(hand: Assembled, step: int, moment: Moment, iterations: int) -> dict[str, Any]:
    """Row of a moment.

    Args:
        hand: the hand.
        step: its number.
        moment: the moment.
        iterations: of Newton's method since the one before.
    """
    greatest = max((digit.finger.pressure for digit in hand.digits), key=abs)
    found: dict[str, Any] = {
        STEP: step,
        PRESSURE: 1e3 * moment.pressure * greatest,
        WEIGHT: moment.weight if hand.hand.gravity is not None else None,
    }
    shapes = moment.state.shape
    onto = {name: np.zeros((2, 3)) for name in hand.hand.objects}
    rooms = dict.fromkeys(hand.hand.objects, math.inf)
    for number, (digit, shape) in enumerate(zip(hand.digits, shapes.each, strict=True), start=1):
        mine = f"finger_{number}"
        found[f"{mine}_pressure_kPa"] = 1e3 * moment.pressure * digit.finger.pressure
        found[f"{mine}_angle_deg"] = math.degrees(digit.turn(shape))
        for strain in ("side_curvature", "twist"):
            if strain in shape.layout.strains:
                name = f"{mine}_{strain.removesuffix('_curvature')}_deg"
                found[name] = math.degrees(digit.turn(shape, strain))
        found |= _triple(f"{mine}_tip", digit.tip(shape), "mm")
        for name, item in hand.hand.objects.items():
            touched = digit.touched(name, shape)
            # of the finger on the object, about the object's middle
            force, moment_ = -touched.force, -touched.moment
            moment_ = moment_ - np.cross(item.middle, force)
            onto[name] += [force, moment_]
            rooms[name] = min(rooms[name], touched.gap)
            found |= _triple(f"{mine}_on_{name}", force, "N")
            found[f"{mine}_{name}_gap_mm"] = touched.gap
    for name, (force, turning) in onto.items():
        found |= _triple(name, force, "N") | _triple(f"{name}_moment", turning, "Nmm")
        found[f"{name}_gap_mm"] = rooms[name]
    for (a, b), meeting in zip(hand.pairs, hand.meetings, strict=True):
        own = hand.system.own(meeting, shapes)
        force, _ = meeting.force(own, np.zeros(3))
        found |= _triple(f"finger_{b + 1}_on_{a + 1}", force, "N")
        found[f"fingers_{a + 1}_{b + 1}_gap_mm"] = meeting.clearance(own)
    return found | {ITERATIONS: iterations, MODES: moment.state.unstable}


def on_object(row: dict[str, Any], finger: int, name: str) -> list[float]:
    """Force of a finger on an object, x, y and z, N.

    Args:
        row: of history.csv.
        finger: place of the finger, from 0 on.
        name: of the object.
    """
    return [row[f"finger_{finger + 1}_on_{name}_{axis}_N"] for axis in _AXES]


def _triple(name: str, values: Floats, unit: str) -> dict[str, float]:
    return {
        f"{name}_{axis}_{unit}": float(value) + 0.0
        for axis, value in zip(_AXES, values, strict=True)
    }


def text(rows: Sequence[dict[str, Any]]) -> str:
    """history.csv; numbers have ten significant digits."""
    columns = [name for name in rows[0] if any(row[name] is not None for row in rows)]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(row[name]) for name in columns] for row in rows)
    return out.getvalue()


def _cell(value: Any) -> Any:
    if not isinstance(value, float):
        return value
    return "" if math.isinf(value) else f"{value:.10g}"
