"""Messages on limit points and lost stability, in the user's units."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.march.records import Critical, Report
from fiberbend import columns as col

UNSTABLE_END = (
    "the end is unstable where every load is kept at its value: given the pressure, no actuator "
    "rests there"
)
_LEFT = {
    "by the loads": "the run goes on along it, to the side that the loads or the mesh favour",
    "chosen": "the run goes on along it, to one of two sides that are alike",
    "": "no state is found along it on which the body rests",
}
"""What a run does at a bifurcation, by the side that it takes."""
_COUNT = ("no", "one", "two", "three")


def critical_points(report: Report, symmetry_factor: float) -> list[dict[str, Any]]:
    """Entries of run.json.

    Args:
        report: of the march.
        symmetry_factor: number of modelled parts that make up the whole actuator.
    """
    return [
        {
            "kind": point.kind,
            "load": point.scalar,
            **_values(point, symmetry_factor),
            "unstable_modes_before": point.before,
            "unstable_modes_beyond": point.after,
            **({"side": point.side} if point.side else {}),
        }
        for point in report.critical
    ]


def _values(point: Critical, symmetry_factor: float) -> dict[str, float]:
    values: dict[str, float] = {}
    if point.scalar == "pressure":
        values[col.PRESSURE] = 1e3 * point.value
        values[col.VOLUME] = symmetry_factor * point.conjugate
    else:
        values["value"] = point.value
    if point.control is not None:
        values[col.ANGLE] = float(np.rad2deg(point.control))
    return values


def remarks(report: Report) -> list[str]:
    """All lines on what happened so far."""
    lines = [remark(point) for point in report.critical if _matters(point)]
    if report.self_contact is not None:
        lines.append(self_contact(report.self_contact))
    return lines


def _matters(point: Critical) -> bool:
    """Limits, lost stability, and stability regained; not one unstable mode less of several."""
    return point.kind == "limit" or point.after > point.before or point.after == 0


def remark(point: Critical) -> str:
    """A line on a critical point."""
    where = _where(point)
    if point.kind == "limit" and point.after > point.before:
        return f"limit point at {where}: beyond it {_beyond(point)}"
    if point.kind == "limit":
        load = "vacuum" if _vacuum(point) else point.scalar
        return f"the {load} rises again from {where} on; given the {load}, the body snaps there"
    if point.after > point.before:
        count = _COUNT[point.after] if point.after < len(_COUNT) else str(point.after)
        plural = "" if point.after == 1 else "s"
        return (
            f"{count} unstable mode{plural} from {where} on: the body buckles: another "
            f"branch starts here; {_LEFT[point.side]}"
        )
    return f"stable again from {where} on"


def stopped(report: Report, target: str, beyond: float) -> str:
    """Why a march ended before its target.

    Args:
        report: of the march.
        target: what was asked for, with its unit.
        beyond: multiple of the volume at the limit point to which the path is followed.
    """
    limits = [p for p in report.critical if p.after > p.before]
    limit = max(limits, key=lambda p: abs(p.value))
    factor = f"1/{beyond:g} of" if _vacuum(limit) else f"{beyond:g} times"
    followed = f"followed to {factor} the volume there"
    if report.reason:
        followed = f"there the run ends: {report.reason}"
    return f"{target} is not reached: {remark(limit)}; {followed}"


def jumped(before: dict[str, Any], after: dict[str, Any]) -> str:
    """A line on a step that has left its branch, from the rows at its ends."""
    ends = f"{before[col.PRESSURE]:.4g} and {after[col.PRESSURE]:.4g} kPa"
    return (
        f"between {ends} the stored energy changes by what no load has done: the run may have "
        "gone to a neighbouring state there; shorter steps (solver.max_turn) may stay on one branch"
    )


def self_contact(measures: dict[str, float]) -> str:
    """A line on a body that begins to pass through itself."""
    pressure = measures.get("value pressure")
    at = "" if pressure is None else f" ({1e3 * pressure:.4g} kPa)"
    return (
        f"from {_degrees(measures['control'])}{at} on the body passes through itself: contact "
        "with itself is not modelled"
    )


def _vacuum(point: Critical) -> bool:
    return point.scalar == "pressure" and point.value < 0


def _beyond(point: Critical) -> str:
    if point.scalar != "pressure":
        return f"the {point.scalar} falls"
    if _vacuum(point):
        return "the chamber collapses at falling vacuum"
    return "the actuator balloons at falling pressure"


def _where(point: Critical) -> str:
    value = f"{1e3 * point.value:.4g} kPa" if point.scalar == "pressure" else f"{point.value:.4g}"
    if point.control is None:
        return value
    return f"{value}, {_degrees(point.control)}"


def _degrees(angle: float) -> str:
    # plus zero: no minus sign before what is rounded to nothing
    return f"{round(float(np.rad2deg(angle)), 1) + 0.0:.1f}°"
