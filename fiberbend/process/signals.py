"""Ctrl-C, SIGTERM and SIGHUP: an end with one line, whenever they come.

Imported before anything slow. Until a command has something to keep, a signal ends the process at
once; from then on it is an exception, so that what is half done is left in order.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from types import FrameType
from typing import Any

from fiberbend.process import ranks

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_PATIENCE = 5.0
"""Seconds after which a second signal ends a process that has not ended by the first."""
_AGAIN = 0.02
"""Seconds after which a signal that was lost in a finaliser comes again."""


class Interrupted(KeyboardInterrupt):
    """A signal that asks to stop.

    Attributes:
        number: of the signal.
        reason: what is kept, for the user.
        together: all ranks have been stopped; None where nobody has looked.
    """

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number
        self.reason = "stopped"
        self.together: bool | None = None

    @property
    def code(self) -> int:
        """Exit code: 128 and the number of the signal, as a shell has it."""
        return 128 + self.number


class _Pending:
    """What has come, whether it is an exception, and whether that went nowhere."""

    number = 0
    since = 0.0
    raises = False
    held = False
    lost = False


_pending = _Pending()


def install() -> None:
    """Take the signals that this process does not ignore: nohup and a shell's & must go on.

    In a thread nothing is taken: the process belongs to who has started it.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    for number in _SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _handle)
    sys.unraisablehook = _lost


@contextlib.contextmanager
def raising() -> Iterator[None]:
    """Within, a signal raises `Interrupted`; it does where they are not installed too."""
    before, _pending.raises = _pending.raises, True
    try:
        yield
    finally:
        _pending.raises = before


@contextlib.contextmanager
def held() -> Iterator[None]:
    """Within, a signal waits for the end: around what takes moments and cannot be left halfway."""
    before, _pending.held = _pending.held, True
    earlier = _pending.number
    try:
        yield
    finally:
        _pending.held = before
    if not earlier and not before:
        check()


def check() -> None:
    """Raise what was lost: in a finaliser or a library's callback an exception goes nowhere."""
    if _pending.number:
        _pending.lost = False
        raise Interrupted(_pending.number)


def stop_of(error: KeyboardInterrupt) -> Interrupted:
    """A Ctrl-C as any other signal."""
    return error if isinstance(error, Interrupted) else Interrupted(signal.SIGINT)


def _lost(what: Any) -> None:
    """Send a signal again whose exception went nowhere; print what else is lost as ever."""
    error = what.exc_value
    if not isinstance(error, Interrupted):
        sys.__unraisablehook__(what)
        return
    _pending.lost = True
    again = threading.Timer(_AGAIN, os.kill, (os.getpid(), error.number))
    again.daemon = True
    again.start()


def _handle(number: int, _frame: FrameType | None) -> None:
    if not _pending.raises:
        if ranks.rank() == 0:
            with contextlib.suppress(OSError):
                os.write(2, b"fiberbend: stopped before anything was written\n")
        os._exit(128 + number)
    if not _pending.number or _pending.lost:
        _pending.number, _pending.since, _pending.lost = number, time.monotonic(), False
        if not _pending.held:
            raise Interrupted(number)
        return
    if time.monotonic() - _pending.since > _PATIENCE:
        os._exit(128 + number)
