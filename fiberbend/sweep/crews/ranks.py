"""The ranks of an MPI launch, on one machine or many: rank 0 leads, each other one solves points.

A rank that is lost ends the launch: its launcher ends the others. What is finished stays.
"""

from __future__ import annotations

import contextlib
import functools
import os
import socket
import sys
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from fiberbend.plan.memory import RANK_MB, room, shortage
from fiberbend.process.signals import stop_of
from fiberbend.running import launch
from fiberbend.sweep.crews.crew import Crew, Submit, T
from machine import world

_PROBE = ".shared"
_PATIENCE = 10.0
"""Seconds in which a file of another machine shows in a folder that both see."""
_PAUSE = 0.02


class Ranks(Crew):
    """All ranks of the launch; collective.

    Raises:
        MachineError: they do not know of each other.
    """

    fewer = "fewer ranks on a machine"

    def __init__(self) -> None:
        launch.start_mpi()
        world.part()
        from mpi4py import MPI

        # what ranks wait for here is apart from what they compute
        self._comm = MPI.Intracomm(MPI.COMM_WORLD.Dup())
        self.count = self._comm.size - 1

    def led(self, action: Callable[[], T]) -> T | None:
        """By rank 0; its result stays there, for it may be large."""
        found: list[T] = []
        launch.on_rank_0(self._comm, lambda: found.append(action()))
        return found[0] if found else None

    def blind(self, folder: Path) -> str:
        """Every rank looks for a file that rank 0 writes; the first one that does not find it."""
        folder, name = self._comm.bcast((folder, f"{_PROBE}.{uuid.uuid4().hex}"))
        self.led((folder / name).touch)
        mine = "" if _shows(folder, name) else f"rank {launch.rank()} on {socket.gethostname()}"
        found = self._comm.allgather(mine)
        self.led(functools.partial((folder / name).unlink, missing_ok=True))
        return next(filter(None, found), "")

    def shortage(self, needs: Sequence[float]) -> str | None:
        """Each machine asks for as many of the largest as it has ranks that solve."""
        from mpi4py import MPI

        needs = self._comm.bcast([*needs])
        here = self._comm.Split_type(MPI.COMM_TYPE_SHARED)
        mine = None
        if here.rank == 0:
            leads = self._comm.rank == 0
            most = [*needs[: here.size - leads]]
            if leads and most:
                # rank 0 beside the ranks that solve
                most[0] += RANK_MB
            mine = shortage(most, room(), f"the sweep on {socket.gethostname()}")
        here.Free()
        return next((text for text in self._comm.allgather(mine) if text is not None), None)

    @contextlib.contextmanager
    def at_work(self, points: int) -> Iterator[Submit | None]:
        """Rank 0 submits; who raises there has to end all ranks, as no other one is told."""
        from mpi4py.futures import MPICommExecutor

        if self._comm.rank > 0:
            self._serve()
            yield None
            return
        with contextlib.ExitStack() as stack:
            executor = stack.enter_context(MPICommExecutor(self._comm, root=0))
            assert executor is not None
            try:
                yield functools.partial(executor.submit, _task)
            except BaseException:
                # its end would wait for every point that is being solved
                stack.pop_all()
                raise

    def _serve(self) -> None:
        """Solve what rank 0 submits, until it has no more."""
        from mpi4py.futures import MPICommExecutor

        import fiberbend.running.runner  # noqa: F401

        try:
            with _quiet(), MPICommExecutor(self._comm, root=0):
                pass
        except KeyboardInterrupt as error:
            _leave(error)

    def ended(self, code: int) -> int:
        """Ranks wait for rank 0, which draws meanwhile, without taking a core."""
        request = self._comm.Ibarrier()
        while not request.Test():
            time.sleep(_PAUSE)
        return int(self._comm.bcast(code))


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Within, what libraries print does not get among the lines for the user."""
    sys.stdout.flush()
    own = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(own, 1)
        os.close(own)


def _task(function: Callable[..., Any], *arguments: Any) -> Any:
    """A task on a rank that serves; a signal that comes meanwhile ends the launch."""
    try:
        return function(*arguments)
    except KeyboardInterrupt as error:
        _leave(error)


def _leave(error: KeyboardInterrupt) -> None:
    """End after a signal; where it has come to all, rank 0 speaks and mpirun ends this one."""
    launch.leave(stop_of(error).code, f"rank {launch.rank()} stopped")


def _shows(folder: Path, name: str) -> bool:
    """Whether a file that another machine has just written shows here."""
    end = time.monotonic() + _PATIENCE
    while True:
        with contextlib.suppress(OSError):
            if name in os.listdir(folder):
                return True
        if time.monotonic() > end:
            return False
        time.sleep(_PAUSE)
