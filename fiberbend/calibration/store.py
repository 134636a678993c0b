"""Calibrations that were found before, a small file each in the user's own cache.

Nothing in it is executed, but a wrong number is a wrong answer: as for compiled kernels, a folder
that others can write is not used, and a file that is not whole is made anew.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fiberbend.calibration import record
from fiberbend.calibration.record import Calibration
from machine import folders

FOLDER = "calibrations"
"""Within the cache."""
_SUM = "sum"


class Store:
    """Calibrations by the digest of what enters them.

    Args:
        path: the folder, which need not be there; None: the user's own.

    Attributes:
        remarks: what was wrong with the folder or with a file in it, for the user.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.remarks: list[str] = []
        self._path: Path | None = None
        try:
            wanted = folders.cache_root().path / FOLDER if path is None else path
        except folders.MachineError as error:
            self.remarks.append(str(error))
            return
        if why := folders.refusal(wanted):
            self.remarks.append(f"{wanted} is not used for calibrations: {why}")
        else:
            self._path = wanted

    def find(self, digest: str) -> Calibration | None:
        """The calibration of a digest, or None where there is none that is whole."""
        if self._path is None:
            return None
        file = self._file(digest)
        try:
            return _read(json.loads(file.read_bytes()), digest)
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            self.remarks.append(f"{file} is damaged and made anew: {error}")
            return None

    def keep(self, digest: str, found: Calibration, content: dict[str, Any]) -> None:
        """Write a calibration, whole or not at all; where it cannot be kept, that is a remark.

        Args:
            digest: of what enters.
            found: the calibration.
            content: what enters, for a reader of the file.
        """
        if self._path is None:
            return
        entry = {"digest": digest, "found": found.entries(), "of": content}
        entry[_SUM] = _sum(entry)
        try:
            handle, draft = tempfile.mkstemp(prefix=f".{digest}.", dir=self._path)
            try:
                with os.fdopen(handle, "w", encoding="utf-8") as file:
                    json.dump(entry, file, indent=1)
                os.replace(draft, self._file(digest))
            except BaseException:
                Path(draft).unlink(missing_ok=True)
                raise
        except OSError as error:
            self.remarks.append(f"{self._path}: the calibration is not kept: {error.strerror}")

    def forget(self, digest: str) -> None:
        """Let a calibration be made anew, as where its time is measured."""
        if self._path is not None:
            with contextlib.suppress(OSError):
                self._file(digest).unlink(missing_ok=True)

    @contextlib.contextmanager
    def alone(self, digest: str) -> Iterator[None]:
        """Let one process at a time calibrate what has a digest; others wait for its result."""
        lock = None
        if self._path is not None:
            try:
                folders.make_private(self._path)
                lock = (self._path / f"{digest}.lock").open("w")
                fcntl.flock(lock, fcntl.LOCK_EX)
            except (OSError, folders.MachineError):
                # a file system without locks: two may do the same, and find the same
                pass
        try:
            yield
        finally:
            if lock is not None:
                lock.close()

    def _file(self, digest: str) -> Path:
        assert self._path is not None
        return self._path / f"{digest}.json"


def _read(entry: Any, digest: str) -> Calibration:
    if not isinstance(entry, dict) or not isinstance(entry.get("found"), dict):
        raise ValueError("it holds no calibration")
    if entry.pop(_SUM, None) != _sum(entry):
        raise ValueError("its content is not what was written")
    if entry["digest"] != digest:
        raise ValueError("it is of another section")
    return record.read(entry["found"])


def _sum(entry: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(entry, sort_keys=True).encode()).hexdigest()
