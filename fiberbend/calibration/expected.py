"""What is known of a calibration before a run, which solves no cell: for a plan."""

from __future__ import annotations

from collections.abc import Iterator

from fiberbend.calibration import cases, reach, ways
from fiberbend.calibration.calibrate import known, waits
from fiberbend.calibration.record import words
from fiberbend.case.case import Case
from fiberbend.models.choice import meshed

_STEPS = (5, 2)
"""Load steps of a cell, bent and kept straight."""
_FIT_S = 1.0
"""Seconds for sections and fit."""


def expected(case: Case) -> Iterator[str]:
    """How the winding of a case gets its numbers, what that costs and how good they are.

    Yields:
        Sentences; none where no winding is calibrated.
    """
    for effect in case.effects:
        numbers = effect.bulges()
        if numbers is not None:
            yield f"spread, bulging as the case says ({words(numbers)})"
    if not waits(case):
        return
    if ways.of_families(case) and (reason := ways.objection(case)):
        yield f"NOT to be calibrated: {reason}"
        return
    kept = known(case)
    if kept is not None:
        yield f"calibrated before ({words(kept.found.bulging())}; left {kept.left_percent:.2f} %)"
        yield from kept.remarks
        return
    yield (
        f"to be calibrated by the cell of this section before the run, about {seconds(case):.0f} "
        "s, and kept"
    )


def seconds(case: Case) -> float:
    """Seconds to calibrate a case whose winding waits for its numbers, kernels compiled."""
    if ways.of_families(case):
        cell = ways.small(case, "cell")
        model = meshed(cell)
        return _FIT_S + len(ways.PARTS) * model.step_seconds(cell, model.size(cell))
    cell = cases.bent_cell(case, reach.first(case))
    model = meshed(cell)
    steps = _STEPS[0] if case.turns is not None and case.turns.twists else sum(_STEPS)
    return _FIT_S + steps * model.step_seconds(cell, model.size(cell))
