"""The command `fiberbend sweep`: a case at many points, resumable, by one process or several."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fiberbend.plan.memory import needed_mb, room, shortage
from fiberbend.process.signals import Interrupted, stop_of
from fiberbend.results.folder import ABOUT_SWEEP, REPORT, TABLE, TRENDS, RunFolder
from fiberbend.running import launch
from fiberbend.running.launch import FAILED
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sweep.only import choose
from fiberbend.sweep.points import Sweep, read_sweep
from fiberbend.sweep.seen import hardly_seen
from fiberbend.sweep.store import NOT_RUN, Store
from fiberbend.sweep.workers import Event, WorkerPool, work

if TYPE_CHECKING:
    from fiberbend.sweep.quantities import ReportedQuantity, TableRow

_MOST_WARNINGS = 10
_NUMBER = re.compile(r"[-+−]?\d[\d.]*")
Say = Callable[[str], None]


def run_sweep(
    path: Path,
    out: Path,
    settings: Sequence[str] = (),
    jobs: int = 1,
    retry: bool = False,
    force: bool = False,
    say: Say = print,
    only: Sequence[str] = (),
    dry: bool = False,
) -> int:
    """Solve the points of a sweep that are not finished, then write its table and pictures.

    Args:
        path: the sweep file.
        out: folder of the sweep.
        settings: changes to the base case.
        jobs: processes that solve at once; one works in this process.
        retry: run failed points again.
        force: run whether there is enough memory or not.
        say: takes lines for the user.
        only: `FIELD=VALUE`, the points to solve; all by default. The others keep their rows.
        dry: say what would be done; nothing is solved or written.

    Returns:
        The exit code: 0, 2 if a point failed, that of the signal if stopped by one.

    Raises:
        CaseError: a file or a point is wrong, the folder cannot be used, or there is not enough
            memory; nothing has run.
    """
    if launch.size() > 1:
        raise CaseError(
            [Problem("fiberbend sweep", "under mpirun, expected -j for more processes")]
        )
    sweep = read_sweep(path, settings)
    part = sweep.part(choose(sweep, only))
    if dry:
        return _dry_run(part, Store.look(out, force), jobs, say)
    store = Store.open(out, force)
    if retry:
        for point in part.points:
            store.forget(point)
    if not force:
        _refuse_shortage(part, store, jobs)
    before = sum(store.result(point) is not None for point in part.points)
    of_all = f" of {len(sweep.points)}" if len(part.points) < len(sweep.points) else ""
    say(f"{len(part.points)}{of_all} points, {before} finished before")
    for text in hardly_seen(part, jobs) if before < len(part.points) else ():
        say(f"warning: {text}")
    stop = None
    try:
        _solve(part, store, jobs, _EventPrinter(len(part.points), before, say))
    except KeyboardInterrupt as error:
        stop = stop_of(error)
    _tell(part, store, say)
    code = _summary(part, store, stop, say)
    _write(sweep, store, say, pictures=stop is None, doubts=hardly_seen(sweep, jobs))
    return code


class _EventPrinter:
    """Prints what happens, a line a point."""

    def __init__(self, count: int, finished: int, say: Say) -> None:
        self._count, self._finished, self._say = count, finished, say

    def __call__(self, event: Event) -> None:
        if "done" in event:
            self._finished += 1
            reason = f": {event['reason']}" if event["reason"] else ""
            self._say(
                f"[{self._finished:3d}/{self._count}] {event['done']}  {event['status']}"
                f"  {event['wall_s']:.2f} s{reason}"
            )
        elif "wait" in event:
            self._say(f"another process is solving {', '.join(event['wait'])}; waiting")
        elif "died" in event:
            self._say(f"a worker died in {event['died']} (code {event['code']})")


def _dry_run(sweep: Sweep, store: Store, jobs: int, say: Say) -> int:
    """Say what would be done.

    Raises:
        CaseError: the points would be refused, as too little memory is free.
    """
    from fiberbend.sweep import dry_run

    for line in dry_run.lines(sweep, store, jobs):
        say(line)
    for text in hardly_seen(sweep, jobs):
        say(f"warning: {text}")
    if not store.force:
        _refuse_shortage(sweep, store, jobs)
    return 0


def _solve(sweep: Sweep, store: Store, jobs: int, on_event: _EventPrinter) -> None:
    left = sum(store.result(point) is None for point in sweep.points)
    if min(jobs, left) < 2:
        launch.start_mpi()
        work(sweep.points, store, on_event)
        return

    WorkerPool(sweep.points, store, on_event, min(jobs, left)).run()


def _refuse_shortage(sweep: Sweep, store: Store, jobs: int) -> None:
    """Refuse points of which so many at once would not fit into memory, were they the largest."""
    left = [point for point in sweep.points if store.result(point) is None]
    cases = [case for point in left for case in point.cases]
    largest = sorted((needed_mb(case) for case in cases), reverse=True)[: max(jobs, 1)]
    text = shortage(largest, room(), "the sweep")
    if text is not None:
        fewer = " (or fewer -j)" if len(largest) > 1 else ""
        raise CaseError([Problem("memory", f"{text}{fewer}")])


def _summary(sweep: Sweep, store: Store, stop: Interrupted | None, say: Say) -> int:
    runs = {point.name: store.result(point) for point in sweep.points}
    counts = Counter(NOT_RUN if run is None else run["status"] for run in runs.values())
    say(f"{len(runs)} points: " + ", ".join(f"{n} {status}" for status, n in counts.items()))
    for name, run in runs.items():
        if run is not None and run["status"] == "failed":
            say(f"failed: {name}: {run['reason']}")
    _say_warnings([run for run in runs.values() if run is not None], say)
    if stop is not None:
        say("interrupted; the same command goes on where it was")
        return stop.code
    return FAILED if counts["failed"] or counts[NOT_RUN] else 0


def _say_warnings(runs: Sequence[Event], say: Say) -> None:
    """What is doubtful of how many points; all of it stands in their run.json."""
    alike: dict[str, list[str]] = {}
    for run in runs:
        for text in dict.fromkeys(run.get("warnings", ())):
            # points warn of the same with other figures
            alike.setdefault(_NUMBER.sub("#", text), []).append(text)
    for texts in sorted(alike.values(), key=len, reverse=True)[:_MOST_WARNINGS]:
        such = ", such as" if len(set(texts)) > 1 else ""
        say(f"warning, {len(texts)} of {len(runs)} points{such}: {texts[0]}")
    if len(alike) > _MOST_WARNINGS:
        say(f"{len(alike) - _MOST_WARNINGS} more warnings in run.json of the points")


# --- table and pictures ------------------------------------------------------------------------


def _tell(sweep: Sweep, store: Store, say: Say) -> None:
    """What was asked for, of the points that were to be solved."""
    from fiberbend.sweep.quantities import quantities
    from fiberbend.sweep.table import collect, in_brief

    rows = collect(sweep, store)
    if any(row["status"] == NOT_RUN for row in rows):
        rows = [row for row in rows if row["status"] != NOT_RUN]
    for line in in_brief(sweep.columns, rows, quantities(sweep.report, rows)):
        say(line)


def _write(
    sweep: Sweep, store: Store, say: Say, pictures: bool, doubts: Sequence[str] = ()
) -> None:
    from fiberbend.sweep.quantities import quantities
    from fiberbend.sweep.table import as_csv, as_json, collect
    from fiberbend.sweep.trends import as_markdown

    rows, folder = collect(sweep, store), RunFolder(store.path)
    reported = quantities(sweep.report, rows)
    folder.write_text(TABLE, as_csv(rows))
    notes = as_markdown(sweep.title, sweep.columns, rows, reported, doubts)
    folder.write_text(TRENDS, notes)
    for index, name in enumerate(sweep.report.history):
        if all(row.get(name) is None for row in rows):
            say(f"report.history.{index}: no point has a column {name}")
    say(f"table: {store.path / TABLE}")
    say(f"trends: {store.path / TRENDS}")
    drawn: dict[str, list[str]] = {}
    if pictures:
        drawn = _draw(sweep, rows, reported, folder)
        if drawn:
            say(f"maps: {store.path / 'maps'}")
    about = as_json(sweep.title, sweep.columns, rows, reported, drawn, doubts)
    folder.write_text(ABOUT_SWEEP, about)

    from fiberbend.report.sweep_page import write_sweep_report
    from fiberbend.running.outputs import page

    with page(say):
        write_sweep_report(folder, sweep.title)
        say(f"report: {store.path / REPORT}")


def _draw(
    sweep: Sweep,
    rows: Sequence[TableRow],
    reported: Sequence[ReportedQuantity],
    folder: RunFolder,
) -> dict[str, list[str]]:
    """Maps and curves of the quantities that the sweep wants drawn: file names of each."""
    from fiberbend.drawing.page import own_style
    from fiberbend.sweep.plots import draw

    wanted = [quantity for quantity in reported if quantity.kind in sweep.report.maps]
    with own_style():
        return draw(
            sweep.title,
            sweep.columns,
            rows,
            wanted,
            lambda name, fill: folder.write(f"maps/{name}", fill),
        )
