"""Iterative solvers beside the direct one: docs/evidence/iterative.md, `python -m bench.iterative`.

Tangents of the baseline's body at rest, at 45° and at 180°, solved for the response to the pressure
by a block preconditioner, by multigrid and by slabs. Seconds are of the processor, of one process.
What has been measured is kept in build/iterative, so that a measurement that was stopped goes on.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from bench.iterative_page import page
from bench.iterative_solvers import blocks, multigrid
from fem.march.hooks import AfterStep
from fem.march.records import State
from fem.scene import Scene
from fem.solver.factor import Factor, Mumps
from fem.solver.newton import Outcome
from fem.solver.problem import RefusedError
from fem.solver.slabs import Slabs
from fiberbend.models.choice import meshed
from fiberbend.reader.reader import read_case
from fiberbend.running.assembly import assemble
from fiberbend.running.calibrated import calibrated
from fiberbend.running.progress import Progress
from fiberbend.running.warm import section_states

Floats = npt.NDArray[np.float64]
Row = dict[str, Any]

ROOT = Path(__file__).resolve().parent.parent
CASE = ROOT / "cases" / "free_bending.yaml"
KEPT = ROOT / "build" / "iterative"
BODIES = (
    (1, 6.0, "discrete"),
    (1, 1.5, "discrete"),
    (1, 6.0, "smeared"),
    (1, 6.0, "calibrated"),
    (2, 2.0, "discrete"),
)
"""Elements through each thickness, length of the elements along the axis, mm, and the winding; the
last takes ten minutes of the processor."""
ANGLES = (0, 45, 180)
SLABS = (4, 16)
TRIED, LARGE = ("discrete",), 200_000
"""Windings of the coarsest body with which block preconditioners and multigrid are tried; unknowns
from which on only the last state is."""


def direct(scene: Scene, b: Floats) -> tuple[list[Row], Floats]:
    """The direct solver, in layers where it takes them, and MUMPS with what its factor takes."""
    free = scene.free[: scene.body.owned]
    rows, found = [], b
    solver = Factor(scene.matrix, volumetric=scene.volumetric, free=free)
    solver.renew()  # with the analysis, which is done once
    start = time.process_time()
    solver.renew()
    middle = time.process_time()
    found = solver.solve_many([b])[0]
    rows.append(
        {
            "solver": "direct",
            "factor": middle - start,
            "solve": time.process_time() - middle,
        }
    )
    solver.destroy()
    general = Mumps(scene.matrix, True, scene.volumetric, free)
    general.renew()
    start = time.process_time()
    general.renew()
    middle = time.process_time()
    general.solve_many([b])
    rows.append(
        {
            "solver": "MUMPS",
            "factor": middle - start,
            "solve": time.process_time() - middle,
            "memory": general.memory_mb,
        }
    )
    general.destroy()
    return rows, found


def slabs(scene: Scene, b: Floats, known: Floats, count: int) -> Row:
    """Slabs, all on this one rank."""
    free = scene.free[: scene.body.owned]
    solver = Slabs(scene.matrix, scene.volumetric, free, scene.place, count)
    row: Row = {"solver": f"{count} slabs"}
    try:
        solver.renew()
        start = time.process_time()
        solver.renew()
        middle = time.process_time()
        x = solver.solve_many([b])[0]
    except RefusedError as error:
        return row | {"why": str(error)}
    u = ~scene.volumetric
    return row | {
        "factor": middle - start,
        "solve": time.process_time() - middle,
        "memory": solver.memory_mb,
        "iterations": solver.iterations,
        "error": float(np.linalg.norm((x - known)[u]) / np.linalg.norm(known[u])),
    }


def at_state(scene: Scene, angle: int, blocked: bool) -> list[Row]:
    """All solvers at the present state.

    Args:
        scene: at an equilibrium.
        angle: that it is bent by, °.
        blocked: try block preconditioners and multigrid as well.
    """
    scene.predict(None)
    scene.assemble_tangent()
    b = scene.load("pressure")
    rows, known = direct(scene, b)
    rows += [slabs(scene, b, known, count) for count in SLABS]
    if blocked:
        rows += blocks(scene, b, known)
        rows += multigrid(scene, b)
    for row in rows:
        row |= {"angle": angle, "unknowns": scene.body.size}
        print(row, flush=True)
    return rows


def measured(section: int, axial: float, winding: str) -> list[Row]:
    """All states of one body, or what was measured before."""
    file = KEPT / f"section{section}_axial{axial:g}_{winding}.json"
    if file.exists():
        kept: list[Row] = json.loads(file.read_text(encoding="utf-8"))
        return kept
    changes = [f"mesh.section={section}", f"mesh.axial={axial} mm", "compare=[]"]
    changes += ["output.at_angles=[45 deg, 180 deg]", "output.stop_at_angle=180 deg"]
    changes += [] if winding == "discrete" else [f"effects.1.winding.as={winding}"]
    case, _ = calibrated(read_case(CASE, changes), MPI.COMM_SELF, Progress(quiet=True), None)
    states = section_states(case)

    def guide(scene: Scene, frames: Any) -> Any:
        return states.guide(scene, frames, case.actuator.length) if states else None

    assembly = assemble(case, meshed(case).mesh(case), MPI.COMM_SELF, guide)
    blocked = (section, axial) == BODIES[0][:2] and winding in TRIED
    angles = ANGLES[-1:] if assembly.scene.body.size > LARGE else ANGLES
    rows = at_state(assembly.scene, 0, blocked) if 0 in angles else []

    def look(state: State, _outcome: Outcome) -> None:
        angle = math.degrees(state.measures["control"])
        for asked in angles:
            if abs(angle - asked) < 1e-3:
                rows.extend(at_state(assembly.scene, asked, blocked))

    assembly.march.run(assembly.ramps, [AfterStep(look)])
    for row in rows:
        row |= {"section": section, "axial": axial, "winding": winding}
    KEPT.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(rows, indent=1), encoding="utf-8")
    return rows


def main() -> None:
    """Measure all bodies, then write."""
    options = argparse.ArgumentParser()
    options.add_argument("--bodies", type=int, default=len(BODIES), help="how many bodies")
    given = options.parse_args()
    rows = [row for body in BODIES[: given.bodies] for row in measured(*body)]
    page(rows, PETSc.Sys.getVersion())


if __name__ == "__main__":
    main()
