"""What MPI is told before it starts; whether a rank computes with the others, how it ends all."""

from __future__ import annotations

import os
import sys
import time
from typing import Any

_HEARD = 0.2
"""Seconds in which a launcher reads what a rank has said."""


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


def keep_hangup() -> None:
    """Leave SIGHUP to this process; before MPI is loaded.

    UCX, which carries the messages of some MPIs, would take it to print more of its own: a run
    whose terminal has gone would go on.
    """
    os.environ.setdefault("UCX_DEBUG_SIGNO", "0")


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
