"""What `fiberbend plan` estimates, measured: fiberbend/models/costs/prices.json, `make times`.

Each run is a process of its own, one after the other. Seconds are those of the processors, user and
system, of which other programs take less than of the clock's. What was measured stands in
bench/plan_times.json: `--fit` makes the prices from it again, `--only body` measures bodies anew.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from bench.growth_model import fitted
from fiberbend.models.choice import meshed
from fiberbend.models.costs.price import AT_REST, FILE, price
from fiberbend.models.model import thread_mb
from fiberbend.plan.estimate import cost_of
from fiberbend.reader.reader import read_case
from machine.factors import LARGE

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "bench" / "plan_times.json"
PAGE = ROOT / "docs" / "evidence" / "times.md"
QUIET = (
    *("output.pictures=false", "output.fields=false", "output.report=false"),
    "compare=[]",
)
TURNS, SPREAD = "cases/free_bending.yaml", "cases/free_bending_smeared.yaml"
TETS = "mesh.element=tetrahedron"
SHORT = ("output.at_angles=[]", "output.stop_at_angle=90 deg")
RUNS: tuple[tuple[str, tuple[str, ...]], ...] = (
    *((TURNS, ("model=section", f"mesh.section={n}")) for n in (1, 2, 4, 6)),
    *(
        (TURNS, ("model=cell", f"mesh.section={n}", f"mesh.axial={a} mm"))
        for n, a in ((1, 0.75), (1, 0.375), (2, 0.375), (2, 0.1875))
    ),
    *((SPREAD, (f"mesh.axial={a} mm",)) for a in (16, 8, 4)),
    (SPREAD, ("mesh.axial=8 mm", "mesh.section=2", *SHORT)),
    (SPREAD, ("mesh.axial=8 mm", "effects.1.winding.as=calibrated")),
    (TURNS, ()),
    (TURNS, ("mesh.axial=3 mm", "mesh.symmetry=full", *SHORT)),
    (TURNS, ("mesh.axial=3 mm", "mesh.section=2", *SHORT)),
    *((SPREAD, (TETS, f"mesh.axial={a} mm", *SHORT)) for a in (12, 8, 6, 4, 2)),
    ("cases/blocked_tip.yaml", ("mesh.axial=3 mm",)),
)
"""Cases, and changes to them."""
TOUCHING = "blocked_tip"
"""Case whose body touches: nothing is fitted to it, and it shows how far a plan is off there."""

HEAD = (
    "# Times of runs, measured and planned",
    "",
    "Made by `make times`: one rank, kernels compiled, without pictures, fields and report.",
    "Seconds are those of the processors. The numbers of `fiberbend plan` are fitted to these",
    f"runs, all but the number of steps, which it counts; not to {TOUCHING}, whose iterations",
    "a step (fiberbend/models/body.py) are between those of spread windings and of turns.",
    "",
)

_WIDER = 2.0
"""Times that the greatest number of unknowns a layer is the least, for a power to be seen."""

Run = dict[str, Any]
Floats = npt.NDArray[np.float64]


def measured(case: str, changes: Sequence[str]) -> Run:
    """A run, and the size of its problem: as it was meshed, the rest as a plan has it.

    Raises:
        RuntimeError: it failed.
    """
    settings = [*QUIET, *changes]
    known = read_case(ROOT / case, settings)
    model = meshed(known)
    size = model.size(known)
    command = [sys.executable, "-m", "fiberbend", "run", case, "--quiet", "--force"]
    command += [word for change in settings for word in ("--set", change)]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "run"
        before, began = _processor_s(), time.perf_counter()
        done = subprocess.run(
            [*command, "--out", str(out)], cwd=ROOT, env=environment, capture_output=True, text=True
        )
        seconds, clock = _processor_s() - before, time.perf_counter() - began
        if done.returncode:
            raise RuntimeError(f"{case}: {done.stderr.strip()}")
        record = json.loads((out / "run.json").read_text(encoding="utf-8"))
    return {
        "case": case,
        "changes": list(changes),
        "model": model.name,
        "kind": size.kind,
        "elements": record["elements"],
        "unknowns": record["unknowns"],
        "layers": round(size.layers, 3),
        "segments": round(size.segments),
        "steps": record["load_steps"],
        "iterations": record["newton_iterations"],
        "factorisations": record["factorisations"],
        "memory_MB": record["peak_memory_MB"],
        "seconds": round(seconds, 3),
        "clock_s": round(clock, 3),
        "phases": {name: round(value, 3) for name, value in record["wall_s"].items()},
        "machine": f"{record['machine']['processor']}, {record['blas']['kernel']}",
        "commit": record["commit"],
    }


def _processor_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def prices(runs: Sequence[Run]) -> dict[str, dict[str, Any]]:
    """Prices by model and kind of elements."""
    groups: dict[str, list[Run]] = {}
    for run in runs:
        if TOUCHING not in run["case"]:
            groups.setdefault(f"{run['model']} {run['kind']}", []).append(run)
    made: dict[str, dict[str, Any]] = {}
    for name, found in groups.items():
        # of meshes alike across no power is seen: that of the model's first kind of elements
        like = next((made[other] for other in made if other.split()[0] == name.split()[0]), {})
        made[name] = _price(found, like)
    return made


def _price(runs: Sequence[Run], like: dict[str, Any]) -> dict[str, Any]:
    """By phases: what each costs by its own measure."""
    m, n, layers = (_column(runs, name) for name in ("elements", "unknowns", "layers"))
    steps, iterations, factors = (
        _column(runs, name) for name in ("steps", "iterations", "factorisations")
    )
    solve = _phase(runs, "solve")
    parts = {name: _phase(runs, f"solve/{name}") for name in ("residual", "tangent", "factor")}
    parts["solve"] = _phase(runs, "solve/solve")
    rest = np.maximum(solve - sum(parts.values()), 1e-3)
    begin = _column(runs, "seconds") - solve
    all_factors = factors + AT_REST
    thread = np.array([thread_mb(run["segments"]) for run in runs])
    base = 0.9 * float(np.min(_column(runs, "memory_MB") - thread))
    memory = np.maximum(_column(runs, "memory_MB") - thread - base, 1.0)
    return {
        "begin": _line(m, begin),
        "step": _line(n, rest / steps),
        "residual": _line(m, parts["residual"] / iterations),
        "tangent": _line(m, parts["tangent"] / all_factors),
        "factor": _power(n, layers, parts["factor"] / all_factors, like.get("factor")),
        "solve": _power(n, layers, parts["solve"] / iterations, like.get("solve")),
        "memory": _power(n, layers, memory, like.get("memory")),
        "base_mb": round(base),
        "iterations": _share(iterations, steps, n),
        "factorisations": _share(factors, iterations, n),
    }


def _share(some: Floats, of: Floats, unknowns: Floats) -> list[float]:
    """Sum over sum, of problems below `LARGE` and from there on; of all where there is none."""
    shares = []
    for kind in (unknowns < LARGE, unknowns >= LARGE):
        kept = kind if kind.any() else np.ones(len(kind), dtype=bool)
        shares.append(_digits(float(np.sum(some[kept]) / np.sum(of[kept]))))
    return shares


def _column(runs: Sequence[Run], name: str) -> Floats:
    return np.array([run[name] for run in runs], dtype=float)


def _phase(runs: Sequence[Run], name: str) -> Floats:
    """Seconds of the processor in a phase: its part of the clock's."""
    return np.array([run["phases"][name] * run["seconds"] / run["clock_s"] for run in runs])


def _line(count: Floats, values: Floats) -> list[float]:
    """a and b of a + b x, none below zero, by least squares of relative errors."""
    from scipy.optimize import nnls

    rows = np.column_stack([np.ones(len(count)), count]) / values[:, None]
    return [_digits(float(x)) for x in nnls(rows, np.ones(len(count)))[0]]


def _power(
    unknowns: Floats, layers: Floats, values: Floats, like: Sequence[float] | None
) -> list[float]:
    """c and p of c L (n/L)^p; p that of another kind where n/L hardly differs."""
    wide, each = unknowns / layers, values / layers
    if like is not None and wide.max() < _WIDER * wide.min():
        return [_digits(float(np.exp(np.mean(np.log(each / wide ** like[1]))))), like[1]]
    fit = fitted([int(n) for n in wide], list(each))
    return [_digits(fit.factor), _digits(fit.exponent)]


def _digits(value: float) -> float:
    return float(f"{value:.3g}")


def table(runs: Sequence[Run]) -> list[str]:
    """Rows of what was measured beside what a plan says of it."""
    lines = [
        "| case | changes | unknowns | planned | steps | iterations | seconds | planned | MB "
        "| planned |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for run in runs:
        case = read_case(ROOT / run["case"], [*QUIET, *run["changes"]])
        model = meshed(case)
        size = model.size(case)
        cost = cost_of(case, model, size)
        planned = cost.seconds()
        lines.append(
            f"| {Path(run['case']).stem} | {', '.join(run['changes'])} | {run['unknowns']} "
            f"| {size.unknowns} | {run['steps']} | {run['iterations']} | {run['seconds']:.1f} "
            f"| {'' if planned is None else f'{planned:.1f}'} "
            f"| {run['memory_MB']:.0f} | {cost.memory_mb:.0f} |"
        )
    return lines


def main() -> None:
    """Measure what is asked for, fit, and write prices and page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fit", action="store_true", help="measure nothing")
    parser.add_argument("--only", help="measure the runs of this model alone")
    options = parser.parse_args()
    kept: list[Run] = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else []
    known = {(run["case"], tuple(run["changes"])): run for run in kept}
    for case, changes in () if options.fit else RUNS:
        model = meshed(read_case(ROOT / case, [*QUIET, *changes]))
        if options.only in (None, model.name) or (case, changes) not in known:
            found = known[case, changes] = measured(case, changes)
            print(case, *changes, f"{found['seconds']} s, {found['memory_MB']} MB", flush=True)
    runs = [known[each] for each in RUNS]
    KEPT.write_text(json.dumps(runs, indent=1) + "\n", encoding="utf-8")
    origin = {name: runs[-1][name] for name in ("machine", "commit")}
    content = {"origin": {"command": "make times", **origin}, "prices": prices(runs)}
    FILE.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    price.cache_clear()
    PAGE.write_text("\n".join([*HEAD, *table(runs), ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
