"""The folder of one run: every file is whole at any moment, also when the run is killed."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import yaml

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.process import remains, signals
from fiberbend.process.lock import FolderLock, HeldError, holder
from fiberbend.schema.paths import differences, value_at
from fiberbend.schema.problems import CaseError, Problem, found

HISTORY_COLUMNS = tuple(column.name for column in col.COLUMNS if column.always)
"""First columns of history.csv, in this order; scripts rely on them."""

RUN_KEYS = (
    "status",
    "reason",
    "model",
    "unknowns",
    "load_steps",
    "newton_iterations",
    "cutbacks",
    "wall_s",
    "peak_memory_MB",
    "ranks",
    "versions",
    "command",
    "commit",
    "machine",
    "blas",
)
"""Keys that run.json always has; scripts rely on them."""

CASE_FILE = "case.resolved.yaml"
RUN_FILE = "run.json"
HISTORY_FILE = "history.csv"
MESH = "mesh.npz"
FIBERS = "fibers.npz"
"""The winding on the mesh, for who draws a run that is done."""
SNAPSHOTS = "snapshots"
REPORT = "report.html"
"""The page with answer, curves and the body in space."""
TABLE = "sweep.csv"
"""By this file a folder is that of a sweep."""
ABOUT_SWEEP = "sweep.json"
TRENDS = "trends.md"
POINTS = "points"
"""Folder of a sweep with the run folders of its points."""
LOG = "run.log"
"""What the run has said, a line at a time."""
CHECKPOINT = "checkpoint.npz"
CHECKPOINT_BEFORE = "checkpoint.before.npz"
"""The one before the last, for when that cannot be read."""
ZONES = "zones"
"""Folder of a run over zones with a file of each that is solved."""
LADDER = "accuracy.json"
"""By this file a folder is that of a ladder of accuracy; what it has found."""
RUNGS = "rungs"
"""Folder of a ladder with a file of each rung."""
DESIGN = "design.json"
"""By this file a folder is that of a design; what it has found."""
HAND = "hand.resolved.yaml"
"""By this file a folder is that of a hand: the hand with the resolved case of every finger."""
BLOCKED = "blocked"
"""Folder within that of a sweep's point with the same body kept straight."""

_OF_A_RUN = (
    *(CASE_FILE, RUN_FILE, HISTORY_FILE, MESH, CHECKPOINT, CHECKPOINT_BEFORE, "actuator.msh"),
    *("error.log", "error.rank*.log", f"{SNAPSHOTS}/*.npz", f"{ZONES}/*.npz"),
    *(FIBERS, LOG, REPORT),
    *("fields/*.vtu", "fields/*.vtp", "fields/*.vtm", "fields/*.pvd"),
    *("pictures/rest.png", "pictures/animation.gif", "pictures/animation.mp4"),
    *("pictures/undeformed.png", "pictures/cut.png", "pictures/montage.png", "pictures/bent*.png"),
    *("pictures/pressure_*.png", "pictures/tip_*.png", "pictures/contact_*.png"),
    *("pictures/over_time.png", "pictures/modes.png"),
    *("pictures/section_*.png", "pictures/cell_*.png", "pictures/fiber_*.png"),
)
_OF_A_SWEEP = (TABLE, ABOUT_SWEEP, TRENDS, "maps/*.png", REPORT)
_OF_CONTROL = ("control.json", "control.csv", "control.png", "filter.csv", "angle_filter.h")
_OF_A_LADDER = (LADDER, f"{RUNGS}/*.json", *(f"accuracy.{end}" for end in ("csv", "md", "png")))
_OF_A_DESIGN = (
    *(DESIGN, "winner.yaml", "winner_blocked.yaml", "winner_by_angle.yaml", "nearest.yaml"),
    *("tries.csv", "sensitivity.csv", "front.csv"),
    *("design_*.png", REPORT),
)
_OF_A_HAND = (HAND, "pictures/hand_*.png")
FILES = (
    *_OF_A_RUN,
    *(f"{BLOCKED}/{name}" for name in _OF_A_RUN),
    *_OF_A_SWEEP,
    *_OF_CONTROL,
    *_OF_A_LADDER,
    *_OF_A_DESIGN,
    *_OF_A_HAND,
)
"""What is written: no other name can be, and `overwrite` removes nothing else."""

_HELD = "{}, expected its end, or another folder by --out"
_EXISTS = "exists, expected a new folder, or --overwrite or --resume"


def checkpoints(path: Path) -> list[Path]:
    """Files in a run folder from which a run of the same case goes on."""
    steps = (path / name for name in (CHECKPOINT, CHECKPOINT_BEFORE))
    return [*filter(Path.exists, steps), *sorted(path.glob(f"{ZONES}/*.npz"))]


class FolderHeldError(CaseError):
    """Another process runs in a folder."""


class RunFolder:
    """Files of one run. Only rank 0 writes; on the other ranks every write does nothing.

    What `create` and `resume` return holds the folder until it is closed, so that no other process
    runs there.

    Args:
        path: the folder.
        writes: this rank writes.
        lock: on the folder, or None.
        durable: a file that is written stays also where the power goes out.

    Attributes:
        path: the folder.
        writes: True on the rank that writes.
    """

    def __init__(
        self,
        path: Path,
        writes: bool = True,
        lock: FolderLock | None = None,
        durable: bool = True,
    ) -> None:
        self.path = path
        self.writes = writes
        self._lock, self._durable = lock, durable

    def __enter__(self) -> RunFolder:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let other processes have the folder."""
        if self._lock is not None:
            self._lock.release()

    @classmethod
    def create(cls, path: Path, case: Case, overwrite: bool = False, comm: Any = None) -> RunFolder:
        """Make a new folder with the resolved case; rank 0 decides and all ranks agree.

        Args:
            path: where.
            case: the case that is run.
            overwrite: replace a run that is there: its files, and nothing else in the folder; a
                folder without a run is left as it is.
            comm: an mpi4py communicator, or None for one process.

        Raises:
            CaseError: on every rank, if the folder is there with something in it, is held by
                another process or cannot be made.
        """
        return cls._agreed(path, lambda: _make(path, case, overwrite), comm)

    @classmethod
    def resume(cls, path: Path, case: Case, comm: Any = None) -> RunFolder:
        """Open the folder of a run that was interrupted.

        Args:
            path: the folder.
            case: the case that is run, equal to that of the folder.
            comm: an mpi4py communicator, or None for one process.

        Raises:
            CaseError: on every rank, if there is no run, another process holds it, or it is a run
                of another case; names the fields that differ.
        """
        return cls._agreed(path, lambda: _same_case(path, case), comm)

    @classmethod
    def _agreed(cls, path: Path, action: Callable[[], FolderLock], comm: Any) -> RunFolder:
        writes = comm is None or comm.rank == 0
        error: CaseError | None = None
        lock: FolderLock | None = None
        if writes:
            try:
                lock = action()
            except CaseError as problem:
                error = problem
            except OSError as problem:
                error = CaseError([Problem(str(path), f"{problem.strerror}, expected a folder")])
        if comm is not None:
            error = comm.bcast(error)
        if error is not None:
            raise error
        return cls(path, writes, lock)

    def write_text(self, name: str, text: str) -> None:
        """Write a text file."""
        self.write(name, lambda file: file.write(text.encode()))

    def write_json(self, name: str, data: Mapping[str, Any]) -> None:
        """Write a JSON file."""
        self.write_text(name, json.dumps(data, indent=2, default=_plain) + "\n")

    def write_arrays(self, name: str, **arrays: Any) -> None:
        """Write an .npz file."""
        import numpy as np

        self.write(name, lambda file: np.savez(file, **arrays))

    def write_case(self, case: Case) -> None:
        """Write the case with every default, readable as a case file."""
        self.write_text(
            CASE_FILE, yaml.safe_dump(case.resolved(), sort_keys=False, allow_unicode=True)
        )

    def write_history(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Write history.csv: one row per step, columns beyond `HISTORY_COLUMNS` in row order.

        Numbers have ten significant digits.

        Args:
            rows: all steps so far; what a row does not have stays empty.

        Raises:
            KeyError: a column that the table of columns does not have.
        """
        columns = list(dict.fromkeys([*HISTORY_COLUMNS, *(key for row in rows for key in row)]))
        for key in columns:
            col.column(key)
        text = io.StringIO()
        writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: _cell(value) for key, value in row.items()} for row in rows)
        self.write_text(HISTORY_FILE, text.getvalue())

    def write_run(self, **entries: Any) -> None:
        """Write run.json; keys of `RUN_KEYS` that are not given are null."""
        self.write_json(RUN_FILE, {**dict.fromkeys(RUN_KEYS), **entries})

    def remove(self, name: str) -> None:
        """Remove a file, if it is there."""
        if self.writes:
            (self.path / name).unlink(missing_ok=True)

    def replace(self, name: str, other: str) -> None:
        """Rename a file, if it is there."""
        if self.writes:
            with contextlib.suppress(FileNotFoundError):
                os.replace(self.path / name, self.path / other)

    def log(self, text: str) -> None:
        """Append lines to the log, which a kill leaves readable.

        A log that cannot be written costs itself, not the results.

        Args:
            text: whole lines.
        """
        if not self.writes:
            return
        with contextlib.suppress(OSError), (self.path / LOG).open("ab") as file:
            file.write(text.encode())

    def write(self, name: str, fill: Callable[[IO[bytes]], object]) -> None:
        """Write a file under another name first, so that no reader ever sees half of it.

        Args:
            name: path within the folder.
            fill: writes the content.

        Raises:
            ValueError: a name that `FILES` does not have.
        """
        if not remains.matches(name, FILES):
            raise ValueError(f"{name} is no file of a run, expected one of results.folder.FILES")
        if not self.writes:
            return
        target = self.path / name
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, part = remains.begin(target)
        try:
            # an archive left half made prints a page when it is collected
            whole = signals.held() if name.endswith(".npz") else contextlib.nullcontext()
            with os.fdopen(handle, "wb") as file:
                with whole:
                    fill(file)
                if self._durable:
                    file.flush()
                    os.fsync(file.fileno())
            remains.let_others_read(part)
            os.replace(part, target)
        except BaseException:
            Path(part).unlink(missing_ok=True)
            raise


def _make(path: Path, case: Case, overwrite: bool) -> FolderLock:
    there = path.exists()
    if there:
        _check(path, overwrite)
    path.mkdir(parents=True, exist_ok=True)
    lock = _hold(path)
    try:
        remains.clear(path, CASE_FILE, FILES)
        if not overwrite:
            # another process may have been quicker
            _check(path, overwrite)
        with remains.aside(path, CASE_FILE, FILES):
            RunFolder(path).write_case(case)
    except BaseException:
        lock.release()
        if not there:
            with contextlib.suppress(OSError):
                path.rmdir()
        raise
    return lock


def _check(path: Path, overwrite: bool) -> None:
    """Whether a run may begin in a folder that is there; an empty one is as good as a new one."""
    if not path.is_dir():
        raise CaseError([Problem(str(path), "is a file, expected a folder")])
    entries = remains.entries(path)
    if not entries:
        return
    if not overwrite:
        who = holder(path)
        text = _HELD.format(who) if who else _EXISTS
        raise CaseError([Problem(str(path), text)])
    if not _is_run(path, entries):
        raise CaseError([Problem(str(path), "contains no run, expected the folder of a run")])


def _is_run(path: Path, entries: Sequence[str]) -> bool:
    """Whether there is a run, one that was being replaced, or one that a sweep could not begin."""
    kept = (path / CASE_FILE).exists() or (path / remains.ASIDE).exists()
    return kept or (RUN_FILE in entries and {*entries} <= {RUN_FILE, "error.log"})


def _hold(path: Path) -> FolderLock:
    try:
        return FolderLock(path)
    except HeldError as error:
        raise FolderHeldError([Problem(str(path), _HELD.format(error))]) from None


def _same_case(path: Path, case: Case) -> FolderLock:
    from fiberbend.reader.yaml_file import load_yaml

    nothing = Problem(str(path), f"contains no {CASE_FILE}, expected a run to resume")
    if not path.is_dir():
        raise CaseError([nothing])
    begun = (path / remains.ASIDE).exists() or not remains.entries(path)
    if not begun and not (path / CASE_FILE).exists():
        raise CaseError([nothing])
    lock = _hold(path)
    try:
        remains.clear(path, CASE_FILE, FILES)
        if not (path / CASE_FILE).exists():
            # killed before it had written its case
            RunFolder(path).write_case(case)
        before, now = load_yaml(path / CASE_FILE), case.resolved()
        changed = differences(before, now)
        if changed:
            raise CaseError(
                Problem(field, f"{found(new)}, expected {found(old)} as in {path}")
                for field in changed
                for new, old in [(value_at(now, field), value_at(before, field))]
            )
    except BaseException:
        lock.release()
        raise
    return lock


def _cell(value: Any) -> str:
    return "" if value is None else f"{value:.10g}"


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else str(value)
