"""What a run leaves, how it ends, and that symmetry, ranks and restarts do not change it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend import run
from fiberbend.models.result import RunResult
from fiberbend.results.folder import HISTORY_COLUMNS, RUN_KEYS
from fiberbend.results.reading import read_history
from tests.conftest import MpiRun
from tests.run.conftest import small, write_case

COMPARED = ("pressure_kPa", "angle_deg", "tip_y_mm", "tip_z_mm", "chamber_mm3")


def command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """`fiberbend` in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "fiberbend", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=600,
    )


def assert_same(rows: list[Any], other: list[Any], tolerance: float) -> None:
    """The last rows agree, relative to the larger of the value and one unit."""
    for column in COMPARED:
        a, b = float(rows[-1][column]), float(other[-1][column])
        assert abs(a - b) <= tolerance * max(1.0, abs(a)), column


def test_folder_has_what_is_promised(small_run: RunResult) -> None:
    """Scripts rely on these names."""
    assert small_run.status == "converged"
    assert small_run.folder is not None
    folder = small_run.folder
    run_json = json.loads((folder / "run.json").read_text())
    assert set(RUN_KEYS) <= set(run_json)
    header = (folder / "history.csv").read_text().splitlines()[0].split(",")
    assert tuple(header[: len(HISTORY_COLUMNS)]) == HISTORY_COLUMNS
    for name in ("case.resolved.yaml", "actuator.msh", "checkpoint.npz"):
        assert (folder / name).stat().st_size > 0
    for name in ("pressure_angle", "tip_path", "undeformed", "cut", "bent_008deg", "montage"):
        assert (folder / "pictures" / f"{name}.png").stat().st_size > 5_000
    assert (folder / "fields" / "008deg.vtm").exists()
    assert not list(folder.glob(".*"))


def test_requests_are_hit_exactly(small_run: RunResult) -> None:
    """Pictures at 90° must be at 90°, not near it."""
    angles = [row["angle_deg"] for row in small_run.rows]
    pressures = [row["pressure_kPa"] for row in small_run.rows]
    assert min(abs(a - 8.0) for a in angles) < 1e-6
    assert min(abs(p - 30.0) for p in pressures) < 1e-9
    assert pressures[-1] == pytest.approx(60.0, abs=1e-9)


def test_history_is_physical(small_run: RunResult) -> None:
    """Signs, orders of magnitude and stability at every step."""
    rows = small_run.rows
    assert np.all(np.diff([row["angle_deg"] for row in rows]) > 0)
    assert np.all(np.diff([row["chamber_mm3"] for row in rows]) > 0)
    assert rows[0]["tip_y_mm"] > rows[-1]["tip_y_mm"]
    assert all(row["unstable_modes"] == 0 for row in rows[1:])
    assert all(0 < row["min_det_F"] <= 1.0 for row in rows)
    # a point loses volume beside a fiber, an element does not: Newton stops at 1e-8
    assert rows[-1]["min_det_F"] < 0.99
    for column in ("volume_error_element", "volume_error"):
        assert all(0 <= row[column] < 1e-6 for row in rows)
    # a hoop carries about P (a + t) pitch / 2 = 0.9 N; bending and the floor's contraction more
    assert 0.5 < rows[-1]["fiber_max_N"] < 10.0


def test_work_of_the_pressure_is_stored(small_run: RunResult) -> None:
    """The pressure is the only load: ∫ P dV is the stored energy; 1e-3 for the few-point spline."""
    row = small_run.rows[-1]
    assert row["work_mJ"] == pytest.approx(row["stored_mJ"], rel=1e-3)


def test_full_body_equals_half(small_run: RunResult) -> None:
    """The mirror plane is exact; gmsh places mirrored nodes to 2e-8 mm."""
    full = run(small(mesh={"axial": "4 mm", "symmetry": "full"}))
    assert full.run["half"] is False
    assert small_run.run["half"] is True
    assert full.run["unknowns"] > 1.8 * small_run.run["unknowns"]
    half = run(small())
    assert_same(half.rows, full.rows, 1e-6)
    for column in ("fiber_max_N", "stored_mJ"):
        assert full.last(column) == pytest.approx(half.last(column), rel=1e-5)


@pytest.mark.mpi
def test_two_ranks_equal_one(small_run: RunResult, mpirun: MpiRun, tmp_path: Path) -> None:
    """A number must not depend on the machine's cores."""
    case = write_case(tmp_path, small(output={"at_angles": ["8 deg"], "at_pressures": ["30 kPa"]}))
    done = mpirun(2, ["-m", "fiberbend", "run", case, "--out", tmp_path / "run"])
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("step   1") == 1
    rows = read_history(tmp_path / "run" / "history.csv")
    assert len(rows) == len(small_run.rows)
    assert_same(small_run.rows, rows, 1e-8)


def test_volume_control_reaches_the_same_state(small_run: RunResult) -> None:
    """Bordering: the pressure found for a volume is the one that gives the volume."""
    volume = small_run.last("chamber_mm3")
    other = run(small(effects=[{"pressure": {"volume": f"{volume} mm^3"}}, small()["effects"][1]]))
    assert other.last("chamber_mm3") == pytest.approx(volume, rel=1e-9)
    assert other.last("pressure_kPa") == pytest.approx(60.0, rel=1e-6)
    assert other.last("angle_deg") == pytest.approx(small_run.last("angle_deg"), rel=1e-6)


def test_gravity_acts_the_way_it_points() -> None:
    """Weight toward −y bends the clamped body down, toward +y up, by the same first-order angle."""
    materials = {
        "wall": "elastosil-m4601",
        "floor": {"name": "combined-base", "density": "1.2 g/cm^3"},
        "sheath": "ecoflex-0030",
    }
    angles = {
        sign: run(
            small(
                materials=materials,
                effects=[{"gravity": {"direction": f"{sign}y"}}],
                output={"fields": False, "pictures": False},
            )
        ).last("angle_deg")
        for sign in "+-"
    }
    assert angles["-"] > 0 > angles["+"]
    assert angles["-"] == pytest.approx(-angles["+"], rel=0.05)


def test_an_angle_that_is_not_reached_stops(tmp_path: Path) -> None:
    """Not a failure: status 'stopped', said so, exit code 0."""
    case = write_case(tmp_path, small(output={"at_angles": ["90 deg"], "pictures": False}))
    done = command("run", case, "--out", tmp_path / "run")
    assert done.returncode == 0
    assert "90° not reached" in done.stderr
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "stopped"


def test_a_load_beyond_reach_fails_and_loses_nothing(tmp_path: Path) -> None:
    """Exit code 2, the cause, and the last converged state saved and drawn."""
    case = write_case(
        tmp_path,
        small(
            effects=[{"pressure": {"to": "50 MPa"}}, small()["effects"][1]],
            solver={"max_cutbacks": 2},
            output={},
        ),
    )
    done = command("run", case, "--out", tmp_path / "run")
    assert done.returncode == 2
    assert "last converged state" in done.stderr
    result = json.loads((tmp_path / "run" / "run.json").read_text())
    assert result["status"] == "failed"
    assert result["cutbacks"] >= 3
    assert len(read_history(tmp_path / "run" / "history.csv")) == result["load_steps"] + 1
    assert (tmp_path / "run" / "snapshots" / "last.npz").exists()
    assert (tmp_path / "run" / "pictures" / "pressure_angle.png").exists()


def test_a_killed_run_resumes_to_the_same_answer(tmp_path: Path) -> None:
    """Killed after its second step; round-off apart, nothing tells the two runs from each other."""
    whole = tmp_path / "whole"
    case = write_case(tmp_path, small(solver={"max_step": "12 kPa"}))
    assert command("run", case, "--out", whole).returncode == 0
    cut = tmp_path / "cut"
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "fiberbend", "run", str(case), "--out", str(cut)],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith("step   3"):
            break
    while not (cut / "checkpoint.npz").exists():
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    before = len(read_history(cut / "history.csv"))
    done = command("run", case, "--out", cut, "--resume")
    assert done.returncode == 0, done.stderr
    assert "resumed after step" in done.stdout
    rows = read_history(cut / "history.csv")
    assert before < len(rows) == len(read_history(whole / "history.csv"))
    assert_same(read_history(whole / "history.csv"), rows, 1e-9)
