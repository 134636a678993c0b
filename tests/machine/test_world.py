"""How one rank ends all: what it has said comes first, and a signal does not keep it from it."""

from __future__ import annotations

import os

import pytest

from machine import world


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


def test_a_hangup_is_left_to_the_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("UCX_DEBUG_SIGNO", "SIGUSR2")
    world.keep_hangup()
    assert os.environ["UCX_DEBUG_SIGNO"] == "SIGUSR2"
    monkeypatch.delenv("UCX_DEBUG_SIGNO")
    world.keep_hangup()
    assert os.environ["UCX_DEBUG_SIGNO"] == "0"
