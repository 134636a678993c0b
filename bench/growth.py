"""Growth of time and memory with the number of unknowns: docs/evidence/growth.md, `make growth`.

The baseline's body with every turn of its winding, bent to 45°, on finer and finer meshes and on
one and two ranks: each a process of its own, one at a time. What has been measured is kept in
build/growth, so that a measurement that was stopped goes on.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.growth_model import Fit, Scaling, fitted, powers
from fiberbend.process.ranks import launcher

ROOT = Path(__file__).resolve().parent.parent
CASE = "cases/free_bending.yaml"
KEPT = ROOT / "build" / "growth"
PAGE = ROOT / "docs" / "evidence" / "growth.md"
CLUSTER = ROOT / "docs" / "cluster.md"
"""The page that has the times on more ranks too, between these marks."""
MARKS = ("<!-- ranks, by `make growth` -->", "<!-- end of ranks -->")
PICTURE = ROOT / "docs" / "images" / "growth.png"
SIZES = ((1, 6.0), (1, 3.0), (1, 1.5), (2, 4.0), (2, 2.0), (2, 1.25), (2, 0.9))
"""Elements through each thickness, and length of the elements along the axis, mm."""
PHASES = ("factor", "tangent", "residual", "solve")
SETTINGS = (
    *("output.pictures=false", "output.fields=false", "output.report=false"),
    *("output.at_angles=[]", "output.stop_at_angle=45 deg"),
)


@dataclasses.dataclass(frozen=True)
class Point:
    """What one run took.

    Attributes:
        section: elements through each thickness.
        axial: length of the elements along the axis, mm.
        ranks: number of processes.
        unknowns: displacements and pressures.
        factorisations: tangents and their factors.
        iterations: of Newton's method.
        seconds: wall time by phase of the solution; `all` for the whole of it.
        memory_mb: greatest memory of all ranks together.
        machine: processor and kernel of the linear algebra.
    """

    section: int
    axial: float
    ranks: int
    unknowns: int
    factorisations: int
    iterations: int
    seconds: dict[str, float]
    memory_mb: float
    machine: str


def measured(section: int, axial: float, ranks: int, most_s: float) -> Point | str:
    """The run of one mesh, or what was measured before.

    Args:
        section: elements through each thickness.
        axial: length of the elements along the axis, mm.
        ranks: number of processes.
        most_s: seconds after which it is ended.

    Returns:
        The point, or why there is none.
    """
    folder = KEPT / f"section{section}_axial{axial:g}_ranks{ranks}"
    file = folder / "run.json"
    if not file.exists():
        changes = (*SETTINGS, f"mesh.section={section}", f"mesh.axial={axial} mm")
        command = [sys.executable, "-m", "fiberbend", "run", CASE, "--out", str(folder), "--quiet"]
        command += ["--overwrite", *(word for change in changes for word in ("--set", change))]
        if ranks > 1:
            command = [launcher(), "-n", str(ranks), *command]
        environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
        try:
            done = subprocess.run(
                command, cwd=ROOT, env=environment, timeout=most_s, capture_output=True, text=True
            )
        except subprocess.TimeoutExpired:
            return f"not done within {most_s:g} s"
        if done.returncode:
            return (done.stderr.strip().splitlines() or ["failed"])[-1]
    record: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    if record["status"] == "failed":
        return str(record["reason"])
    wall = record["wall_s"]
    return Point(
        section,
        axial,
        ranks,
        record["unknowns"],
        record["factorisations"],
        record["newton_iterations"],
        {"all": wall["solve"], **{phase: wall[f"solve/{phase}"] for phase in PHASES}},
        record["peak_memory_MB"],
        f"{record['machine']['processor']}, {record['blas']['kernel']}",
    )


def table(points: Sequence[Point]) -> list[str]:
    """Rows of all runs."""
    lines = [
        "| mesh.section | mesh.axial, mm | unknowns | ranks | iterations | factorisations "
        "| solve, s | factor | tangent | memory, GB |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for p in points:
        lines.append(
            f"| {p.section} | {p.axial:g} | {p.unknowns} | {p.ranks} | {p.iterations} "
            f"| {p.factorisations} | {p.seconds['all']:.1f} | {p.seconds['factor']:.1f} "
            f"| {p.seconds['tangent']:.1f} | {p.memory_mb / 1000:.2f} |"
        )
    return lines


def picture(points: Sequence[Point], fits: dict[str, Fit]) -> None:
    """Time of an iteration and memory against unknowns, with their powers."""
    from matplotlib.ticker import LogLocator

    from fiberbend.drawing.page import figure, save

    page = figure((1300, 560))
    page.subplots_adjust(left=0.06, right=0.985, bottom=0.1, top=0.97, wspace=0.14)
    left, right = page.subplots(1, 2)
    for ranks, color, mark in ((1, "#1f5a99", "o"), (2, "#c0392b", "s")):
        chosen = [p for p in points if p.ranks == ranks]
        if not chosen:
            continue
        n = np.array([p.unknowns for p in chosen])
        name = f"{ranks} rank{'s' * (ranks > 1)}"
        for panel, values, key in (
            (left, [p.seconds["all"] for p in chosen], f"time {ranks}"),
            (right, [p.memory_mb / 1000 for p in chosen], f"memory {ranks}"),
        ):
            panel.loglog(n, values, mark, color=color, label=name)
            if key in fits:
                line = np.geomspace(n.min(), n.max(), 50)
                text = f"unknowns to the power {fits[key].exponent:.2f}"
                panel.loglog(line, fits[key](line), "-", color=color, lw=1, label=text)
    left.set_ylabel("solve to 45°, s")
    right.set_ylabel("greatest memory, GB")
    for panel in (left, right):
        panel.set_xlabel("unknowns")
        panel.grid(True, which="both", alpha=0.25)
        for axis in (panel.xaxis, panel.yaxis):
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter("")
        panel.legend()
    save(page, PICTURE)


def write(points: Sequence[Point], missing: Sequence[str]) -> None:
    """The page and its picture."""
    fits = {}
    for ranks in (1, 2):
        chosen = [p for p in points if p.ranks == ranks]
        if len(chosen) < 3:
            continue
        n = [p.unknowns for p in chosen]
        fits[f"time {ranks}"] = fitted(n, [p.seconds["all"] for p in chosen])
        fits[f"memory {ranks}"] = fitted(n, [p.memory_mb / 1000 for p in chosen])
    picture(points, fits)
    lines = [
        "# Growth of time and memory",
        "",
        f"Made by `make growth` on {points[0].machine}: the baseline's body, every turn of the "
        "winding by itself, bent to 45°. Factorisations are those of Newton's method; `factor` has "
        "those of the response at rest and of the stability at the end too.",
        "",
        "![Time and memory against unknowns](../images/growth.png)",
        "",
        *table(points),
        *(f"- {line}" for line in missing),
        "",
        *(["## Powers", "", *powers(fits), ""] if fits else []),
        "## On more ranks",
        "",
        *Scaling.of(points).text(),
    ]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    put_on_cluster_page(Scaling.of(points).text())


def put_on_cluster_page(lines: Sequence[str]) -> None:
    """Times on more ranks, where who has a cluster looks for them."""
    begin, end = MARKS
    before, _, rest = CLUSTER.read_text(encoding="utf-8").partition(begin)
    after = rest.partition(end)[2]
    block = "\n".join([begin, "", *lines, "", end])
    CLUSTER.write_text(f"{before}{block}{after}", encoding="utf-8")


def main() -> None:
    """Measure all meshes, then write."""
    options = argparse.ArgumentParser()
    options.add_argument("--most-s", type=float, default=900.0, help="seconds a run")
    options.add_argument("--sizes", type=int, default=len(SIZES), help="how many meshes")
    given = options.parse_args()
    points, missing = [], []
    for section, axial in SIZES[: given.sizes]:
        for ranks in (1, 2):
            found = measured(section, axial, ranks, given.most_s)
            name = f"mesh.section {section}, mesh.axial {axial:g} mm, {ranks} rank(s)"
            if isinstance(found, str):
                missing.append(f"{name}: {found}")
                print(missing[-1], flush=True)
                continue
            points.append(found)
            seconds, memory = found.seconds["all"], found.memory_mb / 1000
            print(
                f"{name}: {found.unknowns} unknowns, {seconds:.1f} s, {memory:.2f} GB", flush=True
            )
    write(points, missing)


if __name__ == "__main__":
    main()
