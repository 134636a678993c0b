"""The points of a sweep handed out and gathered; the same loop whoever solves them.

Points are claimed by locks, so that several sweeps of one folder share them. The first point is
solved alone for a while: it compiles the forms, for which others would wait.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from typing import Any

from fiberbend.sweep.crews.crew import Crew, Submit
from fiberbend.sweep.points import Point
from fiberbend.sweep.store import MARK, Store

Event = dict[str, Any]
OnEvent = Callable[[Event], None]

_PAUSE = 0.25
_ALONE = 120.0
"""Seconds in which the forms are compiled, several times over; a body takes hours beyond them."""
_DEATHS = 2
"""A point at which so many workers have died is not tried again."""


class Loop:
    """Solves every point that is not finished; waits for those that other processes have locked.

    Args:
        points: all points of the sweep.
        store: its folder.
        on_event: takes {"done": name, "status": …, "reason": …, "wall_s": …}, {"wait": names of
            points that others have locked} and {"died": name, "code": …}.
        crew: who solves them.
    """

    def __init__(
        self, points: Sequence[Point], store: Store, on_event: OnEvent, crew: Crew
    ) -> None:
        self._store, self._on_event, self._crew = store, on_event, crew
        self._left = {point.name: point for point in points if store.result(point) is None}
        self._running: dict[Future[Event | None], Point] = {}
        # when to ask again for points that other processes have locked
        self._locked_until: dict[str, float] = {}
        self._deaths: Counter[str] = Counter()
        self._alone_until: float | None = None
        self._waits = False

    def run(self, submit: Submit) -> None:
        """Solve all points.

        Args:
            submit: of the crew at work.
        """
        try:
            while self._left:
                self._begin(submit)
                if not self._running:
                    # other processes have what is left; nothing to wait for returns at once
                    time.sleep(_PAUSE)
                ended, _ = wait(self._running, _PAUSE, FIRST_COMPLETED)
                for future in ended:
                    self._ended(self._running.pop(future), future)
        except BrokenExecutor:
            # no worker could even begin: what is left counts as not run
            return

    def _begin(self, submit: Submit) -> None:
        """Give every worker a point, but one alone until the forms are compiled."""
        now, running = time.monotonic(), {point.name for point in self._running.values()}
        if self._alone_until is None:
            self._alone_until = now + _ALONE
        most = self._crew.count if self._alone_until <= now else 1
        for name, point in self._left.items():
            if len(running) >= most:
                return
            if name not in running and self._locked_until.get(name, 0.0) <= now:
                self._running[submit(_solve, self._store, point)] = point
                running.add(name)

    def _ended(self, point: Point, future: Future[Event | None]) -> None:
        try:
            run = future.result()
        except Exception as error:
            code = self._crew.death(error)
            if code is None:
                raise
            self._died(point, code)
            return
        self._alone_until = 0.0
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
        self._store.await_result(point)
        self._locked_until.pop(point.name, None)
        del self._left[point.name]
        self._waits = False
        wall = run[MARK]["wall_s"]
        status, reason = run["status"], run["reason"]
        self._on_event({"done": point.name, "status": status, "reason": reason, "wall_s": wall})

    def _died(self, point: Point, code: int) -> None:
        self._on_event({"died": point.name, "code": code})
        self._deaths[point.name] += 1
        if self._deaths[point.name] < _DEATHS:
            return
        how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
        reason = f"its process ended {how}, {self._deaths[point.name]} times"
        with self._store.claim(point) as claim:
            if claim is None or self._store.result(point) is not None:
                return
            run = self._store.fail(claim, reason)
            if run is not None:
                self._finished(point, run)


def _solve(store: Store, point: Point) -> Event | None:
    """Content of run.json of a point that no other process has locked or finished, else None."""
    with store.claim(point) as claim:
        if claim is None or store.result(point) is not None:
            return None
        return store.solve(claim)
