"""Worker processes of a sweep: each imports the solver once and solves point after point.

A worker finds its points itself, by their locks; it is told only when to begin, and tells what it
does as one JSON mapping a line. The first worker begins alone: its first point compiles the forms.
"""

from __future__ import annotations

import dataclasses
import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

from fiberbend.sweep.points import Point
from fiberbend.sweep.store import MARK, Store

Event = dict[str, Any]
Tell = Callable[[Event], None]

_PAUSE = 0.25
_DEATHS = 2
"""A point at which so many workers have died is not tried again."""


def work(points: Sequence[Point], store: Store, tell: Tell) -> None:
    """Solve every point that is not finished; wait for those that other processes hold.

    Args:
        points: all points of the sweep.
        store: its folder.
        tell: takes {"start": name}, {"done": name, "status": …, "reason": …, "wall_s": …} and
            {"wait": names of points that others hold}.
    """
    left, told = list(points), False
    while left:
        for point in left:
            if store.result(point) is not None:
                continue
            with store.claim(point) as mine:
                if mine and store.result(point) is None:
                    tell({"start": point.name})
                    tell(done(point, store.solve(point)))
                    told = False
        left = [point for point in left if store.result(point) is None]
        if left and not told:
            tell({"wait": [point.name for point in left]})
            told = True
        if left:
            time.sleep(_PAUSE)


def done(point: Point, run: Event) -> Event:
    """The event of a finished point, from the content of its run.json."""
    wall = run[MARK]["wall_s"]
    return {"done": point.name, "status": run["status"], "reason": run["reason"], "wall_s": wall}


def serve(points: Sequence[Point], store: Store) -> int:
    """The work of one worker process, begun by a line on the standard input."""
    # what libraries print must not get among the events
    with os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1) as events:
        os.dup2(2, 1)
        import fiberbend.running.runner  # noqa: F401  the slow import, while the first worker compiles

        def tell(event: Event) -> None:
            print(json.dumps(event, default=str), file=events, flush=True)

        tell({"ready": os.getpid()})
        if not sys.stdin.readline():
            return 0
        try:
            work(points, store, tell)
        except BrokenPipeError:
            # nobody listens any more; the point at hand is finished all the same
            os._exit(0)
    return 0


@dataclasses.dataclass
class _Worker:
    """A worker process as its parent sees it.

    Attributes:
        process: the process, leader of a group of its own: Ctrl-C is the parent's to handle.
        point: name of the point at hand, or empty.
        ready: it has imported everything.
        works: it has been told to begin.
    """

    process: subprocess.Popen[str]
    point: str = ""
    ready: bool = False
    works: bool = False

    def begin(self) -> None:
        """Tell it to begin."""
        assert self.process.stdin is not None
        self.works = True
        try:
            self.process.stdin.write("go\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # it has died, and its end is told elsewhere

    def stop(self) -> None:
        """End it with all that it has started."""
        for kind in (signal.SIGTERM, signal.SIGKILL):
            try:
                os.killpg(self.process.pid, kind)
                self.process.wait(timeout=5)
            except ProcessLookupError:
                return
            except subprocess.TimeoutExpired:
                continue


class Crew:
    """The workers of one sweep.

    Args:
        command: starts one worker.
        count: how many work at once.
        points: all points.
        store: the folder of the sweep.
        tell: takes the events of all workers.
    """

    def __init__(
        self, command: Sequence[str], count: int, points: Sequence[Point], store: Store, tell: Tell
    ) -> None:
        self._command, self._count, self._tell = list(command), count, tell
        self._points = {point.name: point for point in points}
        self._store = store
        self._queue: queue.Queue[tuple[_Worker, Event | None]] = queue.Queue()
        self._workers: list[_Worker] = []
        self._deaths: Counter[str] = Counter()
        self._compiled = False

    def run(self) -> None:
        """Solve all points; ends when no worker is left."""
        try:
            for _ in range(self._count):
                self._start()
            self._begin()
            while self._workers:
                worker, event = self._queue.get()
                if event is None:
                    self._ended(worker)
                else:
                    self._heard(worker, event)
                self._begin()
        finally:
            for worker in self._workers:
                worker.stop()

    def _start(self) -> None:
        environment = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"} | os.environ
        process = subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            env=environment,
            process_group=0,
        )
        worker = _Worker(process)
        self._workers.append(worker)
        threading.Thread(target=self._listen, args=(worker,), daemon=True).start()

    def _listen(self, worker: _Worker) -> None:
        assert worker.process.stdout is not None
        for line in worker.process.stdout:
            try:
                event = json.loads(line)
            except ValueError:
                continue  # cut short by the worker's death
            self._queue.put((worker, event))
        self._queue.put((worker, None))

    def _heard(self, worker: _Worker, event: Event) -> None:
        if "ready" in event:
            worker.ready = True
            return
        worker.point = event.get("start", "")
        self._compiled |= "start" not in event
        if "wait" in event:
            mine = {other.point for other in self._workers}
            event = {"wait": [name for name in event["wait"] if name not in mine]}
        if event.get("wait", True):
            self._tell(event)

    def _begin(self) -> None:
        """Let one worker begin, and the others once the forms are compiled."""
        waiting = [worker for worker in self._workers if not worker.works]
        if self._compiled:
            for worker in waiting:
                worker.begin()
        elif waiting and len(waiting) == len(self._workers):
            waiting[0].begin()

    def _ended(self, worker: _Worker) -> None:
        code = worker.process.wait()
        self._workers.remove(worker)
        if code == 0:
            return
        self._tell({"died": worker.point, "code": code})
        self._deaths[worker.point] += 1
        lost = self._deaths[worker.point] >= _DEATHS
        if worker.point and lost:
            self._give_up(self._points[worker.point], code)
        # one that cannot even begin would not do better the next time
        if worker.ready and (worker.point or not lost):
            self._start()

    def _give_up(self, point: Point, code: int) -> None:
        with self._store.claim(point) as mine:
            if not mine or self._store.result(point) is not None:
                return
            how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
            reason = f"its process ended {how}, {self._deaths[point.name]} times"
            self._tell(done(point, self._store.fail(point, reason)))
