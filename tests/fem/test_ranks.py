"""One rank and two give the same answer."""

from __future__ import annotations

import json

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
