"""What is kept of a solved rung: one JSON file, and whether it still counts."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
from pathlib import Path
from typing import Any

from fiberbend.ladder.rungs import Rung
from fiberbend.process.lock import FolderLock, HeldError
from fiberbend.results.folder import LADDER, RUNGS, RunFolder
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.version import __version__
from machine import origin

FAILED = "failed"
"""Status of a rung without an answer."""
LATE = "late"
"""Status of a rung that was stopped by its limit of time; it is not kept."""

_BUSY, _SLACK = 1.3, 1.0
"""Wall over processor time, and seconds more, that an idle machine does not take."""


@dataclasses.dataclass(frozen=True)
class Record:
    """A rung that was solved.

    Attributes:
        name: of the rung.
        family: model, winding, element and half.
        mesh: `section` and `axial_mm` as the case has them; only what the model uses.
        unknowns: displacements and pressures.
        values: what the case asks for, by the names of its columns; what was not reached is absent.
        status: 'converged', 'stopped' or 'failed'; 'late' before it is kept.
        reason: why not converged.
        wall_s: of the whole process, s, with what is done once and was kept before.
        cpu_s: processor time of the whole process and of those it started, s; likewise.
        once_s: part of both that is done once for many runs and kept: the calibration of a winding.
        solve_wall_s: of the load steps alone, s.
        solve_cpu_s: processor time of the load steps alone, s.
        load_steps: how many.
        iterations: of Newton's method.
        peak_memory_MB: greatest memory of the process.
        key: what the record holds for: case, program, machine.
        provenance: command, commit, machine and BLAS in full.
    """

    name: str
    family: dict[str, Any]
    mesh: dict[str, float]
    unknowns: int
    values: dict[str, float]
    status: str
    reason: str
    wall_s: float
    cpu_s: float
    once_s: float
    solve_wall_s: float
    solve_cpu_s: float
    load_steps: int
    iterations: int
    peak_memory_MB: float
    key: dict[str, str]
    provenance: dict[str, Any]

    @property
    def waited(self) -> bool:
        """It waited for the processor, as where other programs run: its times are not its own."""
        return self.wall_s > _BUSY * self.cpu_s + _SLACK

    @classmethod
    def of(cls, data: Any) -> Record:
        """A record from what a file has.

        Raises:
            ValueError: it is none.
        """
        names = {field.name for field in dataclasses.fields(cls)}
        if not isinstance(data, dict) or data.keys() != names:
            raise ValueError("no record of a rung")
        numbers = [
            data["wall_s"],
            data["cpu_s"],
            data["once_s"],
            data["peak_memory_MB"],
            *_values(data),
        ]
        if not all(isinstance(value, int | float) and math.isfinite(value) for value in numbers):
            raise ValueError("a number that is none")
        return cls(**data)


def _values(data: dict[str, Any]) -> list[Any]:
    values = data["values"]
    if not isinstance(values, dict):
        raise ValueError("no values")
    return list(values.values())


@functools.cache
def _commit() -> str:
    """The commit with which this process began, whatever is checked out meanwhile."""
    return origin.commit(Path(__file__).resolve().parents[2]) or ""


def key_of(rung: Rung) -> dict[str, str]:
    """What a record of a rung holds for: case, the program's version and commit, machine."""
    machine = origin.machine()
    return {
        "case": rung.digest,
        "version": __version__,
        "commit": _commit(),
        "machine": f"{machine['processor']}, {machine['usable_cores']} cores",
    }


def find(folder: Path, rung: Rung) -> Record | None:
    """The record of a rung in a ladder's folder that still holds; None where there is none.

    A file that is damaged, or of another case, program or machine, is as good as none.
    """
    record = _read(folder, rung)
    return record if record is not None and record.key == key_of(rung) else None


def _read(folder: Path, rung: Rung) -> Record | None:
    """The record of a rung, whatever it holds for."""
    try:
        text = (folder / RUNGS / f"{rung.name}.json").read_text(encoding="utf-8")
        return Record.of(json.loads(text))
    except (OSError, ValueError, TypeError):
        return None


class Store:
    """The folder of a ladder, held while it is open.

    Args:
        path: the folder.

    Raises:
        CaseError: something else is in it, another process holds it, or it cannot be made.
    """

    def __init__(self, path: Path) -> None:
        strange = CaseError(
            [Problem(str(path), "contains no ladder, expected a new folder or that of a ladder")]
        )
        try:
            there = path.exists()
            if there and not (path / RUNGS).is_dir() and any(path.iterdir()):
                raise strange
            (path / RUNGS).mkdir(parents=True, exist_ok=True)
            self._lock = FolderLock(path)
        except HeldError as error:
            text = f"{error}, expected its end, or another folder by --out"
            raise CaseError([Problem(str(path), text)]) from None
        except OSError as error:
            raise CaseError([Problem(str(path), f"{error.strerror}, expected a folder")]) from None
        self.path, self.folder = path, RunFolder(path)

    def close(self) -> None:
        """Let other processes have the folder."""
        self._lock.release()

    def find(self, rung: Rung) -> Record | None:
        """The record of a rung that still holds; None where it is to be solved (again)."""
        return find(self.path, rung)

    def outdated(self, rung: Rung) -> tuple[str, ...]:
        """In what a record of the rung differs from what would be solved now; empty without one.

        Names of `key_of`: case, version, commit, machine.
        """
        record = _read(self.path, rung)
        if record is None:
            return ()
        now = key_of(rung)
        return tuple(name for name in now if record.key.get(name) != now[name])

    def keep(self, record: Record) -> None:
        """Write a record, whole or not at all."""
        self.folder.write_json(f"{RUNGS}/{record.name}.json", dataclasses.asdict(record))

    def conclude(self, found: dict[str, Any]) -> None:
        """Write what the ladder has found."""
        self.folder.write_json(LADDER, found)
