"""Damaged cases through validate, plan and run: a table of docs/stability.md by `make survive`.

Every case is a shipped one, damaged by a seed: its values, units, keys, types, structure or its
text. It has to end with a finite answer that obeys sanity, or with one line a problem; never with a
traceback, a hang, or a number that is none.
"""

from __future__ import annotations

import argparse
import collections
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator, Sequence
from concurrent.futures import TimeoutError as FutureTimeoutError
from pathlib import Path

import yaml
from pebble import ProcessPool

from bench.survive import ROOT, put
from bench.survive_damage import KINDS, mutant
from fiberbend.columns import AXIS_STRETCH, DET_F, VOLUME
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import read_case
from fiberbend.schema.problems import LINES, CaseError

COUNT, RUNS = 300, 40
LIMIT = 30
"""Seconds after which validate and plan hang; they take tenths."""
RUN_LIMIT = 180
"""Seconds after which a run of a section hangs; they take seconds."""
# --- outcomes -----------------------------------------------------------------------------------


def complaint_fault(error: CaseError) -> str:
    """What is wrong with how a case is refused, or nothing."""
    lines = str(error).splitlines()
    if not 1 <= len(lines) <= LINES + 1:
        return f"{len(lines)} lines"
    for line in lines:
        if not line.isprintable() or len(line) > 1100 or not line.strip():
            return f"a line that no terminal shows: {line[:60]!r}"
        if "Traceback" in line or " object at 0x" in line or "Error(" in line:
            return f"a line that is no message: {line[:60]}"
    return ""


def outcome(path: Path) -> tuple[str, str]:
    """How validate and plan end for a file, and what is wrong with that, or nothing."""
    try:
        case = read_case(path)
    except CaseError as error:
        return "refused", complaint_fault(error)
    except BaseException:
        return "traceback", traceback.format_exc().splitlines()[-1]
    try:
        lines = make_plan(case).lines()
    except BaseException:
        return "traceback", "plan: " + traceback.format_exc().splitlines()[-1]
    numbers = [word.strip("(),;°%:") for line in lines for word in line.split()]
    if {"nan", "inf", "-inf"} & {*numbers}:
        return "valid", "a plan with a number that is none"
    return "valid", ""


def _of_seed(seed: int, folder: str) -> tuple[str, str]:
    path = Path(folder) / f"{seed}.yaml"
    path.write_text(mutant(seed)[1], encoding="utf-8")
    return outcome(path)


def all_outcomes(seeds: Sequence[int], folder: Path, workers: int) -> list[tuple[str, str]]:
    """The outcome of every seed, each with a time limit."""
    ends = []
    with ProcessPool(workers) as pool:
        futures = [
            pool.schedule(_of_seed, args=(seed, str(folder)), timeout=LIMIT) for seed in seeds
        ]
        for future in futures:
            try:
                ends.append(future.result())
            except FutureTimeoutError:
                ends.append(("hang", f"no end after {LIMIT} s"))
            except Exception as error:
                ends.append(("crash", f"{type(error).__name__}: {error}"))
    return ends


def run_fault(out: Path, code: int, messages: str) -> str:
    """What is wrong with how a run has ended, or nothing."""
    lines = messages.splitlines()
    if "Traceback" in messages or "PETSC ERROR" in messages:
        return f"traceback: {lines[-1]}"
    if code not in (0, 1, 2):
        return f"exit code {code}: {lines[-1] if lines else ''}"
    if " stopped: " in messages:
        return lines[-1]
    if code == 1:
        return "" if lines else "refused without a word"
    run = json.loads((out / "run.json").read_text(encoding="utf-8"), parse_constant=float)
    if (run["status"] == "failed") != (code == 2):
        return f"{run['status']} with exit code {code}"
    if run["status"] != "converged" and not run["reason"]:
        return f"{run['status']} without a reason"
    with (out / "history.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return _insane(rows)


def _insane(rows: Sequence[dict[str, str]]) -> str:
    """What no actuator does, or nothing."""
    if not rows:
        return "no row, not even of rest"
    for number, row in enumerate(rows):
        values = {key: float(text) for key, text in row.items() if text}
        wrong = [key for key, value in values.items() if not math.isfinite(value)]
        if wrong:
            return f"row {number}: {wrong[0]} is {values[wrong[0]]}"
        for key in (VOLUME, DET_F, AXIS_STRETCH):
            if values.get(key, 1.0) <= 0:
                return f"row {number}: {key} is {values[key]}"
    return ""


def run_one(path: Path, out: Path) -> tuple[str, str]:
    """How a run of a section ends, and what is wrong with that, or nothing."""
    settings = ("output.pictures=false", "output.fields=false")
    command = [sys.executable, "-m", "fiberbend", "run", str(path), "--out", str(out), "--quiet"]
    for setting in settings:
        command += ["--set", setting]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=RUN_LIMIT
        )
    except subprocess.TimeoutExpired:
        return "hang", f"no end after {RUN_LIMIT} s"
    fault = run_fault(out, done.returncode, done.stderr)
    if done.returncode == 1:
        return "refused", fault
    if (out / "run.json").exists():
        return json.loads((out / "run.json").read_text(encoding="utf-8"))["status"], fault
    return f"exit code {done.returncode}", fault


def section_mutants(folder: Path, count: int) -> Iterator[tuple[int, Path]]:
    """Damaged cases that a section can answer, with their seeds."""
    seed, kinds = 1_000_000, [KINDS.index(kind) for kind in ("values", "values", "structure")]
    while count:
        seed += 1
        path = folder / f"{seed}.yaml"
        data = yaml.safe_load(mutant(seed * len(KINDS) + kinds[seed % len(kinds)])[1])
        if not isinstance(data, dict):
            continue
        data |= {"model": "section"}
        path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
        try:
            read_case(path)
        except CaseError:
            continue
        count -= 1
        yield seed, path


# --- the page -----------------------------------------------------------------------------------


def table(
    seeds: Sequence[int],
    ends: Sequence[tuple[str, str]],
    runs: Sequence[tuple[int, str, str]],
    seconds: float,
) -> list[str]:
    """The part of the page."""
    counts: dict[str, collections.Counter[str]] = {kind: collections.Counter() for kind in KINDS}
    for seed, (end, fault) in zip(seeds, ends, strict=True):
        counts[KINDS[seed % len(KINDS)]][end] += 1
        counts[KINDS[seed % len(KINDS)]]["fault"] += bool(fault)
    faults = [
        f"seed {s}: {end}, {text}" for s, (end, text) in zip(seeds, ends, strict=True) if text
    ]
    faults += [f"run of seed {s}: {end}, {text}" for s, end, text in runs if text]
    ended = collections.Counter(end for _, end, _ in runs)
    return [
        "",
        "## Damaged cases",
        "",
        "The shipped cases, damaged by a seed, through `validate` and `plan`",
        "(`bench/survive_fuzz.py`; `--first` takes other seeds).",
        "",
        "| damage | cases | valid | refused, a line a problem | traceback, hang or no number |",
        "|---|---|---|---|---|",
        *(
            f"| {kind} | {sum(count[end] for end in count if end != 'fault')} | {count['valid']} "
            f"| {count['refused']} | {count['fault']} |"
            for kind, count in counts.items()
        ),
        "",
        f"{len(runs)} of those that a section can answer were run: "
        + ", ".join(f"{count} {end}" for end, count in sorted(ended.items()))
        + "; every value of their histories is finite, and no chamber, no determinant and no "
        f"stretch is below zero. {seconds:.0f} s in all.",
        *(["", "Not as expected:", "", *(f"- {text}" for text in faults)] if faults else []),
        "",
    ]


def main() -> int:
    """Fuzz; write the page when all ran."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=COUNT, help="cases through validate and plan")
    parser.add_argument("--runs", type=int, default=RUNS, help="runs of a section")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("-j", type=int, default=os.cpu_count() or 1, help="at once")
    options = parser.parse_args()
    start, seeds = time.monotonic(), range(options.first, options.first + options.count)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        ends = all_outcomes(seeds, folder, options.j)
        for seed, (end, fault) in zip(seeds, ends, strict=True):
            if fault:
                print(f"seed {seed}: {end}: {fault}", flush=True)
        runs = []
        for seed, path in section_mutants(folder, options.runs):
            begun = time.monotonic()
            end, fault = run_one(path, folder / f"run{seed}")
            print(f"run {seed}: {end} {time.monotonic() - begun:.0f} s {fault}", flush=True)
            runs.append((seed, end, fault))
    lines = table(seeds, ends, runs, time.monotonic() - start)
    print(*lines, sep="\n")
    if (options.count, options.runs, options.first) == (COUNT, RUNS, 0):
        put("fuzz", lines)
    return int(any(fault for _, fault in ends) or any(fault for _, _, fault in runs))


if __name__ == "__main__":
    sys.exit(main())
