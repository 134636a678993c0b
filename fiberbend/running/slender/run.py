"""A run of a rod, from the case to its folder."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.march.records import Ramp
from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.measured import read_measured
from fiberbend.compare.check import Check, crosscheck
from fiberbend.models.model import SlenderModel
from fiberbend.models.result import Curve, RunResult
from fiberbend.plan.doubts import doubts
from fiberbend.process import signals
from fiberbend.process.signals import stop_of
from fiberbend.results.folder import RunFolder
from fiberbend.results.states import LAST, step_label, write_snapshot
from fiberbend.running import messages, record
from fiberbend.running.calibrated import Own
from fiberbend.running.history import departures, work_of
from fiberbend.running.hooks import SAME, not_reached
from fiberbend.running.launch import on_rank_0
from fiberbend.running.progress import Progress
from fiberbend.running.slender.frame import RodFrame
from fiberbend.running.slender.solid import Solid
from fiberbend.running.slender.touch import passes_itself
from fiberbend.slender.actuator import Slender, slender
from fiberbend.slender.path import BEYOND, Course, Limits, Point
from fiberbend.slender.rows import Rows
from fiberbend.states.labels import angle_labels, pressure_labels, unused
from fiberbend.states.snapshot import Snapshot


def run_rod(
    case: Case,
    model: SlenderModel,
    folder: RunFolder | None,
    progress: Progress,
    comm: Any,
    own: Own | None,
    scratch: RunFolder | None,
) -> RunResult:
    """Solve a case as a rod; collective.

    Args:
        case: of model rod.
        model: its model.
        folder: where the results go, or None.
        progress: reports to the user.
        comm: an mpi4py communicator, of which one rank solves it.
        own: what the run has of itself beside its case.
        scratch: where states go without a folder, or None.
    """
    if case.time is not None:
        from fiberbend.running.slender.moving import run_moving

        return run_moving(case, model, folder, progress, comm, own, scratch)
    run = _RodRun(case, model, folder, progress, comm.size, own or Own(), scratch)
    try:
        return on_rank_0(comm, run.go)
    except KeyboardInterrupt as error:
        stop = stop_of(error)
        stop.reason = messages.interrupted(run.rows, 0, False)
        stop.together = comm.size == 1 or None
        if folder is not None and folder.writes:
            known = (run.rows, progress.wall_s, comm.size)
            folder.write_run(**record.unfinished("interrupted", stop.reason, model.name, *known))
        raise stop from None


class _RodRun(RodFrame):
    """The steps of one run; see `run_rod`."""

    def __init__(
        self,
        case: Case,
        model: SlenderModel,
        folder: RunFolder | None,
        progress: Progress,
        ranks: int,
        own: Own,
        scratch: RunFolder | None,
    ) -> None:
        super().__init__(case, model, folder, progress, ranks, own, scratch)
        self.model = model

    def go(self) -> RunResult:
        """Make the law, solve, write."""
        case, progress = self.case, self.progress
        known = doubts(case)
        progress.phase("law")
        rod = slender(case, progress.message)
        progress.phase("solve")
        course = self._course(rod)
        maker = Rows(rod, course.tells)
        self.add(maker.row(0, course.points[0]))
        self._rows = maker
        report = course.run()
        self._work()
        self.warn([*self.own.remarks, *rod.section.remarks], silent=True)
        self.warn(known)
        self.warn(messages.remarks(report))
        touching = passes_itself(rod, [point.state.shape for point in course.points])
        if touching is not None:
            at = course.points[touching]
            measures = {"control": at.angle, "value pressure": at.values.get("pressure", 0.0)}
            self.warn([f"at the latest {messages.self_contact(measures)}"])
        status, reason = self._ended(rod, course)
        self.warn(self._jumps(), silent=True)
        missed = not_reached(case, report, self.rows)
        self.warn([messages.missed(missed)] if missed else [], silent=True)
        if status == "converged" and self.rows[-1].get(col.MODES):
            self.warn([messages.UNSTABLE_END], silent=True)
        self.warn(record.doubts(case, self.rows), silent=True)
        return self._finish(rod, course, status, reason, touching)

    # --- the path ------------------------------------------------------------------------------

    def _course(self, rod: Slender) -> Course:
        case = self.case
        turn = case.solver.max_turn or self.model.turn
        inflated = [n for n, ramp in enumerate(rod.ramps) if ramp.load == "pressure"]
        limits = Limits(turn, case.solver.max_cutbacks)
        first = min(inflated, default=0)
        return Course(rod, convert.requests(case), limits, first, self._listen)

    def _listen(self, point: Point, part: float) -> None:
        row = self._rows.row(len(self.rows), point)
        self.add(row)
        step = (row[col.STEP], part, row[col.PRESSURE], row[col.ANGLE], point.iterations)
        self.progress.step(*step)
        signals.check()

    def _work(self) -> None:
        """Fill in the work of the loads since rest."""
        self._each = self._uncertainty = np.zeros(len(self.rows))
        if len(self.rows) > 1:
            self._each, self._uncertainty = work_of(*self._rows.loads(self.rows))
        for row, value in zip(self.rows, np.cumsum(self._each), strict=True):
            row[col.WORK] = float(value)

    def _jumps(self) -> list[str]:
        """Steps in which the energy changes by what no load has done: all have a potential."""
        if len(self.rows) < 2 or not all("conjugate" in key for key in self._unpaired()):
            return []
        stored = np.array([row[col.STORED] for row in self.rows])
        steps = departures(self._each, self._uncertainty, stored)
        return [messages.jumped(self.rows[step - 1], self.rows[step]) for step in steps]

    def _unpaired(self) -> list[str]:
        """Columns of loads whose work no column tells."""
        keys = self.rows[-1]
        return [
            key
            for key in keys
            if key.startswith("load_")
            and not any(other.startswith(f"conjugate_{key[5:]}") for other in keys)
        ]

    def _ended(self, rod: Slender, course: Course) -> tuple[str, str]:
        """Status of the run, and why it is not 'converged'."""
        report, rows = course.report, self.rows
        missed = not_reached(self.case, report, rows)
        text = f"; {', '.join(missed)} not reached" if missed else ""
        if report.status == "converged":
            if not missed:
                return "converged", ""
            reason = f"{messages.course(rows)}: {', '.join(missed)} not reached"
            stop = self.case.output.stop_at_angle
            return "stopped", reason + messages.passed_before(rows, stop, report)
        driven = rod.ramps[course.number]
        row = rows[-1]
        failure = (
            f"{report.reason}; last converged state: {row[col.PRESSURE]:.4g} kPa, "
            f"{row[col.ANGLE]:.4g}°"
        )
        if driven.drive == "control":
            begin, target = (float(np.rad2deg(a)) for a in (course.begin, driven.target))
            turned, reason = messages.angle_missed(rows, begin, target, failure)
            return ("stopped" if turned else report.status), reason + text
        if report.status == "stopped":
            ramp = Ramp(driven.load, driven.target, driven.drive)
            return "stopped", messages.stopped(report, ramp, BEYOND) + text
        return "failed", failure + text

    # --- what is left --------------------------------------------------------------------------

    def _finish(
        self, rod: Slender, course: Course, status: str, reason: str, touching: int | None
    ) -> RunResult:
        check: Check | None = None
        if self.folder is not None:
            self.progress.phase("crosscheck")
            curve, measured = self._section(rod), read_measured(self.case)
            check = crosscheck(self.case, self.model, self.rows, curve, measured)
            self.warn(check.doubts(), silent=True)

        def shots(solid: Solid) -> list[Snapshot]:
            return self._shots(course, solid, touching)

        ended, counts = (status, reason), self._counted(rod, course)
        return self.finish(rod, ended, counts, shots, check=check)

    def _section(self, rod: Slender) -> Curve | None:
        """P(θ) of the section by itself, where that is what the law of the rod was made of."""
        found, length = rod.section, self.case.actuator.length
        bends = self.case.zones is None and rod.rod.layout.plane
        if not bends or found.model != "section" or len(found.free) < 2:
            return None
        pressures = np.concatenate([[0.0], found.free[:, 0]])
        angles = np.concatenate([[0.0], found.free[:, 2] * length])
        if not np.all(np.diff(angles) > 0):
            return None
        return Curve(pressures, angles, np.zeros(len(angles)))

    def _shots(self, course: Course, solid: Solid, touching: int | None) -> list[Snapshot]:
        """The states that are asked for and the last one; all of them go to the folder."""
        output = self.case.output
        angles, pressures = angle_labels(output.at_angles), pressure_labels(output.at_pressures)
        hits = dict(course.report.hits)
        shots: list[Snapshot] = []
        for step, point in enumerate(course.points):
            if step == 0:
                continue
            pressure = point.values.get("pressure", 0.0)
            taken = [shot.label for shot in shots]
            asked = [
                *([angles[hits[step]]] if step in hits else []),
                *(
                    label
                    for goal, label in pressures.items()
                    if abs(pressure - goal) <= SAME * abs(goal)
                ),
                *([LAST] if step == len(course.points) - 1 else []),
            ]
            label = unused(asked[0], taken) if asked else step_label(step)
            remark = ""
            if touching is not None and step >= touching:
                remark = "passes through itself: not modelled"
            shot = solid.snapshot(point, label, step, remark)
            if asked:
                shots.append(shot)
            if self.states is not None:
                write_snapshot(self.states, shot)
        return shots

    def _counted(self, rod: Slender, course: Course) -> dict[str, Any]:
        """What the run has counted."""
        report = course.report
        return {
            "unknowns": rod.rod.layout.at_rest().size,
            "pieces": len(rod.rod.layout.lengths),
            "load_steps": report.steps,
            "newton_iterations": report.iterations,
            "factorisations": report.factorisations,
            "cutbacks": report.cutbacks,
            "stability_checked": course.tells,
            "critical_points": messages.critical_points(report, 1.0),
        }
