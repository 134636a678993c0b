"""The jobs in docs/cluster.md do what they say, with a Slurm that is made of mpirun."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from bench.doc_commands import ROOT, Reader, blocks
from bench.growth import MARKS
from bench.ranks import MPIRUN
from fiberbend.process.ranks import launcher
from tests.run.conftest import small
from tests.run.test_sweep import SWEEP

PAGE = ROOT / "docs" / "cluster.md"
SCRIPTS = {block.file: block.text for block in blocks(PAGE) if block.file}
KNOWN = {
    *("job-name", "nodes", "ntasks-per-node", "cpus-per-task", "mem-per-cpu", "time"),
}
"""Options of sbatch that the jobs use, all of them long."""

SRUN = """#!/bin/bash
# srun of a job: its options, then a command for every task
while [[ $1 == --* ]]; do
    case $1 in
        --mpi=pmix | --kill-on-bad-exit=1 | --cpu-bind=cores) shift ;;
        *) echo "srun: unrecognized option '$1'" >&2; exit 255 ;;
    esac
done
tasks=$SLURM_NTASKS
unset SLURM_NTASKS SLURM_PROCID
exec {mpirun} -n "$tasks" "$@"
"""


class Slurm(Reader):
    """A folder with the page's jobs, and `srun`."""

    def __init__(self, folder: Path, tasks: int) -> None:
        super().__init__(folder)
        srun = folder / "bin" / "srun"
        srun.write_text(SRUN.replace("{mpirun}", launcher()), encoding="utf-8")
        srun.chmod(0o755)
        # a batch script has these two before anything is launched
        self.environment |= MPIRUN | {"SLURM_NTASKS": str(tasks), "SLURM_PROCID": "0"}
        for name, text in SCRIPTS.items():
            (self.folder / name).write_text(text, encoding="utf-8")

    def write(self, name: str, content: Any) -> None:
        """A file of the user."""
        (self.folder / name).write_text(yaml.safe_dump(content), encoding="utf-8")


def test_there_is_a_job_for_each() -> None:
    assert {*SCRIPTS} == {"sweep.sh", "body.sh"}


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_job_can_be_read(name: str, tmp_path: Path) -> None:
    """By bash, and by sbatch, which reads its options above the first command."""
    path = tmp_path / name
    path.write_text(SCRIPTS[name], encoding="utf-8")
    done = subprocess.run(["bash", "-n", path], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    first, *lines = SCRIPTS[name].splitlines()
    assert first == "#!/bin/bash"
    count = next(n for n, line in enumerate(lines) if not line.startswith("#"))
    options = [re.fullmatch(r"#SBATCH --([a-z-]+)=\S+", line) for line in lines[:count]]
    assert {option.group(1) if option else "" for option in options} <= KNOWN
    assert not any(line.startswith("#SBATCH") for line in lines[count:])


@pytest.mark.long
@pytest.mark.mpi
def test_the_job_of_a_sweep_goes_on_with_it(tmp_path: Path) -> None:
    slurm = Slurm(tmp_path, 3)
    slurm.write("mine.yaml", SWEEP | {"vary": {"actuator.wall": ["2 mm", "2.5 mm"]}})
    text = slurm.run("bash sweep.sh mine.yaml", 0)
    assert "2 points: 2 converged" in text
    assert (slurm.folder / "runs" / "mine" / "sweep.csv").is_file()
    text = slurm.run("bash sweep.sh mine.yaml", 0)
    assert "2 points, 2 finished before" in text
    assert "a sweep file" in slurm.run("bash sweep.sh", 1)


@pytest.mark.long
@pytest.mark.mpi
def test_the_job_of_a_body_goes_on_with_it(tmp_path: Path) -> None:
    slurm = Slurm(tmp_path, 2)
    slurm.write("mine.yaml", small(mesh={"axial": "8 mm"}))
    slurm.run("bash body.sh mine.yaml mine", 0)
    run = json.loads((slurm.folder / "mine" / "run.json").read_text())
    assert (run["status"], run["ranks"]) == ("converged", 2)
    assert "resumed" in slurm.run("bash body.sh mine.yaml mine", 0)


def test_more_ranks_take_what_the_page_of_growth_says() -> None:
    """`make growth` writes both."""
    begin, end = MARKS
    here = PAGE.read_text(encoding="utf-8").partition(begin)[2].partition(end)[0].strip()
    growth = (ROOT / "docs" / "evidence" / "growth.md").read_text(encoding="utf-8")
    assert here
    assert growth.rstrip().endswith(here)
