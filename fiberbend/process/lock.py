"""One process at a time in a folder."""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import warnings
from pathlib import Path

LOCK_FILE = ".lock"
"""In the folder while it is held; who holds it, a line each: process, host."""


class HeldError(Exception):
    """Another process holds the folder.

    Args:
        who: 'process 12 on host a'.
    """

    def __init__(self, who: str) -> None:
        super().__init__(f"in use by {who}")


class FolderLock:
    """Holds a folder until it is released, or its process ends, however it ends.

    A lock of the system (flock), which on NFS holds for all its hosts; where a file system has
    none, a file with process and host, taken as left over where no such process runs there.

    Args:
        folder: the folder, which is there.

    Raises:
        HeldError: by whom.
        OSError: nothing can be written there.
    """

    def __init__(self, folder: Path) -> None:
        from filelock import BaseFileLock, FileLock, SoftFileLock, Timeout

        self._path = folder / LOCK_FILE
        self._lock: BaseFileLock = FileLock(self._path, thread_local=False)
        try:
            self._acquire()
        except Timeout:
            raise HeldError(_holder(self._path)) from None
        except OSError as error:
            if error.errno not in (errno.ENOLCK, errno.EOPNOTSUPP):
                raise
            with contextlib.suppress(OSError):
                if not self._path.stat().st_size:
                    # what the attempt has made, and no holder wrote
                    self._path.unlink()
            self._lock = SoftFileLock(self._path, thread_local=False)
            try:
                self._acquire()
            except Timeout:
                raise HeldError(_holder(self._path)) from None
        self._soft = isinstance(self._lock, SoftFileLock)
        if not self._soft:
            self._path.write_text(f"{os.getpid()}\n{socket.gethostname()}\n", encoding="utf-8")

    def _acquire(self) -> None:
        with warnings.catch_warnings():
            # that it falls back to a file is what it is for
            warnings.simplefilter("ignore")
            self._lock.acquire(timeout=0)

    def release(self) -> None:
        """Let others have the folder; once is enough."""
        if not self._lock.is_locked:
            return
        if not self._soft:
            # while it is held: who opened it before finds it without a name, and begins anew
            with contextlib.suppress(OSError):
                self._path.unlink()
        self._lock.release()


def holder(folder: Path) -> str:
    """Who holds a folder at present, or nothing."""
    if not (folder / LOCK_FILE).exists():
        return ""
    try:
        FolderLock(folder).release()
    except HeldError as error:
        return str(error)
    except OSError:
        return ""
    return ""


def _holder(path: Path) -> str:
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    if len(lines) < 2:
        return "another process"
    return f"process {lines[0]} on {lines[1]}"
