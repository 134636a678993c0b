"""What listens to the march of a run: rows, snapshots, messages and the checkpoint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fem.march.hooks import Hook, Marching
from fem.march.march import ACROSS
from fem.march.records import Ramp, State
from fem.results.checkpoint import Archive
from fem.solver.newton import Outcome
from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.running import messages, restart
from fiberbend.running.assembly import Assembly
from fiberbend.running.folder import RunFolder
from fiberbend.running.history import Recorder
from fiberbend.running.progress import Progress
from fiberbend.states.snapshot import Snapshot


class Recording(Hook):
    """Keeps what a user reads of every step, reports it, and leaves a checkpoint.

    Args:
        case: the case.
        assembly: its scene.
        archive: moves states to rank 0.
        recorder: the rows.
        folder: where snapshots and the checkpoint go, or None.
        progress: reports to the user.
        resumes: leave a checkpoint after every step.
        snapshots: those of a run that is resumed.

    Attributes:
        snapshots: states that were asked for.
        warnings: what was warned of so far.
    """

    def __init__(
        self,
        case: Case,
        assembly: Assembly,
        archive: Archive,
        recorder: Recorder,
        folder: RunFolder | None,
        progress: Progress,
        resumes: bool,
        snapshots: Sequence[Snapshot] = (),
    ) -> None:
        self._case, self._assembly, self._archive = case, assembly, archive
        self._recorder, self._folder, self._progress = recorder, folder, progress
        self._resumes = resumes
        self.snapshots = list(snapshots)
        self.warnings: list[str] = []

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Record the step, and where the march stands."""
        row = self._recorder.add(state, outcome)
        self.warn(messages.remarks(march.position.report))
        self._progress.step(
            row[col.STEP],
            self._fraction(march.position.ramp, state),
            row[col.PRESSURE],
            row[col.ANGLE],
            outcome.iterations,
        )
        label = self._requested(state)
        if label:
            self.keep(label)
        if self._folder is not None and self._resumes:
            self._recorder.integrate()
            restart.save(self._folder, self._archive, march.position, self._recorder.rows)

    def after_cutback(self, march: Marching, reason: str) -> None:
        """Report it."""
        self._progress.message(f"increment cut back: {reason}")

    def warn(self, lines: Sequence[str]) -> None:
        """Report each line once."""
        for text in lines:
            if text not in self.warnings:
                self.warnings.append(text)
                self._progress.message(text)

    def keep(self, label: str) -> None:
        """Keep the present state for fields and pictures; collective."""
        output = self._case.output
        if self._folder is None or not (output.fields or output.pictures):
            return
        row = self._recorder.rows[-1]
        if label == "last" and any(s.step == row[col.STEP] for s in self.snapshots):
            return
        displacement, multiplier = self._archive.displacement(), self._archive.multiplier()
        if displacement is None or multiplier is None:
            multiplier = np.zeros((0, 0))
            displacement = np.zeros((0, 3))
        scene = self._assembly.scene
        shot = Snapshot(
            label=label,
            step=row[col.STEP],
            pressure_kpa=row[col.PRESSURE],
            angle_deg=row[col.ANGLE],
            displacement=displacement,
            multiplier=multiplier,
            fiber_force=self._archive.fiber_force(),
            **{name: scene.scalar(name) for name in scene.body.natural},
        )
        self.snapshots.append(shot)
        arrays = {k: v for k, v in vars(shot).items() if v is not None}
        self._folder.write_arrays(f"snapshots/{label}.npz", **arrays)

    def _fraction(self, number: int, state: State) -> float:
        """Part of all ramps that is done."""
        ramps = self._assembly.ramps
        return (number + _share(ramps[number], state)) / len(ramps)

    def _requested(self, state: State) -> str:
        """Label of the requested output that this state is, or nothing."""
        angle = state.measures["control"]
        for goal in self._case.output.at_angles:
            if abs(angle - goal) < 1e-6:
                return f"{np.rad2deg(goal):03.0f}deg"
        pressure = state.scalars.get("pressure", 0.0)
        for goal in self._case.output.at_pressures:
            if abs(pressure - goal) < 1e-9 * max(1.0, abs(goal)):
                return f"{1e3 * goal:g}kPa"
        return ""


def ended(case: Case, assembly: Assembly, rows: Sequence[dict[str, Any]]) -> tuple[str, str]:
    """Status of a run whose march is over, and why it is not 'converged'.

    Args:
        case: has the outputs that were asked for.
        assembly: its march has ended.
        rows: rows of the history.
    """
    march, report = assembly.march, assembly.march.report
    if report.status == "stopped":
        ramp = assembly.ramps[march.position.ramp]
        unit, factor = ("kPa", 1e3) if ramp.scalar == "pressure" else ("", 1.0)
        target = f"{factor * ramp.target:g} {unit}".strip()
        return "stopped", messages.stopped(report, target, march.rules.beyond)
    if report.status == "failed":
        row = rows[-1]
        instead = ""
        if report.reason == ACROSS:
            whole = "" if assembly.scene.body.components == 3 else "model: body and "
            instead = f": expected {whole}mesh.symmetry: full;"
        return "failed", (
            f"{report.reason}{instead} after {report.cutbacks} cut-backs; last converged state: "
            f"{row[col.PRESSURE]:.4g} kPa, {row[col.ANGLE]:.4g}°"
        )
    output = case.output
    reached = max(row[col.ANGLE] for row in rows)
    wanted = [np.rad2deg(a) for a in (*output.at_angles, output.stop_at_angle) if a]
    missed = [f"{a:g}°" for a in wanted if a > reached + 1e-6]
    if missed:
        return "stopped", f"the loads end at {reached:.4g}°: {', '.join(missed)} not reached"
    return "converged", ""


def _share(ramp: Ramp, state: State) -> float:
    """Part of a ramp that is done, by its load or by the angle at which it ends."""
    done = state.measures[ramp.key] / ramp.target
    if ramp.until:
        done = max(done, state.measures["control"] / ramp.until)
    return float(np.clip(done, 0.0, 1.0))
