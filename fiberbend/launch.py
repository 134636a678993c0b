"""How this process was launched, known before MPI starts: rank, number of ranks, threads."""

from __future__ import annotations

import os

_RANK = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID")
_SIZE = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_NTASKS")


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


def _first(names: tuple[str, ...], default: int) -> int:
    for name in names:
        value = os.environ.get(name, "")
        if value.isdecimal():
            return int(value)
    return default
