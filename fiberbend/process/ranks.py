"""Rank and number of ranks by what an MPI launcher sets, known before MPI starts."""

from __future__ import annotations

import contextlib
import os
import sys
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
    beside = Path(sys.executable).with_name("mpiexec.hydra")
    return "OMPI_COMM_WORLD_SIZE" in os.environ and beside.exists()


def end_all(code: int) -> None:
    """End all ranks by MPICH's launcher where MPI has not started: it lets the others go on.

    Others end all ranks when the first one ends with an error.
    """
    if "HYDI_CONTROL_FD" in os.environ and "PMI_FD" in os.environ:
        from machine import world

        world.be_heard()
        with contextlib.suppress(OSError, ValueError):
            os.write(int(os.environ["PMI_FD"]), f"cmd=abort exitcode={code}\n".encode())


def _launch() -> tuple[int, int, bool]:
    for rank_name, size_name, signs in _LAUNCHES:
        if signs and not any(name in os.environ for name in signs):
            continue
        own, count = (os.environ.get(name, "") for name in (rank_name, size_name))
        if own.isdecimal() or (count.isdecimal() and not signs):
            return int(own or 0), int(count) if count.isdecimal() else 1, True
    return 0, 1, False
