"""How ranks start without a word, and how one ends all: what it has said comes first."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from bench.ranks import MPIRUN
from fiberbend.process.ranks import launcher
from machine import world
from tests.conftest import ROOT

NETWORK = "OMPI_MCA_btl_tcp_disable_family"
SIGNALS = {"UCX_DEBUG_SIGNO": "0", "UCX_HANDLE_ERRORS": "none"}
START = """
import os, sys
{imports}
from fiberbend.running.launch import start_mpi
start_mpi()
from mpi4py import MPI
# in one piece: launchers mix what ranks write
sys.stdout.write(f"{{MPI.COMM_WORLD.allreduce(1)}} {{{name!r} in os.environ}}\\n")
"""
"""How many ranks a rank counts, and whether a setting is left behind."""


@pytest.mark.mpi
@pytest.mark.parametrize("imports", ["", "import fem"])
def test_ranks_of_one_machine_start_without_a_word(imports: str) -> None:
    """By the command as by a script; also where the machine has IPv4 and IPv6."""
    environment = os.environ | MPIRUN | {"PYTHONPATH": str(ROOT)}
    del environment[NETWORK]
    script = START.format(imports=imports, name=NETWORK)
    command = [launcher(), "-n", "2", sys.executable, "-c", script]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == 2 * "2 False\n"


CAUGHT = """
import re
{imports}
from fiberbend.running.launch import start_mpi
start_mpi()
text = open("/proc/self/status", encoding="utf-8").read()
caught = int(re.search(r"SigCgt:\\s*(\\w+)", text)[1], 16)
print([number for number in (1, 4, 13, 15) if caught >> (number - 1) & 1])
"""
"""Those of SIGHUP, SIGILL, SIGPIPE and SIGTERM that a process takes."""


@pytest.mark.parametrize("imports", ["", "import fem"])
def test_mpi_takes_no_signals(imports: str) -> None:
    """A script ends when its terminal is closed, and a crash in one line."""
    environment = {name: value for name, value in os.environ.items() if "UCX" not in name}
    command = [sys.executable, "-c", CAUGHT.format(imports=imports)]
    done = subprocess.run(
        command, env=environment | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "[]\n", "")


@pytest.mark.parametrize(
    ("variables", "there"),
    [
        ({"OMPI_COMM_WORLD_SIZE": "4", "OMPI_COMM_WORLD_LOCAL_SIZE": "4"}, "6"),
        ({"OMPI_COMM_WORLD_SIZE": "4", "OMPI_COMM_WORLD_LOCAL_SIZE": "2"}, None),
        ({"OMPI_COMM_WORLD_SIZE": "1", "OMPI_COMM_WORLD_LOCAL_SIZE": "1", NETWORK: "4"}, "4"),
        ({"UCX_DEBUG_SIGNO": "SIGUSR1"}, None),
        ({}, None),
    ],
)
def test_several_machines_keep_every_network(
    variables: dict[str, str], there: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And what the user has set stays."""
    monkeypatch.setattr("os.environ", dict(variables))
    with world.starting():
        assert os.environ.get(NETWORK) == there
        assert SIGNALS | variables | os.environ == os.environ
    assert os.environ == variables


class _Comm:
    """A communicator that remembers with which code it was ended."""

    def __init__(self) -> None:
        self.codes: list[int] = []

    def Abort(self, code: int) -> None:
        """End all ranks."""
        self.codes.append(code)


def test_all_are_ended_once_the_launcher_has_read(monkeypatch: pytest.MonkeyPatch) -> None:
    comm, slept = _Comm(), list[float]()
    monkeypatch.setattr(world.time, "sleep", slept.append)
    world.end_all(comm, 2)
    assert (comm.codes, slept) == ([2], [world._HEARD])


def test_a_signal_meanwhile_ends_all_too(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_seconds: float) -> None:
        raise KeyboardInterrupt

    comm = _Comm()
    monkeypatch.setattr(world.time, "sleep", interrupted)
    with pytest.raises(KeyboardInterrupt):
        world.end_all(comm, 130)
    assert comm.codes == [130]
