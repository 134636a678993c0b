"""What a case asks for: pressures at angles, motions at pressures, forces of what is held."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from fiberbend import columns as col
from fiberbend.answer.motion import BEND, Reading, told_by
from fiberbend.answer.numbers import quantity
from fiberbend.case.case import Case
from fiberbend.models.model import ModelKind

Told = tuple[str, str, str]
"""What is answered, the answer with its unit, and a note that may be empty."""

_SAME = 1e-6
"""Part of an asked angle or pressure by which a row may miss it."""
HELD = {
    col.AXIS_STRETCH: Reading((col.AXIAL_FORCE,), "axial force", "N"),
    col.ANGLE: Reading((col.MOMENT_X,), "bending moment", "N mm"),
    col.SIDE_ANGLE: Reading((col.MOMENT_Y,), "side moment", "N mm"),
    col.TWIST: Reading((col.TORQUE,), "torque", "N mm"),
}
"""What an actuator exerts on what holds a motion of it, by the motion's column."""
_PRESSURE = Reading((col.PRESSURE,), "pressure", "kPa")
_TIP_FORCE = Reading((col.TIP_FORCE,), "tip force", "N")
_AT_END = (
    Reading((col.ROOF_FORCE,), "force of the roof", "N"),
    Reading((col.AXIAL_FORCE,), "axial force", "N"),
    Reading((col.MOMENT,), "bending moment", "N mm"),
)
"""What is told of the end of a run whose tip is blocked."""


def asked(case: Case, model: ModelKind, rows: Sequence[col.Row]) -> Iterator[Told]:
    """What a case asks for, and what holds the actuator at the end.

    Args:
        case: the case.
        model: the one that has solved it.
        rows: of the history, the first at rest.

    Yields:
        What it is, the answer, and a note.
    """
    if case.straight:
        yield from _forces(case, model, rows)
        return
    held = {key: text for effect in case.acting for key, text in effect.held().items()}
    yield from _motions(case, rows, held)
    for motion, text in held.items():
        force = HELD[motion].told(rows[-1])
        if force:
            yield HELD[motion].name, force, f"at the end, on what holds {text}"


def _at(rows: Sequence[col.Row], key: Reading, goal: float, wanted: Reading) -> Told:
    """What is wanted where something has an asked value, at every load step that has it.

    Args:
        rows: of the history.
        key: what is asked at.
        goal: its value.
        wanted: what answers.
    """
    (column,) = key.columns
    label = f"{wanted.name} at {quantity(goal, key.unit)}"
    slack = _SAME * max(1.0, abs(goal))
    there = [row for row in rows[1:] if abs(row[column] - goal) <= slack]
    found = list(filter(None, map(wanted.told, there)))
    if not found:
        return label, "not reached", ""
    first, *again = found
    return label, first, f"and again {', '.join(again)}" if again else ""


def _motions(case: Case, rows: Sequence[col.Row], held: Mapping[str, str]) -> Iterator[Told]:
    """Pressures at the asked angles; at the asked pressures how far it moves, and what holds it."""
    if case.inflation is None:
        return
    for angle in dict.fromkeys(case.output.at_angles):
        yield _at(rows, BEND, math.degrees(angle), _PRESSURE)
    told = [*told_by(rows, held), *(HELD[motion] for motion in held)]
    for pressure in dict.fromkeys(case.output.at_pressures):
        yield from (_at(rows, _PRESSURE, 1e3 * pressure, wanted) for wanted in told)


def _forces(case: Case, model: ModelKind, rows: Sequence[col.Row]) -> Iterator[Told]:
    """Tip forces at the asked pressures and at the end, named for what they are."""
    asked_at, last = dict.fromkeys(case.output.at_pressures), rows[-1]
    yield from (_at(rows, _PRESSURE, 1e3 * pressure, _TIP_FORCE) for pressure in asked_at)
    if not _TIP_FORCE.told(last):
        return
    if not asked_at:
        yield f"tip force at {_PRESSURE.told(last)}", _TIP_FORCE.told(last), ""
    yield "this force is", _force_name(case, model), ""
    for force in _AT_END:
        if force.told(last):
            yield force.name, force.told(last), "at the end"


def _force_name(case: Case, model: ModelKind) -> str:
    """What the tip force of a model is."""
    if model.ends:
        return "that of the body's tip on the post"
    from fiberbend.models.closed_form import lever_arm

    lever = quantity(lever_arm(case), "mm")
    if model.elements() is None:
        return f"κP/L_f, of a closed form whose section keeps its shape; L_f = {lever}"
    return f"M/L_f, of a {model.name} kept straight all along, without caps; L_f = {lever}"
