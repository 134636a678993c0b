"""The command `fiberbend design`: from what is wanted to a case, confirmed, in a folder."""

from __future__ import annotations

import dataclasses
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fiberbend.design.reading import Design, read_design
from fiberbend.process.signals import Interrupted, stop_of
from fiberbend.results.folder import DESIGN, REPORT, RunFolder
from fiberbend.results.held import held
from fiberbend.running import launch
from fiberbend.schema.problems import CaseError, Problem

if TYPE_CHECKING:
    from fiberbend.design.search.confirm import Confirmed
    from fiberbend.design.search.front import Front
    from fiberbend.design.search.search import Found
    from fiberbend.design.search.wishes import Correction
    from fiberbend.design.told.outcome import Outcome, Times
    from fiberbend.design.told.sensitivity import Row

Say = Callable[[str], None]


@dataclasses.dataclass(frozen=True)
class Options:
    """How a design is made.

    Attributes:
        overwrite: replace an earlier design in the folder.
        quiet: no progress; the answer alone.
        force: solve bodies whether there is enough memory or not.
    """

    overwrite: bool = False
    quiet: bool = False
    force: bool = False


def run_design(
    path: Path,
    out: Path,
    changes: Sequence[str] = (),
    options: Options | None = None,
    say: Say = print,
) -> int:
    """Search a case, confirm it, and write its folder.

    Args:
        path: the design file.
        out: the folder.
        changes: changes to the base case.
        options: how it is made.
        say: takes lines for the user.

    Returns:
        The exit code: 0 with an answer, also one that says which limit stops it; 2 where no case
        has one, or where a finer model does not confirm it; that of a signal.

    Raises:
        CaseError: file, changes or folder are wrong; nothing has been solved.
    """
    options = options or Options()
    if launch.size() > 1:
        text = "under mpirun, expected one process: sections are too small to share"
        raise CaseError([Problem("fiberbend design", text)])
    design = read_design(path, changes)
    with held(out, DESIGN, "design", options.overwrite) as folder:
        launch.start_mpi()
        return _Made(design, folder, options, say).go()


class _Made:
    """A design that is being made, and what is known of it when it is interrupted."""

    def __init__(self, design: Design, folder: RunFolder, options: Options, say: Say) -> None:
        from fiberbend.design.search.search import Search
        from fiberbend.design.search.wishes import Correction
        from fiberbend.design.solving.models import Section
        from fiberbend.design.solving.tries import Tries

        self._design, self._folder, self._options, self._say = design, folder, options, say
        self._tell: Say = (lambda _line: None) if options.quiet else say
        self._tries = Tries(design, Section(design.search.mesh))
        self._search = Search(design, self._tries, self._tell)
        self._none = tuple(Correction() for _ in design.quantities)

    def go(self) -> int:
        """Search, confirm, write, and print; the exit code."""
        from fiberbend.design.search.confirm import Confirmed
        from fiberbend.design.told.doubt import doubt
        from fiberbend.design.told.outcome import FAILED, UNCONFIRMED, Times, outcome
        from fiberbend.design.told.sensitivity import finest, sensitivities

        stop: Interrupted | None = None
        done: Confirmed | None = None
        front: Front | None = None
        table: list[Row] = []
        why = ""
        times = Times()
        begun = time.process_time()
        try:
            found, front = self._find(self._none)
            times = Times(search=time.process_time() - begun)
            if found is not None:
                done = Confirmed(found, self._none)
                done, front, times = self._confirmed(done, front, times)
                self._tell("how every quantity changes with every dimension")
                near = finest(self._design, done)
                table, why = sensitivities(self._design, near), doubt(done, near)
        except KeyboardInterrupt as error:
            stop = stop_of(error)
            times = times if done else Times(search=time.process_time() - begun)
            if done is None and self._search.best is not None:
                done = Confirmed(self._search.best, self._none)
        stopped = stop is not None
        made = outcome(self._design, self._tries, done, table, front, times, stopped, why)
        self._write(made, pictures=stop is None)
        if stop is not None:
            return stop.code
        return launch.FAILED if made.status in (FAILED, UNCONFIRMED) else 0

    def _find(self, corrections: Sequence[Correction]) -> tuple[Found | None, Front | None]:
        """The best case, and the trade-off where there are two goals."""
        from fiberbend.design.search.front import Front, trade_off

        count = len(self._design.goals)
        if count < 2:
            return self._search.whole(corrections, 0 if count else None), None
        found = trade_off(self._search, corrections, self._tell)
        if isinstance(found, Front):
            return found.found[found.knee], found
        return found, None

    def _confirmed(
        self, done: Confirmed, front: Front | None, times: Times
    ) -> tuple[Confirmed, Front | None, Times]:
        """An answer that cell and body agree with; a trade-off once more with what they say."""
        from fiberbend.design.search.confirm import Confirmer
        from fiberbend.design.solving.body import Body
        from fiberbend.running.runner import run_case

        force = self._options.force
        body = Body(lambda case: run_case(case, None, force=force), self._design.quantities)
        confirmer = Confirmer(self._design, self._search, body, self._tell)
        done = confirmer.confirm(done)
        found_again = 0.0
        if front is not None and done.checks:
            begun = time.process_time()
            found, again = self._find(done.corrections)
            found_again = time.process_time() - begun
            if again is not None and found is not None:
                front = again
                done = confirmer.confirm(dataclasses.replace(done, found=found))
        times = dataclasses.replace(times, corrected=done.searched_cpu_s + found_again)
        spent = sum(check.cpu_s for check in done.checks)
        return done, front, dataclasses.replace(times, confirmed=spent)

    def _write(self, made: Outcome, pictures: bool) -> None:
        from fiberbend.answer.answer import lines
        from fiberbend.design.told.outcome import FAILED, MET, answer
        from fiberbend.design.told.picture import draw
        from fiberbend.design.told.record import write
        from fiberbend.report.design_page import write_design_page
        from fiberbend.running.outputs import page

        cases = write(self._folder, made)
        if pictures and made.status != FAILED:
            launch.settle_folders()
            with page(self._say):
                draw(self._folder, made)
        with page(self._say):
            write_design_page(self._folder.path)
        for line in lines(answer(made)):
            self._say(line)
        if made.status != MET:
            launch.say(f"{made.status}: {made.reason}", sys.stderr)
        path = self._folder.path
        for name in cases:
            self._say(f"case in {path / name}")
        self._say(f"results in {path}")
        if (path / REPORT).exists():
            self._say(f"report in {path / REPORT}")
