"""Points that are claimed where locks hold, where they hold on one machine, and where none are."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import yaml
from mpi4py import MPI

from fem import kernels
from fiberbend.results.folder import RunFolder
from fiberbend.sweep import loop
from fiberbend.sweep.crews.crew import Crew, Here, Submit
from fiberbend.sweep.loop import Event, Loop
from fiberbend.sweep.points import Point, read_sweep
from fiberbend.sweep.store import MARK, Store
from machine.folders import MachineError
from tests.run.test_sweep import NAMES, SWEEP

DONE = {"status": "converged", "reason": ""}


@pytest.fixture
def points(tmp_path: Path) -> tuple[Point, ...]:
    path = tmp_path / "six.yaml"
    path.write_text(yaml.safe_dump(SWEEP | {"set": {"model": "analytic"}}), encoding="utf-8")
    return read_sweep(path).points


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store.open(tmp_path / "out")


def unlocked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every lock is had at once, as that of another machine where locks are those of one."""
    monkeypatch.setattr(fcntl, "flock", lambda *_: None)


def test_a_point_is_claimed_once(store: Store, points: tuple[Point, ...]) -> None:
    with store.claim(points[0]) as first:
        assert first is not None
        with store.claim(points[0]) as second:
            assert second is None
        with store.claim(points[1]) as other:
            assert other is not None
        assert first.holds()
    with store.claim(points[0]) as third:
        assert third is not None


def test_where_locks_do_not_hold_the_second_claim_counts(
    store: Store, points: tuple[Point, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first one leaves no result, neither a good one nor a failure by the other's doing."""
    unlocked(monkeypatch)
    point = points[0]
    with store.claim(point) as first, store.claim(point) as second:
        assert first is not None
        assert second is not None
        assert (first.holds(), second.holds()) == (False, True)
        assert store.solve(first) is None
        assert store.fail(first, "mixed up", "a log") is None
        assert store.result(point) is None
        assert not (store.folder(point) / "error.log").exists()
        run = store.solve(second)
    assert run is not None
    assert run["status"] == "converged"
    assert store.result(point) == run


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS])
def test_a_file_system_without_locks(
    store: Store, points: tuple[Point, ...], monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    """A point that another process runs is left to it: its run folder is held by a file."""

    def none(*_: Any) -> None:
        raise OSError(number, "no locks")

    monkeypatch.setattr(fcntl, "flock", none)
    point = points[0]
    with RunFolder.create(store.folder(point), point.case), store.claim(point) as claim:
        assert claim is not None
        assert store.solve(claim) is None
    assert store.result(point) is None
    with store.claim(point) as claim:
        assert claim is not None
        run = store.solve(claim)
    assert run is not None
    assert store.result(point) == run


def test_other_errors_of_a_lock_are_errors(
    store: Store, points: tuple[Point, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: Any) -> None:
        raise OSError(errno.EIO, "broken")

    monkeypatch.setattr(fcntl, "flock", broken)
    with pytest.raises(OSError, match="broken"), store.claim(points[0]):
        pass


def test_a_result_that_shows_late_is_waited_for(
    store: Store, points: tuple[Point, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of another machine, of whose folder a network file system remembers the state before."""
    with store.claim(points[0]) as claim:
        assert claim is not None
        store.solve(claim)
    found, asked = store.result(points[0]), []

    def late(point: Point) -> Any:
        asked.append(point.name)
        return found if len(asked) > 3 else None

    monkeypatch.setattr(store, "result", late)
    store.await_result(points[0])
    assert len(asked) == 4


class Threads(Crew):
    """Two threads, which solve nothing."""

    count = 2

    @contextlib.contextmanager
    def at_work(self, points: int) -> Iterator[Submit]:
        """They do what they are given."""
        with ThreadPoolExecutor(self.count) as pool:
            yield pool.submit


class Slow(Store):
    """A store whose points take a second and a half."""

    log: list[str]

    def solve(self, claim: Any) -> Any:
        """Nothing but time."""
        self.log.append(f"begin {claim.point.name}")
        time.sleep(1.5)
        self.log.append(f"end {claim.point.name}")
        return self._finish(claim, dict(DONE), 1.5)


@pytest.mark.parametrize(("alone", "overlap"), [(0.1, True), (100.0, False)])
def test_the_first_point_is_alone_for_a_while(
    points: tuple[Point, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    alone: float,
    overlap: bool,
) -> None:
    """It compiles the forms; a body of hours would let all others wait."""
    monkeypatch.setattr(loop, "_ALONE", alone)
    store = Slow(Store.open(tmp_path / "out").path)
    store.log = []
    events: list[Event] = []
    crew = Threads()
    with crew.at_work(3) as submit:
        Loop(points[:3], store, events.append, crew).run(submit)
    assert sorted(event["done"] for event in events if "done" in event) == sorted(NAMES[:3])
    assert store.log[0] == f"begin {NAMES[0]}"
    assert store.log[1].startswith("begin" if overlap else "end")


def test_this_process_alone_solves_in_order(points: tuple[Point, ...], store: Store) -> None:
    events: list[Event] = []
    crew = Here()
    with crew.at_work(len(points)) as submit:
        Loop(points, store, events.append, crew).run(submit)
    assert [event["done"] for event in events] == NAMES
    assert all(MARK in (store.result(point) or {}) for point in points)


def test_forms_are_not_compiled_where_nothing_can_be_locked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Two machines would remove what the other one is compiling."""

    def none(*_: Any) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", none)
    words = "cannot be locked: No locks available; set XDG_CACHE_HOME"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with pytest.raises(MachineError, match=words):
        kernels.library(MPI.COMM_SELF, [], "int one(void);", "int one(void) { return 1; }", "one")
