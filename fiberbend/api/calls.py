"""The functions of `import fiberbend`."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import os
import shutil
import tempfile
import threading
import weakref
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fiberbend.api.loading import load
from fiberbend.api.result import Result
from fiberbend.api.sweep import Sweep
from fiberbend.case.case import Case
from fiberbend.reader.reader import as_case
from fiberbend.schema.problems import CaseError, Problem, found

if TYPE_CHECKING:
    from fiberbend.models.result import RunResult
    from fiberbend.plan.plan import Plan

TURN = threading.RLock()
"""Held by the call that solves: MPI and PETSc serve one at a time, threads take turns."""
AnyCase = Case | Mapping[str, Any] | Path | str
"""A checked case, a mapping as its YAML gives it, or the path of a case file."""
Settings = Iterable[str] | Mapping[str, Any]
"""Changes to a case: "actuator.wall=3 mm" each, or values by their dotted paths."""


def run(
    case: AnyCase,
    out: Path | str | None = None,
    overwrite: bool = False,
    quiet: bool = True,
    force: bool = False,
    *,
    settings: Settings = (),
    resume: bool = False,
    states: bool = True,
) -> Result:
    """Solve a case; under mpirun with all ranks together.

    It may be called in a notebook, in a running event loop and in a thread; calls in several
    threads follow one another.

    Args:
        case: a case, a mapping as its YAML gives it, or the path of a case file.
        out: run folder. Without one there are no pictures, no report and no comparison with other
            models, and `Result.mesh` reads the states from a temporary folder, which is removed
            with the result.
        overwrite: replace an earlier run in `out`.
        quiet: report no progress; else there are lines, or a bar on a terminal and in a notebook.
        force: run whether the memory that it is expected to need is free or not.
        settings: changes to the case, such as `["actuator.wall=3 mm"]` or
            `{"actuator.wall": "3 mm"}`.
        resume: go on with an interrupted run in `out`.
        states: keep the states of a run without `out`; some 50 bytes for a node and load step.

    Returns:
        What was computed; look at its `status` and `reason`: a run that failed or stopped early
        is returned too.

    Raises:
        CaseError: everything that is wrong with the case or the folder, or not enough memory.
    """
    from fiberbend.running import launch
    from fiberbend.running.progress import Progress

    checked = as_case(case, settings)
    if overwrite and resume:
        raise CaseError([Problem("run", "overwrite and resume together, expected one of them")])
    if resume and out is None:
        raise CaseError([Problem("out", "nothing, expected the folder of a run to resume")])
    with TURN, contextlib.closing(Progress(quiet=quiet)) as progress:
        launch.start_mpi()
        from fiberbend.running.runner import run_case

        if out is not None:
            done = run_case(checked, Path(out), overwrite, progress, resume, force)
            return _result(done, checked, done.folder)
        if not states:
            return _result(run_case(checked, None, progress=progress, force=force), checked, None)
        with _Scratch() as scratch:
            path = scratch.path
            done = run_case(checked, None, progress=progress, force=force, states=path)
            return scratch.given_to(_result(done, checked, scratch.own()))


def validate(case: AnyCase, *, settings: Settings = ()) -> Case:
    """Check a case.

    Args:
        case: a case, a mapping as its YAML gives it, or the path of a case file.
        settings: changes to it, as of `run`.

    Returns:
        The checked case, with every default in it.

    Raises:
        CaseError: everything that is wrong with it, a problem a line.
    """
    return as_case(case, settings)


def plan(case: AnyCase, *, settings: Settings = ()) -> Plan:
    """What a run would do and cost; nothing is solved.

    Args:
        case: a case, a mapping as its YAML gives it, or the path of a case file.
        settings: changes to it, as of `run`.

    Returns:
        Model, unknowns, load steps, time, memory, errors and warnings; it prints as the command
        `fiberbend plan` does.

    Raises:
        CaseError: everything that is wrong with the case.
    """
    from fiberbend.plan.plan import make_plan

    return make_plan(as_case(case, settings))


def sweep(
    file: Mapping[str, Any] | Path | str,
    out: Path | str,
    jobs: int | None = None,
    *,
    settings: Iterable[str] = (),
    retry: bool = False,
    force: bool = False,
    quiet: bool = True,
) -> Sweep:
    """Solve a case at many points; what is finished in the folder already is not solved again.

    Args:
        file: a sweep file, or a mapping as its YAML gives it; files that a mapping names are
            relative to the working folder.
        out: folder of the sweep.
        jobs: processes that solve at once, one unless given; under mpirun all ranks but one.
        settings: changes to the base case, "actuator.floor=3 mm" each.
        retry: run failed points again.
        force: run whether there is enough memory or not.
        quiet: report no progress.

    Returns:
        The table and the runs; points that failed are in them.

    Raises:
        CaseError: the file or a point is wrong, the folder cannot be used, or there is not enough
            memory.
        KeyboardInterrupt: it was interrupted; the same call goes on where it was.
    """
    from fiberbend.sweep.command import run_sweep

    given = jobs is not None
    if given and (isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1):
        raise CaseError([Problem("jobs", f"{found(jobs)}, expected a whole number from 1 on")])
    with TURN, _as_file(file) as path:
        code = run_sweep(
            path, Path(out), list(settings), jobs, retry, force, say=_silent if quiet else print
        )
    if code > 128:
        raise KeyboardInterrupt
    loaded = load(out)
    assert isinstance(loaded, Sweep)
    return loaded


def _silent(_line: str) -> None:
    """Say nothing."""


def _result(done: RunResult, case: Case, kept_in: Path | None) -> Result:
    return Result(
        status=done.status,
        reason=done.reason,
        rows=done.rows,
        run=done.run,
        folder=done.folder,
        case=case,
        kept_in=kept_in,
    )


class _Scratch:
    """A temporary folder with the states of a run, one for each rank that can see them.

    Rank 0 writes. Each other rank then links the files into a folder of its own, so that no rank
    waits for another one before it removes its own.
    """

    def __init__(self) -> None:
        from mpi4py import MPI

        self._comm = MPI.COMM_WORLD
        own = tempfile.mkdtemp(prefix="fiberbend-") if self._comm.rank == 0 else ""
        self._written = self._comm.bcast(own)
        self._own = Path(own) if own else None
        self._kept = False

    @property
    def path(self) -> Path:
        """Where rank 0 writes."""
        return Path(self._written)

    def __enter__(self) -> _Scratch:
        return self

    def __exit__(self, *_: object) -> None:
        if self._own is not None and not self._kept:
            _remove(self._own, os.getpid())

    def own(self) -> Path | None:
        """This rank's folder, now that all states are written; None on another machine; collective.

        Of a path that the writer's machine alone has, other ranks see nothing.
        """
        if self._own is None and self.path.is_dir():
            self._own = Path(tempfile.mkdtemp(prefix="fiberbend-"))
            shutil.copytree(self.path, self._own, copy_function=_link, dirs_exist_ok=True)
        self._comm.barrier()
        return self._own

    def given_to(self, result: Result) -> Result:
        """Let the folder go with a result."""
        if self._own is not None:
            weakref.finalize(result, _remove, self._own, os.getpid())
        self._kept = True
        return result


def _link(source: str, target: str) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)


def _remove(path: Path, process: int) -> None:
    """Remove a temporary folder, not from a process that was forked off."""
    if os.getpid() == process:
        shutil.rmtree(path, ignore_errors=True)


@contextlib.contextmanager
def _as_file(file: Mapping[str, Any] | Path | str) -> Iterator[Path]:
    """A sweep as a file; problems of a mapping have no lines."""
    if isinstance(file, (str, Path)):
        yield Path(file)
        return
    if not isinstance(file, Mapping):
        wanted = "expected a mapping or the path of a sweep file"
        raise CaseError([Problem("sweep", f"{found(file)}, {wanted}")])
    import yaml

    from fiberbend.reader.own_files import root_paths

    data = dict(file)
    base = data.get("case")
    if isinstance(base, str):
        data["case"] = str(Path(base).resolve())
    elif isinstance(base, Mapping):
        base = copy.deepcopy(dict(base))
        root_paths(base, Path())
        data["case"] = base
    data |= _rooted(data)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sweep.yaml"
        path.write_text(yaml.safe_dump(data, sort_keys=False, allow_unicode=True), encoding="utf-8")
        try:
            yield path
        except CaseError as error:
            raise CaseError(dataclasses.replace(p, line=None) for p in error.problems) from None


def _rooted(sweep: Mapping[str, Any]) -> dict[str, Any]:
    """Changes of a sweep whose own files of materials are seen from the working folder."""
    from fiberbend.reader.own_files import rooted_value, rooted_values

    found: dict[str, Any] = {}
    for part, rooted in (("set", rooted_value), ("vary", rooted_values), ("zip", rooted_values)):
        changes = sweep.get(part)
        if isinstance(changes, Mapping):
            found[part] = {key: rooted(str(key), value, Path()) for key, value in changes.items()}
    points = sweep.get("points")
    if isinstance(points, list | tuple):
        found["points"] = [
            {key: rooted_value(str(key), value, Path()) for key, value in point.items()}
            if isinstance(point, Mapping)
            else point
            for point in points
        ]
    return found
