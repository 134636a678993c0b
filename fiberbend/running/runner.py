"""A run from a case to its folder: mesh, scene, march, results."""

from __future__ import annotations

import resource as usage
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI

from fem.effects.embedded_fibers import FiberPotential
from fem.march.frames import Frames
from fem.march.guide import Guide
from fem.march.hooks import Hook, Marching
from fem.march.records import Ramp, Report, State
from fem.march.selfcontact import Rod
from fem.results.checkpoint import Archive
from fem.scene import Scene
from fem.solver.newton import Outcome
from fiberbend.case.case import Case
from fiberbend.effects.table import ContactEffect
from fiberbend.models import kinds
from fiberbend.models.choice import UNIFORM, choose_model
from fiberbend.models.closed_form import held
from fiberbend.models.result import RunResult
from fiberbend.plan.plan import winding_remark
from fiberbend.running import messages, restart
from fiberbend.running.assembly import assemble
from fiberbend.running.folder import RunFolder
from fiberbend.running.history import Recorder
from fiberbend.running.progress import Progress
from fiberbend.running.record import blocked_tip, contact, versions
from fiberbend.running.warm import guides, section_states
from fiberbend.states.snapshot import Scenery, Snapshot
from geometry.mesh.data import MeshData

if TYPE_CHECKING:
    from fiberbend.compare.check import Check

MESH = "mesh.npz"


def run_case(
    case: Case,
    out: Path | None,
    overwrite: bool = False,
    progress: Progress | None = None,
    resume: bool = False,
) -> RunResult:
    """Solve a case; collective over MPI.COMM_WORLD.

    Args:
        case: the case.
        out: run folder, or None to write nothing.
        overwrite: replace an earlier run.
        progress: what is told meanwhile; silent unless given.
        resume: go on from the checkpoint in the folder.

    Raises:
        CaseError: the folder cannot be used.
        MeshError: gmsh failed.
    """
    comm = MPI.COMM_WORLD
    progress = progress or Progress(quiet=True)
    folder = None
    if out is not None and resume:
        folder = RunFolder.resume(out, case, comm)
    elif out is not None:
        folder = RunFolder.create(out, case, overwrite, comm)
    model, _ = choose_model(case)
    if model == "body":
        return _Run(case, model, folder, progress, comm).go(resume)
    if model == "analytic":
        from fiberbend.running.analytic import run_analytic

        return _on_rank_0(comm, lambda: run_analytic(case, folder, progress))  # type: ignore[no-any-return]
    # a section or a cell is too small to share: one rank solves it
    return _on_rank_0(  # type: ignore[no-any-return]
        comm, lambda: _Run(case, model, folder, progress, MPI.COMM_SELF).go(False)
    )


def _on_rank_0(comm: MPI.Comm, action: Callable[[], Any]) -> Any:
    """Result of an action of rank 0 on every rank, or its error on every rank."""
    outcome: tuple[Any, Exception | None] = (None, None)
    if comm.rank == 0:
        try:
            outcome = (action(), None)
        except Exception as error:
            outcome = (None, error)
    value, problem = comm.bcast(outcome)
    if problem is not None:
        raise problem
    return value


class _Run(Hook):
    """The steps of one run and what they share; hears of every step of its march."""

    def __init__(
        self,
        case: Case,
        model: str,
        folder: RunFolder | None,
        progress: Progress,
        comm: MPI.Comm,
    ) -> None:
        self.case, self.folder, self.progress, self.comm = case, folder, progress, comm
        self.model = model
        self.blocked = model == "body" and held(case)
        self.snapshots: list[Snapshot] = []
        self.warnings: list[str] = []

    def go(self, again: bool) -> RunResult:
        """Mesh, compile, solve, write."""
        self.progress.phase("mesh")
        mesh = _on_rank_0(self.comm, lambda: self._mesh(again))
        self.progress.phase("compile")
        case, model = self.case, self.model
        built = assemble(case, model, mesh, self.comm, [self], self._rod, self._guide)
        self.parts, self.scene, self.ramps = built.parts, built.scene, built.ramps
        self.newton, self.march = built.newton, built.march
        reading = built.reading
        self.archive = Archive(self.scene, reading.frames)
        gauge, rest = reading.gauge(), self.march.rest
        saved = restart.load(self.folder, self.archive) if again and self.folder else None
        if saved is not None:
            self.snapshots = saved.snapshots
            self.march.resume(saved.position)
        self.recorder = Recorder(self.scene, gauge, rest, saved.rows if saved else None)
        if again:
            self._remark_stability()
            self.progress.message(f"resumed after step {self.recorder.rows[-1]['step']}")
        self._remark()
        self.progress.phase("solve")
        report = self.march.run(self.ramps)
        status, reason = self._status(report)
        self._remark_ends(status, self.recorder.integrate())
        self.check = self._cross_check()
        self.progress.phase("output")
        self._snapshot("last")
        rows = self.check.beside(self.recorder.rows) if self.check else self.recorder.rows
        run = self._write(status, reason, report, rows)
        if self.folder is not None and self.comm.rank == 0:
            self._draw(status, reason, rows)
            run["wall_s"] = self._wall()
            self.folder.write_run(**run)
        self.comm.barrier()
        self._tell(run)
        path = self.folder.path if self.folder else None
        return RunResult(status, reason, rows, run, path)

    # --- mesh ----------------------------------------------------------------------------------

    def _mesh(self, again: bool) -> MeshData:
        folder, case = self.folder, self.case
        if folder is not None and again:
            return MeshData.load(folder.path / MESH)
        msh = folder.path / "actuator.msh" if folder else None
        mesh = kinds.make_mesh(case, self.model, msh)
        if folder is not None:
            mesh.save(folder.path / MESH)
        return mesh

    def _remark(self) -> None:
        remark = winding_remark(self.case)
        if remark is not None and "NOT" in remark:
            self.progress.message(f"winding {remark}")

    # --- steps ---------------------------------------------------------------------------------

    def _rod(self, scene: Scene, frames: Frames | None) -> Rod:
        return messages.rod(scene, frames, self.case.actuator.cap)

    def _guide(self, scene: Scene, frames: Frames) -> Guide | None:
        """What a body leans on: its section's states, solved on rank 0; collective."""
        if not guides(self.case):
            return None
        self.progress.phase("section")
        states = _on_rank_0(self.comm, lambda: section_states(self.case))
        return states.guide(scene, frames, self.case.actuator.length) if states else None

    def after_cutback(self, march: Marching, reason: str) -> None:
        """Say so."""
        self.progress.message(f"increment cut back: {reason}")

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Record the step, and where the march stands."""
        row = self.recorder.add(state, outcome)
        self._remark_stability()
        self.progress.step(
            row["step"],
            self._fraction(state),
            row["pressure_kPa"],
            row["angle_deg"],
            outcome.iterations,
        )
        label = self._requested(state)
        if label:
            self._snapshot(label)
        if self.folder is not None and self.model not in UNIFORM:
            self.recorder.integrate()
            restart.save(self.folder, self.archive, march.position, self.recorder.rows)

    def _remark_stability(self) -> None:
        """Say once where stability was lost or gained, and where the body meets itself."""
        for text in messages.remarks(self.march.report):
            if text not in self.warnings:
                self.warnings.append(text)
                self.progress.message(text)

    def _remark_ends(self, status: str, jumps: list[int]) -> None:
        """Say what only a whole history tells: jumps, and an end at which nothing would rest."""
        rows = self.recorder.rows
        lines = [messages.jumped(rows[step - 1], rows[step]) for step in jumps]
        if status == "converged" and rows[-1].get("unstable_modes"):
            lines.append(messages.UNSTABLE_END)
        for text in lines:
            self.warnings.append(text)
            self.progress.message(text)

    def _fraction(self, state: State) -> float:
        """Part of all ramps that is done."""
        ramps = self.ramps
        number = self.march.position.ramp
        ramp = ramps[number]
        done = _share(ramp, state)
        return (number + done) / len(ramps)

    def _requested(self, state: State) -> str:
        """Label of the requested output that this state is, or nothing."""
        angle = state.measures["control"]
        for goal in self.case.output.at_angles:
            if abs(angle - goal) < 1e-6:
                return f"{np.rad2deg(goal):03.0f}deg"
        pressure = state.scalars.get("pressure", 0.0)
        for goal in self.case.output.at_pressures:
            if abs(pressure - goal) < 1e-9 * max(1.0, abs(goal)):
                return f"{1e3 * goal:g}kPa"
        return ""

    def _snapshot(self, label: str) -> None:
        """Keep the present state for fields and pictures; collective."""
        output = self.case.output
        if self.folder is None or not (output.fields or output.pictures):
            return
        row = self.recorder.rows[-1]
        if label == "last" and any(s.step == row["step"] for s in self.snapshots):
            return
        displacement = self.archive.displacement()
        multiplier = self.archive.multiplier()
        force = None
        for key, discrete in self.scene.discrete.items():
            if isinstance(discrete, FiberPotential):
                force = self.archive.forces(key)
        if displacement is None or multiplier is None:
            multiplier = np.zeros((0, 0))
            displacement = np.zeros((0, 3))
        shot = Snapshot(
            label=label,
            step=row["step"],
            pressure_kpa=row["pressure_kPa"],
            angle_deg=row["angle_deg"],
            displacement=displacement,
            multiplier=multiplier,
            fiber_force=force,
            **{name: self.scene.scalar(name) for name in self.scene.body.natural},
        )
        self.snapshots.append(shot)
        arrays = {k: v for k, v in vars(shot).items() if v is not None}
        self.folder.write_arrays(f"snapshots/{label}.npz", **arrays)

    def _cross_check(self) -> Check | None:
        """The run beside the section model and the closed forms; only for a run with a folder."""
        if self.folder is None:
            return None
        from fiberbend.compare.beside import check_run

        self.progress.phase("crosscheck")

        def solve(case: Case) -> RunResult:
            return _Run(case, "section", None, Progress(quiet=True), MPI.COMM_SELF).go(False)

        rows = self.recorder.rows
        check: Check = _on_rank_0(self.comm, lambda: check_run(self.case, self.model, rows, solve))
        return check

    # --- results -------------------------------------------------------------------------------

    def _status(self, report: Report) -> tuple[str, str]:
        if report.status == "stopped":
            ramp = self.ramps[self.march.position.ramp]
            unit, factor = ("kPa", 1e3) if ramp.scalar == "pressure" else ("", 1.0)
            target = f"{factor * ramp.target:g} {unit}".strip()
            return "stopped", messages.stopped(report, target, self.march.rules.beyond)
        if report.status == "failed":
            row = self.recorder.rows[-1]
            return "failed", (
                f"{report.reason} after {report.cutbacks} cut-backs; last converged state: "
                f"{row['pressure_kPa']:.4g} kPa, {row['angle_deg']:.4g}°"
            )
        output = self.case.output
        reached = max(row["angle_deg"] for row in self.recorder.rows)
        wanted = [np.rad2deg(a) for a in (*output.at_angles, output.stop_at_angle) if a]
        missed = [f"{a:g}°" for a in wanted if a > reached + 1e-6]
        if missed:
            return "stopped", (f"the loads end at {reached:.4g}°: {', '.join(missed)} not reached")
        return "converged", ""

    def _wall(self) -> dict[str, float]:
        seconds = {name: round(value, 3) for name, value in self.progress.wall_s.items()}
        return seconds | {f"solve/{k}": round(v, 3) for k, v in self.newton.seconds.items()}

    def _write(
        self, status: str, reason: str, report: Report, rows: list[dict[str, Any]]
    ) -> dict[str, Any]:
        memory = self.comm.allreduce(usage.getrusage(usage.RUSAGE_SELF).ru_maxrss / 1024)
        scene = self.scene
        run: dict[str, Any] = {
            "status": status,
            "reason": reason,
            "model": self.model,
            "half": scene.domain.data.half,
            "unknowns": scene.body.size,
            "elements": len(scene.domain.data.cells),
            "element": scene.domain.data.cell_type,
            "effects": scene.keys,
            "load_steps": report.steps,
            "newton_iterations": report.iterations,
            "factorisations": report.factorisations,
            "cutbacks": report.cutbacks,
            "warnings": self.warnings,
            "critical_points": messages.critical_points(report, scene.body.symmetry_factor),
            "wall_s": self._wall(),
            "peak_memory_MB": round(memory, 1),
            "ranks": self.comm.size,
            "winding": winding_remark(self.case),
            "versions": versions(),
        }
        if self.blocked and "tip_force_N" in self.recorder.rows[-1]:
            run["blocked_tip"] = blocked_tip(self.case, self.recorder.rows[-1])
        if self.case.find(ContactEffect) is not None:
            run["contact"] = contact(self.case, self.recorder.rows)
        if self.check is not None:
            run["crosscheck"] = self.check.entry()
        if self.folder is not None:
            self.folder.write_history(rows)
            self.folder.write_run(**run)
        return run

    def _tell(self, run: dict[str, Any]) -> None:
        """Say what the run took, and what stands beside it."""
        say = self.progress.message
        for line in self.check.lines() if self.check is not None else ():
            say(line)
        say(
            f"{run['unknowns']} unknowns: {run['load_steps']} steps, {run['newton_iterations']} "
            f"iterations, {run['factorisations']} factorisations, {run['cutbacks']} cut-backs"
        )
        phases = ", ".join(f"{name} {value:.1f} s" for name, value in self._wall().items())
        say(f"{phases}; peak memory {run['peak_memory_MB']:.0f} MB on {run['ranks']} ranks")

    def _draw(self, status: str, reason: str, rows: list[dict[str, Any]]) -> None:
        """Fields, pictures and plots, on rank 0."""
        from fiberbend.running import report

        assert self.folder is not None
        scenery = Scenery(
            mesh=self.scene.domain.data,
            materials=self.parts.materials,
            fibers=self.parts.fibers,
            smeared=self.parts.smeared,
            title=self.case.title,
            uniform=self.model in UNIFORM,
        )
        report.draw(
            self.folder,
            self.case,
            scenery,
            self.snapshots,
            rows,
            None if status == "converged" else f"{status}: {reason}",
            self.progress.message,
            check=self.check,
            model=self.model,
        )


def _share(ramp: Ramp, state: State) -> float:
    """Part of a ramp that is done, by its load or by the angle at which it ends."""
    done = state.measures[ramp.key] / ramp.target
    if ramp.until:
        done = max(done, state.measures["control"] / ramp.until)
    return float(np.clip(done, 0.0, 1.0))
