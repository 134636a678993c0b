"""A run from a case to its folder: mesh, scene, march, results."""

from __future__ import annotations

import contextlib
import tempfile
import weakref
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

from fem import kernels
from fem.march.frames import Frames
from fem.march.guide import Guide
from fem.march.march import ACROSS
from fem.results.checkpoint import Archive
from fem.scene import Scene
from fem.solver.problem import RefusedError
from fiberbend import columns as col
from fiberbend.answer.answer import answer
from fiberbend.case.case import Case
from fiberbend.case.section_beside import section_guides
from fiberbend.models.choice import choose_model, meshed
from fiberbend.models.model import MeshedModel
from fiberbend.models.result import RunResult
from fiberbend.plan.doubts import doubts
from fiberbend.plan.memory import fits, refuse_shortage
from fiberbend.process.signals import Interrupted, stop_of
from fiberbend.results.folder import MESH, REPORT, RunFolder
from fiberbend.results.states import LAST, write_fibers
from fiberbend.running import launch, messages, record, restart
from fiberbend.running.assembly import Assembly, assemble, without_symmetry
from fiberbend.running.calibrated import Own, calibrated
from fiberbend.running.history import Recorder
from fiberbend.running.hooks import Recording, ended, shows_states, unmet
from fiberbend.running.launch import on_rank_0
from fiberbend.running.outputs import draw, write_page
from fiberbend.running.progress import Progress
from fiberbend.running.warm import SectionStates, section_states
from geometry.mesh.data import MeshData

if TYPE_CHECKING:
    from fiberbend.compare.check import Check

GMSH_FILE = "actuator.msh"


def run_case(
    case: Case,
    out: Path | None,
    overwrite: bool = False,
    progress: Progress | None = None,
    resume: bool = False,
    force: bool = False,
    states: Path | None = None,
    comm: MPI.Comm | None = None,
) -> RunResult:
    """Solve a case; collective over its ranks.

    Args:
        case: the case.
        out: run folder, or None to write nothing.
        overwrite: replace an earlier run.
        progress: reports to the user; none by default.
        resume: go on from the checkpoint in the folder.
        force: run whether its memory is free or not.
        states: folder for mesh, winding and states of a run without `out`; none by default.
        comm: the ranks that solve it together; all of the launch by default.

    Raises:
        CaseError: the folder cannot be used, there is not enough memory for the run, or a winding
            cannot be calibrated.
        MeshError: gmsh failed.
    """
    comm = MPI.COMM_WORLD if comm is None else comm
    progress = progress or Progress(quiet=True)
    if not force:
        refuse_shortage(case, comm, out is not None)
    case, own = calibrated(case, comm, progress, out if resume else None)
    if out is None:
        scratch = None if states is None else RunFolder(states, comm.rank == 0, durable=False)
        return _solve(case, None, progress, comm, False, force, own, scratch)
    if resume:
        folder = RunFolder.resume(out, case, comm)
    else:
        folder = RunFolder.create(out, case, overwrite, comm)
    with folder, progress.logged(folder.log, [*record.header(), *own.lines]):
        # in place of an end that is no more
        folder.write_run(
            status="running",
            reason="begun; where no process runs it: go on with --resume",
            model=choose_model(case)[0].name,
            ranks=comm.size,
            versions=record.versions(),
            **record.provenance(),
            **own.entries,
        )
        result = _solve(case, folder, progress, comm, resume, force, own)
        progress.log(f"{result.status}{': ' if result.reason else ''}{result.reason}")
        progress.log(f"results in {out}")
        if (out / REPORT).exists():
            progress.log(f"report in {out / REPORT}")
        return result


def _solve_beside(case: Case) -> RunResult:
    """A case beside the run, on this rank alone."""
    return _Run(case, meshed(case), None, Progress(quiet=True), MPI.COMM_SELF, 1).go(False)


class _AcrossError(Exception):
    """Half a body buckles across its mirror plane, and may be solved whole instead."""


def _solve(
    case: Case,
    folder: RunFolder | None,
    progress: Progress,
    comm: MPI.Comm,
    resume: bool,
    force: bool,
    own: Own,
    scratch: RunFolder | None = None,
) -> RunResult:
    kind, _ = choose_model(case)
    model, rod = kind.elements(), kind.slender()
    if rod is not None:
        from fiberbend.running.slender.run import run_rod

        return run_rod(case, rod, folder, progress, comm, own, scratch)
    if model is None:
        from fiberbend.running.analytic import run_analytic

        return on_rank_0(comm, lambda: run_analytic(case, folder, progress, comm.size))
    if model.shared:
        whole = without_symmetry(case)
        # asked now: later the half body takes of the memory that is free
        leaves = case.mesh.symmetry == "auto" and model.half(case)[0]
        leaves = leaves and (force or fits(whole, comm, folder is not None))
        try:
            run = _Run(case, model, folder, progress, comm, comm.size, scratch, own, leaves)
            return run.go(resume)
        except _AcrossError:
            if run.states is not None:
                restart.discard(run.states)
            whole_own = own.also(messages.WHOLE)
            run = _Run(whole, model, folder, progress, comm, comm.size, scratch, whole_own)
            return run.go(False)
    # too small to share: one rank solves it
    if case.zones is not None:
        from fiberbend.running.zones.run import run_zones

        return run_zones(case, model, folder, progress, comm, own, scratch, resume)
    alone = _Run(case, model, folder, progress, MPI.COMM_SELF, comm.size, scratch, own)
    return on_rank_0(comm, lambda: alone.go(False))


class _Run:
    """The steps of one run of finite elements, and what they share; `ranks` wait for its end."""

    def __init__(
        self,
        case: Case,
        model: MeshedModel,
        folder: RunFolder | None,
        progress: Progress,
        comm: MPI.Comm,
        ranks: int,
        scratch: RunFolder | None = None,
        own: Own | None = None,
        may_leave: bool = False,
    ) -> None:
        self.case, self.model, self.folder = case, model, folder
        self.states, self.progress = folder or scratch, progress
        self.comm, self.ranks, self.may_leave = comm, ranks, may_leave
        self.own, self.solved = own or Own(), False
        self.recording: Recording | None = None
        self.run: dict[str, Any] = {}

    def go(self, again: bool) -> RunResult:
        """Mesh, compile, solve, write; stopped by a signal, leave run.json."""
        with self._stoppable():
            return self._go(again)

    def _go(self, again: bool) -> RunResult:
        progress, case = self.progress, self.case
        # before this run takes of the memory that is free
        known = doubts(case)
        progress.phase("mesh")
        mesh = on_rank_0(self.comm, lambda: self._mesh(again))
        section = self._section()
        progress.phase("compile")

        def make_guide(scene: Scene, frames: Frames) -> Guide | None:
            return section.guide(scene, frames, case.actuator.length) if section else None

        assembly = assemble(case, mesh, self.comm, make_guide, watch=True)
        recorder, recording = self._recording(assembly, again)
        if self.states is not None and assembly.parts.fibers is not None:
            write_fibers(self.states, assembly.parts.fibers, assembly.parts.smeared)
        recording.warn(self.own.remarks, silent=True)
        recording.warn(known)
        if again and not mesh.half and case.mesh.symmetry == "auto" and self.model.half(case)[0]:
            # killed in the whole body that stands for the half
            recording.warn([messages.WHOLE])
        progress.phase("solve")
        # the march keeps what it calls: in a cycle with it all matrices would outlive the run
        report = assembly.march.run(assembly.ramps, [weakref.proxy(recording)])
        recording.remark(report)
        if report.reason == ACROSS and mesh.half and self.may_leave:
            progress.message(messages.WHOLE)
            raise _AcrossError
        self.solved = True
        status, reason = ended(case, assembly, recorder.rows)
        self._warn_of_ends(status, assembly, recorder, recording)
        found = check.doubts() if (check := self._cross_check(recorder.rows, section)) else []
        recording.warn([*messages.pushed(report, recorder.rows), *found], silent=True)
        given = (status, recorder.rows, self.own.entries, _solve_beside, progress.phase)
        error, lacking = on_rank_0(self.comm, lambda: record.accuracy(case, *given))
        recording.warn(lacking, silent=True)
        progress.phase("output")
        recording.keep(LAST)
        last = (lambda: assembly.model_mesh(case), recording.last)
        strain, beyond = on_rank_0(self.comm, lambda: record.strain(case, *last))
        recording.warn(beyond, silent=True)
        rows = check.beside(recorder.rows) if check else recorder.rows
        run = record.entries(
            status,
            reason,
            self.model.name,
            record.counted(assembly, recording.warnings),
            self._wall(assembly),
            self.comm.allreduce(record.peak_memory_mb()),
            self.comm.size,
            kernels.versions(),
        )
        run |= record.of_effects(case, recorder.rows) | record.beside(check) | error
        run |= self.own.entries | strain
        if self.folder is not None:
            self.folder.write_history(rows)
            self.run = run
            self.folder.write_run(**run)
            if self.comm.rank == 0:
                why = f"{status}: {reason}" if reason else None
                self._draw(assembly, recording, why, rows, check)
                self._close(run, assembly, recording)
                if case.output.report:
                    progress.phase("report")
                    write_page(self.folder, case, rows, run, lambda text: recording.warn([text]))
                    self._close(run, assembly, recording)
        self.comm.barrier()
        self._report(run, rows)
        return RunResult(status, reason, rows, run, self.folder.path if self.folder else None)

    @contextlib.contextmanager
    def _stoppable(self) -> Iterator[None]:
        try:
            yield
        except KeyboardInterrupt as error:
            self._stopped(stop := stop_of(error))
            raise stop from None
        except RefusedError as error:
            rows = self.recording.rows if self.recording else []
            known = (rows, self.progress.wall_s, self.ranks)
            raise record.refused(self.folder, self.model.name, *known, error) from None

    def _stopped(self, stop: Interrupted) -> None:
        """Say what is kept, and leave it in run.json: by the rank that still can."""
        folder = self.folder
        if folder is None:
            return
        rows, kept = (self.recording.rows, self.recording.kept) if self.recording else ([], 0)
        kept = len(rows) - 1 if self.solved else kept
        stop.reason = messages.interrupted(rows, kept, self.solved)
        stop.together = self.ranks == 1 or launch.all_stopped()
        if folder.writes or not stop.together:
            known = (rows[: kept + 1] if kept else rows, self.progress.wall_s, self.ranks)
            run = record.unfinished("interrupted", stop.reason, self.model.name, *known)
            own = RunFolder(folder.path)
            if self.solved and not self.run:
                own.write_history(rows)
            own.write_run(**{**run, **self.run, "status": run["status"], "reason": stop.reason})
            self.progress.log(f"interrupted: {stop.reason}")

    # --- before the march ----------------------------------------------------------------------

    def _mesh(self, again: bool) -> MeshData:
        folder = self.folder
        if folder is None:
            mesh = self.model.mesh(self.case, None)
            if self.states is not None:
                self.states.write(MESH, mesh.save)
            return mesh
        if again and (kept := restart.mesh(folder)) is not None:
            return kept
        with tempfile.TemporaryDirectory() as scratch:
            # where a mesher whose run is killed may go on
            own = Path(scratch) / GMSH_FILE
            mesh = self.model.mesh(self.case, own)
            if own.exists():
                folder.write(GMSH_FILE, lambda target: target.write(own.read_bytes()))
        folder.write(MESH, mesh.save)
        return mesh

    def _section(self) -> SectionStates | None:
        """The section's states that guide a body, solved on rank 0; collective."""
        if not (self.model.ends and section_guides(self.case)):
            return None
        self.progress.phase("section")
        return on_rank_0(self.comm, lambda: section_states(self.case))

    def _recording(self, assembly: Assembly, again: bool) -> tuple[Recorder, Recording]:
        """The rows and what listens to the march, which goes on where the checkpoint is."""
        march, observables = assembly.march, assembly.observables
        archive, gauge = Archive(assembly.scene, observables.frames), observables.gauge()
        saved = None
        if again and self.folder:
            saved = restart.load(self.folder, archive, self.progress.message)
        if saved is not None:
            march.resume(saved.position)
        rows = None if saved is None else saved.rows
        recorder = Recorder(assembly.scene, gauge, self.model, march.rest, rows)
        recording = self.recording = Recording(
            self.case,
            assembly,
            archive,
            recorder,
            self.folder,
            self.progress,
            self.model,
            self.states if self.folder is None or shows_states(self.case.output) else None,
            () if saved is None else saved.snapshots,
        )
        if again:
            recording.warn([] if saved is None else saved.warnings)
            recording.remark(march.report)
            self.progress.message(f"resumed after step {recorder.rows[-1][col.STEP]}")
        return recorder, recording

    # --- after the march -----------------------------------------------------------------------

    def _warn_of_ends(
        self, status: str, assembly: Assembly, recorder: Recorder, recording: Recording
    ) -> None:
        """Warn of what only a whole history shows: jumps, what is missed, and an unstable end."""
        jumps, rows = recorder.integrate(), recorder.rows
        lines = [messages.jumped(rows[step - 1], rows[step]) for step in jumps]
        lines += unmet(self.case, assembly, rows)
        if status == "converged" and rows[-1].get(col.MODES):
            lines.append(messages.UNSTABLE_END)
        lines += record.doubts(self.case, rows)
        if assembly.scene.domain.data.half and assembly.scene.free_opposite is None:
            lines += messages.uncounted(assembly.ramps, rows)
        # the answer, which follows, has them
        recording.warn(lines, silent=True)

    def _cross_check(
        self, rows: list[dict[str, Any]], section: SectionStates | None
    ) -> Check | None:
        """The run beside the section model and the closed forms; only for a run with a folder."""
        if self.folder is None:
            return None
        from fiberbend.compare.beside import check_run

        self.progress.phase("crosscheck")
        given = (rows, _solve_beside, None if section is None else section.bending)
        return on_rank_0(self.comm, lambda: check_run(self.case, self.model, *given))

    def _close(self, run: dict[str, Any], assembly: Assembly, recording: Recording) -> None:
        """Write how long the last phase took, and what it warned of; on the rank that writes."""
        assert self.folder is not None
        self.progress.close()
        run |= {"wall_s": self._wall(assembly), "warnings": list(recording.warnings)}
        self.folder.write_run(**run)

    def _wall(self, assembly: Assembly) -> dict[str, float]:
        seconds = {name: round(value, 3) for name, value in self.progress.wall_s.items()}
        return seconds | {f"solve/{k}": round(v, 3) for k, v in assembly.newton.seconds.items()}

    def _report(self, run: dict[str, Any], rows: list[dict[str, Any]]) -> None:
        """Report the cost of the run, and what it answers."""
        for line in record.cost(run):
            self.progress.detail(line)
        self.progress.answer(answer(self.case, rows, run))

    def _draw(
        self,
        assembly: Assembly,
        recording: Recording,
        reason: str | None,
        rows: list[dict[str, Any]],
        check: Check | None,
    ) -> None:
        """Fields, pictures and plots, on rank 0."""
        assert self.folder is not None
        mesh, shots = assembly.model_mesh(self.case), recording.snapshots
        beside = (lambda text: recording.warn([text]), check, self.model.name)
        draw(self.folder, self.case, mesh, shots, rows, reason, *beside)
