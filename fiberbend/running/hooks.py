"""What listens to the march of a run: rows, snapshots, messages and the checkpoint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fem.march.hooks import Hook, Marching
from fem.march.march import ACROSS
from fem.march.records import Ramp, Report, State
from fem.results.checkpoint import Archive
from fem.solver.newton import Outcome
from fiberbend import columns as col
from fiberbend.case.case import Case, Output
from fiberbend.models.model import MeshedModel
from fiberbend.process import signals
from fiberbend.results.folder import RunFolder
from fiberbend.results.states import LAST, STEP, step_label, write_snapshot
from fiberbend.running import messages, record, restart
from fiberbend.running.assembly import Assembly
from fiberbend.running.history import Recorder
from fiberbend.running.progress import Progress
from fiberbend.states.labels import angle_labels, pressure_labels, unused
from fiberbend.states.snapshot import Snapshot

SAME = 1e-9
"""Part of a pressure, or MPa, by which it may miss the one that is asked for."""


class Recording(Hook):
    """Keeps what a user reads of every step, reports it, and leaves a checkpoint.

    Args:
        case: the case.
        assembly: its scene.
        archive: moves states to rank 0.
        recorder: the rows.
        folder: where the checkpoint goes, or None.
        progress: reports to the user.
        model: says whether a checkpoint is left after every step.
        states: where snapshots go, or None.
        snapshots: those of a run that is resumed.

    Attributes:
        snapshots: states that were asked for.
        warnings: what was warned of so far.
        rows: the history so far.
        kept: the step that is kept; 0: none.
    """

    def __init__(
        self,
        case: Case,
        assembly: Assembly,
        archive: Archive,
        recorder: Recorder,
        folder: RunFolder | None,
        progress: Progress,
        model: MeshedModel,
        states: RunFolder | None = None,
        snapshots: Sequence[Snapshot] = (),
    ) -> None:
        self._case, self._assembly, self._archive = case, assembly, archive
        self._recorder, self._folder, self._progress = recorder, folder, progress
        self._model, self._resumes = model.name, model.resumes
        self._states, self._room = states, True
        self.rows = recorder.rows
        self.kept = int(self.rows[-1][col.STEP]) if model.resumes else 0
        self.snapshots = list(snapshots)
        self.warnings: list[str] = []
        self._angles = angle_labels(case.output.at_angles)
        self._pressures = pressure_labels(case.output.at_pressures)

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Record the step, and where the march stands."""
        row = self._recorder.add(state, outcome)
        self.remark(march.position.report)
        self._progress.step(
            row[col.STEP],
            self._fraction(march.position.ramp, state),
            row[col.PRESSURE],
            row[col.ANGLE],
            outcome.iterations,
        )
        asked = self._requested(march.position.report, state)
        self.keep(asked or step_label(row[col.STEP]))
        if self._folder is not None and self._resumes and not march.position.entering:
            self._recorder.integrate()
            self._save(self._folder, march, row[col.STEP])
        signals.check()

    def _save(self, folder: RunFolder, march: Marching, step: int) -> None:
        """Keep where it stands; run.json says so too, of a run that is killed."""
        restart.save(folder, self._archive, march.saved(), self.rows, self.warnings)
        self.kept = step
        reason = f"at step {step}, kept; where no process runs it: go on with --resume"
        scene = self._assembly.scene
        spent = self._progress.wall_s
        run = record.unfinished(
            "running", reason, self._model, self.rows, spent, scene.domain.comm.size
        )
        folder.write_run(**run)

    def after_cutback(self, march: Marching, reason: str) -> None:
        """Report it."""
        self._progress.detail(f"increment cut back: {reason}")

    def remark(self, report: Report) -> None:
        """Warn of what has happened to the body so far."""
        walls = self._assembly.walls
        self.warn(messages.remarks(report))
        if walls is not None and walls.passed is not None:
            self.warn([messages.walls_passed(walls.passed)])
        if why := self._assembly.newton.factor.left:
            self.warn([messages.left_to_mumps(why)])

    def warn(self, lines: Sequence[str], silent: bool = False) -> None:
        """Report each line once; `silent`: with the others at the end only."""
        for text in lines:
            if text not in self.warnings:
                self.warnings.append(text)
                if not silent:
                    self._progress.message(text)

    def keep(self, label: str) -> None:
        """Keep the present state for fields, pictures and the report; collective."""
        if self._states is None:
            return
        row = self._recorder.rows[-1]
        if label == LAST and any(s.step == row[col.STEP] for s in self.snapshots):
            return
        displacement, multiplier = self._archive.displacement(), self._archive.multiplier()
        if displacement is None or multiplier is None:
            multiplier = np.zeros((0, 0))
            displacement = np.zeros((0, 3))
        scene, walls = self._assembly.scene, self._assembly.walls
        shot = Snapshot(
            label=label,
            step=row[col.STEP],
            pressure_kpa=row[col.PRESSURE],
            angle_deg=row[col.ANGLE],
            displacement=displacement,
            multiplier=multiplier,
            fiber_force=self._archive.fiber_force(),
            remark=messages.on_state(
                self._assembly.march.report, None if walls is None else walls.passed, row[col.ANGLE]
            ),
            **{name: scene.scalar(name) for name in scene.body.natural},
        )
        if not label.startswith(STEP):
            self.snapshots.append(shot)
        try:
            if self._room:
                write_snapshot(self._states, shot)
        except OSError as error:
            if self._folder is not None:
                raise
            # of a run without a folder the rows are the result: a full disk costs its states
            self._room = False
            self.warn([f"states are kept up to step {shot.step - 1} only: {error.strerror}"])

    @property
    def last(self) -> Snapshot | None:
        """The last state; None where it was not kept."""
        found = (shot for shot in self.snapshots if shot.step == self.rows[-1][col.STEP])
        return next(found, None)

    def _fraction(self, number: int, state: State) -> float:
        """Part of all ramps that is done."""
        ramps = self._assembly.ramps
        return (number + _share(ramps[number], state)) / len(ramps)

    def _requested(self, report: Report, state: State) -> str:
        """Label of the requested output that this state is, or nothing."""
        taken = [shot.label for shot in self.snapshots]
        for step, angle in reversed(report.hits):
            if step == report.steps and angle in self._angles:
                return unused(self._angles[angle], taken)
        pressure = state.scalars.get("pressure", 0.0)
        for goal, label in self._pressures.items():
            if abs(pressure - goal) <= SAME * abs(goal):
                return unused(label, taken)
        return ""


def shows_states(output: Output) -> bool:
    """Whether anything is asked for that needs the states of a run, not its history alone."""
    return output.fields or output.pictures or output.report or output.animation


def ended(case: Case, assembly: Assembly, rows: Sequence[dict[str, Any]]) -> tuple[str, str]:
    """Status of a run whose march is over, and why it is not 'converged'.

    Args:
        case: has the outputs that were asked for.
        assembly: its march has ended.
        rows: rows of the history.
    """
    march, report = assembly.march, assembly.march.report
    missed = not_reached(case, report, rows)
    if report.status == "converged":
        if not missed:
            return "converged", ""
        text = f"{messages.course(rows)}: {', '.join(missed)} not reached"
        return "stopped", text + messages.passed_before(rows, case.output.stop_at_angle, report)
    ramp, row = assembly.ramps[march.position.ramp], rows[-1]
    text = f"; {', '.join(missed)} not reached" if missed else ""
    failure = report.reason
    if report.status == "failed":
        instead = ""
        if report.reason == ACROSS:
            whole = "" if assembly.scene.body.components == 3 else "model: body and "
            instead = f": expected {whole}mesh.symmetry: full;"
        failure = (
            f"{report.reason}{instead} after {report.cutbacks} cut-backs; last converged state: "
            f"{row[col.PRESSURE]:.4g} kPa, {row[col.ANGLE]:.4g}°"
        )
    if ramp.drive == "control":
        begin = float(np.rad2deg(march.position.begin or 0.0))
        turned, reason = messages.angle_missed(rows, begin, float(np.rad2deg(ramp.target)), failure)
        return ("stopped" if turned else report.status), reason + text
    if report.status == "stopped":
        return "stopped", messages.stopped(report, ramp, march.rules.beyond) + text
    return "failed", failure + text


def unmet(case: Case, assembly: Assembly, rows: Sequence[dict[str, Any]]) -> list[str]:
    """Warnings of what a case asks for and its run has not met.

    Args:
        case: has the outputs that were asked for.
        assembly: its march has ended.
        rows: rows of the history.
    """
    report = assembly.march.report
    missed = not_reached(case, report, rows)
    lines = [messages.missed(missed)] if missed else []
    later = [ramp.scalar for ramp in assembly.ramps[assembly.march.position.ramp + 1 :]]
    if report.ended_at is not None and later:
        end = f"{np.rad2deg(report.ended_at):.6g}°"
        lines.append(f"the run ended at {end}, before {' and '.join(later)} acted")
    return lines


def not_reached(case: Case, report: Report, rows: Sequence[dict[str, Any]]) -> list[str]:
    """Angles and pressures that a case asks for and no state has, with their units."""
    output = case.output
    hits = {angle for _, angle in report.hits}
    angles = dict.fromkeys(
        angle for angle in (*output.at_angles, output.stop_at_angle) if angle is not None
    )
    found = [f"{np.rad2deg(angle):.6g}°" for angle in angles if angle not in hits]
    for pressure in dict.fromkeys(output.at_pressures):
        gaps = [abs(row[col.PRESSURE] / 1e3 - pressure) for row in rows]
        if min(gaps) > SAME * abs(pressure):
            found.append(f"{1e3 * pressure:.6g} kPa")
    return found


def _share(ramp: Ramp, state: State) -> float:
    """Part of a ramp that is done, by its load or by the angle at which it ends."""
    done = state.measures[ramp.key] / ramp.target
    if ramp.until:
        done = max(done, state.measures["control"] / ramp.until)
    return float(np.clip(done, 0.0, 1.0))
