"""The same cases on every stack: answers and times, docs/platforms.md by `make platforms`.

Each stack leaves a record in bench/stacks, named by its release of dolfinx: `make platforms` on the
stack of .venv, `make platforms ON=wheel` (or debian12, debian13) in a copy on another one. The page
compares all records that are complete, from two on.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from bench.ranks import MPIRUN
from fiberbend.process.ranks import launcher

ROOT = Path(__file__).resolve().parent.parent
RECORDS = ROOT / "bench" / "stacks"
PAGE = ROOT / "docs" / "platforms.md"
REPEATS = 2
TOLERANCE = 1e-7
"""Greatest relative difference between two stacks."""
BARE = ("output.pictures=false", "output.fields=false", "output.report=false")
COARSE = ("free_bending", "mesh.axial=6 mm")
BLOCKED = ("blocked_tip", "mesh.axial=6 mm", "actuator.length=60 mm")
CASES: dict[str, tuple[int, tuple[str, ...]]] = {
    "section": (1, ("section",)),
    "cell": (1, ("cell",)),
    "coarse body": (1, COARSE),
    "coarse body, two ranks": (2, COARSE),
    "blocked tip": (1, BLOCKED),
    "body, every turn resolved": (
        1,
        ("free_bending", "output.at_angles=[]", "output.stop_at_angle=90 deg"),
    ),
}
"""Ranks, name of a case in cases/, and changes to it."""
ORDERINGS = {"AMD": 0, "AMF": 2, "SCOTCH": 3, "PORD": 4, "METIS": 5, "QAMD": 6}
"""MUMPS's own numbers of them."""
TETRAHEDRA = (
    "free_bending",
    "mesh.element=tetrahedron",
    "mesh.axial=6 mm",
    "mesh.section=1",
    "output.at_angles=[]",
    "output.stop_at_angle=90 deg",
)
"""A body whose every tangent is left to MUMPS."""
PROGRAM = (
    "import sys, time; time.perf_counter = time.process_time; {first}; sys.argv[0] = 'fiberbend'; "
    "from fiberbend.__main__ import entry; entry()"
)
"""fiberbend, whose solver reads the clock of its processor: something else may keep it waiting."""
ORDERED = "from fem.solver import factor; factor.ORDERING_PORD = {number}"
COLUMNS = ("pressure_kPa", "angle_deg", "tip_force_N")


class Run(NamedTuple):
    """A run of a case; times in s."""

    answers: list[dict[str, float]]
    """What it answers where it was asked for."""
    record: dict[str, Any]
    """Its run.json."""
    cpu: float
    """Of all its processes together; ranks that wait for each other keep their processors busy."""
    wall: float

    @property
    def factor(self) -> float:
        """Processor time of all factorisations, of rank 0."""
        return float(self.record["wall_s"]["solve/factor"])


def solve(name: str, folder: Path) -> Run:
    """Run one of the cases.

    Args:
        name: of CASES.
        folder: where the run is left.
    """
    ranks, changed = CASES[name]
    return launch(ranks, "pass", changed, folder)


def launch(ranks: int, first: str, changed: Sequence[str], folder: Path) -> Run:
    """Run a case as a user does, in processes of its own.

    Args:
        ranks: number of processes.
        first: a statement of Python that each runs before.
        changed: name of a case, and changes to it.
        folder: where the run is left.

    Raises:
        RuntimeError: it failed.
    """
    case, *changes = changed
    program = PROGRAM.format(first=first)
    command = [sys.executable, "-c", program, "run", f"cases/{case}.yaml", "--quiet"]
    command += ["--overwrite", "--out", str(folder)]
    command += [word for change in (*changes, *BARE) for word in ("--set", change)]
    if ranks > 1:
        command = [launcher(), "-n", str(ranks), *command]
    environment = os.environ | MPIRUN | {"PYTHONPATH": str(ROOT)}
    # a warm cache holds Python's bytes too
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - began
    if done.returncode:
        raise RuntimeError(f"{case}: {done.stderr.strip()}")
    record = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Run(list(answers(folder / "history.csv")), record, spent, wall)


def answers(history: Path) -> Iterator[dict[str, float]]:
    """The states of a run that were asked for: round angles or round pressures."""
    with history.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            found = {column: float(row[column]) for column in COLUMNS if row.get(column)}
            asked = ("angle_deg", 90.0) if "tip_force_N" not in found else ("pressure_kPa", 50.0)
            turns = found[asked[0]] / asked[1]
            if round(turns) > 0 and abs(turns - round(turns)) < 1e-8:
                yield found


def measured(before: Mapping[str, Any], only: Sequence[str]) -> dict[str, Any]:
    """Cases on this stack; each after one run that compiles its kernels.

    Args:
        before: the record that is there, or an empty one.
        only: names of cases, and "orderings", that are measured; the rest is kept.
    """
    runs = dict(before.get("runs", {}))
    facts = {name: before.get(name) for name in ("versions", "processor", "blas")}
    for name in (name for name in CASES if name in only):
        with tempfile.TemporaryDirectory() as folder:
            found, record, *_ = solve(name, Path(folder) / "run")
            repeats = [solve(name, Path(folder) / "run") for _ in range(REPEATS)]
        if any(again.answers != found for again in repeats) and CASES[name][0] == 1:
            raise RuntimeError(f"{name}: two runs of one process differ")
        runs[name] = {
            "answers": found,
            "cpu_s": round(min(again.cpu for again in repeats), 2),
            "wall_s": round(min(again.wall for again in repeats), 2),
            "factor_cpu_s": min(again.factor for again in repeats),
            "unknowns": record["unknowns"],
            "iterations": record["newton_iterations"],
        }
        facts = {
            "versions": record["versions"],
            "processor": f"{record['machine']['processor']}, {record['blas']['kernel']}",
            "blas": record["blas"]["library"],
        }
        spent = runs[name]
        print(f"{name}: {spent['cpu_s']} s, {spent['wall_s']} s by the clock", flush=True)
    return {
        "stack": stack(),
        **facts,
        "setup_s": setup_seconds() or before.get("setup_s"),
        "runs": {name: runs[name] for name in CASES if name in runs},
        "orderings": orderings() if "orderings" in only else before.get("orderings", {}),
    }


def orderings() -> dict[str, float | None]:
    """Processor time of all factorisations of tetrahedra by ordering, s; None: not in MUMPS."""
    found: dict[str, float | None] = {}
    for name, number in ORDERINGS.items():
        asked = ORDERED.format(number=number)
        times = []
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(REPEATS):
                try:
                    run = launch(1, asked, TETRAHEDRA, Path(folder) / "run")
                except RuntimeError as error:
                    if "MUMPS took ordering" not in str(error):
                        raise
                    break
                times.append(run.factor)
        found[name] = min(times) if times else None
        print(f"ordering {name}: {found[name]}", flush=True)
    return found


def dolfinx() -> ModuleType:
    """The library, loaded as the program loads it: by itself it may not find its MPI."""
    import fem

    assert fem.compat
    return sys.modules["dolfinx"]


def stack() -> str:
    """Where the finite elements of this Python come from."""
    if Path(dolfinx().__file__ or "").is_relative_to(sys.prefix):
        return "wheels"
    return platform.freedesktop_os_release().get("PRETTY_NAME", "system").partition(" (")[0]


def setup_seconds() -> int | None:
    """What setup.sh took to make this environment, s; None where it is not known."""
    file = Path(sys.prefix) / "setup.seconds"
    return int(file.read_text(encoding="utf-8")) if file.exists() else None


def release(record: Mapping[str, Any]) -> str:
    """The release of dolfinx without what a packager adds to it, such as 0.9."""
    return ".".join(record["versions"]["dolfinx"].split(".")[:2])


def records() -> list[dict[str, Any]]:
    """What stacks have left on which all cases were run, the oldest release first."""
    found = [json.loads(p.read_text(encoding="utf-8")) for p in RECORDS.glob("dolfinx-*.json")]
    found = [record for record in found if record["runs"].keys() == CASES.keys()]
    return sorted(found, key=lambda record: [int(part) for part in release(record).split(".")])


def difference(
    one: Sequence[Mapping[str, float]], other: Sequence[Mapping[str, float]]
) -> dict[str, float]:
    """Greatest difference of each column, relative to its greatest value.

    Raises:
        ValueError: other states or other columns.
    """
    if [row.keys() for row in one] != [row.keys() for row in other] or not one:
        raise ValueError(f"{len(one)} states and {len(other)}, or other columns")
    return {
        column: max(abs(a[column] - b[column]) for a, b in zip(one, other, strict=True))
        / (max(abs(row[column]) for row in one) or 1.0)
        for column in one[0]
    }


def page(all_records: Sequence[Mapping[str, Any]]) -> str:
    """The tables of all stacks."""
    names = [f"{record['stack']}, dolfinx {release(record)}" for record in all_records]
    first = all_records[0]
    lines = [HEAD, "| | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|"]

    def row(title: str, values: Sequence[str]) -> None:
        lines.append(f"| {title} | " + " | ".join(values) + " |")

    row("PETSc", [record["versions"]["petsc"] for record in all_records])
    row("Python", [record["versions"]["python"] for record in all_records])
    row("numpy", [record["versions"]["numpy"] for record in all_records])
    row("BLAS", [record["blas"] for record in all_records])
    row("processor", [record["processor"] for record in all_records])
    row(
        "`make setup`, the first time, s",
        ["–" if record["setup_s"] is None else str(record["setup_s"]) for record in all_records],
    )
    lines += [ANSWERS, "| case, state | quantity | " + " | ".join(names) + " |"]
    lines.append("|---" * (len(names) + 2) + "|")
    for name in CASES:
        for index, state in enumerate(first["runs"][name]["answers"]):
            given, unit = ("pressure_kPa", "kPa") if "tip_force_N" in state else ("angle_deg", "°")
            for column in state:
                if column == given or (column == "angle_deg" and abs(state[column]) < 1e-6):
                    continue
                values = [
                    f"{record['runs'][name]['answers'][index][column]:.10g}"
                    for record in all_records
                ]
                lines.append(
                    f"| {name}, {state[given]:.6g} {unit} | `{column}` | {' | '.join(values)} |"
                )
    lines += [DIFFERENCES, "| case | " + " | ".join(names[1:]) + " |", "|---" * len(names) + "|"]
    for name in CASES:
        worst = [
            max(difference(first["runs"][name]["answers"], r["runs"][name]["answers"]).values())
            for r in all_records[1:]
        ]
        row(name, [f"{value:.1e}" if value else "0" for value in worst])
    lines += [SPEED, "| case | unknowns | iterations | " + " | ".join(names) + " |"]
    lines.append("|---" * (len(names) + 3) + "|")
    for name in CASES:
        runs = [record["runs"][name] for record in all_records]
        spent = " | ".join(
            "{cpu_s:.2f} ({factor_cpu_s:.2f}), {wall_s:.2f}".format(**r) for r in runs
        )
        lines.append(f"| {name} | {runs[0]['unknowns']} | {runs[0]['iterations']} | {spent} |")
    lines += [ORDERING, "| ordering | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|"]
    for ordering in ORDERINGS:
        times = [record["orderings"].get(ordering) for record in all_records]
        row(ordering, ["not built in" if t is None else f"{t:.2f}" for t in times])
    return "\n".join(lines) + "\n"


HEAD = """# Platforms

<!-- Written by `make platforms`; do not edit by hand. -->

fiberbend runs on three stacks: FEniCSx of Debian 12, of Debian 13, and as wheels from PyPI for any
x86-64 Linux with glibc 2.34, a C compiler (FFCx compiles kernels when a case is run) and Python
from 3.12 to 3.14. `make setup` takes Debian's where it is there, or where root or sudo can install
it; else the wheels, which need no root. `FIBERBEND_STACK=debian` or `wheel` chooses. Any other
release of dolfinx is refused.

The wheels come from `dolfinx-solver-real`, a young package of few releases. It is pinned with all
that it needs in `requirements-wheel.txt`; should it vanish, Debian's two releases stay.

Every test runs on Debian 12. `make test-wheel` and `make test-debian13` run the fast tests
(`tests/fast.txt`) on the two others.

## The stacks that were measured
"""
ANSWERS = """
## Answers

What was asked for in each case, as it stands in `history.csv`.
"""
DIFFERENCES = """
## Differences

The greatest of all quantities above, relative to the greatest value of the quantity and to the
first stack; 0 where all ten digits of `history.csv` are the same.
"""
SPEED = """
## Speed

Processor time of the whole process without pictures and report, s, in parentheses that of the
factorisations, then the time by the clock, which grows with what else the machine does: the least
of two each, after one run that compiles the kernels. Two ranks are counted together, also while one
waits for the other, and the factorisations of one. Other programs share caches and cores, which
lengthens processor time by up to half: stacks are compared by their iterations, and by times only
where the machine was idle for all.
"""
ORDERING = """
## Orderings

Processor time of all factorisations of a body of tetrahedra by MUMPS up to 90°, s, by the ordering
of its unknowns; the least of two. The program asks for PORD on every stack.
"""


def main() -> None:
    """Measure this stack, unless only the page is asked for, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", action="store_true", help="only write the page")
    parser.add_argument("--only", action="append", help="a case, or orderings; repeatable")
    asked = parser.parse_args()
    if not asked.page:
        file = RECORDS / f"dolfinx-{release({'versions': {'dolfinx': dolfinx().__version__}})}.json"
        before = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        record = measured(before, asked.only or [*CASES, "orderings"])
        file.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    found = records()
    if len(found) > 1:
        PAGE.write_text(page(found), encoding="utf-8")


if __name__ == "__main__":
    main()
