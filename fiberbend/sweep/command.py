"""The command `fiberbend sweep`: a case at many points, resumable, by one process or several."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from fiberbend.plan.memory import needed_mb, room, shortage
from fiberbend.process.signals import Interrupted, stop_of
from fiberbend.results.folder import REPORT, RunFolder
from fiberbend.running import launch
from fiberbend.running.launch import FAILED
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sweep.points import Sweep, read_sweep
from fiberbend.sweep.store import Store
from fiberbend.sweep.workers import Event, WorkerPool, work

_MOST_WARNINGS = 10
Say = Callable[[str], None]


def run_sweep(
    path: Path,
    out: Path,
    settings: Sequence[str] = (),
    jobs: int = 1,
    retry: bool = False,
    force: bool = False,
    say: Say = print,
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
    store = Store.open(out, force)
    if retry:
        for point in sweep.points:
            store.forget(point)
    if not force:
        _refuse_shortage(sweep, store, jobs)
    before = sum(store.result(point) is not None for point in sweep.points)
    say(f"{len(sweep.points)} points, {before} finished before")
    stop = None
    try:
        _solve(sweep, store, jobs, _EventPrinter(len(sweep.points), before, say))
    except KeyboardInterrupt as error:
        stop = stop_of(error)
    _write(sweep, store, say, pictures=stop is None)
    return _summary(sweep, store, stop, say)


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
    cases = [case for point in left for case in (point.case, point.blocked) if case is not None]
    largest = sorted((needed_mb(case) for case in cases), reverse=True)[: max(jobs, 1)]
    text = shortage(largest, room(), "the sweep")
    if text is not None:
        fewer = " (or fewer -j)" if len(largest) > 1 else ""
        raise CaseError([Problem("memory", f"{text}{fewer}")])


def _summary(sweep: Sweep, store: Store, stop: Interrupted | None, say: Say) -> int:
    runs = {point.name: store.result(point) for point in sweep.points}
    counts = Counter("not run" if run is None else run["status"] for run in runs.values())
    say(f"{len(runs)} points: " + ", ".join(f"{n} {status}" for status, n in counts.items()))
    for name, run in runs.items():
        if run is not None and run["status"] == "failed":
            say(f"failed: {name}: {run['reason']}")
    _say_warnings([run for run in runs.values() if run is not None], say)
    if stop is not None:
        say("interrupted; the same command goes on where it was")
        return stop.code
    return FAILED if counts["failed"] or counts["not run"] else 0


def _say_warnings(runs: Sequence[Event], say: Say) -> None:
    """What is doubtful of how many points; all of it stands in their run.json."""
    counts = Counter(text for run in runs for text in run.get("warnings", ()))
    for text, number in counts.most_common(_MOST_WARNINGS):
        say(f"warning, {number} of {len(runs)} points: {text}")
    if len(counts) > _MOST_WARNINGS:
        say(f"{len(counts) - _MOST_WARNINGS} more warnings in run.json of the points")


# --- table and pictures ------------------------------------------------------------------------


def _write(sweep: Sweep, store: Store, say: Say, pictures: bool) -> None:
    from fiberbend.sweep.table import as_csv, collect, quantities
    from fiberbend.sweep.trends import as_markdown

    rows, folder = collect(sweep, store), RunFolder(store.path)
    reported = quantities(sweep.report, rows)
    folder.write_text("sweep.csv", as_csv(rows))
    folder.write_text("trends.md", as_markdown(sweep.columns, rows, reported))
    for index, name in enumerate(sweep.report.history):
        if all(row.get(name) is None for row in rows):
            say(f"report.history.{index}: no point has a column {name}")
    say(f"table in {store.path / 'sweep.csv'}")
    if pictures:
        from fiberbend.drawing.page import own_style
        from fiberbend.sweep.plots import draw

        drawn = [quantity for quantity in reported if quantity.kind in sweep.report.maps]
        with own_style():
            names = draw(
                sweep.title,
                sweep.columns,
                rows,
                drawn,
                lambda name, fill: folder.write(f"maps/{name}", fill),
            )
        if names:
            say(f"maps in {store.path / 'maps'}")
    from fiberbend.report.sweep_page import write_sweep_report
    from fiberbend.running.outputs import page

    with page(say):
        write_sweep_report(folder, sweep.title)
        say(f"report: {store.path / REPORT}")
