"""What `make survive` runs: a command in a session of its own, what it leaves, and its tables."""

from __future__ import annotations

import contextlib
import functools
import json
import os
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bench.ranks import MPIRUN
from fiberbend.process.ranks import launcher

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "stability.md"
LIMIT = 300.0
"""Seconds after which a command hangs."""
_LEADER = "FIBERBEND_LEADER"
_ENDS = {".png": b"IEND\xaeB`\x82", ".csv": b"\n", ".yaml": b"\n", ".msh": b"\n$EndElements\n"}
"""How a file of a kind ends."""


def launch(ranks: int, arguments: Sequence[str | Path]) -> subprocess.Popen[str]:
    """`fiberbend` on some ranks, in a session of its own, with signals as a terminal has them."""
    environment = os.environ | MPIRUN | {"PYTHONPATH": str(ROOT)}
    mpirun = [launcher(), "-n", str(ranks)] if ranks > 1 else []
    return subprocess.Popen(
        led([*mpirun, sys.executable, "-m", "fiberbend", *map(str, arguments)]),
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
        # a shell's background job, and all that it starts, would ignore Ctrl-C
        preexec_fn=functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )


def led(command: Sequence[str]) -> list[str]:
    """A command all of whose processes know the number of the first one.

    MPICH's launcher gives each rank a session of its own.
    """
    return ["bash", "-c", f'export {_LEADER}=$$; exec "$@"', "bash", *command]


def session(number: int) -> list[int]:
    """Processes of a session, and all others of a command that is `led`, that still run."""
    found = []
    led_by = f"{_LEADER}={number}".encode()
    for entry in Path("/proc").iterdir():
        if not entry.name.isdecimal():
            continue
        with contextlib.suppress(OSError):
            state, *numbers = (entry / "stat").read_text().rpartition(")")[2].split()
            if state != "Z" and (
                int(numbers[2]) == number or led_by in (entry / "environ").read_bytes().split(b"\0")
            ):
                found.append(int(entry.name))
    return found


def kill(process: subprocess.Popen[str]) -> str:
    """Kill a command and all that it has started at once, as a power cut does; what it printed."""
    while pids := session(process.pid):
        for pid in pids:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        time.sleep(0.01)
    return process.communicate(timeout=LIMIT)[0]


def end(process: subprocess.Popen[str]) -> tuple[int, str]:
    """Exit code of a command, and what it printed; it is killed where it hangs."""
    try:
        out, _ = process.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return -1, kill(process) + f"\nhangs: no end after {LIMIT:g} s"
    return process.returncode, out


def files(folder: Path) -> list[str]:
    """Files of a folder and those below it."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def broken(path: Path) -> str:
    """What is wrong with a file, or nothing; by its kind."""
    try:
        if path.suffix == ".npz":
            with np.load(path) as arrays:
                dict(arrays)
        elif path.suffix == ".json":
            json.loads(path.read_text())
        elif path.suffix in (".vtu", ".vtp", ".vtm", ".pvd"):
            ET.parse(path)
        elif not path.read_bytes().endswith(_ENDS.get(path.suffix, b"")):
            return f"{path.name} is cut off"
    except Exception as error:
        return f"{path.name}: {error}"
    return ""


def put(name: str, lines: Sequence[str]) -> None:
    """Write a part of docs/stability.md between its marks, at the end where it is not there yet."""
    begin, last = f"<!-- {name}, by `make survive` -->", f"<!-- end of {name} -->"
    text = PAGE.read_text(encoding="utf-8")
    before, found, rest = text.partition(begin)
    after = rest.partition(last)[2] if found else ""
    if not found:
        before = before.rstrip("\n") + "\n\n"
    block = "\n".join([begin, *lines, last])
    PAGE.write_text(f"{before}{block}{after or chr(10)}", encoding="utf-8")


def kept(text: str) -> str:
    """The parts of a page that `put` has written, for who writes the rest of it."""
    begin = text.find("<!-- ")
    return "\n" + text[begin:].rstrip("\n") if begin >= 0 else ""
