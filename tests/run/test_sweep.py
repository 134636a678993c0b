"""Sweeps: no point twice, none lost, whatever is killed; and the table says what the runs say.

Most of it runs with a solver of a few lines, but in real processes, locks and folders.
"""

from __future__ import annotations

import csv
import functools
import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from bench.ranks import MPIRUN
from bench.survive import led
from fiberbend.sweep.store import MARK
from tests.conftest import ROOT, launcher

SWEEP: dict[str, Any] = {
    "title": "Six actuators",
    "case": str(ROOT / "cases" / "free_bending_smeared.yaml"),
    "set": {
        "model": "section",
        "effects.0": {"pressure": {"angle": "20 deg"}},
        "output": {"pictures": False, "fields": False},
    },
    "vary": {
        "actuator.radius": ["7 mm", "8 mm"],
        "actuator.wall": ["1.5 mm", "2 mm", "2.5 mm"],
    },
    "report": {"angles": ["10 deg", "20 deg"], "maps": []},
}
NAMES = [f"radius-{r}mm_wall-{w}mm" for r in (7, 8) for w in (1.5, 2, 2.5)]
LAST = NAMES[-1]

SOLVER = '''
"""Stands for fiberbend.running.runner. FAKE holds what happens at which point, "name=what …"."""
import os, signal, sys, time, types
from pathlib import Path

ACTS = dict(item.split("=", 1) for item in os.environ["FAKE"].split() if "=" in item)

def run_case(case, out, overwrite=False, progress=None, resume=False, force=False, comm=None):
    assert comm.size == 1
    from fiberbend.models.result import RunResult
    from fiberbend.results.folder import RunFolder
    folder = RunFolder.resume(out, case) if resume else RunFolder.create(out, case, overwrite)
    with open(os.environ["FAKE_LOG"], "a") as log:
        mpi = "mpi4py.MPI" in sys.modules
        log.write(f"{out.name} {os.getpid()} {'resumed' if resume else 'fresh'} {mpi}\\n")
    act = ACTS.get(out.name, ACTS.get("all", ""))
    begun = [line.split()[0] for line in open(os.environ["FAKE_LOG"])].count(out.name)
    if act == "hang" or act == "hang-once" and begun == 1:
        folder.write_text("checkpoint.npz", "half of it")
        time.sleep(600)
    if act == "slow":
        time.sleep(0.4)
    if act == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if act == "raise":
        raise ArithmeticError("nothing converges")
    status = "failed" if act == "fail" else "converged"
    reason = "det F at element 7" if act == "fail" else ""
    p = case.actuator.wall / case.actuator.radius
    rows = [{"step": n, "pressure_kPa": n * p, "angle_deg": 10.0 * n} for n in range(3)]
    folder.write_history(rows)
    run = {"status": status, "reason": reason, "model": case.model}
    folder.write_run(**run)
    return RunResult(status, reason, rows, run, out)

module = types.ModuleType("fiberbend.running.runner")
module.run_case = run_case
sys.modules["fiberbend.running.runner"] = module
'''


class Lab:
    """A sweep file, its folder, and the command with the solver above."""

    def __init__(self, folder: Path) -> None:
        self.file, self.out, self.log = folder / "six.yaml", folder / "out", folder / "log"
        self.file.write_text(yaml.safe_dump(SWEEP, sort_keys=False), encoding="utf-8")
        (folder / "site").mkdir()
        (folder / "site" / "sitecustomize.py").write_text(SOLVER, encoding="utf-8")
        self.site = folder / "site"

    def start(self, *arguments: str, ranks: str = "", **acts: str) -> subprocess.Popen[str]:
        """The command in a session of its own; what happens at which point, by its name.

        By mpirun where there is a number of ranks.
        """
        path = [str(self.site), str(ROOT)]
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join(path),
            "FAKE": " ".join(f"{name}={act}" for name, act in acts.items()),
            "FAKE_LOG": str(self.log),
            **(MPIRUN if ranks else {}),
        }
        command = [launcher(), "-n", ranks] if ranks else []
        command = [*command, sys.executable, "-m", "fiberbend", "sweep", str(self.file), "--out"]
        return subprocess.Popen(
            led([*command, str(self.out), *arguments]),
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            # a shell's background job, and all that it starts, would ignore Ctrl-C
            preexec_fn=functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
        )

    def run(self, *arguments: str, ranks: str = "", **acts: str) -> tuple[int, str, str]:
        """The command to its end: exit code, output and errors."""
        process = self.start(*arguments, ranks=ranks, **acts)
        out, err = process.communicate(timeout=120)
        return process.returncode, out, err

    def starts(self) -> Counter[str]:
        """How often the solver was called for each point."""
        return Counter(line.split()[0] for line in self._lines())

    def pids(self, name: str) -> list[int]:
        """The processes that have begun a point."""
        return [int(line.split()[1]) for line in self._lines() if line.split()[0] == name]

    def table(self) -> list[dict[str, str]]:
        """The rows of sweep.csv."""
        with (self.out / "sweep.csv").open(newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def finished(self) -> dict[str, int]:
        """When run.json of each finished point was written, in ns."""
        paths = [self.out / "points" / name / "run.json" for name in NAMES]
        marked = [path for path in paths if path.exists() and MARK in json.loads(path.read_text())]
        return {path.parent.name: path.stat().st_mtime_ns for path in marked}

    def _lines(self) -> list[str]:
        return self.log.read_text().splitlines() if self.log.exists() else []


@pytest.fixture
def lab(tmp_path: Path) -> Lab:
    return Lab(tmp_path)


def wait_for(condition: Callable[[], object]) -> None:
    for _ in range(3000):
        if condition():
            return
        time.sleep(0.02)
    raise AssertionError("it does not come to pass")


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    return state != "Z"


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_every_point_once_and_none_again(lab: Lab, jobs: str) -> None:
    """A second call of the same command has nothing to do."""
    code, out, err = lab.run("-j", jobs)
    assert (code, err) == (0, "")
    assert "6 points: 6 converged" in out
    assert lab.starts() == Counter(NAMES)
    before = lab.finished()
    assert [row["point"] for row in lab.table()] == NAMES
    code, out, _ = lab.run("-j", jobs)
    assert code == 0
    assert "6 points, 6 finished before" in out
    assert lab.starts() == Counter(NAMES)
    assert lab.finished() == before


def test_workers_import_once(lab: Lab) -> None:
    """A process a point would spend its time on imports."""
    lab.run("-j", "2", all="slow")
    pids = {pid for name in NAMES for pid in lab.pids(name)}
    assert len(pids) == 2


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_mpi_is_started_before_the_solver(lab: Lab, jobs: str) -> None:
    """As runs do, in a quarter of the time that the solver's import would take for it."""
    lab.run("-j", jobs)
    assert [line.split()[3] for line in lab.log.read_text().splitlines()] == ["True"] * 6


def test_the_first_point_is_alone(lab: Lab) -> None:
    """It compiles the forms; others would wait for its lock. SIGTERM ends all."""
    process = lab.start("-j", "2", **{NAMES[0]: "hang"})
    wait_for(lambda: lab.pids(NAMES[0]))
    time.sleep(1.5)
    assert lab.starts() == Counter(NAMES[:1])
    process.terminate()
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (143, "")
    assert "6 points: 6 not run" in out
    assert not alive(lab.pids(NAMES[0])[0])


def test_workers_that_cannot_begin_end_the_sweep(lab: Lab) -> None:
    """The points are not run, nothing hangs, and what is wrong is told."""
    (lab.site / "sitecustomize.py").write_text(
        "import sys; sys.modules['fiberbend.running.runner'] = None", encoding="utf-8"
    )
    code, out, err = lab.run("-j", "2")
    assert code == 2
    assert "6 points: 6 not run" in out
    assert "fiberbend.running.runner" in err


def test_killed_altogether_it_resumes_with_what_was_not_finished(lab: Lab) -> None:
    """SIGKILL for the sweep and its workers, in the middle of the last point."""
    process = lab.start("-j", "2", **{LAST: "hang"})
    wait_for(lambda: len(lab.finished()) == 5 and lab.pids(LAST))
    process.kill()
    process.wait()
    os.kill(lab.pids(LAST)[0], signal.SIGKILL)
    before = lab.finished()
    assert LAST not in before
    code, out, _ = lab.run("-j", "2")
    assert code == 0
    assert "6 points, 5 finished before" in out
    assert lab.starts() == Counter(NAMES) + Counter([LAST])
    after = lab.finished()
    assert {name: after[name] for name in before} == before
    # a body's hours are not lost: it goes on from its last converged state
    assert lab.log.read_text().splitlines()[-1].split()[2] == "resumed"


@pytest.mark.long
def test_a_killed_worker_is_replaced(lab: Lab) -> None:
    """Its point is solved by another one, and only that point is begun again."""
    hung = NAMES[2]
    process = lab.start("-j", "2", **{hung: "hang-once"})
    wait_for(lambda: lab.pids(hung))
    os.kill(lab.pids(hung)[0], signal.SIGKILL)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert f"a worker died in {hung} (code -9)" in out
    assert lab.starts() == Counter(NAMES) + Counter([hung])
    assert [row["status"] for row in lab.table()] == ["converged"] * 6


@pytest.mark.long
def test_a_point_that_kills_its_process_is_given_up(lab: Lab) -> None:
    """Here the first one, which the forms' compilation waits for."""
    code, out, _ = lab.run("-j", "2", **{NAMES[0]: "die"})
    assert code == 2
    assert f"failed: {NAMES[0]}: its process ended by signal 9, 2 times" in out
    assert "5 converged" in out


def test_failed_points_are_listed_and_the_others_done(lab: Lab) -> None:
    code, out, _ = lab.run(**{NAMES[1]: "fail", NAMES[4]: "raise"})
    assert code == 2
    assert "6 points: 4 converged, 2 failed" in out
    assert f"failed: {NAMES[1]}: det F at element 7\n" in out
    assert f"failed: {NAMES[4]}: ArithmeticError: nothing converges\n" in out
    assert "Traceback" in (lab.out / "points" / NAMES[4] / "error.log").read_text()
    reasons = {row["point"]: row["reason"] for row in lab.table() if row["status"] == "failed"}
    assert set(reasons) == {NAMES[1], NAMES[4]}
    code, _, _ = lab.run()
    assert (code, lab.starts()) == (2, Counter(NAMES))
    code, _, _ = lab.run("--retry")
    assert (code, lab.starts()) == (0, Counter(NAMES) + Counter([NAMES[1], NAMES[4]]))


@pytest.mark.long
def test_two_sweeps_at_once_share_the_points(lab: Lab) -> None:
    """What `make -j2` or two terminals do; both wait for the end and tell the whole result."""
    processes = [lab.start(all="slow"), lab.start("-j", "2", all="slow")]
    for process in processes:
        out, err = process.communicate(timeout=120)
        assert (process.returncode, err) == (0, "")
        assert "6 points: 6 converged" in out
    assert lab.starts() == Counter(NAMES)


@pytest.mark.long
def test_a_changed_case_runs_again_and_only_it(lab: Lab) -> None:
    lab.run()
    changed = SWEEP | {"vary": SWEEP["vary"] | {"actuator.wall": ["1.5 mm", "2.0 mm", "3 mm"]}}
    lab.file.write_text(yaml.safe_dump(changed), encoding="utf-8")
    lab.run()
    assert lab.starts() == Counter([*NAMES, "radius-7mm_wall-3mm", "radius-8mm_wall-3mm"])
    lab.run("--set", "actuator.floor=3 mm")
    assert lab.starts()[NAMES[0]] == 2


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_interrupted_it_leaves_a_table_and_no_process(lab: Lab, jobs: str) -> None:
    """Ctrl-C in a terminal reaches the sweep; it answers for its workers."""
    process = lab.start("-j", jobs, **{LAST: "hang"})
    wait_for(lambda: len(lab.finished()) == 5 and lab.pids(LAST))
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (130, "")
    assert "interrupted; the same command goes on where it was" in out
    assert [row["status"] for row in lab.table()] == ["converged"] * 5 + ["not run"]
    assert not any(alive(pid) for name in NAMES for pid in lab.pids(name))


def test_wrong_input_runs_nothing(lab: Lab) -> None:
    code, out, err = lab.run("--set", "actuator.cap=3")
    assert (code, out) == (1, "")
    assert "actuator.cap: 3, expected a length" in err
    assert not lab.out.exists()
    lab.out.mkdir()
    (lab.out / "thesis.tex").touch()
    code, _, err = lab.run()
    assert (code, "contains no sweep" in err) == (1, True)
    assert lab.starts() == Counter()
