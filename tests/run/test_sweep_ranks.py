"""A sweep by the ranks of mpirun: the same table as by the local pool, whoever is killed."""

from __future__ import annotations

import csv
import os
import re
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
import yaml

import fiberbend
from bench.ranks import MPIRUN
from bench.survive import led, session
from fiberbend.process.ranks import foreign_launcher
from fiberbend.results.reading import read_history
from tests.conftest import ROOT, MpiRun, heard_when_stopped, killed_by, launcher
from tests.run.conftest import small
from tests.run.test_sweep import LAST, NAMES, SWEEP, Lab, wait_for

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
        if name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK"):
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

    def start(self, out: str, *arguments: str, ranks: str = "") -> subprocess.Popen[str]:
        """The command, by mpirun where there is a number of ranks."""
        command = [launcher(), "-n", ranks] if ranks else []
        command = [*command, sys.executable, "-m", "fiberbend", "sweep", str(self.file)]
        return subprocess.Popen(
            led([*command, "--out", str(self.folder / out), *arguments]),
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


@pytest.mark.long
@pytest.mark.mpi
def test_27_points_with_one_rank_killed_give_the_table_of_the_pool(tmp_path: Path) -> None:
    """Table, trends and histories byte for byte, but for the times."""
    cube = Cube(tmp_path)
    process = cube.start("ranks", ranks="3")
    points = tmp_path / "ranks" / "points"
    wait_for(lambda: len(list(points.glob("*/run.json"))) > 9)
    [victim] = [pid for pid in session(process.pid) if rank_of(pid) == "2"]
    os.kill(victim, signal.SIGKILL)
    process.communicate(timeout=60)
    assert process.returncode == killed_by(signal.SIGKILL)
    gone(process)
    before = {path: path.stat().st_mtime_ns for path in points.glob("*/history.csv")}
    assert 5 < len(before) < 25
    text = cube.end(cube.start("ranks", ranks="3"))
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


@pytest.mark.mpi
def test_ranks_share_the_points_and_the_leader_solves_none(lab: Lab) -> None:
    """Each point once; the local pool then has nothing to do."""
    code, out, err = lab.run(ranks="3", all="slow")
    assert (code, err) == (0, "")
    assert "6 points, 0 finished before" in out
    assert "6 points: 6 converged" in out
    assert lab.starts() == Counter(NAMES)
    assert len({pid for name in NAMES for pid in lab.pids(name)}) == 2
    before = (lab.out / "sweep.csv").read_bytes()
    code, out, err = lab.run("-j", "2")
    assert (code, err) == (0, "")
    assert "6 points, 6 finished before" in out
    assert (lab.starts(), (lab.out / "sweep.csv").read_bytes()) == (Counter(NAMES), before)


@pytest.mark.long
@pytest.mark.mpi
def test_a_lost_rank_costs_its_points_which_the_pool_takes_up(lab: Lab) -> None:
    """And what the pool has left when it is killed, ranks take up."""
    process = lab.start(ranks="3", **{LAST: "hang", HUNG: "hang-once"})
    wait_for(lambda: len(lab.finished()) == 4 and lab.pids(LAST) and lab.pids(HUNG))
    os.kill(lab.pids(HUNG)[0], signal.SIGKILL)
    process.communicate(timeout=60)
    assert process.returncode == killed_by(signal.SIGKILL)
    gone(process)
    process = lab.start("-j", "2", **{LAST: "hang"})
    wait_for(lambda: len(lab.finished()) == 5 and len(lab.pids(LAST)) == 2)
    process.kill()
    process.wait()
    os.kill(lab.pids(LAST)[-1], signal.SIGKILL)
    gone(process)
    before = lab.finished()
    code, out, err = lab.run(ranks="2")
    assert (code, err) == (0, "")
    assert "6 points, 5 finished before" in out
    assert lab.starts() == Counter(NAMES) + Counter([HUNG, LAST, LAST])
    assert before.items() <= lab.finished().items()
    # what has left a checkpoint goes on from there
    assert lab.log.read_text().splitlines()[-1].split()[2] == "resumed"


@pytest.mark.long
@pytest.mark.mpi
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_mpirun_that_is_stopped_leaves_a_table_and_no_process(lab: Lab, number: int) -> None:
    """Its own exit code; the table is written in the time that it leaves, or by the next start."""
    process = lab.start(ranks="3", **{LAST: "hang"})
    wait_for(lambda: len(lab.finished()) == 5 and lab.pids(LAST))
    process.send_signal(number)
    out, _ = process.communicate(timeout=60)
    assert process.returncode != 0
    assert "interrupted; the same command goes on where it was" in out or not heard_when_stopped()
    gone(process)
    assert len(lab.finished()) == 5
    code, out, err = lab.run("-j", "1")
    assert (code, err) == (0, "")
    assert [row["status"] for row in lab.table()] == ["converged"] * 6


@pytest.mark.long
@pytest.mark.mpi
def test_a_signal_for_one_rank_ends_all(lab: Lab) -> None:
    """They would wait for it; one line says which one it was."""
    process = lab.start(ranks="3", **{LAST: "hang"})
    wait_for(lambda: len(lab.finished()) == 5 and lab.pids(LAST))
    os.kill(lab.pids(LAST)[0], signal.SIGTERM)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 143
    assert len(re.findall(r"^fiberbend: rank [12] stopped$", err, re.MULTILINE)) == 1
    gone(process)


@pytest.mark.long
@pytest.mark.mpi
def test_points_that_fail_on_ranks_are_listed(lab: Lab) -> None:
    code, out, _ = lab.run(ranks="2", **{NAMES[1]: "fail", NAMES[4]: "raise"})
    assert code == 2
    assert "6 points: 4 converged, 2 failed" in out
    assert f"failed: {NAMES[4]}: ArithmeticError: nothing converges\n" in out
    assert "Traceback" in (lab.out / "points" / NAMES[4] / "error.log").read_text()


@pytest.mark.long
@pytest.mark.mpi
@pytest.mark.parametrize("other", ["ranks", "processes"])
def test_a_sweep_by_ranks_shares_the_points_with_another(lab: Lab, other: str) -> None:
    """The second one may be a second mpirun."""
    second = {"ranks": ("3", ()), "processes": ("", ("-j", "2"))}
    ranks, jobs = second[other]
    for process in [lab.start(ranks="2", all="slow"), lab.start(*jobs, ranks=ranks, all="slow")]:
        out, err = process.communicate(timeout=120)
        assert (process.returncode, err) == (0, "")
        assert "6 points: 6 converged" in out
    assert lab.starts() == Counter(NAMES)


@pytest.mark.long
@pytest.mark.mpi
def test_ranks_whose_solver_cannot_be_loaded_end_the_sweep(lab: Lab) -> None:
    (lab.site / "sitecustomize.py").write_text(
        "import sys; sys.modules['fiberbend.running.runner'] = None", encoding="utf-8"
    )
    process = lab.start(ranks="3")
    _, err = process.communicate(timeout=60)
    assert process.returncode == 2
    assert re.search(r"fiberbend: rank [12] stopped: .*fiberbend\.running\.runner", err)
    gone(process)


HUGE = ("model=body", "mesh.section=9", "mesh.axial=0.1 mm", "effects.0={pressure: {to: 5 kPa}}")
REFUSALS: dict[str, tuple[tuple[str, ...], str]] = {
    "jobs": (("-j", "2"), "fiberbend sweep: -j 2 under mpirun, expected either"),
    "one job": (("-j", "1"), "fiberbend sweep: -j 1 under mpirun, expected either"),
    "a case": (("--set", "actuator.cap=3"), "actuator.cap: 3, expected a length"),
    "memory": (
        tuple(word for setting in HUGE for word in ("--set", setting)),
        "memory: the sweep on .* needs about .* GB \\(2 at once\\), .* \\(or fewer ranks on",
    ),
}


@pytest.mark.mpi
@pytest.mark.parametrize("what", REFUSALS)
def test_ranks_refuse_wrong_input_in_one_line(lab: Lab, what: str) -> None:
    arguments, expected = REFUSALS[what]
    code, out, err = lab.run(*arguments, ranks="3")
    own = lines(err)
    assert (code, len(own), out) == (1, 1, ""), err
    assert re.search(expected, own[0])
    assert lab.starts() == Counter()


@pytest.mark.mpi
def test_a_folder_with_something_else_is_refused_once(lab: Lab) -> None:
    """Rank 0 alone looks; all end."""
    lab.out.mkdir()
    (lab.out / "thesis.tex").touch()
    code, out, err = lab.run(ranks="3")
    assert (code, out, len(lines(err))) == (1, "", 1)
    assert "contains no sweep" in err


ELSEWHERE = """
import os, sys
from fiberbend.process import ranks
from fiberbend.sweep.crews import ranks as crew
from fiberbend.cli import entry

crew._PATIENCE = 0.5
if ranks.rank() == 1:
    os.chdir("elsewhere")
sys.argv[1:] = ["sweep", {file!r}, "--out", "out"]
entry()
"""


@pytest.mark.long
@pytest.mark.mpi
def test_a_folder_that_one_machine_does_not_see_is_refused(
    lab: Lab, mpirun: MpiRun, tmp_path: Path
) -> None:
    """Its results would be lost."""
    script = tmp_path / "elsewhere.py"
    script.write_text(ELSEWHERE.format(file=str(lab.file)), encoding="utf-8")
    (tmp_path / "elsewhere").mkdir()
    done = mpirun(3, [script], cwd=tmp_path, timeout=60)
    assert done.returncode == 1
    [line] = lines(done.stderr)
    assert re.fullmatch(
        r"out: not seen by rank 1 on \S+, expected a folder that all machines share", line
    )
    assert not any("shared" in path.name for path in (tmp_path / "out").rglob("*"))


def test_ranks_that_mpi_does_not_join_are_refused(
    lab: Lab, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As by srun without --mpi=pmix: each would be a sweep of its own."""
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    code, out, err = lab.run()
    assert (code, out, len(lines(err))) == (1, "", 1)
    foreign = "launched by the mpirun of Open MPI"
    unjoined = "rank 0 of 2, but MPI has started 1: expected the mpirun of"
    assert (foreign if foreign_launcher() else unjoined) in err


SCRIPT = """
import sys

import fiberbend

sweep = fiberbend.sweep({sweep!r}, {out!r})
body = fiberbend.run({body!r}, {run!r})
# in one piece: launchers mix what ranks write
sys.stdout.write(f"{{sweep}}; {{body.status}} on {{body.run['ranks']}}\\n")
sys.stdout.flush()
"""


@pytest.mark.long
@pytest.mark.mpi
def test_a_script_sweeps_by_ranks_and_then_shares_a_body(mpirun: MpiRun, tmp_path: Path) -> None:
    """Every rank has the table; what a rank printed elsewhere meanwhile it prints again."""
    sweep = SWEEP | {"set": SWEEP["set"] | {"model": "analytic"}}
    script, out = tmp_path / "script.py", str(tmp_path / "out")
    case, run = small(mesh={"axial": "8 mm"}), str(tmp_path / "run")
    text = SCRIPT.format(sweep=sweep, out=out, body=case, run=run)
    script.write_text(text, encoding="utf-8")
    done = mpirun(2, [script], timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
    line = f"<Sweep of 6 points: 6 converged, in {out}>; converged on 2\n"
    assert done.stdout == 2 * line
    alone = fiberbend.run(case).rows[-1]["angle_deg"]
    shared = read_history(tmp_path / "run" / "history.csv")[-1]["angle_deg"]
    assert shared == pytest.approx(alone, rel=1e-6)


def lines(text: str) -> list[str]:
    """Lines of the program, without those by which mpirun tells that it ends with an error."""
    ours, inside = [], False
    for line in text.splitlines():
        if line.startswith("-----"):
            inside = not inside
        elif line.strip() and not inside:
            ours.append(line)
    return ours
