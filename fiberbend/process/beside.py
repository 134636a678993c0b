"""A task in another process of this program, while this one goes on with something else."""

from __future__ import annotations

import ctypes
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from typing import Any, Generic, TypeVar

T = TypeVar("T")
_SERVE = "from fiberbend.process.beside import serve; serve({}, {})"
_DIE_WITH_PARENT = 1
"""PR_SET_PDEATHSIG of Linux's prctl."""


class _Setting:
    """Whether this process may start others."""

    enabled = False


def enable(yes: bool = True) -> None:
    """Let this process start others: a command that has the machine to itself, on two cores."""
    _Setting.enabled = yes and len(os.sched_getaffinity(0)) > 1


class Beside(Generic[T]):
    """A task that runs beside this process where it may, and else when its result is asked for.

    The other process imports this program anew. It ignores Ctrl-C and ends with this one. Where it
    cannot be started, or dies, the task runs here.

    Args:
        function: of a module, so that it can be pickled; it must need no MPI.
        arguments: that can be pickled.
    """

    def __init__(self, function: Callable[..., T], *arguments: Any) -> None:
        self._function, self._arguments = function, arguments
        self._child: subprocess.Popen[bytes] | None = None
        if not _Setting.enabled:
            return
        task = pickle.dumps((function, arguments))
        read, write = os.pipe()
        try:
            self._child = subprocess.Popen(
                [sys.executable, "-P", "-c", _SERVE.format(write, os.getpid())],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=[write],
            )
            assert self._child.stdin is not None
            with self._child.stdin as stdin:
                stdin.write(task)
        except OSError:
            self.stop()
        finally:
            os.close(write)
        self._answer = os.fdopen(read, "rb")

    def result(self) -> T:
        """What the task returns, once it is done.

        Raises:
            Exception: what the task raises.
        """
        if self._child is None:
            return self._function(*self._arguments)
        try:
            with self._answer as pipe:
                value, error = pickle.load(pipe)
        except (EOFError, pickle.UnpicklingError):
            self.stop()
            return self._function(*self._arguments)
        except BaseException:
            self.stop()
            raise
        self._child.wait()
        if error is not None:
            raise error
        done: T = value
        return done

    def stop(self) -> None:
        """End the other process; its result is not wanted any more."""
        child, self._child = self._child, None
        if child is not None:
            child.kill()
            child.wait()


def serve(target: int, parent: int) -> None:
    """Do the task that standard input has, in the other process.

    Args:
        target: descriptor that takes the result.
        parent: process that waits for it.
    """
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    if os.getppid() != parent:
        return
    function, arguments = pickle.load(sys.stdin.buffer)
    answer: tuple[Any, Exception | None]
    try:
        answer = (function(*arguments), None)
    except Exception as error:
        answer = (None, error)
    with os.fdopen(target, "wb") as pipe:
        pickle.dump(answer, pipe)
