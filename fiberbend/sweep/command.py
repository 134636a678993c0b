"""The command `fiberbend sweep`: a case at many points, resumable, by one process or several."""

from __future__ import annotations

import signal
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from types import FrameType

from fiberbend.running import launch
from fiberbend.running.folder import RunFolder
from fiberbend.running.launch import FAILED
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sweep.points import Sweep, read_sweep
from fiberbend.sweep.store import Store
from fiberbend.sweep.workers import Event, WorkerPool, work

INTERRUPTED = 130
Say = Callable[[str], None]


def run_sweep(
    path: Path,
    out: Path,
    settings: Sequence[str] = (),
    jobs: int = 1,
    retry: bool = False,
    say: Say = print,
) -> int:
    """Solve the points of a sweep that are not finished, then write its table and pictures.

    Args:
        path: the sweep file.
        out: folder of the sweep.
        settings: changes to the base case.
        jobs: processes that solve at once; one works in this process.
        retry: run failed points again.
        say: takes lines for the user.

    Returns:
        The exit code: 0, 2 if a point failed, 130 if interrupted.

    Raises:
        CaseError: a file or a point is wrong, or the folder cannot be used; nothing has run.
    """
    if launch.size() > 1:
        raise CaseError(
            [Problem("fiberbend sweep", "under mpirun, expected -j for more processes")]
        )
    sweep = read_sweep(path, settings)
    store = Store.open(out)
    if retry:
        for point in sweep.points:
            store.forget(point)
    before = sum(store.result(point) is not None for point in sweep.points)
    say(f"{len(sweep.points)} points, {before} finished before")
    interrupted = False
    try:
        _solve(sweep, store, jobs, _EventPrinter(len(sweep.points), before, say))
    except KeyboardInterrupt:
        interrupted = True
    _write(sweep, store, say, pictures=not interrupted)
    return _summary(sweep, store, interrupted, say)


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

    def stop(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    previous = {number: signal.signal(number, stop) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        WorkerPool(sweep.points, store, on_event, min(jobs, left)).run()
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)


def _summary(sweep: Sweep, store: Store, interrupted: bool, say: Say) -> int:
    runs = {point.name: store.result(point) for point in sweep.points}
    counts = Counter("not run" if run is None else run["status"] for run in runs.values())
    say(f"{len(runs)} points: " + ", ".join(f"{n} {status}" for status, n in counts.items()))
    for name, run in runs.items():
        if run is not None and run["status"] == "failed":
            say(f"failed: {name}: {run['reason']}")
    if interrupted:
        say("interrupted; the same command goes on where it was")
        return INTERRUPTED
    return FAILED if counts["failed"] or counts["not run"] else 0


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
