"""Who solves the points of a sweep: this process, or worker processes that import the solver once.

Points are claimed by locks, so that several sweeps of one folder share them. Worker processes come
from a pool that replaces those that die. The first point is solved alone: it compiles the forms.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from fiberbend.running import launch
from fiberbend.sweep.points import Point
from fiberbend.sweep.store import MARK, Store

if TYPE_CHECKING:
    from pebble import ProcessPool

Event = dict[str, Any]
OnEvent = Callable[[Event], None]

_PAUSE = 0.25
_DEATHS = 2
"""A point at which so many workers have died is not tried again."""
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")
_SAFE = "PYTHONSAFEPATH"
"""With it a worker imports nothing from the working folder while it starts."""


def work(points: Sequence[Point], store: Store, on_event: OnEvent) -> None:
    """Solve every point that is not finished; wait for those that other processes have locked.

    Args:
        points: all points of the sweep.
        store: its folder.
        on_event: takes {"done": name, "status": …, "reason": …, "wall_s": …} and {"wait": names of
            points that others have locked}.
    """
    left, reported = list(points), False
    while left:
        for point in left:
            if store.result(point) is None and (run := _solve(store, point)) is not None:
                on_event(done(point, run))
                reported = False
        left = [point for point in left if store.result(point) is None]
        if left and not reported:
            on_event({"wait": [point.name for point in left]})
            reported = True
        if left:
            time.sleep(_PAUSE)


def done(point: Point, run: Event) -> Event:
    """The event of a finished point, from the content of its run.json."""
    wall = run[MARK]["wall_s"]
    return {"done": point.name, "status": run["status"], "reason": run["reason"], "wall_s": wall}


def _solve(store: Store, point: Point) -> Event | None:
    """Content of run.json of a point that no other process has locked or finished, else None."""
    with store.claim(point) as mine:
        return store.solve(point) if mine and store.result(point) is None else None


class WorkerPool:
    """Solves points as `work` does, by worker processes, and reports {"died": name, "code": …} too.

    Args:
        points: all points of the sweep.
        store: its folder.
        on_event: takes the events.
        count: how many work at once.
    """

    def __init__(
        self, points: Sequence[Point], store: Store, on_event: OnEvent, count: int
    ) -> None:
        self._store, self._on_event, self._count = store, on_event, count
        self._left = {point.name: point for point in points if store.result(point) is None}
        self._running: dict[Future[Event | None], Point] = {}
        # when to ask again for points that other processes have locked
        self._locked_until: dict[str, float] = {}
        self._deaths: Counter[str] = Counter()
        self._compiled = False
        self._waits = False

    def run(self) -> None:
        """Solve all points; whatever ends this, no worker is left."""
        with _pool(self._count) as pool:
            try:
                while self._left:
                    self._begin(pool)
                    if not self._running:
                        # other processes have what is left; nothing to wait for returns at once
                        time.sleep(_PAUSE)
                    ended, _ = wait(self._running, _PAUSE, FIRST_COMPLETED)
                    for future in ended:
                        self._ended(self._running.pop(future), future)
            except BrokenProcessPool:
                # no worker could even begin: what is left counts as not run
                return

    def _begin(self, pool: ProcessPool) -> None:
        """Give every worker a point, but one alone until the forms are compiled."""
        running = {point.name for point in self._running.values()}
        for name, point in self._left.items():
            if len(running) >= (self._count if self._compiled else 1):
                return
            if name not in running and self._locked_until.get(name, 0.0) <= time.monotonic():
                self._running[pool.schedule(_solve, args=(self._store, point))] = point
                running.add(name)

    def _ended(self, point: Point, future: Future[Event | None]) -> None:
        from pebble import ProcessExpired

        try:
            run = future.result()
        except ProcessExpired as death:
            self._died(point, death.exitcode)
            return
        self._compiled = True
        if run is not None:
            self._finished(point, run)
        elif self._store.result(point) is not None:
            del self._left[point.name]
        else:
            self._locked_until[point.name] = time.monotonic() + _PAUSE
            if not self._waits and self._locked_until.keys() >= self._left.keys():
                self._on_event({"wait": [*self._left]})
                self._waits = True

    def _finished(self, point: Point, run: Event) -> None:
        self._locked_until.pop(point.name, None)
        del self._left[point.name]
        self._waits = False
        self._on_event(done(point, run))

    def _died(self, point: Point, code: int) -> None:
        self._on_event({"died": point.name, "code": code})
        self._deaths[point.name] += 1
        if self._deaths[point.name] < _DEATHS:
            return
        with self._store.claim(point) as mine:
            if not mine or self._store.result(point) is not None:
                return
            how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
            reason = f"its process ended {how}, {self._deaths[point.name]} times"
            self._finished(point, self._store.fail(point, reason))


@contextmanager
def _pool(count: int) -> Iterator[ProcessPool]:
    """A pool of worker processes that are ended, with all that they have started, at its end."""
    from pebble import ProcessPool

    new = {name: "1" for name in (*_THREADS, _SAFE) if name not in os.environ}
    os.environ.update(new)
    # a fork would take over what this process has of MPI
    pool = ProcessPool(count, initializer=_prepare, context=multiprocessing.get_context("spawn"))
    try:
        yield pool
    finally:
        pool.stop()
        pool.join()
        for name in new:
            del os.environ[name]


def _prepare() -> None:
    """Make this process a worker: the slow imports, while the first one compiles."""
    # Ctrl-C is the parent's to handle; what this process starts ends with it
    os.setpgid(0, 0)
    signal.signal(signal.SIGTERM, lambda *_: os.killpg(0, signal.SIGKILL))
    # what libraries print must not get among the lines for the user
    os.dup2(2, 1)
    launch.start_mpi()
    import fiberbend.running.runner  # noqa: F401
