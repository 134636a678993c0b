"""One rank and two give the same answer."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from mpi4py import MPI

from tests.conftest import MpiRun
from tests.fem.spread import measure


@pytest.mark.mpi
def test_two_ranks_equal_one(mpirun: MpiRun) -> None:
    # both converge to 1e-8 of the forces by themselves; what remains is the order of sums
    run = mpirun(2, ["-m", "tests.fem.spread"])
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout.splitlines()[-1])
    serial = measure(MPI.COMM_SELF)
    assert found.keys() == serial.keys()
    for name, value in serial.items():
        assert found[name] == pytest.approx(value, rel=1e-8), name


ALONE = """
import os, signal, sys
import fem
from mpi4py import MPI

print("begun " + str(MPI.COMM_WORLD.rank))  # in one piece: launchers mix what ranks write
if MPI.COMM_WORLD.rank == {rank}:
    {fault}
MPI.COMM_WORLD.Barrier()
"""
FAULTS = {
    "raise RuntimeError('out of luck')": (1, "RuntimeError: out of luck"),
    "os.kill(os.getpid(), signal.SIGINT)": (130, "KeyboardInterrupt"),
    "os.kill(os.getpid(), signal.SIGTERM)": (143, ""),
    "os.kill(os.getpid(), signal.SIGKILL)": (137, ""),
}


@pytest.mark.mpi
@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("rank", [0, 1])
def test_what_ends_one_rank_of_a_program_ends_all(
    rank: int, fault: str, mpirun: MpiRun, tmp_path: Path
) -> None:
    """Whoever uses `fem` alone: the other rank would wait for ever, and mpirun with it."""
    script = tmp_path / "alone.py"
    script.write_text(ALONE.format(rank=rank, fault=fault), encoding="utf-8")
    run = mpirun(2, [script], timeout=60)
    code, said = FAULTS[fault]
    assert run.returncode != 0
    if said or MPI.get_vendor()[0] == "Open MPI":
        assert run.returncode == code
    # else a signal has ended the rank, and MPICH's launcher returns the signal's number, or a
    # library's own code where it has caught the signal
    assert run.stderr.count(said) == 1 or not said
    if said:
        assert "Traceback" in run.stderr
        assert f"begun {rank}" in run.stdout
