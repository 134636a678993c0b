"""What a sweep would do, before anything is solved: its points with their time and memory."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from fiberbend.case.case import Case
from fiberbend.models.choice import choose_model
from fiberbend.models.costs.price import machine
from fiberbend.plan.estimate import cold, drawing_seconds, steps_of, steps_of_rod
from fiberbend.plan.memory import gigabytes, needed_mb, room
from fiberbend.schema.units import show
from fiberbend.slender.kept import laws_to_make
from fiberbend.sweep.fields import shown
from fiberbend.sweep.points import Point, Sweep
from fiberbend.sweep.store import MARK, Store
from fiberbend.sweep.table import aligned

IMPORTS_S = 0.6
"""Seconds of a model's start that a process spends once, on imports."""
_CLOSED_FORM_S = 0.05
_ROD_S = 0.3
"""Beside its steps, where the law of its section is kept."""


def lines(sweep: Sweep, store: Store, jobs: int) -> Iterator[str]:
    """What a sweep would do, as lines of text.

    Args:
        sweep: the points that would run.
        store: its folder, which is only read.
        jobs: processes that would solve at once.
    """
    rows = [[*(column.heading for column in sweep.columns), "model", "time", "memory", ""]]
    left = []
    for index, point in enumerate(sweep.points):
        run = store.result(point)
        values = [shown(column.values[index]) for column in sweep.columns]
        model = choose_model(point.case)[0].name
        if run is None:
            left.append(point)
            needs = [_time(seconds(point.cases)), gigabytes(_memory(point)), ""]
        else:
            needs = ["", "", f"{run['status']} before, in {run[MARK]['wall_s']:.3g} s"]
        rows.append([*values, model, *needs])
    yield from aligned(rows)
    if any(point.blocked is not None for point in left):
        assert sweep.report.force_at is not None
        at = show(sweep.report.force_at, "pressure")
        yield f"each point is solved again, kept straight under {at}: the time is that of both"
    yield from _total(left, len(sweep.points), jobs)
    yield "nothing was solved or written"


def seconds(cases: Sequence[Case]) -> float | None:
    """Seconds to solve cases in a process that has solved others; None where steps are not known.

    Args:
        cases: those of one point.
    """
    parts = [_seconds(case) for case in cases]
    return None if None in parts else math.fsum(part for part in parts if part is not None)


def together(times: Sequence[float], jobs: int) -> float:
    """Seconds of points that some processes share, imports counted.

    Args:
        times: seconds of each point.
        jobs: how many processes.
    """
    if not times:
        return 0.0
    return IMPORTS_S + max(math.fsum(times) / min(jobs, len(times)), *times, 0.0)


def in_words(time: float) -> str:
    """A time that is good to a factor of two, "about 25 s", "about 3 h"."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if time >= 2 * size:
            return f"about {_two_digits(time / size)} {unit}"
    return f"about {_two_digits(time)} s"


def _seconds(case: Case) -> float | None:
    model = choose_model(case)[0]
    elements = model.elements()
    drawing = drawing_seconds(case, model)
    rod = model.slender()
    if rod is not None:
        steps = steps_of_rod(case, rod)
        return None if steps is None else _ROD_S + steps * rod.step_s + drawing
    if elements is None:
        return _CLOSED_FORM_S + drawing
    steps = steps_of(case, elements)
    if steps is None:
        return None
    size = elements.size(case)
    step = elements.step_seconds(case, size)
    return max(elements.start_seconds(size) - IMPORTS_S, 0.0) + steps * step + drawing


def _memory(point: Point) -> float:
    return max(needed_mb(case) for case in point.cases)


def _time(time: float | None) -> str:
    return "not known" if time is None else in_words(time)


def _two_digits(value: float) -> str:
    if value >= 10:
        digits = 1 - math.floor(math.log10(value))
        return f"{round(value, digits):.0f}"
    return f"{value:.2g}"


def _total(left: Sequence[Point], number: int, jobs: int) -> Iterator[str]:
    """How many points, how long, and how much memory they need at once."""
    noun = "point" if number == 1 else "points"
    yield f"{number} {noun}: {number - len(left)} finished before, {len(left)} to solve"
    if not left:
        return
    jobs = min(jobs, len(left))
    times = [seconds(point.cases) for point in left]
    known = [time for time in times if time is not None]
    share = f"{jobs} at once" if jobs > 1 else "one after the other"
    if known:
        least = "at least " if len(known) < len(times) else ""
        time = in_words(together(known, jobs))
        yield f"time: {least}{time}, {share}; on {machine()}, an estimate"
    if len(known) < len(times):
        number = len(times) - len(known)
        yield f"time: of {number} points it is not known, as their load steps are not"
    kinds = (choose_model(point.case)[0].elements() for point in left)
    compiled = max((model.compile_s for model in kinds if model is not None), default=0.0)
    if compiled and cold():
        yield f"about {compiled:g} s more, as nothing is compiled yet"
    number, law_s = laws_to_make(case for point in left for case in point.cases)
    if number:
        noun = "a law of a section is" if number == 1 else f"{number} laws of sections are"
        yield f"{in_words(law_s / jobs)} more, as {noun} not kept yet"
    memory = math.fsum(sorted(map(_memory, left), reverse=True)[:jobs])
    free = room()
    beside = "" if free is None else f"; {gigabytes(free.mb)} are free {free.source}"
    yield f"memory: about {gigabytes(memory)}, {share}{beside}"
