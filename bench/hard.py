"""Hard cases in every model that supports them: docs/stability.md by `make hard`.

Each case runs in a process of its own with a time limit, so that a crash or a hang is a line of the
table and a failure, not the end of the run.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from bench.hard_cases import HARD, MODELS, ORDERS, Hard
from bench.hard_infsup import LADDERS, fault
from bench.survive import kept

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "stability.md"
LIMIT = 600
"""Seconds after which a case hangs."""


def call(*arguments: str) -> tuple[Any, str]:
    """What a module prints as JSON on its last line, or None; and why it did not."""
    command = [sys.executable, "-m", *arguments]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=LIMIT
        )
    except subprocess.TimeoutExpired:
        return None, f"hangs: no end after {LIMIT} s"
    if done.returncode == 0:
        return json.loads(done.stdout.splitlines()[-1]), ""
    last = (done.stderr.strip().splitlines() or ["no message"])[-1]
    return None, f"crashed with exit code {done.returncode}: {last}"


def one(hard: Hard, model: str) -> dict[str, Any]:
    """The record of a case, or of its crash."""
    start = time.monotonic()
    record: dict[str, Any] | None
    record, problem = call("bench.hard_solve", hard.name, model)
    if record is not None:
        return record
    return {
        "name": hard.name,
        "model": model,
        "status": "crashed",
        "reason": problem,
        "iterations": 0,
        "faults": [problem],
        "seconds": round(time.monotonic() - start, 1),
    }


def out_of_order(records: Sequence[dict[str, Any]]) -> list[str]:
    """Where a case does not bend further than the one that it should."""
    angles = {(r["name"], r["model"]): r["angle_deg"] for r in records if r["status"] != "crashed"}
    found = []
    for names in ORDERS:
        for model in MODELS:
            bent = [angles[name, model] for name in names if (name, model) in angles]
            if any(more <= less for less, more in itertools.pairwise(bent)):
                shown = ", ".join(f"{angle:.2f}" for angle in bent)
                found.append(f"{model}: {' < '.join(names)} expected, {shown} found")
    return found


def inf_sup(index: int) -> tuple[str, str]:
    """Line of the table of inf-sup constants, and what is wrong with it."""
    ladder = LADDERS[index]
    found, problem = call("bench.hard_infsup", str(index))
    label = f"| {ladder.name} | {ladder.model} | {ladder.angle:g} |"
    if found is None:
        return f"{label} **{problem}** | | |", problem
    cells = " | ".join(f"{beta:.3f} ({count})" for count, beta in found)
    return f"{label} {cells} |", fault([beta for _, beta in found])


def row(hard: Hard, record: dict[str, Any]) -> str:
    """Line of the table."""
    name, model, seconds = record["name"], record["model"], record["seconds"]
    if record["status"] == "crashed":
        return f"| {name} | {model} | **{record['reason']}** |" + " |" * 8 + f" {seconds:.0f} |"
    end = "reached" if record["status"] == "converged" else "refused"
    modes = "" if record["modes"] is None else record["modes"]
    return (
        f"| {name} | {model} | {end} | {record['angle_deg']:.1f} | {record['pressure_kpa']:.1f} "
        f"| {record['steps']} | {record['cutbacks']} | {record['iterations']} "
        f"| {record['least_det_f']:.2f} | {modes} | {record['gap']:.0e} | {seconds:.0f} |"
    )


HEAD = """\
# Hard cases

Made by `make hard` (`bench/hard.py`) from the table of cases in `bench/hard_cases.py`; each runs in
a process of its own, at most {limit} s. Fast sections are part of `make test`, fast
cells of `make test-long`. The body is
80 mm long by default, so that 180° bend it as much as 360° the paper's
actuator; bodies are coarse (elements of 8 mm) with their winding spread over its surface.

**{count} runs: {reached} reached, {refused} refused with a physical reason, {bad} not as expected;
{iterations} Newton iterations.**

- *end*: reached, or refused; the reasons are below.
- *modes*: unstable modes at the end (negative eigenvalues with all loads kept, by inertia).
- *gap*: of the work of the loads, ∫ P dV and the like by a spline through the steps, from the
  stored energy, over the greatest stored energy.
- *s*: processor time of the run on the machine that made the page, with kernels that it compiled.

"""
COLUMNS = (
    "case",
    "model",
    "end",
    "angle °",
    "kPa",
    "steps",
    "cut-backs",
    "iterations",
    "least det F",
    "modes",
    "gap",
    "s",
)


def write(records: Sequence[dict[str, Any]], constants: Sequence[str], faults: list[str]) -> None:
    """The page."""
    known = {hard.name: hard for hard in HARD}
    bad = [r for r in records if r["faults"]]
    reached = [r for r in records if r["status"] == "converged"]
    refused = [r for r in records if r["status"] in ("stopped", "failed")]
    lines = [
        HEAD.format(
            limit=LIMIT,
            count=len(records),
            reached=len(reached),
            refused=len(refused),
            bad=len(bad),
            iterations=sum(r["iterations"] for r in records),
        )
        + f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}\n"
        + "\n".join(row(known[r["name"]], r) for r in records),
        "\n## What each is, and where it is not\n",
        *(f"- **{h.name}**: {h.why}.{f' Not in {h.absent}.' if h.absent else ''}" for h in HARD),
        "\n## Refused, and why\n",
        *(f"- {r['name']}, {r['model']}: {r['reason']}" for r in refused),
        "\n## Warnings\n",
        *(f"- {r['name']}, {r['model']}: {w}" for r in records for w in r.get("warnings", [])),
        "\n## Compared\n",
        "| case | model | what | value | least | greatest |\n|---|---|---|---|---|---|",
        *(
            f"| {r['name']} | {r['model']} | {what} | {value:.4g} | {low:.4g} | {high:.4g} |"
            for r in records
            for what, value, low, high in r.get("checks", [])
        ),
    ]
    lines += [
        "\n## Order\n",
        "At the same pressure each bends further than the one before, in every model:\n",
        *(f"- {' < '.join(names)}" for names in ORDERS),
        "\n## Inf-sup constant\n",
        "β² is the least eigenvalue of B K⁻¹ Bᵀ q = β² M q, K the stiffness in the displacements",
        "at rest, B the rate of volume at an angle, M weighted by 1/μ (`tests/hard/infsup.py`);",
        "elements in brackets. A pair that locks falls as the elements' size, to a half or two",
        "thirds in the last column.\n",
        "| element | model | angle ° | coarse | finer | finest |\n|---|---|---|---|---|---|",
        *constants,
    ]
    if bad or faults:
        lines.append("\n## Not as expected\n")
        lines += [f"- {text}" for text in faults]
        lines += [f"- {r['name']}, {r['model']}: {fault}" for r in bad for fault in r["faults"]]
    others = kept(PAGE.read_text(encoding="utf-8")) if PAGE.exists() else ""
    PAGE.write_text("\n".join(lines) + f"{others}\n", encoding="utf-8")


def main() -> int:
    """Run all, or those named; write the page when all ran."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="cases; all by default")
    parser.add_argument("--model", choices=MODELS)
    parser.add_argument("-j", type=int, default=os.cpu_count() or 1, help="at once")
    options = parser.parse_args()
    todo = [
        (hard, model)
        for hard in HARD
        for model in hard.models
        if (not options.names or hard.name in options.names)
        and (options.model is None or options.model == model)
    ]
    records = []
    with ThreadPoolExecutor(options.j) as pool:
        for record in pool.map(lambda item: one(*item), todo):
            records.append(record)
            state = "; ".join(record["faults"]) or record["status"]
            print(
                f"{record['name']:18s} {record['model']:8s} {record['iterations']:4d} iterations "
                f"{record['seconds']:6.1f} s  {state}",
                flush=True,
            )
        faults = out_of_order(records)
        constants: list[str] = []
        whole = not options.names and options.model is None
        for line, problem in pool.map(inf_sup, range(len(LADDERS)) if whole else ()):
            constants.append(line)
            faults += [f"{line}: {problem}"] if problem else []
    print(*constants, *faults, sep="\n")
    total = sum(record["iterations"] for record in records)
    bad = sum(bool(record["faults"]) for record in records) + len(faults)
    print(f"{len(records)} runs, {total} Newton iterations, {bad} not as expected")
    if whole:
        write(records, constants, faults)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
