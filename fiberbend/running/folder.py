"""The folder of one run: every file is whole at any moment, also when the run is killed."""

from __future__ import annotations

import csv
import io
import json
import os
import shutil
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import yaml

from fiberbend import columns as col
from fiberbend.case.case import Case
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
)
"""Keys that run.json always has; scripts rely on them."""

CASE_FILE = "case.resolved.yaml"
RUN_FILE = "run.json"
HISTORY_FILE = "history.csv"
CHECKPOINT = "checkpoint.npz"


class RunFolder:
    """Files of one run. Only rank 0 writes; on the other ranks every write does nothing.

    Attributes:
        path: the folder.
        writes: True on the rank that writes.
    """

    def __init__(self, path: Path, writes: bool = True) -> None:
        self.path = path
        self.writes = writes

    @classmethod
    def create(cls, path: Path, case: Case, overwrite: bool = False, comm: Any = None) -> RunFolder:
        """Make a new folder with the resolved case; rank 0 decides and all ranks agree.

        Args:
            path: where.
            case: the case that is run.
            overwrite: replace a run that is there; a folder without a run is never replaced.
            comm: an mpi4py communicator, or None for one process.

        Raises:
            CaseError: on every rank, if the folder is there or cannot be made.
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
            CaseError: on every rank, if there is no run, or it is a run of another case; names
                the fields that differ.
        """
        return cls._agreed(path, lambda: _same_case(path, case), comm)

    @classmethod
    def _agreed(cls, path: Path, action: Callable[[], None], comm: Any) -> RunFolder:
        writes = comm is None or comm.rank == 0
        error: CaseError | None = None
        if writes:
            try:
                action()
            except CaseError as problem:
                error = problem
            except OSError as problem:
                error = CaseError([Problem(str(path), f"{problem.strerror}, expected a folder")])
        if comm is not None:
            error = comm.bcast(error)
        if error is not None:
            raise error
        return cls(path, writes)

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

    def write(self, name: str, fill: Callable[[IO[bytes]], object]) -> None:
        """Write a file under another name first, so that no reader ever sees half of it.

        Args:
            name: path within the folder.
            fill: writes the content.
        """
        if not self.writes:
            return
        target = self.path / name
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, part = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                fill(file)
                file.flush()
                os.fsync(file.fileno())
            # mkstemp makes files that only their owner can read.
            os.chmod(part, 0o666 & ~_umask())
            os.replace(part, target)
        except BaseException:
            Path(part).unlink(missing_ok=True)
            raise


def read_history(path: Path) -> list[dict[str, float | None]]:
    """The rows of a history.csv; empty cells are None."""
    with path.open(newline="", encoding="utf-8") as file:
        return [
            {key: float(value) if value else None for key, value in row.items()}
            for row in csv.DictReader(file)
        ]


def _make(path: Path, case: Case, overwrite: bool) -> None:
    if path.exists():
        if not overwrite:
            raise CaseError(
                [Problem(str(path), "exists, expected a new folder, or --overwrite or --resume")]
            )
        if not path.is_dir():
            raise CaseError([Problem(str(path), "is a file, expected a folder")])
        if any(path.iterdir()) and not (path / CASE_FILE).exists():
            raise CaseError([Problem(str(path), "contains no run, expected the folder of a run")])
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{path.name}.", dir=path.parent) as scratch:
        fresh = Path(scratch) / path.name
        fresh.mkdir()
        RunFolder(fresh).write_case(case)
        if path.exists():
            shutil.rmtree(path)
        fresh.rename(path)


def _same_case(path: Path, case: Case) -> None:
    from fiberbend.reader.yaml_file import load_yaml

    if not (path / CASE_FILE).exists():
        raise CaseError([Problem(str(path), f"contains no {CASE_FILE}, expected a run to resume")])
    before, now = load_yaml(path / CASE_FILE), case.resolved()
    changed = differences(before, now)
    if changed:
        raise CaseError(
            Problem(field, f"{found(new)}, expected {found(old)} as in {path}")
            for field in changed
            for new, old in [(value_at(now, field), value_at(before, field))]
        )


def _cell(value: Any) -> Any:
    return "" if value is None else value


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else str(value)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
