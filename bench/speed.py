"""What an answer costs in each model, on this machine: docs/speed.md by `make speed`.

Every time is the least of several, after one that compiles the kernels; the limits beside them are
those that the project has set itself. Run it on an idle machine.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
CASE = ROOT / "cases" / "free_bending.yaml"
REPEATS = 5
SPAN = 5.0
"""Seconds at least over which a time is repeated: a shared processor's clock comes and goes."""


def least(action: Callable[[], object], repeats: int = REPEATS) -> float:
    """Least wall time of an action, s, after one call that does not count."""
    action()
    times: list[float] = []
    while len(times) < repeats or sum(times) < SPAN:
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def analytic() -> list[tuple[str, float, float]]:
    """P(θ) of 100 points and θ(P) of one sample, by the closed form of eq. (19)."""
    from analytic.bending import Hemicircle
    from analytic.control.filter import AngleFilter

    actuator = Hemicircle(radius=8, floor=2, wall=2, length=160)
    angles = np.linspace(0, 2 * np.pi, 100)
    samples = actuator.pressure(angles).tolist()
    sensor = AngleFilter.from_model(actuator)

    def filtered() -> None:
        for sample in samples:
            sensor(sample)

    return [
        ("P(θ), closed form, 100 points", least(lambda: actuator.pressure(angles)), 1e-3),
        ("θ(P), angle filter, a sample", least(filtered) / len(samples), 50e-6),
    ]


def uniform(model: str, limit: float, *settings: str) -> tuple[str, float, float]:
    """A curve from 0 to 360° after its kernels are compiled."""
    from mpi4py import MPI

    from fiberbend.models.choice import meshed
    from fiberbend.reader.reader import read_case
    from fiberbend.running.assembly import assemble

    case = read_case(CASE, [f"model={model}", "output={}", *settings])
    case = case.model_copy(
        update={
            "effects": tuple(
                effect.model_copy(update={"to": None, "angle": 2 * np.pi})
                if effect.name == "pressure"
                else effect
                for effect in case.effects
            )
        }
    )
    mesh = meshed(case).mesh(case)
    steps = []

    def solve() -> None:
        built = assemble(case, mesh, MPI.COMM_SELF)
        start = time.perf_counter()
        report = built.march.run(built.ramps)
        steps.append((time.perf_counter() - start, report.steps, report.iterations))

    least(solve)
    spent, count, iterations = min(steps)
    name = f"{model}, 0–360°, {len(mesh.cells)} elements, {count} steps, {iterations} iterations"
    return name, spent, limit


def process(what: str, limit: float, *settings: str) -> tuple[str, float, float]:
    """The command as a user runs it, from the shell to the last file.

    Args:
        what: it writes.
        limit: of the time, s.
        settings: changes to the case.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = [
            *(sys.executable, "-m", "fiberbend", "run", str(CASE), "--quiet", "--overwrite"),
            *("--out", f"{folder}/run", "--set", "model=section"),
            *(word for setting in settings for word in ("--set", setting)),
        ]
        environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)  # a warm cache holds Python's too

        def run() -> None:
            subprocess.run(command, check=True, cwd=ROOT, env=environment, capture_output=True)

        return f"section, 0–360°, the whole process {what}", least(run), limit


def main() -> None:
    """Measure, print, and write docs/speed.md."""
    rows = analytic()
    rows.append(uniform("section", 0.5))
    rows.append(uniform("cell", 4.0, "mesh.section=1", "mesh.axial=0.75 mm"))
    rows.append(uniform("cell", float("nan"), "mesh.section=2", "mesh.axial=0.75 mm"))
    bare = ("output.pictures=false", "output.fields=false", "output.report=false")
    rows.append(process("without pictures and report", 2.5, *bare))
    rows.append(process("with pictures and report", 4.0, "output.fields=false"))
    lines = [
        "# What an answer costs",
        "",
        f"Made by `make speed` on {processor()}, {os.cpu_count()} cores; baseline actuator. Times",
        f"are the least of {REPEATS} and of {SPAN:g} s, after one that compiles the kernels.",
        "",
        "| what | time | limit set |",
        "|---|---|---|",
    ]
    for name, spent, limit in rows:
        bound = "–" if np.isnan(limit) else show(limit)
        lines.append(f"| {name} | {show(spent)} | {bound} |")
    text = "\n".join(lines) + "\n"
    print(text)
    (ROOT / "docs" / "speed.md").write_text(text, encoding="utf-8")


def show(seconds: float) -> str:
    """A time with three digits and a handy unit."""
    for scale, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def processor() -> str:
    """Name of the processor."""
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()


if __name__ == "__main__":
    main()
