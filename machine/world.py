"""What MPI is told before it starts; whether a rank computes with the others, how it ends all."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Iterator
from importlib import metadata
from typing import Any

_HEARD = 0.2
"""Seconds in which a launcher reads what a rank has said."""
_NO_SIGNALS = {"UCX_DEBUG_SIGNO": "0", "UCX_HANDLE_ERRORS": "none"}
"""UCX: by default SIGHUP makes it say more, and a crash print pages."""
_NO_NETWORK = {"OMPI_MCA_btl_tcp_disable_family": "6"}
"""Open MPI: the version of IP that it does without."""
_LIBRARY = "MPI4PY_LIBMPI"
"""mpi4py as a wheel: the library that it loads."""


class _World:
    alone = False


def part() -> None:
    """Let this rank compute by itself.

    Libraries that start by words between all ranks, as PETSc does, would wait for those that do
    not load them.
    """
    _World.alone = True


def parted() -> bool:
    """Whether it does."""
    return _World.alone


def _beside() -> dict[str, str]:
    """The library of PyPI's MPICH, where it is among the packages of this Python.

    mpi4py looks for it by the prefix of Python alone. Where packages are taken from elsewhere, it
    would load another MPI of the system, and PETSc, linked with MPICH's, would not load.
    """
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        return {}
    places = (os.path.realpath(path.locate()) for path in files if path.name == "libmpi.so.12")
    found = next(filter(os.path.exists, places), None)
    return {_LIBRARY: found} if found else {}


@contextlib.contextmanager
def starting() -> Iterator[None]:
    """While MPI is loaded and starts: it is that of PETSc, takes no signals, needs no network.

    Open MPI of Debian 13 (5.0.7) loads UCX, which takes SIGHUP and the signals of a crash. And
    where a machine has IPv4 and IPv6, each of its ranks complains that one does not reach the
    other, though they talk by memory. What the user has set stays, and nothing is left behind.
    """
    wanted = _NO_SIGNALS | _beside()
    ranks = os.environ.get("OMPI_COMM_WORLD_SIZE", "")
    if ranks and ranks == os.environ.get("OMPI_COMM_WORLD_LOCAL_SIZE"):
        wanted |= _NO_NETWORK
    new = {name: value for name, value in wanted.items() if name not in os.environ}
    os.environ.update(new)
    try:
        yield
    finally:
        for name in new:
            del os.environ[name]


def be_heard() -> None:
    """Wait until the launcher has read what this rank has said: MPICH's drops the rest at the end.

    Open MPI's reads all of it.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    time.sleep(_HEARD)


def end_all(comm: Any, code: int) -> None:
    """End all ranks of a communicator, also where a signal comes meanwhile."""
    try:
        be_heard()
    finally:
        comm.Abort(code)
