"""The folder of a sweep: which points are finished, and who solves which.

A point is finished when its run.json has the digest of its case; that is written last. A point
is claimed by a lock on a file of its own, which the system releases when the process ends, however
it ends. Lock files stay: two processes could otherwise lock two files of the same name.
"""

from __future__ import annotations

import contextlib
import fcntl
import gc
import json
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fiberbend.case.case import Case
from fiberbend.results.folder import (
    BLOCKED,
    CHECKPOINT,
    CHECKPOINT_BEFORE,
    HISTORY_FILE,
    POINTS,
    RUN_FILE,
    RunFolder,
)
from fiberbend.results.reading import read_history
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sweep.points import Point

MARK = "sweep"
"""Key of run.json under which a finished point stands."""
NOT_RUN = "not run"
"""Status in the table of a point without a result."""
_LOCKS = ".locks"


class Store:
    """The folder of a sweep.

    Attributes:
        path: the folder; each point has its run folder in `points/`.
        force: points run whether there is enough memory or not.
    """

    def __init__(self, path: Path, force: bool = False) -> None:
        self.path, self.force = path, force

    @classmethod
    def open(cls, path: Path, force: bool = False) -> Store:
        """Make the folder, or go on with the sweep that is in it.

        Raises:
            CaseError: something else is there, or the folder cannot be made.
        """
        store = cls.look(path, force)
        try:
            (path / _LOCKS).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise CaseError([Problem(str(path), f"{error.strerror}, expected a folder")]) from None
        return store

    @classmethod
    def look(cls, path: Path, force: bool = False) -> Store:
        """The folder as it is, or is not yet there; nothing is made.

        Raises:
            CaseError: something else is there.
        """
        try:
            strange = path.exists() and not (path / _LOCKS).is_dir() and any(path.iterdir())
        except OSError as error:
            raise CaseError([Problem(str(path), f"{error.strerror}, expected a folder")]) from None
        if strange:
            text = "contains no sweep, expected a new folder or that of a sweep"
            raise CaseError([Problem(str(path), text)])
        return cls(path, force)

    def folder(self, point: Point) -> Path:
        """The run folder of a point."""
        return self.path / POINTS / point.name

    def result(self, point: Point) -> dict[str, Any] | None:
        """Content of run.json of a finished point, or None."""
        try:
            run = json.loads((self.folder(point) / RUN_FILE).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        mark = run.get(MARK) if isinstance(run, dict) else None
        done = isinstance(mark, dict) and mark.get("digest") == point.digest
        return run if done else None

    def history(self, point: Point, part: str = "") -> list[dict[str, float | None]]:
        """Rows of history.csv of a point or of its `BLOCKED` part, none if there is no file."""
        path = self.folder(point) / part / HISTORY_FILE
        return read_history(path) if path.exists() else []

    @contextlib.contextmanager
    def claim(self, point: Point) -> Iterator[bool]:
        """Lock a point; False where another process has locked it."""
        with (self.path / _LOCKS / point.name).open("a") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                yield False
                return
            yield True

    def solve(self, point: Point) -> dict[str, Any]:
        """Run a claimed point; whatever goes wrong is its result.

        Returns:
            Content of run.json.
        """
        start = time.monotonic()
        try:
            folder, force = self.folder(point), self.force
            run = _run(point.case, folder, force)
            if point.blocked is not None:
                run = _with_blocked(run, _run(point.blocked, folder / BLOCKED, force))
        except Exception as error:
            reason = traceback.format_exception_only(error)[-1].strip().splitlines()[0]
            text = "".join(traceback.format_exception(error))
            return self.fail(point, reason, text, time.monotonic() - start)
        finally:
            # PETSc objects hang in cycles and would pile up over the points
            gc.collect()
        return self._finish(point, run, time.monotonic() - start)

    def fail(self, point: Point, reason: str, log: str = "", wall: float = 0.0) -> dict[str, Any]:
        """Finish a claimed point that has come to nothing.

        Args:
            point: the point.
            reason: one line.
            log: more of it, for error.log.
            wall: seconds that it took.
        """
        self.folder(point).mkdir(parents=True, exist_ok=True)
        if log:
            RunFolder(self.folder(point)).write_text("error.log", log)
        return self._finish(point, {"status": "failed", "reason": reason}, wall)

    def forget(self, point: Point) -> None:
        """Take a failed point that no process has locked as unfinished, so that it runs again."""
        with self.claim(point) as mine:
            run = self.result(point)
            if mine and run is not None and run["status"] == "failed":
                (self.folder(point) / RUN_FILE).unlink()
                for name in (CHECKPOINT, CHECKPOINT_BEFORE, "error.log"):
                    (self.folder(point) / name).unlink(missing_ok=True)

    def _finish(self, point: Point, run: dict[str, Any], wall: float) -> dict[str, Any]:
        run = run | {MARK: {"point": point.name, "digest": point.digest, "wall_s": round(wall, 3)}}
        RunFolder(self.folder(point)).write_run(**run)
        return run


def _run(case: Case, folder: Path, force: bool) -> dict[str, Any]:
    """Solve a case, from the last state of a killed run of the same case if it left one."""
    from fiberbend.running.runner import run_case

    if any((folder / name).exists() for name in (CHECKPOINT, CHECKPOINT_BEFORE)):
        try:
            return run_case(case, folder, resume=True, force=force).run
        except Exception:  # another case, or of another version: from the start
            gc.collect()
    return run_case(case, folder, overwrite=True, force=force).run


def _with_blocked(run: dict[str, Any], blocked: dict[str, Any]) -> dict[str, Any]:
    """A run with the result of the same body kept straight."""
    if blocked["status"] == "failed" != run["status"]:
        run = run | {"status": "failed", "reason": f"kept straight: {blocked['reason']}"}
    return run
