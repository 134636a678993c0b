"""Rank and number of ranks by what an MPI launcher sets, known before MPI starts."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from pathlib import Path

_LAUNCHES = (
    ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", ()),
    # srun --mpi=pmix gives no size of its own
    ("PMIX_RANK", "SLURM_STEP_NUM_TASKS", ("PMIX_NAMESPACE",)),
    ("PMI_RANK", "PMI_SIZE", ("PMI_FD", "PMI_PORT")),
)
"""Variables of rank and size by launcher, and those of which one shows that it is there.

A batch job sets SLURM_PROCID and SLURM_NTASKS for its script too, and shells hand on PMI_RANK:
alone they are no launch.
"""

_PASSED_ON = 0.3
"""Seconds in which a launcher passes on what a process has said, before it is told to end it."""


def rank() -> int:
    """Rank of this process, 0 without an MPI launch."""
    return _launch()[0]


def size() -> int:
    """Number of ranks, 1 without an MPI launch."""
    return _launch()[1]


def launched() -> bool:
    """Whether an MPI launcher has started this process."""
    return _launch()[2]


def launcher() -> str:
    """The mpirun of this Python's MPI: beside it, where it came as a wheel, or the system's."""
    own = Path(sys.executable).with_name("mpirun")
    return str(own) if own.exists() else "mpirun"


def foreign_launcher() -> bool:
    """Whether Open MPI's mpirun has started a Python that has MPICH's beside it.

    MPICH, asked to start under it, ends the process with pages of its own.
    """
    return "OMPI_COMM_WORLD_SIZE" in os.environ and _has_mpich()


def end_launch(code: int) -> None:
    """End all ranks, MPI not started, where the launcher lets the others go on: MPICH's.

    Args:
        code: exit code of the launcher.
    """
    wire = os.environ.get("PMI_FD", "")
    if size() > 1 and wire.isdecimal() and _has_mpich():
        sys.stdout.flush()
        sys.stderr.flush()
        time.sleep(_PASSED_ON)
        with contextlib.suppress(OSError):
            os.write(int(wire), f"cmd=abort exitcode={code}\n".encode())


def _has_mpich() -> bool:
    """Whether this Python has a launcher of MPICH of its own."""
    return Path(sys.executable).with_name("mpiexec.hydra").exists()


def _launch() -> tuple[int, int, bool]:
    for rank_name, size_name, signs in _LAUNCHES:
        if signs and not any(name in os.environ for name in signs):
            continue
        own, count = (os.environ.get(name, "") for name in (rank_name, size_name))
        if own.isdecimal() or (count.isdecimal() and not signs):
            return int(own or 0), int(count) if count.isdecimal() else 1, True
    return 0, 1, False
