"""Messages on limit points and lost stability, in the user's units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fem.march.records import Critical, Ramp, Report
from fiberbend import columns as col
from fiberbend.states.labels import short_number

UNSTABLE_END = (
    "the end is unstable where every load is kept at its value: given the pressure, no actuator "
    "rests there"
)
WRINKLE = (
    "; its waves span less than three elements, so that the mesh gives this load: under pressure a "
    "winding has no stiffness against bending (tension_only: true lets it go slack)"
)
WHOLE = (
    "the body buckles across its mirror plane, which half of it cannot: the whole body is solved "
    "(mesh.symmetry: auto)"
)
PUSHES = 0.05
"""Part of the greatest force of a fiber from which the push of another is no round-off."""
UNCOUNTED = (
    "half of the body on tetrahedra cannot tell whether the whole buckles across the mirror plane "
    "under a load that presses it: mesh.symmetry: full, or mesh.element: hexahedron, tells"
)
TURNED = 0.1
"""An angle that has come back by so much, in degrees, has had its greatest value."""
_SAME = 1e-9
"""Degrees up to which an angle is that where a load began."""
_LEFT = {
    "by the loads": "the run goes on along it, to the side that the loads or the mesh favour",
    "chosen": "the run goes on along it, to one of two sides that are alike",
    "not looked for": "a rod does not look for it and goes on along the old one",
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
            **({"wrinkle": True} if point.wrinkle else {}),
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


def left_to_mumps(why: str) -> str:
    """A line on a body that is factorised in layers no more.

    Args:
        why: of the solver.
    """
    return f"MUMPS goes on, with the same results but slower: {why}"


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
            f"branch starts here; {_LEFT[point.side]}{WRINKLE if point.wrinkle else ''}"
        )
    return f"stable again from {where} on"


def stopped(report: Report, ramp: Ramp, beyond: float) -> str:
    """Why a march ended before the target of a load.

    Args:
        report: of the march.
        ramp: the load.
        beyond: multiple of the volume at the limit point to which the path is followed.
    """
    limits = [p for p in report.critical if p.after > p.before]
    limit = max(limits, key=lambda p: abs(p.value))
    factor = f"1/{beyond:g} of" if _vacuum(limit) else f"{beyond:g} times"
    followed = f"followed to {factor} the volume there"
    if report.reason:
        followed = f"there the run ends: {report.reason}"
    return f"{amount(ramp.scalar, ramp.target)} is not reached: {remark(limit)}; {followed}"


def interrupted(rows: Sequence[col.Row], kept: int, solved: bool) -> str:
    """What a signal has left of a run.

    Args:
        rows: of the history so far.
        kept: the last step that is kept; 0: none.
        solved: all load steps are done, and what is missing are files made from them.
    """
    if solved:
        return (
            f"stopped after the last load step, {kept}: history.csv is whole; pictures, fields or "
            "report are missing, --resume makes them"
        )
    if kept:
        return f"stopped at step {kept}, kept; go on with --resume"
    step = rows[-1][col.STEP] if rows else 0
    return f"stopped at step {step}, nothing kept; --resume begins anew"


def interrupted_zones(kept: int, zones: int) -> str:
    """What a signal has left of a run over zones.

    Args:
        kept: zones from the root on that are solved and kept.
        zones: how many there are.
    """
    if not kept:
        return "stopped in zone 1, nothing kept; --resume begins anew"
    if kept < zones:
        return f"stopped in zone {kept + 1}, those before it kept; go on with --resume"
    return "stopped after the last zone, all kept; --resume chains them, and makes what is missing"


def pushed(report: Report, rows: Sequence[col.Row]) -> list[str]:
    """Why steps were cut where no mode was lost: threads that push are near to wrinkling."""
    pushes = [row for row in rows[1:] if (row.get(col.FIBER_MIN) or 0.0) < 0]
    least = min((row[col.FIBER_MIN] for row in pushes), default=0.0)
    most = max((row.get(col.FIBER_MAX) or 0.0 for row in rows[1:]), default=0.0)
    if not report.cutbacks or report.critical or -least <= PUSHES * most:
        return []
    return [
        f"steps were cut while lines of the winding push with up to {short_number(-least)} N: a "
        "thread that pushes has no stiffness against bending, and all but wrinkles in waves as "
        "short as the elements (tension_only: true lets it go slack)"
    ]


def uncounted(ramps: Sequence[Ramp], rows: Sequence[col.Row]) -> list[str]:
    """A warning of half a body that does not know its opposite modes, where it may lose one.

    Args:
        ramps: the loads; an inflation stretches a body, others may press it.
        rows: of the history.
    """
    presses = min(row[col.PRESSURE] for row in rows) < 0
    return [UNCOUNTED] if presses or any(ramp.scalar != "pressure" for ramp in ramps) else []


def missed(requests: Sequence[str]) -> str:
    """A warning of what a case asks for and its run has not met, with units."""
    return f"asked for and not reached: {', '.join(requests)}"


def course(rows: Sequence[col.Row]) -> str:
    """How far the loads have bent an actuator."""
    angles = [row[col.ANGLE] for row in rows]
    low, high, last = min(angles), max(angles), angles[-1]
    text = f"the loads end at {last + 0.0:.4g}°"
    if min(last - low, high - last) <= TURNED and min(abs(low), abs(high)) <= TURNED:
        return text
    return f"{text}, the angle between {low + 0.0:.4g} and {high:.4g}° meanwhile"


def passed_before(rows: Sequence[col.Row], stop: float | None, report: Report) -> str:
    """A remark on a stop that only loads pass which are put on whole; empty elsewhere.

    Args:
        rows: of the history.
        stop: the angle at which the run was to end, rad, or None.
        report: of the march.
    """
    if stop is None or report.ended_at is not None:
        return ""
    angles = [np.deg2rad(row[col.ANGLE]) for row in rows]
    if not min(angles) < stop < max(angles):
        return ""
    return (
        f" ({np.rad2deg(stop):.6g}° is passed by what is put on before the pressure: that is put "
        "on whole)"
    )


def angle_missed(
    rows: Sequence[col.Row], begin: float, target: float, failure: str
) -> tuple[bool, str]:
    """Whether an angle has a greatest value short of the one that is asked for, and the reason.

    Args:
        rows: of the history.
        begin: the angle where the load began that was to reach it, °.
        target: what was asked for, °.
        failure: why the march went no further; empty where it was no failure.
    """
    side = 1.0 if target >= begin else -1.0
    # what other loads have done before is not this one's
    first = next((n for n, row in enumerate(rows) if abs(row[col.ANGLE] - begin) <= _SAME), 0)
    rows = rows[first:]
    best = max(rows, key=lambda row: side * float(row[col.ANGLE]))
    last = rows[-1]
    turned = bool(side * (best[col.ANGLE] - last[col.ANGLE]) > TURNED)
    here = f"{last[col.ANGLE]:.4g}° at {last[col.PRESSURE]:.4g} kPa"
    text = f"{target:.6g}° is not reached: "
    if side * (best[col.ANGLE] - begin) > TURNED:
        most = "greatest" if side * best[col.ANGLE] > 0 else "least"
        text += f"the angle is {most} at {best[col.ANGLE]:.4g}°, {best[col.PRESSURE]:.4g} kPa"
        text += f", and goes back to {here}" if turned else ""
    elif turned:
        text += f"the pressure bends it the other way, from {begin + 0.0:.4g}° to {here}"
    elif len(rows) > 1:
        text += f"it stays at {here}"
    else:
        return False, text + failure
    if failure:
        text += f"; there the run ends: {failure}"
    return turned or not failure, text


def amount(scalar: str, value: float) -> str:
    """A value of a load, with its unit or its name."""
    if scalar == "pressure":
        return f"{1e3 * value:.6g} kPa"
    return f"{scalar} {value:.6g}"


def jumped(before: dict[str, Any], after: dict[str, Any]) -> str:
    """A line on a step that has left its branch, from the rows at its ends."""
    ends = f"{before[col.PRESSURE]:.4g} and {after[col.PRESSURE]:.4g} kPa"
    if before[col.PRESSURE] == after[col.PRESSURE]:
        # another load has grown
        ends = f"steps {before[col.STEP]} and {after[col.STEP]}"
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


def walls_passed(measures: dict[str, float]) -> str:
    """A line on a chamber whose walls have passed through each other."""
    where = _degrees(measures["control"])
    if "value pressure" in measures:
        where = f"{1e3 * measures['value pressure']:.4g} kPa, {where}"
    return (
        f"at {where} opposite walls of the chamber have passed through each other: contact with "
        "itself is not modelled, and from there on no actuator looks like this"
    )


def on_state(report: Report, walls: Mapping[str, float] | None, angle_deg: float) -> str:
    """What every picture of a state has to say; empty where there is nothing.

    Args:
        report: of the march so far.
        walls: measures where walls of the chamber have passed through each other; None: they have
            not.
        angle_deg: bending angle of the state, °.
    """
    if walls is not None:
        where = short_number(float(np.rad2deg(walls["control"])))
        return f"chamber walls pass through each other from {where}° on: not modelled"
    contact = report.self_contact
    if contact is None:
        return ""
    begin = float(np.rad2deg(contact["control"]))
    # a body that is bent back no longer passes through itself
    if begin * (angle_deg - begin) < -_SAME * abs(begin):
        return ""
    return f"passes through itself from {short_number(begin)}° on: not modelled"


def _vacuum(point: Critical) -> bool:
    return point.scalar == "pressure" and point.value < 0


def _beyond(point: Critical) -> str:
    if point.scalar != "pressure":
        return f"the {point.scalar} falls"
    if _vacuum(point):
        return "the chamber collapses at falling vacuum"
    return "the actuator balloons at falling pressure"


def _where(point: Critical) -> str:
    value = f"{point.scalar} {point.value:.4g}"
    if point.scalar == "pressure":
        value = f"{1e3 * point.value:.4g} kPa"
    if point.control is None:
        return value
    return f"{value}, {_degrees(point.control)}"


def _degrees(angle: float) -> str:
    # plus zero: no minus sign before what is rounded to nothing
    return f"{round(float(np.rad2deg(angle)), 1) + 0.0:.1f}°"
