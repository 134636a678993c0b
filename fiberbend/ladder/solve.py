"""A rung solved in a process of its own, with times and memory as the system counts them."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import yaml

from fiberbend.calibration.store import Store
from fiberbend.ladder.asked import asked
from fiberbend.ladder.record import FAILED, LATE, Record, key_of
from fiberbend.ladder.rungs import AXIAL, SECTION, Rung
from fiberbend.results.folder import HISTORY_FILE, RUN_FILE
from fiberbend.results.reading import read_history
from fiberbend.running.record import provenance

_PAUSE = 0.02
_GRACE = 3.0
"""Seconds between the signal that asks a process to stop and the one that makes it."""
_BUSY = 4.0
"""A process may take so many times its processor time where others run."""
_PLACE = re.compile(r"^(\w+\.)+(?=[A-Z]\w*: )")
"""The module of an error's class, as Python prints it."""
_TAIL = 2000
"""Characters of what a process has said that are looked at for its reason."""


@dataclasses.dataclass(frozen=True)
class _Ended:
    """How a process has ended."""

    code: int
    wall_s: float
    usage: Any
    late: bool


@dataclasses.dataclass(frozen=True)
class _Found:
    """What a process had to make that others keep.

    Attributes:
        compiled: kernels.
        calibration: digest of the calibration that it used; empty without one.
        made: it made that itself.
    """

    compiled: bool
    calibration: str
    made: bool


class Processes:
    """Solves rungs in a process each; remembers which calibrations it has seen being made."""

    def __init__(self) -> None:
        self._timed: set[str] = set()

    def __call__(self, rung: Rung, most_s: float | None = None, verbose: bool = False) -> Record:
        """Solve a rung; whatever goes wrong is its record.

        A first run that had to compile kernels counts for nothing, and one that took a calibration
        from before counts for little: how busy the machine was then is not known. It is run again,
        and calibrates.

        Args:
            rung: the rung.
            most_s: seconds of processor time, or four times as many of any, after which it is
                stopped; no limit by default.
            verbose: let it print its load steps.
        """
        record, found = _once(rung, most_s, verbose)
        timed = found.calibration in self._timed or (found.made and not found.compiled)
        again = bool(found.calibration) and not timed
        if record.status not in (FAILED, LATE) and (found.compiled or again):
            if again:
                Store().forget(found.calibration)
            record, _ = _once(rung, most_s, verbose)
        if record.status not in (FAILED, LATE):
            self._timed.add(found.calibration)
        return record


def solve(rung: Rung, most_s: float | None = None, verbose: bool = False) -> Record:
    """Solve one rung, as `Processes` does."""
    return Processes()(rung, most_s, verbose)


def _once(rung: Rung, most_s: float | None, verbose: bool) -> tuple[Record, _Found]:
    with tempfile.TemporaryDirectory(prefix="fiberbend-rung-") as name:
        scratch = Path(name)
        case, run, notes = (scratch / each for each in ("case.yaml", "run", "notes.json"))
        text = yaml.safe_dump(rung.case.resolved(), sort_keys=False, allow_unicode=True)
        case.write_text(text, encoding="utf-8")
        talk = "verbose" if verbose else "quiet"
        with (scratch / "errors").open("w+b") as errors:
            ended = _run([str(case), str(run), str(notes), talk], most_s, errors)
            errors.seek(0, os.SEEK_END)
            errors.seek(max(0, errors.tell() - _TAIL))
            said = errors.read().decode(errors="replace").strip().splitlines()
        found, own = _json(run / RUN_FILE), _json(notes)
        rows = read_history(run / HISTORY_FILE) if (run / HISTORY_FILE).exists() else []
    once, kept = _once_s(found)
    status, reason = _status(found, ended, said, most_s)
    values = {
        each.name: value
        for each in asked(rung.case)
        if rows and (value := each.value(rows, status == "converged")) is not None
    }
    record = Record(
        name=rung.name,
        family=dataclasses.asdict(rung.family),
        mesh=_mesh(rung),
        unknowns=int(found.get("unknowns") or rung.unknowns),
        values=values if status not in (FAILED, LATE) else {},
        status=status,
        reason=reason,
        wall_s=round(ended.wall_s + kept, 3),
        cpu_s=round(ended.usage.ru_utime + ended.usage.ru_stime + kept, 3),
        once_s=round(once, 3),
        solve_wall_s=round((found.get("wall_s") or {}).get("solve", 0.0), 3),
        solve_cpu_s=round(own.get("cpu_s", {}).get("solve", 0.0), 3),
        load_steps=int(found.get("load_steps") or 0),
        iterations=int(found.get("newton_iterations") or 0),
        peak_memory_MB=round(ended.usage.ru_maxrss / 1024, 1),
        key=key_of(rung),
        # the BLAS is the solver's: this process has loaded none
        provenance=provenance() | {name: found[name] for name in ("blas",) if found.get(name)},
    )
    entry = found.get("calibration") or {}
    made = bool(entry.get("seconds"))
    return record, _Found(bool(own.get("compiled")), str(entry.get("digest") or ""), made)


def _mesh(rung: Rung) -> dict[str, float]:
    """Section and length of elements, of those that the model has."""
    found: dict[str, float] = {}
    if SECTION in rung.mesh:
        found[SECTION] = rung.case.mesh.section
    if AXIAL in rung.mesh:
        found["axial_mm"] = rung.case.mesh.axial
    return found


def _once_s(run: dict[str, Any]) -> tuple[float, float]:
    """Seconds of what a run needs once and keeps, and those of it that an earlier run has spent.

    The entry `calibration` of run.json says what a calibration took (`took_seconds`), and what of
    it this run has spent (`seconds`).
    """
    entry = run.get("calibration") or {}
    spent = float(entry.get("seconds") or 0.0)
    took = float(entry.get("took_seconds") or spent)
    return took, took - spent


def _status(
    run: dict[str, Any], ended: _Ended, said: list[str], most_s: float | None
) -> tuple[str, str]:
    if ended.late:
        return LATE, f"stopped after {ended.wall_s:.0f} s, much more than --within allows"
    status = run.get("status")
    if status in ("converged", "stopped", FAILED):
        return str(status), str(run.get("reason") or "")
    if ended.code < 0:
        name = signal.Signals(-ended.code).name
        more = ", as by the system where memory runs out" if ended.code == -signal.SIGKILL else ""
        return FAILED, f"its process was ended by {name}{more}"
    # of the name of an error its last part
    return FAILED, _PLACE.sub(
        "", said[-1]
    ) if said else f"its process ended with exit code {ended.code}"


def _run(arguments: list[str], most_s: float | None, errors: IO[bytes]) -> _Ended:
    """Run the child to its end; a signal to this process ends it too."""
    command = [sys.executable, "-m", "fiberbend.ladder.child", *arguments, str(os.getpid())]
    begun = time.monotonic()
    late = False
    # a group of its own: a Ctrl-C in the terminal is this process's to hand on
    with _started(command, errors) as child:
        while True:
            pid, code, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                child.returncode = os.waitstatus_to_exitcode(code)
                break
            if most_s is not None and not late:
                late = _cpu_s(child.pid) > most_s or time.monotonic() - begun > _BUSY * most_s
                if late:
                    _kill(child.pid, signal.SIGKILL)
            time.sleep(_PAUSE)
    return _Ended(child.returncode, time.monotonic() - begun, usage, late)


@contextlib.contextmanager
def _started(command: list[str], errors: IO[bytes]) -> Iterator[subprocess.Popen[bytes]]:
    child = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stderr=errors,
        start_new_session=True,
        env=os.environ | {"PYTHONSAFEPATH": "1", "PYTHONPATH": _path()},
    )
    try:
        yield child
    finally:
        if child.returncode is None:
            _kill(child.pid, signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                child.wait(_GRACE)
            _kill(child.pid, signal.SIGKILL)
            child.wait()


def _cpu_s(pid: int) -> float:
    """Processor time that a process has taken so far, s; nothing where the system does not say."""
    try:
        # behind the name in brackets, which may hold anything: fields 14 and 15 of proc(5)
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _path() -> str:
    """Where the other process finds this very program."""
    own, others = str(Path(__file__).resolve().parents[2]), os.environ.get("PYTHONPATH", "")
    return os.pathsep.join(filter(None, (own, others)))


def _kill(group: int, number: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(group, number)


def _json(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}
