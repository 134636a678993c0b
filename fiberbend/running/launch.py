"""How this process was launched, and how it ends with all other ranks."""

from __future__ import annotations

import functools
import os
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, TextIO, TypeVar, cast

from fiberbend.process import beside, ranks
from fiberbend.process.ranks import rank as rank
from fiberbend.process.ranks import size as size
from fiberbend.process.signals import Interrupted
from machine import world
from machine.folders import MachineError, settle

if TYPE_CHECKING:
    from fiberbend.case.case import Case

FAILED = 2
"""Exit code of a solution that failed."""

_PATIENCE = 5.0
"""Seconds that an error of one rank waits for that of the others; all end within ten."""
_HASTE = 0.3
"""The same for a signal: mpirun kills a second after it has handed one on."""
_GRACE = 1.5
_ALONE = {
    "OMPI_MCA_ess_singleton_isolated": "1",
    "OMPI_MCA_pml": "ob1",
    "OMPI_MCA_btl": "self",
}
"""Open MPI's settings for a process that talks to itself only."""
_STRAY = "PMIX_RANK"
"""What a shell may hand on without a launch, and MPICH does not start with."""


class _Group:
    """All ranks, apart from what they compute together: by a communicator of its own."""

    comm: Any = None
    error = ""


_group = _Group()


def set_threads() -> None:
    """Give each of several ranks one BLAS thread, before numpy is loaded.

    With more, ranks and threads fight for the cores. A value set outside is kept.
    """
    if size() > 1:
        for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
            os.environ.setdefault(name, "1")


def settle_folders() -> None:
    """Give libraries folders that they can use, before they are loaded; say what is not followed.

    Raises:
        MachineError: no folder can be used.
    """
    for line in settle():
        say(f"fiberbend: {line}", sys.stderr)


def start_mpi() -> None:
    """Start MPI; without mpirun in a quarter of the time, by looking for no other process.

    What is set for it is taken back: an mpirun that is launched from here must not find it. An
    error that nobody catches ends all ranks from here on.

    Raises:
        MachineError: the launcher belongs to another MPI, so that every process ends or takes
            itself for the whole; or no folder can be used.
    """
    from machine.kernel import settle_kernel

    settle_folders()
    settle_kernel()
    if ranks.foreign_launcher():
        raise MachineError(
            "launched by the mpirun of Open MPI; this Python has MPICH: take its own, "
            f"{ranks.launcher()}"
        )
    alone = not ranks.launched()
    new = [name for name in _ALONE if alone and name not in os.environ]
    os.environ.update({name: _ALONE[name] for name in new})
    stray = {_STRAY: os.environ.pop(_STRAY)} if alone and _STRAY in os.environ else {}
    try:
        with warnings.catch_warnings(), world.starting():
            # of another launcher, of which the error below speaks
            warnings.filterwarnings("ignore", "suspicious MPI", RuntimeWarning)
            from mpi4py import MPI
    finally:
        os.environ.update(stray)
        for name in new:
            del os.environ[name]
    if MPI.COMM_WORLD.size < size():
        raise MachineError(
            f"rank {rank()} of {size()}, but MPI has started {MPI.COMM_WORLD.size}: expected the "
            f"mpirun of {MPI.get_vendor()[0]}, {ranks.launcher()}, or srun --mpi=pmix"
        )
    if MPI.COMM_WORLD.size > 1 and _group.comm is None:
        _group.comm = MPI.COMM_WORLD.Dup()
        sys.excepthook = _end_all
    _say_slow_kernel()


@functools.cache
def _say_slow_kernel() -> None:
    """Once, where a script has loaded numpy before this program could choose."""
    from machine import origin
    from machine.kernel import slow_kernel

    line = slow_kernel(origin.blas()) if "numpy" in sys.modules else ""
    if line and rank() == 0:
        say(f"fiberbend: {line}", sys.stderr)


def all_here(seconds: float) -> bool:
    """Whether all ranks come to this point within a time; True where this one is alone.

    Errors of all ranks are one error, of which one rank speaks. Where others compute on, they wait
    for this one for ever, and have to be ended.
    """
    if _group.comm is None:
        return size() == 1
    request = _group.comm.Ibarrier()
    # the first rank to give up ends the others before they speak
    end = time.monotonic() + seconds * (1 + 0.1 * min(rank(), 9))
    while not request.Test():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True


def all_stopped() -> bool:
    """Whether all ranks have been stopped by a signal, as mpirun does."""
    return all_here(_HASTE)


def stopped(stop: Interrupted) -> int:
    """Say what a signal has left, from one rank, and end all ranks; the exit code."""
    if stop.together is None:
        stop.together = all_stopped()
    if rank() == 0 or not stop.together:
        print(f"fiberbend: {stop.reason}", file=sys.stderr, flush=True)
    if not stop.together:
        leave(stop.code)
    return stop.code


def leave(code: int, reason: str = "") -> None:
    """End all ranks after a signal, where there are others: they may wait for this one.

    mpirun has ended them before where the signal came from there.

    Args:
        code: exit code.
        reason: a line for the user where it has not.
    """
    if _group.comm is None:
        return
    time.sleep(_GRACE)
    if reason:
        print(f"fiberbend: {reason}", file=sys.stderr, flush=True)
    end_all(code)


def end_all(code: int) -> None:
    """End all ranks at once, where there are others."""
    if _group.comm is not None:
        world.end_all(_group.comm, code)


def refuse(text: str, code: int) -> int:
    """Say what is wrong with the input, from one rank; the exit code.

    Every rank finds the same and ends by itself, MPI or not. What one rank alone finds ends all.
    """
    if _group.comm is None or all_here(_PATIENCE):
        say(text, sys.stderr)
        _group.error = text
    else:
        print(f"rank {rank()}: {text}", file=sys.stderr, flush=True)
        end_all(code)
    return code


T = TypeVar("T")


def on_rank_0(comm: Any, action: Callable[[], T]) -> T:
    """Result of an action of rank 0 on every rank, or its error on every rank; collective."""
    outcome: tuple[T | None, Exception | None] = (None, None)
    if comm.rank == 0:
        try:
            outcome = (action(), None)
        except Exception as error:
            outcome = (None, error)
    outcome = comm.bcast(outcome)
    value, problem = outcome
    if problem is not None:
        raise problem
    return cast(T, value)


def let_rank_0_speak(code: int) -> None:
    """Delay the end of another rank: all are killed when the first one ends with an error.

    Rank 0 ends long before the time is up, and mpirun then ends this rank too; else it has found
    nothing, and this one speaks. Once MPI is up, its own end waits for all ranks.
    """
    if "mpi4py.MPI" in sys.modules or size() == 1:
        return
    if rank() == 0:
        ranks.end_all(code)
        return
    time.sleep(_PATIENCE)
    print(f"rank {rank()}: {_group.error}", file=sys.stderr, flush=True)
    ranks.end_all(code)


def say(text: str, stream: TextIO | None = None) -> None:
    """A line for the user, from one rank.

    Args:
        text: the line.
        stream: where to write, the standard output by default.
    """
    if rank() == 0:
        print(text, file=stream or sys.stdout, flush=True)


def crash(error: BaseException, out: Path) -> int:
    """Leave a log and end all ranks: those that wait for this one would wait for ever.

    Args:
        error: what has ended the command.
        out: its folder, which may not be there yet.

    Returns:
        The exit code, where all ranks end by themselves.
    """
    import traceback

    log = out / f"error.rank{rank()}.log" if out.is_dir() else Path(f"fiberbend.rank{rank()}.log")
    what = traceback.format_exception_only(error)[-1].strip().splitlines()[0]
    try:
        log.write_text("".join(traceback.format_exception(error)), encoding="utf-8")
        where = f"; see {log}"
    except OSError:
        where = ""
    together = all_here(_PATIENCE / 2)
    if not together or rank() == 0:
        print(f"fiberbend: rank {rank()} stopped: {what}{where}", file=sys.stderr, flush=True)
    if not together:
        end_all(FAILED)
    return FAILED


def _end_all(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """What becomes of an error that nobody catches, such as of a script: it ends all ranks."""
    together = all_here(_PATIENCE / 2)
    if not together or rank() == 0:
        sys.__excepthook__(kind, error, trace)
    if not together:
        end_all(1)


def prepare_drawing(case: Case) -> None:
    """Start the process that draws beside a run of seconds; see `fiberbend.process.beside`.

    It imports meanwhile what drawing needs. One that waits beside a body of minutes would only
    take memory.

    Args:
        case: the case that is run.
    """
    from fiberbend.models.choice import choose_model

    model = choose_model(case)[0].elements()
    if case.output.pictures and model is not None and not model.shared:
        beside.prepare("fiberbend.running.outputs", "fiberbend.drawing.curves", "pyvista")
