"""Processes of this machine, from a pool that replaces those that die."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Iterator

from fiberbend.running import launch
from fiberbend.sweep.crews.crew import Crew, Here, Submit

_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")
_SAFE = "PYTHONSAFEPATH"
"""With it a worker imports nothing from the working folder while it starts."""


class Pool(Crew):
    """Worker processes that import the solver once and solve point after point.

    Args:
        count: how many.
    """

    fewer = "fewer -j"

    def __init__(self, count: int) -> None:
        self.count = count

    @contextlib.contextmanager
    def at_work(self, points: int) -> Iterator[Submit]:
        """Whatever ends this, no worker is left, nor what it has started."""
        if points < 2:
            with Here().at_work(points) as submit:
                yield submit
            return
        from pebble import ProcessPool

        new = {name: "1" for name in (*_THREADS, _SAFE) if name not in os.environ}
        os.environ.update(new)
        # a fork would take over what this process has of MPI
        spawn = multiprocessing.get_context("spawn")
        pool = ProcessPool(min(self.count, points), initializer=_prepare, context=spawn)
        try:
            # without a limit of time
            yield lambda function, *arguments: pool.submit(function, None, *arguments)
        finally:
            pool.stop()
            pool.join()
            for name in new:
                del os.environ[name]

    def death(self, error: BaseException) -> int | None:
        """The pool hands it on as an error of the task."""
        from pebble import ProcessExpired

        return error.exitcode if isinstance(error, ProcessExpired) else None


def _prepare() -> None:
    """Make this process a worker: the slow imports, while the first one compiles."""
    # Ctrl-C is the parent's to handle; what this process starts ends with it
    os.setpgid(0, 0)
    signal.signal(signal.SIGTERM, lambda *_: os.killpg(0, signal.SIGKILL))
    # what libraries print must not get among the lines for the user
    os.dup2(2, 1)
    launch.start_mpi()
    import fiberbend.running.runner  # noqa: F401
