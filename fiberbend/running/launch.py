"""How this process was launched, known before MPI starts: rank, number of ranks, threads."""

from __future__ import annotations

import os
import sys
import time
import traceback
from pathlib import Path
from typing import TextIO

from machine.folders import settle

FAILED = 2
"""Exit code of a solution that failed."""

_RANK = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID")
_PATIENCE = 20.0
_SIZE = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_NTASKS")
_ALONE = {
    "OMPI_MCA_ess_singleton_isolated": "1",
    "OMPI_MCA_pml": "ob1",
    "OMPI_MCA_btl": "self",
}
"""Open MPI's settings for a process that talks to itself only."""


def rank() -> int:
    """Rank of this process, 0 without mpirun."""
    return _first(_RANK, 0)


def size() -> int:
    """Number of ranks, 1 without mpirun."""
    return _first(_SIZE, 1)


def set_threads() -> None:
    """Give each of several ranks one BLAS thread, before numpy is loaded.

    With more, ranks and threads fight for the cores. A value set outside is kept.
    """
    if size() > 1:
        for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
            os.environ.setdefault(name, "1")


def start_mpi() -> None:
    """Start MPI; without mpirun in a quarter of the time, by looking for no other process.

    What is set for it is taken back: an mpirun that is launched from here must not find it.
    """
    for line in settle():
        say(f"fiberbend: {line}", sys.stderr)
    alone = not any(name in os.environ for name in (*_RANK, *_SIZE))
    new = [name for name in _ALONE if alone and name not in os.environ]
    os.environ.update({name: _ALONE[name] for name in new})
    try:
        import mpi4py.MPI  # noqa: F401
    finally:
        for name in new:
            del os.environ[name]


def let_rank_0_speak() -> None:
    """Delay the end of another rank: mpirun kills all when the first one ends with an error.

    Rank 0 ends long before the time is up, and mpirun then ends this rank too. Once MPI is up,
    its own end waits for all ranks.
    """
    if rank() > 0 and "mpi4py.MPI" not in sys.modules:
        time.sleep(_PATIENCE)


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
        The exit code, where this process is alone.
    """
    log = out / f"error.rank{rank()}.log" if out.is_dir() else Path(f"fiberbend.rank{rank()}.log")
    what = traceback.format_exception_only(error)[-1].strip().splitlines()[0]
    try:
        log.write_text("".join(traceback.format_exception(error)), encoding="utf-8")
        where = f"; see {log}"
    except OSError:
        where = ""
    print(f"fiberbend: rank {rank()} stopped: {what}{where}", file=sys.stderr, flush=True)
    if size() > 1:
        from mpi4py import MPI

        MPI.COMM_WORLD.Abort(FAILED)
    return FAILED


def _first(names: tuple[str, ...], default: int) -> int:
    for name in names:
        value = os.environ.get(name, "")
        if value.isdecimal():
            return int(value)
    return default
