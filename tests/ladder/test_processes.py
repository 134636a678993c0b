"""A real ladder in its own processes: to its end, killed, told to stop, too slow."""

from __future__ import annotations

import dataclasses
import functools
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fiberbend.ladder.command import Options
from fiberbend.ladder.record import FAILED, LATE, Record
from fiberbend.ladder.rungs import ladder
from fiberbend.ladder.solve import _once_s, solve
from tests.conftest import ROOT

SECTION = ROOT / "cases" / "section.yaml"
ONLY = Options(only=("analytic", "section-spread"))


QUICK = ["--set", "effects.0.pressure.angle=20 deg", "--set", "output.at_angles=[10 deg, 20 deg]"]


def command(out: Path, *more: str) -> list[str]:
    only = ["--only", "analytic", "--only", "section-spread"]
    program = [sys.executable, "-m", "fiberbend", "accuracy", str(SECTION)]
    return [*program, "--out", str(out), *only, *QUICK, *more]


def environment() -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}


@pytest.mark.long
def test_a_real_ladder_end_to_end(tmp_path: Path) -> None:
    done = subprocess.run(
        command(tmp_path / "out"),
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=900,
    )
    assert done.returncode == 0, done.stderr
    assert "section-spread-s4" in done.stdout
    assert 'take "section, spread winding' in done.stdout
    found = {}
    for path in (tmp_path / "out" / "rungs").glob("*.json"):
        each = Record.of(json.loads(path.read_text()))
        found[each.name] = each
    assert set(found) == {"analytic-spread", *(f"section-spread-s{n}" for n in (1, 2, 3, 4))}
    for name, each in found.items():
        assert each.status == "converged", each.reason
        assert 0 < each.solve_cpu_s < each.cpu_s
        assert 0 < each.solve_wall_s < each.wall_s
        assert each.peak_memory_MB > 50
        assert set(each.values) == {"pressure_10deg_kPa", "pressure_20deg_kPa"}
        if name != "analytic-spread":
            assert each.iterations >= each.load_steps > 0
            assert each.unknowns > 0
    # finer meshes are softer, and their limit is near the last
    last = [found[f"section-spread-s{n}"].values["pressure_20deg_kPa"] for n in (1, 2, 3, 4)]
    assert last == sorted(last, reverse=True)
    text = (tmp_path / "out" / "accuracy.md").read_text()
    assert "section, spread winding (reference)" in text
    # nothing but what is named is left, and no process
    names = {path.name for path in (tmp_path / "out").iterdir()} - {".lock"}
    assert names == {"rungs", *(f"accuracy.{end}" for end in ("csv", "json", "md", "png"))}


def test_killed_it_goes_on_and_leaves_no_process(tmp_path: Path) -> None:
    out = tmp_path / "out"
    first = subprocess.Popen(
        command(out), cwd=tmp_path, env=environment(), stdout=subprocess.PIPE, text=True
    )
    assert first.stdout is not None
    for line in first.stdout:
        if line.startswith("[ 2/5]"):
            break
    children = Path(f"/proc/{first.pid}/task/{first.pid}/children")
    end = time.monotonic() + 60
    while not (running := children.read_text().split()) and time.monotonic() < end:
        time.sleep(0.01)
    first.kill()
    first.wait()
    first.stdout.close()
    assert running
    while any(Path(f"/proc/{pid}").exists() for pid in running) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(Path(f"/proc/{pid}").exists() for pid in running)
    kept = {path.name: path.stat().st_mtime_ns for path in (out / "rungs").glob("*.json")}
    assert len(kept) == 2
    done = subprocess.run(
        command(out), cwd=tmp_path, env=environment(), capture_output=True, text=True, timeout=900
    )
    assert done.returncode == 0, done.stderr
    assert "5 rungs, 2 solved before" in done.stdout
    now = {path.name: path.stat().st_mtime_ns for path in (out / "rungs").glob("*.json")}
    assert len(now) == 5
    assert kept.items() <= now.items()


def test_a_signal_ends_it_in_order(tmp_path: Path) -> None:
    out = tmp_path / "out"
    first = subprocess.Popen(
        command(out),
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        text=True,
        # a shell's & and nohup ignore it, and so would the ladder
        preexec_fn=functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    assert first.stdout is not None
    said = []
    for line in first.stdout:
        said.append(line)
        if line.startswith("[ 1/5]"):
            first.send_signal(signal.SIGINT)
    assert first.wait(60) == 128 + signal.SIGINT, "".join(said)
    assert "interrupted; the same command goes on where it was\n" in said
    assert list((out / "rungs").glob("*.json"))


def test_what_is_done_once_counts_in_every_rung() -> None:
    assert _once_s({}) == (0.0, 0.0)
    assert _once_s({"calibration": {"seconds": 4.0, "took_seconds": 4.0}}) == (4.0, 0.0)
    assert _once_s({"calibration": {"seconds": 0.0, "took_seconds": 4.0}}) == (4.0, 4.0)
    assert _once_s({"calibration": {"stiffness_MPa_per_mm": 0.7}}) == (0.0, 0.0)


def test_a_rung_that_takes_too_long_is_stopped() -> None:
    rung = next(rung for rung in ladder(SECTION).rungs if rung.family.model == "section")
    found = solve(rung, most_s=0.3)
    assert found.status == LATE
    assert "--within" in found.reason
    assert found.values == {}


def test_a_process_that_fails_is_named_with_its_reason() -> None:
    rung = next(rung for rung in ladder(SECTION).rungs if rung.family.model == "section")
    actuator = rung.case.actuator.model_copy(update={"wall": -1.0})
    wrong = rung.case.model_copy(update={"actuator": actuator})
    found = solve(dataclasses.replace(rung, case=wrong))
    assert found.status == FAILED
    assert "actuator.wall" in found.reason
