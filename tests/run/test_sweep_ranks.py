"""A sweep by the ranks of mpirun: the same table as by the local pool, whoever is killed."""

from __future__ import annotations

import csv
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml

from bench.survive import session
from tests.conftest import MPIRUN, ROOT
from tests.run.test_sweep import LAST, NAMES, SWEEP, Lab, alive, wait_for

TIMES = {"wall_s"}
"""Columns of sweep.csv with a time."""
HUNG = NAMES[2]
CUBE = SWEEP | {
    "title": "Twenty-seven actuators",
    "vary": {
        "actuator.radius": ["7 mm", "8 mm", "9 mm"],
        "actuator.wall": ["1.5 mm", "2 mm", "2.5 mm"],
        "actuator.floor": ["1.5 mm", "2 mm", "3 mm"],
    },
    "report": {"angles": ["10 deg", "20 deg"], "maps": [], "history": ["crown_stretch"]},
}


@pytest.fixture
def lab(tmp_path: Path) -> Lab:
    return Lab(tmp_path)


def rank_of(pid: int) -> str:
    """The rank of a process of mpirun, or nothing."""
    for entry in Path(f"/proc/{pid}/environ").read_bytes().split(b"\0"):
        name, _, value = entry.decode(errors="replace").partition("=")
        if name == "OMPI_COMM_WORLD_RANK":
            return value
    return ""


def gone(process: subprocess.Popen[str]) -> None:
    """Nothing of a command goes on."""
    wait_for(lambda: not session(process.pid))


def without_times(path: Path) -> str:
    """A table as text, but for its times."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    kept = [name for name in rows[0] if name not in TIMES]
    assert len(kept) == len(rows[0]) - len(TIMES)
    return "\n".join(",".join(row[name] for name in kept) for row in rows)


class Cube:
    """The sweep of 27 sections with the real solver."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.file = folder, folder / "cube.yaml"
        self.file.write_text(yaml.safe_dump(CUBE, sort_keys=False), encoding="utf-8")

    def start(self, out: str, *arguments: str, ranks: int = 0) -> subprocess.Popen[str]:
        launcher = ["mpirun", "-n", str(ranks)] if ranks else []
        command = [*launcher, sys.executable, "-m", "fiberbend", "sweep", str(self.file)]
        return subprocess.Popen(
            [*command, "--out", str(self.folder / out), *arguments],
            env=os.environ | MPIRUN | {"PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def end(self, process: subprocess.Popen[str]) -> str:
        """What it has printed; it has ended well."""
        out, err = process.communicate(timeout=300)
        assert (process.returncode, err) == (0, "")
        return out


@pytest.mark.mpi
def test_27_points_with_one_rank_killed_give_the_table_of_the_pool(tmp_path: Path) -> None:
    """Table, trends and histories byte for byte, but for the times."""
    cube = Cube(tmp_path)
    process = cube.start("ranks", ranks=3)
    points = tmp_path / "ranks" / "points"
    wait_for(lambda: len(list(points.glob("*/run.json"))) > 9)
    [victim] = [pid for pid in session(process.pid) if rank_of(pid) == "2"]
    os.kill(victim, signal.SIGKILL)
    process.communicate(timeout=60)
    assert process.returncode == 137
    gone(process)
    before = {path: path.stat().st_mtime_ns for path in points.glob("*/history.csv")}
    assert 5 < len(before) < 25
    text = cube.end(cube.start("ranks", ranks=3))
    found = int(text.partition("27 points, ")[2].split()[0])
    assert len(before) - 2 <= found <= len(before)
    assert "27 points: 27 converged" in text
    kept = [path for path, when in before.items() if path.stat().st_mtime_ns == when]
    assert len(kept) >= found
    cube.end(cube.start("pool", "-j", "2"))
    for name in ("trends.md", "sweep.json"):
        assert (tmp_path / "ranks" / name).read_bytes() == (tmp_path / "pool" / name).read_bytes()
    tables = [without_times(tmp_path / out / "sweep.csv") for out in ("ranks", "pool")]
    assert tables[0] == tables[1]
    histories = sorted(points.glob("*/history.csv"))
    assert len(histories) == 27
    for path in histories:
        same = tmp_path / "pool" / path.relative_to(tmp_path / "ranks")
        assert path.read_bytes() == same.read_bytes()
