"""The command `fiberbend sweep`: a case at many points, resumable, by one process or many."""

from __future__ import annotations

import dataclasses
import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fiberbend.plan.memory import needed_mb
from fiberbend.process import ranks
from fiberbend.process.signals import Interrupted, stop_of
from fiberbend.results.folder import ABOUT_SWEEP, REPORT, TABLE, TRENDS, RunFolder
from fiberbend.running import launch
from fiberbend.running.launch import FAILED
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sweep.crews.crew import Crew, Here
from fiberbend.sweep.crews.pool import Pool
from fiberbend.sweep.crews.ranks import Ranks
from fiberbend.sweep.loop import Event, Loop
from fiberbend.sweep.only import choose
from fiberbend.sweep.points import Sweep, read_sweep
from fiberbend.sweep.seen import hardly_seen
from fiberbend.sweep.store import NOT_RUN, Store

if TYPE_CHECKING:
    from fiberbend.sweep.quantities import ReportedQuantity, TableRow

_MOST_WARNINGS = 10
_NUMBER = re.compile(r"[-+−]?\d[\d.]*")
Say = Callable[[str], None]


def run_sweep(
    path: Path,
    out: Path,
    settings: Sequence[str] = (),
    jobs: int | None = None,
    retry: bool = False,
    force: bool = False,
    say: Say = print,
    only: Sequence[str] = (),
    dry: bool = False,
) -> int:
    """Solve the points of a sweep that are not finished, then write its table and pictures.

    Collective over all ranks where an MPI launcher has started several: rank 0 leads, each other
    one solves points.

    Args:
        path: the sweep file.
        out: folder of the sweep.
        settings: changes to the base case.
        jobs: processes that solve at once, one unless given; none may be given under mpirun.
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
    if ranks.launched() and jobs is not None:
        text = f"-j {jobs} under mpirun, expected either: all ranks but one solve points"
        raise CaseError([Problem("fiberbend sweep", text)])
    crew = _crew(jobs or 1)
    lead = crew.led(lambda: _Lead.begun(path, out, settings, only, retry, force, dry))
    if lead is not None and dry:
        lead.tell_plan(crew.count, say)
    if not dry and (who := crew.blind(Store(out).locks)):
        text = f"not seen by {who}, expected a folder that all machines share"
        raise CaseError([Problem(str(out), text)])
    if not force:
        _refuse_shortage(crew, [] if lead is None else lead.needs())
    if dry:
        return 0
    if lead is not None:
        lead.tell_begin(crew.count, say)
    stop = None
    try:
        with crew.at_work(0 if lead is None else lead.left) as submit:
            if lead is not None and submit is not None:
                printer = _EventPrinter(len(lead.part.points), lead.finished, say)
                Loop(lead.part.points, lead.store, printer, crew).run(submit)
    except KeyboardInterrupt as error:
        stop = stop_of(error)
    code = 0 if lead is None else lead.end(stop, crew.count, say)
    if stop is not None:
        # ranks that serve wait for more
        launch.leave(code)
        return code
    return crew.ended(code)


def _crew(jobs: int) -> Crew:
    if launch.size() > 1:
        return Ranks()
    return Pool(jobs) if jobs > 1 else Here()


@dataclasses.dataclass(frozen=True)
class _Lead:
    """A sweep as the process sees it that hands out its points.

    Attributes:
        sweep: all points.
        part: those to solve.
        store: their folder.
        finished: how many of them were finished before.
    """

    sweep: Sweep
    part: Sweep
    store: Store
    finished: int

    @property
    def left(self) -> int:
        """How many were not."""
        return len(self.part.points) - self.finished

    @classmethod
    def begun(
        cls,
        path: Path,
        out: Path,
        settings: Sequence[str],
        only: Sequence[str],
        retry: bool,
        force: bool,
        dry: bool,
    ) -> _Lead:
        """Read a sweep and open its folder, as of `run_sweep`."""
        sweep = read_sweep(path, settings)
        part = sweep.part(choose(sweep, only))
        store = Store.look(out, force) if dry else Store.open(out, force)
        for point in part.points if retry and not dry else ():
            store.forget(point)
        finished = sum(store.result(point) is not None for point in part.points)
        return cls(sweep, part, store, finished)

    def needs(self) -> list[float]:
        """Memory of what is left to solve, the largest first, MB."""
        left = [point for point in self.part.points if self.store.result(point) is None]
        return sorted((needed_mb(case) for point in left for case in point.cases), reverse=True)

    def tell_plan(self, jobs: int, say: Say) -> None:
        """Say what would be done."""
        from fiberbend.sweep import dry_run

        for line in dry_run.lines(self.part, self.store, jobs):
            say(line)
        self._tell_unseen(jobs, say)

    def tell_begin(self, jobs: int, say: Say) -> None:
        """Say what there is to do."""
        count = len(self.part.points)
        of_all = f" of {len(self.sweep.points)}" if count < len(self.sweep.points) else ""
        say(f"{count}{of_all} points, {self.finished} finished before")
        if self.finished < count:
            self._tell_unseen(jobs, say)

    def _tell_unseen(self, jobs: int, say: Say) -> None:
        for text in hardly_seen(self.part, jobs):
            say(f"warning: {text}")

    def end(self, stop: Interrupted | None, jobs: int, say: Say) -> int:
        """Say and write what has come of it; the exit code."""
        _tell(self.part, self.store, say)
        code = _summary(self.part, self.store, stop, say)
        doubts = hardly_seen(self.sweep, jobs)
        _write(self.sweep, self.store, say, pictures=stop is None, doubts=doubts)
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


def _refuse_shortage(crew: Crew, needs: Sequence[float]) -> None:
    """Refuse points of which so many at once would not fit into memory, were they the largest."""
    text = crew.shortage(needs)
    if text is not None:
        fewer = f" (or {crew.fewer})" if crew.fewer else ""
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
