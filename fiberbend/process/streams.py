"""Standard output and error that may be closed or full without ending a computation."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import sys
from typing import Any, TextIO, cast


class _Lossy:
    """A stream that goes nowhere from the first write on that fails.

    Attributes:
        lost: why, or None.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.lost: OSError | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write, or lose it."""
        try:
            return self._stream.write(text)
        except OSError as error:
            self._lose(error)
            return len(text)

    def flush(self) -> None:
        """Write what is held back, or lose it."""
        try:
            self._stream.flush()
        except OSError as error:
            self._lose(error)

    def _lose(self, error: OSError) -> None:
        self.lost = self.lost or error
        # what is still held back is flushed at the end of the process: into nothing
        with contextlib.suppress(OSError, ValueError):
            nothing = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nothing, self._stream.fileno())
            os.close(nothing)


def guard() -> None:
    """Make the standard streams of this process such."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            # else the next file that is opened gets what libraries print
            os.open(os.devnull, os.O_RDWR)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            stream = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
        if isinstance(stream, io.TextIOWrapper):
            # a terminal that knows no θ costs no line
            stream.reconfigure(errors="backslashreplace")
        if not isinstance(stream, _Lossy):
            setattr(sys, name, cast(TextIO, _Lossy(stream)))


def loss() -> str:
    """Why the standard output is not complete; nothing where its reader wanted no more."""
    stream = sys.stdout
    if not isinstance(stream, _Lossy):
        return ""
    stream.flush()
    if stream.lost is None or stream.lost.errno == errno.EPIPE:
        return ""
    return stream.lost.strerror or str(stream.lost)
