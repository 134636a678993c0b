"""Kill a run at a random moment, go on with it, and compare: docs/stability.md by `make survive`.

SIGKILL to all its processes at once, serial and on two ranks, from the mesh to the pictures; every
third is killed a second time while it goes on.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import random
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from bench.survive import broken, end, files, kill, launch, put
from fiberbend.results.reading import read_history

CASE = """\
title: Killed and gone on with
actuator:
  {section: hemicircle, radius: 8 mm, length: 24 mm, wall: 2 mm, floor: 2 mm, sheath: 1 mm,
   cap: 6 mm}
materials: {wall: elastosil-m4601, floor: combined-base, sheath: ecoflex-0030}
effects:
- pressure: {to: 100 kPa}
- winding: {pattern: double-helix, pitch: 3 mm, fiber: kevlar}
model: MODEL
mesh: {axial: 8 mm}
solver: {max_step: 12 kPa}
output: {at_angles: [8 deg], stop_at_angle: 16 deg}
"""
ROUND_OFF = 1e-9
"""Greatest difference of a value in history.csv, over the greatest of its column or energy."""
ERRORS = ("volume_error", "volume_error_element", "balance_force", "balance_moment")
"""Columns of what is left of round-off, in parts of the whole."""
SEED = 20261126


@dataclasses.dataclass(frozen=True)
class Whole:
    """A run that nobody killed.

    Attributes:
        ranks: of it.
        rows: of its history.
        run: content of its run.json.
        files: of its folder.
        seconds: that it took.
    """

    ranks: int
    rows: list[dict[str, float | None]]
    run: dict[str, Any]
    files: list[str]
    seconds: float


@dataclasses.dataclass(frozen=True)
class Killed:
    """A run that was killed and gone on with.

    Attributes:
        ranks: of it.
        moments: when it was killed, s after its starts.
        phases: what it was at.
        step: after which it went on at last; None: it began anew.
        difference: greatest of its history from that of the whole run.
        faults: what is wrong.
    """

    ranks: int
    moments: list[float]
    phases: list[str]
    step: int | None
    difference: float
    faults: list[str]


def whole(case: Path, out: Path, ranks: int) -> Whole:
    """The run that the killed ones are compared with.

    Raises:
        RuntimeError: it failed.
    """
    start = time.monotonic()
    code, text = end(launch(ranks, ["run", case, "--out", out]))
    seconds = time.monotonic() - start
    if code:
        raise RuntimeError(text)
    run = json.loads((out / "run.json").read_text())
    return Whole(ranks, read_history(out / "history.csv"), run, files(out), seconds)


def killed(case: Path, out: Path, like: Whole, moments: list[float]) -> Killed:
    """Kill a run at some moments, one after the other, and go on to its end."""
    phases, faults = [], []
    for moment in moments:
        process = launch(like.ranks, ["run", case, "--out", out, "--verbose", *_on(out)])
        time.sleep(moment)
        phases.append(_phase(kill(process)))
        faults += [
            f"after the kill: {problem}"
            for path in (out.rglob("[!.]*") if out.exists() else ())
            if path.is_file() and (problem := broken(path))
        ]
    code, text = end(launch(like.ranks, ["run", case, "--out", out, *_on(out)]))
    if code:
        return Killed(like.ranks, moments, phases, None, np.nan, [*faults, text])
    resumed = [line for line in text.splitlines() if line.startswith("resumed after step")]
    run = json.loads((out / "run.json").read_text())
    for key in ("status", "load_steps", "newton_iterations", "cutbacks"):
        if run[key] != like.run[key]:
            faults.append(f"{key} {run[key]}, expected {like.run[key]}")
    if files(out) != like.files:
        faults.append(f"files: {sorted(set(files(out)) ^ set(like.files))}")
    beside = [path.name for path in out.parent.iterdir() if path.name.startswith(f".{out.name}")]
    faults += [f"left beside the folder: {beside}"] if beside else []
    faults += [problem for name in files(out) if (problem := broken(out / name))]
    difference = _difference(read_history(out / "history.csv"), like.rows)
    if not difference <= ROUND_OFF:
        faults.append(f"history differs by {difference:.1e}")
    step = int(resumed[-1].split()[-1]) if resumed else None
    return Killed(like.ranks, moments, phases, step, difference, faults)


def _on(out: Path) -> list[str]:
    """How a run goes on; before its folder is made there is nothing to go on with."""
    return ["--resume"] if out.exists() else []


def _phase(text: str) -> str:
    phase = "start"
    for line in text.splitlines():
        if line.endswith(" …"):
            phase = line[:-2]
        elif line.startswith("step ") and "iterations" in line:
            phase = f"solve, step {int(line[5:8])}"
        elif line.startswith("results in"):
            phase = "ended"
    return phase


def _difference(rows: list[Any], others: list[Any]) -> float:
    if len(rows) != len(others) or any(
        row.keys() != other.keys() for row, other in zip(rows, others, strict=True)
    ):
        return float("inf")
    worst, energy = 0.0, max(row["stored_mJ"] for row in others)
    for name in rows[0]:
        pairs = [(row[name], other[name]) for row, other in zip(rows, others, strict=True)]
        if any((a is None) != (b is None) for a, b in pairs):
            return float("inf")
        values = np.array([pair for pair in pairs if pair[0] is not None], dtype=float)
        if len(values):
            # that of what keeps the volume is round-off of all energy, and errors are so of one
            least = energy if name.endswith("mJ") else 1.0 if name in ERRORS else 1e-300
            scale = max(float(np.abs(values).max()), least)
            worst = max(worst, float(np.abs(values[:, 0] - values[:, 1]).max()) / scale)
    return worst


def loop(folder: Path, model: str, kills: dict[int, int], seed: int) -> list[Killed]:
    """Kill runs of a case at moments spread over its time.

    Args:
        folder: for the case and the runs.
        model: of the case.
        kills: number of kills by number of ranks.
        seed: of the moments.
    """
    chance = random.Random(seed)
    case = folder / "case.yaml"
    case.write_text(CASE.replace("MODEL", model), encoding="utf-8")
    found = []
    for ranks, count in kills.items():
        if not count:
            continue
        like = whole(case, folder / f"whole{ranks}", ranks)
        number = done = 0
        while done < count:
            twice = number % 3 == 1 and done + 2 <= count
            moments = [like.seconds * (done + chance.random()) / count]
            if twice:
                moments.append(like.seconds * chance.random())
            one = killed(case, folder / f"killed{ranks}-{number}", like, moments)
            found.append(one)
            print(row(one), flush=True)
            done += len(moments)
            number += 1
    return found


def row(one: Killed) -> str:
    """Line of the table."""
    moments = ", ".join(f"{moment:.1f}" for moment in one.moments)
    step = "anew" if one.step is None else f"step {one.step}"
    verdict = "; ".join(one.faults).replace("\n", " ") or "the same"
    return (
        f"| {one.ranks} | {moments} | {'; '.join(one.phases)} | {step} | {one.difference:.0e} "
        f"| {verdict} |"
    )


def main() -> int:
    """Run the loop; write its table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=30, help="half of them on two ranks")
    parser.add_argument("--model", default="body")
    parser.add_argument("--seed", type=int, default=SEED)
    options = parser.parse_args()
    kills = {1: options.kills - options.kills // 2, 2: options.kills // 2}
    with tempfile.TemporaryDirectory() as scratch:
        found = loop(Path(scratch), options.model, kills, options.seed)
    bad = sum(bool(one.faults) for one in found)
    total = sum(len(one.moments) for one in found)
    print(f"{total} kills, {bad} not the same")
    if options.kills >= 30 and options.model == "body":
        put("kills", [*_head(total, len(found), bad), *map(row, found)])
    return 1 if bad else 0


def _head(kills: int, runs: int, bad: int) -> list[str]:
    return [
        "## Killed at random moments",
        "",
        "Made by `bench/survive_kill.py`: SIGKILL to all processes of a run at once, then the",
        "same command with `--resume` (without it where the run had no folder yet). Compared with",
        f"the run that nobody killed: history.csv to {ROUND_OFF:g} of each column's greatest",
        "value (an energy: of the greatest one), numbers of steps and iterations, names of all",
        "files, each of them whole, and nothing else left.",
        "",
        f"**{kills} kills of {runs} runs: {bad} not the same.**",
        "",
        "| ranks | killed after s | at | went on from | difference | outcome |",
        "|---|---|---|---|---|---|",
    ]


if __name__ == "__main__":
    sys.exit(main())
