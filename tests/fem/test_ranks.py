"""One rank and two give the same answer."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest
from mpi4py import MPI

from tests.conftest import MpiRun, killed_by
from tests.fem.spread import measure


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("cell", "ranks"),
    [("hexahedron", 2), pytest.param("tetrahedron", 3, marks=pytest.mark.long)],
)
def test_ranks_equal_one(cell: str, ranks: int, mpirun: MpiRun) -> None:
    # both converge to 1e-8 of the forces by themselves; what remains is the order of sums
    run = mpirun(ranks, ["-m", "tests.fem.spread", cell])
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout.splitlines()[-1])
    serial = measure(MPI.COMM_SELF, cell)
    assert found.keys() == serial.keys()
    for name, value in serial.items():
        assert found[name] == pytest.approx(value, rel=1e-8), name


ALONE = """
import os, signal, sys
import fem
from mpi4py import MPI

sys.stdout.write(f"begun {{MPI.COMM_WORLD.rank}}\\n")  # at once, so that lines stay whole
if MPI.COMM_WORLD.rank == {rank}:
    {fault}
MPI.COMM_WORLD.Barrier()
"""
FAULTS = {
    "raise RuntimeError('out of luck')": (1, "RuntimeError: out of luck"),
    "os.kill(os.getpid(), signal.SIGINT)": (130, "KeyboardInterrupt"),
    "os.kill(os.getpid(), signal.SIGTERM)": (killed_by(signal.SIGTERM), ""),
    "os.kill(os.getpid(), signal.SIGKILL)": (killed_by(signal.SIGKILL), ""),
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
    assert run.returncode == code
    assert run.stderr.count(said) == 1 or not said
    if said:
        assert "Traceback" in run.stderr
        assert f"begun {rank}" in run.stdout
