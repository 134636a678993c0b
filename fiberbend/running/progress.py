"""Progress of a run: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, TextIO

from fiberbend.running import launch

if TYPE_CHECKING:
    from rich.progress import Progress as RichProgress


class Progress:
    """Reports of a run. Silent when quiet, and on every rank but 0.

    Attributes:
        wall_s: seconds spent in each phase so far, by its name.
    """

    def __init__(
        self,
        quiet: bool = False,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Start the clock.

        Args:
            quiet: print nothing.
            stream: where to write, the standard output by default.
            clock: seconds; another one for tests.
        """
        self.wall_s: dict[str, float] = {}
        self._stream = stream or sys.stdout
        self._clock = clock
        self._begin = self._phase_begin = clock()
        self._phase = ""
        self._speaks = not quiet and launch.rank() == 0
        self._bar: RichProgress | None = None

    def phase(self, name: str) -> None:
        """Begin a phase: mesh, compile, solve, output …; ends the one before."""
        self._end_phase()
        self._phase = name
        self._close_bar()
        self._say(f"{name} …")

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
        if not self._speaks:
            return
        if self._stream.isatty() and launch.size() == 1:
            pressure, angle = _unsigned(pressure_kpa, 1), _unsigned(angle_deg, 1)
            self._draw(
                fraction, f"step {step}  {pressure:.1f} kPa  {angle:.1f}°  {iterations} iter."
            )
            return
        spent = self._clock() - self._phase_begin
        left = spent * (1 - fraction) / fraction if fraction > 0 else None
        times = f"{_clock_text(self._clock() - self._begin)} elapsed"
        if left is not None:
            times += f", about {_clock_text(left)} to go"
        plural = " " if iterations == 1 else "s"
        self._say(
            f"step {step:3d}  P {_unsigned(pressure_kpa, 2):8.2f} kPa  "
            f"θ {_unsigned(angle_deg, 2):7.2f}°  "
            f"{iterations:2d} iteration{plural}  {100 * fraction:5.1f} %  {times}"
        )

    def message(self, text: str) -> None:
        """Print another line: a cut-back, a warning."""
        self._say(text)

    def close(self) -> None:
        """End the last phase; nothing is drawn after it."""
        self._end_phase()
        self._close_bar()

    def _end_phase(self) -> None:
        now = self._clock()
        if self._phase:
            self.wall_s[self._phase] = self.wall_s.get(self._phase, 0.0) + now - self._phase_begin
        self._phase, self._phase_begin = "", now

    def _say(self, text: str) -> None:
        if not self._speaks:
            return
        if self._bar is not None:
            self._bar.console.print(text, highlight=False, markup=False)
        else:
            print(text, file=self._stream, flush=True)

    def _draw(self, fraction: float, text: str) -> None:
        if self._bar is None:
            self._bar = self._new_bar()
        task = self._bar.task_ids[0]
        self._bar.update(task, completed=min(max(fraction, 0.0), 1.0), description=text)
        self._bar.start()

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
            # from all steps: one alone can take longer than rich's half a minute
            speed_estimate_period=math.inf,
        )
        bar.add_task("", total=1.0)
        # the time of the whole run, not of the bar
        bar.tasks[0].start_time = bar.get_time() - (self._clock() - self._begin)
        return bar

    def _close_bar(self) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None


def _unsigned(value: float, digits: int) -> float:
    """A value without the sign of what its digits show as nothing."""
    return round(value, digits) + 0.0


def _clock_text(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"
