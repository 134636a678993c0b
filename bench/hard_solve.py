"""Solve one hard case in one model: `python -m bench.hard_solve NAME MODEL` prints its record."""

from __future__ import annotations

import dataclasses
import json
import os
import sys
from typing import Any

from bench import hard_procedures as procedures
from bench.hard_cases import Hard, find


@dataclasses.dataclass
class Record:
    """How a hard case ended in a model.

    Attributes:
        name: of the case.
        model: that solved it.
        status: converged, stopped or failed.
        reason: why not converged.
        angle_deg: at the end.
        pressure_kpa: at the end.
        steps: converged load steps.
        cutbacks: failed ones.
        iterations: Newton iterations, failed steps included.
        least_det_f: over all steps.
        modes: unstable modes at the end.
        gap: |∫ Σ q dQ − stored energy| at the end over the greatest stored energy.
        warnings: of the run.
        checks: further comparisons, what was measured and its bounds.
        seconds: processor time, with that of compilers and of gmsh.
        faults: what is not as expected; empty when all is well.
    """

    name: str
    model: str
    status: str
    reason: str
    angle_deg: float
    pressure_kpa: float
    steps: int
    cutbacks: int
    iterations: int
    least_det_f: float
    modes: int
    gap: float
    warnings: list[str]
    checks: list[tuple[str, float, float, float]]
    seconds: float
    faults: list[str]


def solve(hard: Hard, model: str) -> Record:
    """Solve a case and compare it with what is expected of it."""
    before = sum(os.times()[:4])
    done = getattr(procedures, hard.procedure)(hard, model)
    rows, run = done.rows, done.run
    last = rows[-1]
    stored = max(abs(row["stored_mJ"]) for row in rows)
    record = Record(
        name=hard.name,
        model=model,
        status=run["status"],
        reason=run["reason"],
        angle_deg=last["angle_deg"],
        pressure_kpa=last["pressure_kPa"],
        steps=run["load_steps"],
        cutbacks=run["cutbacks"],
        iterations=run["newton_iterations"],
        least_det_f=min(row["min_det_F"] for row in rows),
        modes=last.get("unstable_modes", 0),
        gap=abs(last["work_mJ"] - last["stored_mJ"]) / max(stored, 1e-12),
        warnings=run["warnings"],
        checks=done.checks,
        seconds=round(sum(os.times()[:4]) - before, 1),
        faults=[],
    )
    record.faults = faults(hard, record)
    return record


def faults(hard: Hard, record: Record) -> list[str]:
    """What a record has against the expectation of its case."""
    found = []
    word = hard.refused.get(record.model)
    if word is None and record.status != "converged":
        found.append(f"expected to be reached, but {record.status}: {record.reason}")
    if word is not None and (record.status == "converged" or word not in record.reason):
        found.append(f"expected to be refused with '{word}', but {record.status}: {record.reason}")
    for text in hard.warns:
        if not any(text in line for line in record.warnings):
            found.append(f"expected a warning of '{text}': {record.warnings}")
    if word is None and hard.stable and record.modes:
        found.append(f"{record.modes} unstable modes at the end")
    if word is None and not record.gap <= hard.balance:
        found.append(f"∫ P dV is {record.gap:.2g} off the stored energy")
    for what, value, low, high in record.checks:
        if not low <= value <= high:
            found.append(f"{what} is {value:.6g}, expected {low:.6g} to {high:.6g}")
    return found


def main(arguments: list[str]) -> None:
    """Print the record of a case as JSON on the last line."""
    name, model = arguments
    record: dict[str, Any] = dataclasses.asdict(solve(find(name), model))
    print(json.dumps(record, default=float))


if __name__ == "__main__":
    main(sys.argv[1:])
