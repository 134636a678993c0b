"""Progress of a run: a bar on a terminal and in a notebook, plain lines elsewhere."""

from __future__ import annotations

import contextlib
import datetime
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, TextIO

from fiberbend.notebook import place
from fiberbend.running import launch

if TYPE_CHECKING:
    from rich.progress import Progress as RichProgress

    from fiberbend.answer.answer import Answer


class Progress:
    """Reports of a run. Silent when quiet, and on every rank but 0; its log has everything.

    Attributes:
        wall_s: seconds spent in each phase so far, by its name.
    """

    def __init__(
        self,
        quiet: bool = False,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
        verbose: bool = False,
        answers: bool = False,
    ) -> None:
        """Start the clock.

        Args:
            quiet: print nothing.
            stream: where to write, the standard output by default.
            clock: seconds; another one for tests.
            verbose: print phases, cut-backs, counts and comparisons too.
            answers: print the answer also when quiet.
        """
        self.wall_s: dict[str, float] = {}
        self._stream = stream or sys.stdout
        self._clock = clock
        self._begin = self._phase_begin = clock()
        self._phase = ""
        self._speaks = not quiet and launch.rank() == 0
        self._answers = self._speaks or (answers and launch.rank() == 0)
        self._verbose = verbose
        self._bar: RichProgress | None = None
        self._place = place.Place() if stream is None and place.shown() else None
        self._log: Callable[[str], None] | None = None

    @contextlib.contextmanager
    def logged(self, write: Callable[[str], None], head: Sequence[str] = ()) -> Iterator[None]:
        """Hand every line to a log too, with the seconds since the start, and how it ends.

        Args:
            write: appends whole lines.
            head: the first lines.
        """
        self._log = write
        try:
            for line in (datetime.datetime.now().astimezone().isoformat(" ", "seconds"), *head):
                self.log(line)
            yield
        except Exception as error:
            what = str(error).strip().splitlines() or [""]
            self.log(f"ended by {type(error).__name__}: {what[0]}")
            raise
        finally:
            self._log = None

    def log(self, text: str) -> None:
        """Write a line into the log only."""
        if self._log is not None:
            self._log(f"{self._clock() - self._begin:9.2f} s  {text}\n")

    def phase(self, name: str) -> None:
        """Begin a phase: mesh, compile, solve, output …; ends the one before."""
        self._end_phase()
        self._phase = name
        self.log(f"{name} …")
        if not self._speaks:
            return
        if self._verbose:
            self._close_bar()
            self._print(f"{name} …")
        elif self._draws:
            self._draw(None, f"{name} …")

    def step(
        self,
        step: int,
        fraction: float,
        pressure_kpa: float,
        angle_deg: float,
        iterations: int,
    ) -> None:
        """Report a load step that has converged.

        Args:
            step: its number.
            fraction: part of the load that is on, 0 to 1.
            pressure_kpa: chamber pressure in kPa.
            angle_deg: bending angle in degrees.
            iterations: Newton iterations of this step.
        """
        draws = self._speaks and self._draws
        if draws:
            pressure, angle = _unsigned(pressure_kpa, 1), _unsigned(angle_deg, 1)
            self._draw(
                fraction, f"step {step}  {pressure:.1f} kPa  {angle:.1f}°  {iterations} iter."
            )
        if self._log is None and (draws or not self._speaks):
            return
        spent = self._clock() - self._phase_begin
        left = spent * (1 - fraction) / fraction if fraction > 0 else None
        times = f"{_clock_text(self._clock() - self._begin)} elapsed"
        if left is not None:
            times += f", about {_clock_text(left)} to go"
        plural = " " if iterations == 1 else "s"
        text = (
            f"step {step:3d}  P {_unsigned(pressure_kpa, 2):8.2f} kPa  "
            f"θ {_unsigned(angle_deg, 2):7.2f}°  "
            f"{iterations:2d} iteration{plural}  {100 * fraction:5.1f} %  {times}"
        )
        self.log(text)
        if self._speaks and not draws:
            self._print(text)

    def message(self, text: str) -> None:
        """Print another line, such as a warning."""
        self.log(text)
        if self._speaks:
            self._print(text)

    def detail(self, text: str) -> None:
        """Print a line for who asks for more, such as a cut-back."""
        self.log(text)
        if self._speaks and self._verbose:
            self._print(text)

    def answer(self, found: Answer) -> None:
        """Print what the run answers; with the comparisons when verbose, and in the log.

        Not in a notebook, where the result shows it.
        """
        from fiberbend.answer.answer import lines

        self._close_bar()
        full = lines(found, verbose=True)
        for line in full:
            self.log(line)
        if self._answers and self._place is None:
            text = full if self._verbose else lines(found)
            # a line between the load steps and their answer
            print(*([""] if self._speaks else []), *text, sep="\n", file=self._stream, flush=True)

    def close(self) -> None:
        """End the last phase; nothing is drawn after it."""
        self._end_phase()
        self._close_bar()

    def _end_phase(self) -> None:
        now = self._clock()
        if self._phase:
            self.wall_s[self._phase] = self.wall_s.get(self._phase, 0.0) + now - self._phase_begin
        self._phase, self._phase_begin = "", now

    @property
    def _draws(self) -> bool:
        """A bar is drawn in place of lines."""
        here = self._place is not None or self._stream.isatty()
        return here and launch.size() == 1

    def _print(self, text: str) -> None:
        if self._bar is not None and self._place is None:
            self._bar.console.print(text, highlight=False, markup=False)
        else:
            print(text, file=self._stream, flush=True)

    def _draw(self, fraction: float | None, text: str) -> None:
        """Draw the bar; without a fraction it stays where it is."""
        if self._bar is None:
            self._bar = self._new_bar()
        task = self._bar.task_ids[0]
        # rounded: a bar that round-off leaves short of its end has a gap there
        done = None if fraction is None else round(min(max(fraction, 0.0), 1.0), 9)
        # at once: a solver that computes lets no thread draw
        self._bar.update(task, completed=done, description=text, refresh=self._place is None)
        if self._place is None:
            self._bar.start()
        else:
            self._place.show(self._bar)

    def _new_bar(self) -> RichProgress:
        from rich.console import Console
        from rich.progress import BarColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        from rich.progress import Progress as RichProgress

        bar = RichProgress(
            BarColumn(bar_width=10),
            TextColumn("{task.description}", markup=False),
            TimeElapsedColumn(),
            TextColumn("elapsed,"),
            TimeRemainingColumn(compact=True),
            TextColumn("to go"),
            console=Console(file=self._stream),
            # the answer alone stays on the screen
            transient=not self._verbose,
            # from all steps: one alone can take longer than rich's half a minute
            speed_estimate_period=math.inf,
        )
        bar.add_task("", total=1.0)
        # the time of the whole run, not of the bar
        bar.tasks[0].start_time = bar.get_time() - (self._clock() - self._begin)
        return bar

    def _close_bar(self) -> None:
        bar, self._bar = self._bar, None
        if bar is not None and self._place is None:
            bar.stop()
        if bar is not None and self._place is not None:
            self._place.clear()


def _unsigned(value: float, digits: int) -> float:
    """A value without the sign of what its digits show as nothing."""
    return round(value, digits) + 0.0


def _clock_text(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"
