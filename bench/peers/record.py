"""What a run of one program on one mesh leaves: a JSON file each."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

GOALS = (90.0, 180.0)
"""Angles in degrees that are compared."""
_POLL = 0.05
"""Seconds between looks at a process."""


@dataclasses.dataclass(frozen=True)
class Usage:
    """What a process has taken.

    Attributes:
        wall: s.
        cpu: s, of all its threads.
        memory: greatest resident set, MB.
        load: load average of the machine just before.
        code: it returned; None when it was ended at its limit of time.
    """

    wall: float
    cpu: float
    memory: float
    load: float
    code: int | None


def run(
    command: Sequence[str], folder: Path, limit: float, extra: Mapping[str, str], log: Path
) -> Usage:
    """Run a program by itself and measure it.

    Args:
        command: with arguments.
        folder: to run it in.
        limit: of its wall time, s.
        extra: variables of the environment.
        log: file for what it prints.
    """
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    with log.open("w", encoding="utf-8") as out:
        load, start = os.getloadavg()[0], time.perf_counter()
        process = subprocess.Popen(
            command,
            cwd=folder,
            env={**os.environ, **threads, **extra},
            stdout=out,
            stderr=subprocess.STDOUT,
        )
        late = False
        while True:
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if not late and time.perf_counter() - start > limit:
                process.kill()
                late = True
            time.sleep(_POLL)
        process.returncode = os.waitstatus_to_exitcode(status)
        wall = time.perf_counter() - start
    code = None if late else process.returncode
    return Usage(wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, load, code)


@dataclasses.dataclass(frozen=True)
class Record:
    """A program on a mesh.

    Attributes:
        program: its name.
        version: of it.
        section: elements through each thickness.
        axial: length of the elements, mm.
        elements: number of solid elements.
        unknowns: number.
        kPa: pressure of every load step that converged.
        degrees: bending angle there.
        done: Newton iterations until then, with those that were given up.
        iterations: in total.
        wall: s.
        cpu: s.
        memory: greatest resident set, MB.
        load: load average of the machine just before.
        ended: how it came to its end, in words; empty when it reached the last goal.
    """

    program: str
    version: str
    section: int
    axial: float
    elements: int
    unknowns: int
    kPa: list[float]
    degrees: list[float]
    done: list[int]
    iterations: int
    wall: float
    cpu: float
    memory: float
    load: float
    ended: str

    @property
    def reached(self) -> float:
        """Greatest angle, °."""
        return max(self.degrees, default=0.0)

    def pressure(self, goal: float) -> float | None:
        """Pressure in kPa at an angle, by a cubic spline of all load steps; None beyond them."""
        from scipy.interpolate import CubicSpline

        if self.reached < goal * (1 - 1e-9):
            return None
        angles = np.array([0.0, *self.degrees])
        keep = np.r_[True, np.diff(angles) > 0]
        return float(CubicSpline(angles[keep], np.array([0.0, *self.kPa])[keep])(goal))

    def share(self, goal: float) -> float | None:
        """Part of the iterations until an angle is reached."""
        for angle, done in zip(self.degrees, self.done, strict=True):
            if angle >= goal * (1 - 1e-9):
                return done / max(1, self.iterations)
        return None

    def steps(self, goal: float) -> int:
        """Load steps until an angle is reached."""
        return 1 + sum(angle < goal * (1 - 1e-9) for angle in self.degrees)

    def save(self, path: Path) -> None:
        """Write it."""
        path.write_text(json.dumps(dataclasses.asdict(self), indent=1) + "\n", encoding="utf-8")


def load_record(path: Path) -> Record:
    """A record that was saved."""
    return Record(**json.loads(path.read_text(encoding="utf-8")))
