"""A run of a rod in time, from its case to its folder."""

from __future__ import annotations

import math
import time as clock
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.answer.timed import ENTRY
from fiberbend.case.case import Case
from fiberbend.case.timed.frames import frame_time
from fiberbend.models.model import ModelKind
from fiberbend.models.result import RunResult
from fiberbend.plan.doubts import doubts
from fiberbend.process import signals
from fiberbend.process.signals import stop_of
from fiberbend.results.folder import RunFolder
from fiberbend.results.states import LAST, step_label, write_snapshot
from fiberbend.running import record
from fiberbend.running.calibrated import Own
from fiberbend.running.launch import on_rank_0
from fiberbend.running.outputs import pictures
from fiberbend.running.progress import Progress
from fiberbend.running.slender.frame import RodFrame
from fiberbend.running.slender.solid import Solid
from fiberbend.running.slender.touch import passes_itself
from fiberbend.slender.actuator import Slender, slender
from fiberbend.slender.timed import Timed, rest_angle, timed
from fiberbend.slender.timed_rows import TimedRows
from fiberbend.states.snapshot import Snapshot
from rod.motion import Moving
from rod.motion.course import Event
from rod.statics import NoEquilibriumError


def run_moving(
    case: Case,
    model: ModelKind,
    folder: RunFolder | None,
    progress: Progress,
    comm: Any,
    own: Own | None,
    scratch: RunFolder | None,
) -> RunResult:
    """Solve a case with `time` as a rod that moves; collective.

    Args:
        case: of a model that moves.
        model: its model.
        folder: where the results go, or None.
        progress: reports to the user.
        comm: an mpi4py communicator, of which one rank solves it.
        own: what the run has of itself beside its case.
        scratch: where states go without a folder, or None.
    """
    run = _MovingRun(case, model, folder, progress, comm.size, own or Own(), scratch)
    try:
        return on_rank_0(comm, run.go)
    except KeyboardInterrupt as error:
        stop = stop_of(error)
        at = f"{run.rows[-1][col.TIME]:.4g} s" if run.rows else "its begin"
        stop.reason = f"stopped at {at}; the rows up to there are kept, --resume begins anew"
        stop.together = comm.size == 1 or None
        if folder is not None and folder.writes:
            # a motion is not gone on with: what is known of it stays
            if run.rows:
                folder.write_history(run.rows)
            known = (run.rows, progress.wall_s, comm.size)
            folder.write_run(**record.unfinished("interrupted", stop.reason, model.name, *known))
        raise stop from None


class _MovingRun(RodFrame):
    """The steps of one run; see `run_moving`."""

    def __init__(
        self,
        case: Case,
        model: ModelKind,
        folder: RunFolder | None,
        progress: Progress,
        ranks: int,
        own: Own,
        scratch: RunFolder | None,
    ) -> None:
        super().__init__(case, model, folder, progress, ranks, own, scratch)
        self._kept: list[tuple[int, Moving]] = []
        self._events: list[Event] = []
        self._spent = 0.0

    def go(self) -> RunResult:
        """Make the law, move, write."""
        case, progress = self.case, self.progress
        known = doubts(case)
        progress.phase("law")
        rod = slender(case)
        progress.phase("solve")
        motion = timed(case, rod)
        if motion.start.state.unstable:
            self.warn(["the equilibrium from which it begins is unstable: it may leave it any way"])
        rows = TimedRows(motion)
        status, reason = "converged", ""
        began = clock.process_time()
        try:
            self._move(motion, rows)
        except NoEquilibriumError as error:
            last = self.rows[-1]
            status = "failed"
            reason = f"{error}; last state: {last[col.TIME]:.4g} s, {last[col.ANGLE]:.4g}°"
        self._spent = clock.process_time() - began
        self.warn([*self.own.remarks, *rod.section.remarks], silent=True)
        self.warn(known)
        touching = passes_itself(rod, [moving.shape for _, moving in self._kept])
        if touching is not None:
            step = self._kept[touching][0]
            text = f"at {self.rows[step][col.TIME]:.4g} s it passes through itself: not modelled"
            self.warn([text])
        self.warn(record.doubts(case, self.rows), silent=True)
        told = self._told(motion)

        def shots(solid: Solid) -> list[Snapshot]:
            return self._shots(rows, solid, touching)

        def draws(folder: RunFolder, why: str | None) -> None:
            self._draw_over_time(folder, why, told[ENTRY])

        ended, counts = (status, reason), self._counted(rod)
        return self.finish(rod, ended, counts, shots, told, pictures=draws)

    # --- the motion ----------------------------------------------------------------------------

    def _move(self, motion: Timed, rows: TimedRows) -> None:
        """Make the steps; keep rows, and states as often as a film has them."""
        duration, shown = motion.times[-1], 0
        frame = frame_time(duration)
        for passed in motion.run():
            moving, step = passed.moving, len(self.rows)
            row = rows.row(step, moving)
            self.add(row)
            self._events += passed.events
            # of the states around the time of a frame the one that is first
            if moving.time >= shown * frame * (1 - 1e-9) or moving.time == duration:
                self._kept.append((step, moving))
                shown = math.floor(moving.time / frame + 1e-9) + 1
            if step:
                part = moving.time / duration
                told = (row[col.PRESSURE], row[col.ANGLE], moving.iterations)
                self.progress.step(step, part, *told)
            signals.check()

    def _shots(self, rows: TimedRows, solid: Solid, touching: int | None) -> list[Snapshot]:
        """The farthest state and the last one; all that are kept go to the folder."""
        angles = [abs(self.rows[step][col.ANGLE]) for step, _ in self._kept]
        farthest = int(np.argmax(angles))
        shots = []
        for number, (step, moving) in enumerate(self._kept):
            asked = ["farthest"] if number == farthest else []
            asked += [LAST] if number == len(self._kept) - 1 else []
            label = asked[-1] if asked and step else step_label(step)
            late = touching is not None and number >= touching
            remark = "passes through itself: not modelled" if late else ""
            shot = solid.snapshot(rows.point(moving), label, step, remark)
            if asked and step:
                shots.append(shot)
            if self.states is not None:
                write_snapshot(self.states, shot)
        return shots

    def _counted(self, rod: Slender) -> dict[str, Any]:
        """What the run has counted."""
        return {
            "unknowns": rod.rod.layout.at_rest().size,
            "pieces": len(rod.rod.layout.lengths),
            "load_steps": len(self.rows) - 1,
            "newton_iterations": sum(row[col.ITERATIONS] for row in self.rows),
        }

    def _told(self, motion: Timed) -> dict[str, Any]:
        """The entry of run.json on the motion."""
        last, steps = self.rows[-1], max(len(self.rows) - 1, 1)
        return {
            ENTRY: {
                "time_s": last[col.TIME],
                "rest_angle_deg": rest_angle(motion, 1e-3 * last[col.PRESSURE]),
                "events": [
                    {"name": e.name, "touch": e.below, "time_s": e.time} for e in self._events
                ],
                "ms_a_step": round(1e3 * self._spent / steps, 3),
                "energy_drift_mJ": max(abs(row[col.DRIFT]) for row in self.rows),
                "frame_s": frame_time(motion.times[-1]),
            }
        }

    def _draw_over_time(self, folder: RunFolder, why: str | None, entry: dict[str, Any]) -> None:
        from fiberbend.drawing.moving.over_time import plot_over_time

        events = [
            (e["time_s"], f"{'touches' if e['touch'] else 'leaves'} {e['name']}")
            for e in entry["events"]
        ]
        more = (self.case.title, why, events, entry["rest_angle_deg"])
        with pictures(self.say):
            folder.write(
                "pictures/over_time.png",
                lambda file: plot_over_time(self.rows, file, *more),
            )
