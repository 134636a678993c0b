"""What tests share."""

from __future__ import annotations

import functools
import os
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from bench.ranks import MPIRUN
from fiberbend.process.ranks import launcher

ROOT = Path(__file__).resolve().parent.parent
MpiRun = Callable[..., "subprocess.CompletedProcess[str]"]
BESIDE_OTHERS = {
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_hwloc_default_binding_policy": "none",  # of Open MPI 5
}
"""Ranks that wait leave their core to the tests that run beside them, and none is tied to one."""


def killed_by(number: int) -> int:
    """Exit code of `launcher` where a signal has killed a rank; that of the wheels adds no 128."""
    return 128 + number if launcher() == "mpirun" else number


@functools.cache
def heard_when_stopped() -> bool:
    """Whether `launcher`, told to stop, prints what ranks say in the time that it leaves them.

    Open MPI 5 leaves a quarter of a second, and sleeps meanwhile.
    """
    said = subprocess.run([launcher(), "--version"], capture_output=True, text=True).stdout
    found = re.search(r"\(Open MPI\) (\d+)", said)
    return found is None or int(found[1]) < 5


@pytest.fixture(scope="session")
def mpirun() -> MpiRun:
    """Launch Python on several ranks: `mpirun(2, ["-m", "fiberbend", …], cwd=…)`."""

    def launch(
        ranks: int, arguments: Sequence[str | Path], cwd: Path = ROOT, timeout: float = 300.0
    ) -> subprocess.CompletedProcess[str]:
        environment = os.environ | MPIRUN | BESIDE_OTHERS
        command = [launcher(), "-n", str(ranks), sys.executable, *map(str, arguments)]
        return subprocess.run(
            command, cwd=cwd, env=environment, timeout=timeout, capture_output=True, text=True
        )

    return launch
