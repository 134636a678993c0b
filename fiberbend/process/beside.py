"""A task in another process of this program, while this one goes on with something else."""

from __future__ import annotations

import atexit
import contextlib
import importlib
import os
import signal
import sys
from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeVar

T = TypeVar("T")
_SERVE = "from fiberbend.process.beside import serve; serve({}, {}, {!r})"
_DIE_WITH_PARENT = 1
"""PR_SET_PDEATHSIG of Linux's prctl."""


class _Child:
    """Another process of this program, which waits for a task.

    Args:
        modules: what it imports meanwhile.

    Raises:
        OSError: it cannot be started.
    """

    def __init__(self, modules: Sequence[str] = ()) -> None:
        import subprocess

        read, write = os.pipe()
        self.answer = os.fdopen(read, "rb")
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", _SERVE.format(write, os.getpid(), [*modules])],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=[write],
            )
        finally:
            os.close(write)

    def take(self, task: bytes) -> None:
        """Give it its task, pickled.

        Raises:
            OSError: it has ended.
        """
        assert self.process.stdin is not None
        with self.process.stdin as stdin:
            stdin.write(task)

    def end(self) -> None:
        """End it at once."""
        self.process.kill()
        self.process.wait()
        self.answer.close()


class _Setting:
    """Whether this process may start others, and the one that waits for a task."""

    enabled = False
    waiting: _Child | None = None


def enable(yes: bool = True) -> None:
    """Let this process start others: a command that has the machine to itself, on two cores."""
    _Setting.enabled = yes and len(os.sched_getaffinity(0)) > 1


def prepare(*modules: str) -> None:
    """Start the process of the next task now, while this one has not got it yet.

    Args:
        modules: what the task imports.
    """
    if _Setting.enabled and _Setting.waiting is None:
        with contextlib.suppress(OSError):
            _Setting.waiting = _Child(modules)
            atexit.register(dismiss)


def dismiss() -> None:
    """End a process that waits for a task."""
    child, _Setting.waiting = _Setting.waiting, None
    if child is not None:
        child.end()


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
        self._child: _Child | None = None
        if not _Setting.enabled:
            return
        import pickle

        task = pickle.dumps((function, arguments))
        child, _Setting.waiting = _Setting.waiting, None
        try:
            self._child = child or _Child()
            self._child.take(task)
        except OSError:
            self.stop()

    def result(self) -> T:
        """What the task returns, once it is done.

        Raises:
            Exception: what the task raises.
        """
        if self._child is None:
            return self._function(*self._arguments)
        import pickle

        try:
            value, error = pickle.load(self._child.answer)
        except (EOFError, pickle.UnpicklingError):
            self.stop()
            return self._function(*self._arguments)
        finally:
            self.stop()
        if error is not None:
            raise error
        done: T = value
        return done

    def stop(self) -> None:
        """End the other process; its result is not wanted any more."""
        child, self._child = self._child, None
        if child is not None:
            child.end()


def serve(target: int, parent: int, modules: Sequence[str]) -> None:
    """Do the task that standard input has, in the other process.

    Args:
        target: descriptor that takes the result.
        parent: process that waits for it.
        modules: what is imported before the task is there.
    """
    import ctypes
    import pickle

    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    if os.getppid() != parent:
        return
    for module in modules:
        # a task that needs what cannot be imported says so itself
        with contextlib.suppress(ImportError):
            importlib.import_module(module)
    task = sys.stdin.buffer.read()
    if not task:
        return
    function, arguments = pickle.loads(task)
    answer: tuple[Any, Exception | None]
    try:
        answer = (function(*arguments), None)
    except Exception as error:
        answer = (None, error)
    with os.fdopen(target, "wb") as pipe:
        pickle.dump(answer, pipe)
