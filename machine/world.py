"""Whether a rank of a launch computes with the others, or by itself; said before fem is loaded."""

from __future__ import annotations


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
