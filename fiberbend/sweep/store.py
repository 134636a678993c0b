"""The folder of a sweep: which points are finished, and who solves which.

A point is finished when its run.json has the digest of its case; that is written last. A point
is claimed by a lock on a file of its own, which the system releases when the process ends, however
it ends. Lock files stay: two processes could otherwise lock two files of the same name.

Not every file system of a cluster has locks that hold for all its machines. Who claims a point
leaves its name in the lock file, and finishes the point only if it is still there: of two processes
that believe to have locked it, the result of the second one counts.
"""

from __future__ import annotations

import contextlib
import dataclasses
import errno
import fcntl
import gc
import json
import os
import socket
import time
import traceback
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

from fiberbend.case.case import Case
from fiberbend.results.folder import (
    BLOCKED,
    HISTORY_FILE,
    POINTS,
    RUN_FILE,
    FolderHeldError,
    RunFolder,
    checkpoints,
)
from fiberbend.results.reading import read_history
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sweep.points import Point

MARK = "sweep"
"""Key of run.json under which a finished point stands."""
NOT_RUN = "not run"
"""Status in the table of a point without a result."""
_LOCKS = ".locks"
_NO_LOCKS = (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS)
_PATIENCE = 10.0
"""Seconds in which a result of another machine shows in a folder that both see."""
_PAUSE = 0.05


@dataclasses.dataclass(frozen=True)
class Claim:
    """A point that this process solves, and no other one.

    Attributes:
        point: the point.
        path: its lock file.
        word: what this process has left there; empty where it could not.
    """

    point: Point
    path: Path
    word: str

    def holds(self) -> bool:
        """Whether no other process has claimed it since: one for which the lock does not hold."""
        with contextlib.suppress(OSError):
            return not self.word or self.path.read_text(encoding="utf-8") == self.word
        return True


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

    @property
    def locks(self) -> Path:
        """The folder of lock files, a file each point."""
        return self.path / _LOCKS

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

    def await_result(self, point: Point) -> None:
        """Wait until a finished point shows here: another machine may have written it."""
        end = time.monotonic() + _PATIENCE
        while self.result(point) is None and time.monotonic() < end:
            self._look_again(point)
            time.sleep(_PAUSE)

    def _look_again(self, point: Point) -> None:
        """List its folder: what a network file system remembers of it may be old."""
        with contextlib.suppress(OSError):
            os.listdir(self.folder(point))

    def history(self, point: Point, part: str = "") -> list[dict[str, float | None]]:
        """Rows of history.csv of a point or of its `BLOCKED` part, none if there is no file."""
        path = self.folder(point) / part / HISTORY_FILE
        return read_history(path) if path.exists() else []

    @contextlib.contextmanager
    def claim(self, point: Point) -> Iterator[Claim | None]:
        """Lock a point; None where another process has locked it."""
        path = self.locks / point.name
        with path.open("a", encoding="utf-8") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                yield None
                return
            except OSError as error:
                if error.errno not in _NO_LOCKS:
                    raise
            word = _signed(lock)
            self._look_again(point)
            yield Claim(point, path, word)

    def solve(self, claim: Claim) -> dict[str, Any] | None:
        """Run a claimed point; whatever goes wrong is its result.

        Returns:
            Content of run.json; None where another process has it all the same.
        """
        start, point = time.monotonic(), claim.point
        try:
            folder, force = self.folder(point), self.force
            run = _run(point.case, folder, force)
            if point.blocked is not None:
                run = _with_blocked(run, _run(point.blocked, folder / BLOCKED, force))
        except FolderHeldError:
            return None
        except Exception as error:
            reason = traceback.format_exception_only(error)[-1].strip().splitlines()[0]
            text = "".join(traceback.format_exception(error))
            return self.fail(claim, reason, text, time.monotonic() - start)
        finally:
            # PETSc objects hang in cycles and would pile up over the points
            gc.collect()
        return self._finish(claim, run, time.monotonic() - start)

    def fail(
        self, claim: Claim, reason: str, log: str = "", wall: float = 0.0
    ) -> dict[str, Any] | None:
        """Finish a claimed point that has come to nothing; None as of `solve`.

        Args:
            claim: of the point.
            reason: one line.
            log: more of it, for error.log.
            wall: seconds that it took.
        """
        folder = self.folder(claim.point)
        folder.mkdir(parents=True, exist_ok=True)
        if log and claim.holds():
            RunFolder(folder).write_text("error.log", log)
        return self._finish(claim, {"status": "failed", "reason": reason}, wall)

    def forget(self, point: Point) -> None:
        """Take a failed point that no process has locked as unfinished, so that it runs again."""
        with self.claim(point) as claim:
            run = self.result(point)
            if claim is not None and run is not None and run["status"] == "failed":
                (self.folder(point) / RUN_FILE).unlink()
                folder = self.folder(point)
                for path in (*checkpoints(folder), folder / "error.log"):
                    path.unlink(missing_ok=True)

    def _finish(self, claim: Claim, run: dict[str, Any], wall: float) -> dict[str, Any] | None:
        point = claim.point
        if not claim.holds():
            return None
        run = run | {MARK: {"point": point.name, "digest": point.digest, "wall_s": round(wall, 3)}}
        RunFolder(self.folder(point)).write_run(**run)
        return run


def _signed(lock: IO[str]) -> str:
    """What this process leaves in a lock file; nothing where a full disk prevents it."""
    word = f"process {os.getpid()} on {socket.gethostname()}, {uuid.uuid4().hex}\n"
    try:
        lock.truncate(0)
        lock.write(word)
        lock.flush()
        os.fsync(lock.fileno())
    except OSError:
        return ""
    return word


def _run(case: Case, folder: Path, force: bool) -> dict[str, Any]:
    """Solve a case, from the last state of a killed run of the same case if it left one.

    On this process alone, also where it is a rank among others.
    """
    from mpi4py import MPI

    from fiberbend.running.runner import run_case

    alone = MPI.COMM_SELF
    if checkpoints(folder):
        try:
            return run_case(case, folder, resume=True, force=force, comm=alone).run
        except FolderHeldError:
            raise
        except Exception:  # another case, or of another version: from the start
            gc.collect()
    return run_case(case, folder, overwrite=True, force=force, comm=alone).run


def _with_blocked(run: dict[str, Any], blocked: dict[str, Any]) -> dict[str, Any]:
    """A run with the result of the same body kept straight."""
    if blocked["status"] == "failed" != run["status"]:
        run = run | {"status": "failed", "reason": f"kept straight: {blocked['reason']}"}
    return run
