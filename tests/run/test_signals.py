"""A run that is told to stop, and ranks of which one fails: one line, and nothing goes on alone."""

from __future__ import annotations

import json
import re
import signal
import time
from pathlib import Path
from typing import Any

import pytest
import yaml

from bench.survive import LIMIT, end, files, kill, launch, session
from fiberbend.cli import main
from fiberbend.results.reading import read_history
from tests.conftest import MpiRun, heard_when_stopped
from tests.run.conftest import small

STOPPED = (
    r"fiberbend: (stopped at step (\d+), kept; go on with --resume)\n"
    r"|fiberbend: (stopped after the last load step, (\d+): .*)\n"
)


def _stop(ranks: int, number: int, tmp_path: Path) -> tuple[int, str, dict[str, Any]]:
    """Exit code, last lines and run.json of a run that gets a signal after its first step."""
    case, out = tmp_path / "case.yaml", tmp_path / "run"
    output = {"fields": False, "pictures": False}
    case.write_text(
        yaml.safe_dump(small(solver={"max_step": "1 kPa"}, mesh={"axial": "8 mm"}, output=output))
    )
    process = launch(ranks, ["run", case, "--out", out])
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith("step   1"):
            break
    while (run := json.loads((out / "run.json").read_text()))["load_steps"] is None:
        time.sleep(0.01)
    assert run["status"] == "running"
    begin = time.monotonic()
    process.send_signal(number)
    code, text = end(process)
    while session(process.pid):
        assert time.monotonic() - begin < LIMIT, "a rank goes on"
        time.sleep(0.05)
    run = json.loads((out / "run.json").read_text())
    if run["status"] != "running":  # else killed by mpirun, maybe while it wrote
        assert not any(".part" in name for name in files(out))
    return code, text, run


@pytest.mark.parametrize(
    "number", [signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.long)]
)
def test_a_run_that_is_told_to_stop_keeps_its_steps(number: int, tmp_path: Path) -> None:
    """Also where a library of MPI would take the signal for itself."""
    code, text, run = _stop(1, number, tmp_path)
    assert code == 128 + number
    assert_said(text, run)


def test_a_run_says_from_its_beginning_that_it_runs(tmp_path: Path) -> None:
    case, out = tmp_path / "case.yaml", tmp_path / "run"
    case.write_text(yaml.safe_dump(small(model="section")))
    process = launch(1, ["run", case, "--out", out, "--verbose"])
    assert process.stdout is not None
    assert process.stdout.readline() == "mesh …\n"
    kill(process)
    run = json.loads((out / "run.json").read_text())
    assert (run["status"], run["model"]) == ("running", "section")


@pytest.mark.mpi
def test_told_to_stop_on_two_ranks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By mpirun, which has an exit code of its own; with time to end beside other tests."""
    monkeypatch.setenv("OMPI_MCA_odls_base_sigkill_timeout", "6")
    _, text, run = _stop(2, signal.SIGINT, tmp_path)
    if run["status"] == "interrupted":  # else killed by mpirun within a long call, its steps kept
        assert run["reason"] == f"stopped at step {run['load_steps']}, kept; go on with --resume"
        if text or heard_when_stopped():
            assert_said(text, run)
    else:
        assert run["status"] == "running"
    assert run["ranks"] == 2
    assert run["load_steps"] >= 1


@pytest.mark.long
@pytest.mark.parametrize("phase", ["crosscheck", "output", "report"])
def test_told_to_stop_after_the_last_load_step(phase: str, tmp_path: Path) -> None:
    """The curves are whole, and a run says so; the rest is made by --resume."""
    case, out = tmp_path / "case.yaml", tmp_path / "run"
    case.write_text(yaml.safe_dump(small(model="section")))
    process = launch(1, ["run", case, "--out", out, "--verbose"])
    assert process.stdout is not None
    for line in process.stdout:
        if line == f"{phase} …\n":
            break
    process.send_signal(signal.SIGINT)
    code, text = end(process)
    assert code == 130
    assert "stopped after the last load step" in text
    assert "nothing kept" not in text
    run = json.loads((out / "run.json").read_text())
    rows = read_history(out / "history.csv")
    assert (run["status"], run["load_steps"]) == ("interrupted", len(rows) - 1)
    assert (rows[-1]["pressure_kPa"] or 0) > 0
    assert main(["plot", str(out), "--out", str(tmp_path / "a.png")]) == 0
    assert main(["report", str(out)]) == 0
    assert main(["run", str(case), "--out", str(out), "--resume", "--quiet"]) == 0
    run = json.loads((out / "run.json").read_text())
    assert run["status"] == "converged"
    assert {"output", "report"} <= run["wall_s"].keys()


def assert_said(text: str, run: dict[str, Any]) -> None:
    """One line, of one rank, and the same in run.json."""
    # a signal by mpirun may come late
    [(line, step)] = [tuple(filter(None, found)) for found in re.findall(STOPPED, text)]
    assert (run["status"], run["reason"], run["load_steps"]) == ("interrupted", line, int(step))


FAILS = """
import sys
import fiberbend
from fiberbend.running import launch

launch.start_mpi()
from mpi4py import MPI

if MPI.COMM_WORLD.rank == 1:
    raise RuntimeError("out of luck")
MPI.COMM_WORLD.Barrier()
"""
WRONG = """
import sys
from fiberbend.running import launch
from fiberbend.cli import entry

sys.argv[1:] = ["validate", "none.yaml"] if launch.rank() == 1 else ["validate", {case!r}]
if launch.rank() == 0:
    import time
    time.sleep({late})
entry()
"""


@pytest.mark.mpi
def test_an_error_of_one_rank_of_a_script_ends_all(mpirun: MpiRun, tmp_path: Path) -> None:
    script = tmp_path / "fails.py"
    script.write_text(FAILS, encoding="utf-8")
    begin = time.monotonic()
    done = mpirun(2, [script], timeout=60)
    assert done.returncode == 1
    assert time.monotonic() - begin < 15, "ten seconds, and the start"
    assert done.stderr.count("RuntimeError: out of luck") == 1


@pytest.mark.mpi
def test_what_one_rank_alone_finds_is_said(mpirun: MpiRun, tmp_path: Path) -> None:
    """A file that is missing on another computer: rank 0 has nothing to say of it."""
    script = tmp_path / "wrong.py"
    case = str(Path(__file__).resolve().parents[2] / "cases" / "section.yaml")
    script.write_text(WRONG.format(case=case, late=LIMIT), encoding="utf-8")
    done = mpirun(2, [script], timeout=60)
    assert done.returncode == 1
    assert "rank 1: none.yaml: no such file" in done.stderr
