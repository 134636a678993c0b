"""The whole body of a design: its cases, and their runs as readings."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fem.solver.problem import RefusedError
from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.quantities.seen import Reading, State
from fiberbend.design.solving.models import States, UnsolvedError
from fiberbend.effects.pressure import PressureEffect
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from fiberbend.schema.units import show
from geometry.mesh.errors import MeshError

MODEL = "body"
FREE, BENT, BLOCKED = "", "_by_angle", "_blocked"
"""Ends of the names of a body's cases: under pressure, bent to an angle, with its tip blocked."""
_OUTPUT = {"pictures": False, "fields": False, "report": False}
_SAME = 1e-6
_BESIDE = ("accuracy", "compare")
"""What a body of a design is not asked for."""
Run = Callable[[Case], RunResult]


def body_data(
    data: Mapping[str, Any],
    quantities: Sequence[Quantity[Any]],
    wanted: Sequence[State],
    model: str | None = MODEL,
) -> dict[str, dict[str, Any]]:
    """The cases of a body that has all states, as files have them, by the ends of their names.

    Args:
        data: the case as a file has it.
        quantities: of the design.
        wanted: their states.
        model: that solves them; None: the case's own.
    """
    kinds: dict[str, list[float]] = {"pressure": [], "angle": [], "straight": []}
    for kind, value in wanted:
        kinds[kind].append(value)
    found: dict[str, dict[str, Any]] = {}
    if pressures := kinds["pressure"]:
        end = max(pressures, key=abs)
        asked = {"at_pressures": [show(p, "pressure") for p in sorted(pressures, key=abs)]}
        found[FREE] = _data(data, {"to": show(end, "pressure")}, asked, model)
    if angles := kinds["angle"]:
        end = max(angles, key=abs)
        asked = {"at_angles": [show(a, "angle") for a in sorted(angles, key=abs)]}
        found[BENT] = _data(data, {"angle": show(end, "angle")}, asked, model)
    blocked = next((by for each in quantities if (by := each.blocked_by())), None)
    if blocked is not None:
        pressures = [s.value for q in quantities if q.blocked_by() for s in q.states()]
        asked = {"at_pressures": [show(p, "pressure") for p in sorted({*pressures})]}
        # no other model has ends
        load = {"to": show(max(pressures), "pressure")}
        found[BLOCKED] = _data(data, load, asked, MODEL, blocked)
    return found


def _data(
    data: Mapping[str, Any],
    load: Mapping[str, str],
    asked: Mapping[str, Any],
    model: str | None,
    blocked: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    name = PressureEffect.name
    effects = [{name: dict(load)} if name in entry else entry for entry in data["effects"]]
    if blocked is not None:
        effects.append(dict(blocked))
    left = {key: value for key, value in data.items() if key not in _BESIDE}
    solved_by = {} if model is None else {"model": model}
    return {**left, **solved_by, "effects": effects, "output": dict(asked)}


class Body:
    """The whole body.

    Args:
        run: solves a case, writing nothing.
        quantities: of the design.
    """

    def __init__(self, run: Run, quantities: Sequence[Quantity[Any]]) -> None:
        self._run, self._quantities = run, quantities

    def states(
        self, data: Mapping[str, Any], wanted: Sequence[State], zones: int
    ) -> tuple[States, list[str]]:
        """Readings of the states that a body has, and the warnings of its runs.

        Args:
            data: the case as a file has it.
            wanted: the states.
            zones: how many; 0 without zones.

        Raises:
            CaseError: there is no such body.
            UnsolvedError: a run ended before it had them.
        """
        found: dict[State, tuple[Reading, ...]] = {}
        warnings: list[str] = []
        posts = {s for each in self._quantities if each.blocked_by() for s in each.states()}
        keys = {
            FREE: ("pressure", col.PRESSURE, 1e3),
            BENT: ("angle", col.ANGLE, math.degrees(1)),
            BLOCKED: ("straight", col.PRESSURE, 1e3),
        }
        for end, given in body_data(data, self._quantities, wanted).items():
            try:
                result = self._run(parse_case(given | {"output": given["output"] | _OUTPUT}))
            except (MeshError, RefusedError) as error:
                raise UnsolvedError(f"{type(error).__name__}: {error}") from None
            warnings += result.run.get("warnings") or ()
            kind, column, factor = keys[end]
            goals = [state for state in wanted if state.kind == kind]
            for state in goals:
                row = _row(result.rows, column, factor * state.value)
                if row is None:
                    if end == BLOCKED and state not in posts:
                        # a moment kept straight, of which a body has none
                        continue
                    raise UnsolvedError(
                        result.reason or f"the body has no state at {state.value:g}"
                    )
                found[state] = _readings(row, result.rows[0], zones)
        return found, list(dict.fromkeys(warnings))


def _row(rows: Sequence[col.Row], column: str, goal: float) -> col.Row | None:
    slack = _SAME * max(1.0, abs(goal))
    return next(
        (row for row in rows if row.get(column) is not None and abs(row[column] - goal) <= slack),
        None,
    )


def _readings(row: col.Row, rest: col.Row, zones: int) -> tuple[Reading, ...]:
    """What is read of a body; sums of all zones stand in the first.

    It tells the stretch of its whole centre-line: every zone has that.
    """
    whole = Reading(
        pressure=1e-3 * row[col.PRESSURE],
        angle=math.radians(row[col.ANGLE]),
        stretch=row.get(col.AXIS_STRETCH) or 1.0,
        # a body has ends, where strain hangs on the mesh, and no one moment
        moment=math.nan,
        strain=math.nan,
        volume=row[col.VOLUME],
        rest=rest[col.VOLUME],
        work=row[col.WORK],
        force=row.get(col.TIP_FORCE) or 0.0,
        tip_y=row[col.TIP_Y],
        tip_z=row[col.TIP_Z],
    )
    if not zones:
        return (whole,)
    parts = [
        whole._replace(
            angle=math.radians(row[col.zone(number, "angle_deg")]),
            volume=whole.volume if number == 0 else 0.0,
            rest=whole.rest if number == 0 else 0.0,
            work=whole.work if number == 0 else 0.0,
        )
        for number in range(zones)
    ]
    return tuple(parts)
