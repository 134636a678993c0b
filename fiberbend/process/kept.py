"""Files that were made before, in the user's own cache, by a digest of what enters them.

Nothing in them is executed, but a wrong number is a wrong answer: as for compiled kernels, a folder
that others can write is not used, and a file that is not whole is made anew.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

from machine import folders

Item = TypeVar("Item")


class Kept:
    """Files of one kind in one folder.

    Args:
        folder: its name within the cache.
        what: the files hold, for the user.
        suffix: of their names.
        path: another folder, which need not be there; None: that of the user.

    Attributes:
        remarks: what was wrong with the folder or with a file in it, for the user.
    """

    def __init__(self, folder: str, what: str, suffix: str, path: Path | None = None) -> None:
        self.remarks: list[str] = []
        self._what, self._suffix = what, suffix
        self._path: Path | None = None
        try:
            wanted = folders.cache_root().path / folder if path is None else path
        except folders.MachineError as error:
            self.remarks.append(str(error))
            return
        if why := folders.refusal(wanted):
            self.remarks.append(f"{wanted} is not used for {what}: {why}")
        else:
            self._path = wanted

    def read(self, digest: str, parse: Callable[[bytes], Item]) -> Item | None:
        """What a file holds, or None where there is none that is whole.

        Args:
            digest: of what enters.
            parse: reads it; a ValueError where it is not what was written.
        """
        if self._path is None:
            return None
        file = self._file(digest)
        try:
            return parse(file.read_bytes())
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            self.remarks.append(f"{file} is damaged and made anew: {error}")
            return None

    def write(self, digest: str, content: bytes) -> None:
        """Write a file, whole or not at all; where it cannot be kept, that is a remark."""
        if self._path is None:
            return
        try:
            folders.make_private(self._path)
            handle, draft = tempfile.mkstemp(prefix=f".{digest}.", dir=self._path)
            try:
                with os.fdopen(handle, "wb") as file:
                    file.write(content)
                os.replace(draft, self._file(digest))
            except BaseException:
                Path(draft).unlink(missing_ok=True)
                raise
        except (OSError, folders.MachineError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            self.remarks.append(f"{self._path}: {self._what} cannot be kept: {why}")

    def forget(self, digest: str) -> None:
        """Let a file be made anew, as where its time is measured."""
        if self._path is not None:
            with contextlib.suppress(OSError):
                self._file(digest).unlink(missing_ok=True)

    @contextlib.contextmanager
    def alone(self, digest: str) -> Iterator[None]:
        """Let one process at a time make what has a digest; others wait for its result."""
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
        return self._path / f"{digest}{self._suffix}"
