"""Run folders without a solver: an actuator in exact circular bending, at a few load steps."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.reader.reader import parse_case
from fiberbend.results.folder import MESH, RunFolder
from fiberbend.results.states import step_label, write_fibers, write_snapshot
from fiberbend.states.snapshot import ModelMesh, Snapshot
from tests.output import bending

ANGLES = (20.0, 45.0, 70.0)
HOSTILE = "A <script>alert('title')</script> & \"quotes\" $x$"
CASE: dict[str, Any] = {
    "title": HOSTILE,
    "actuator": {
        "radius": "8 mm",
        "length": "24 mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "sheath": "1 mm",
        "cap": "4 mm",
    },
    "materials": {"wall": "elastosil-m4601", "floor": "combined-base", "sheath": "ecoflex-0030"},
    "effects": [
        {"pressure": {"to": "70 kPa"}},
        {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}},
        {"contact": {"cylinder": {"center": ["-20 mm", "20 mm"], "radius": "5 mm"}}},
    ],
    "model": "body",
    "mesh": {"axial": "4 mm"},
    "output": {"pictures": False, "fields": False, "at_angles": ["45 deg"]},
}


def case(**changes: Any) -> Case:
    """The case with top-level entries changed."""
    return parse_case(CASE | changes)


def state(model_mesh: ModelMesh, step: int, degrees: float) -> Snapshot:
    """A state at an angle; 1 kPa for a degree."""
    mesh = model_mesh.mesh
    moved = bending.bent(mesh.nodes, 24.0, np.radians(degrees)) - mesh.nodes
    return Snapshot(
        label=step_label(step),
        step=step,
        pressure_kpa=degrees,
        angle_deg=degrees,
        displacement=moved,
        multiplier=np.zeros(mesh.cells.shape),
        fiber_force=np.zeros(len(model_mesh.fibers.cell)) if model_mesh.fibers else None,
    )


def row(step: int, degrees: float) -> dict[str, Any]:
    """A row of the history: the tip moves as the centre of the cap's face does."""
    tip = bending.bent(np.array([[0.0, 5.0, 28.0]]), 24.0, np.radians(degrees))[0]
    return {
        col.STEP: step,
        col.PRESSURE: degrees,
        col.ANGLE: degrees,
        col.TIP_Y: tip[1],
        col.TIP_Z: tip[2],
        col.VOLUME: 2000.0 + degrees,
        col.TIP_FORCE: None,
        col.ITERATIONS: 3,
    }


def rows(angles: tuple[float, ...] = ANGLES) -> list[dict[str, Any]]:
    """The history from rest on."""
    return [row(step, degrees) for step, degrees in enumerate((0.0, *angles))]


def run_of(status: str = "converged", **entries: Any) -> dict[str, Any]:
    """Content of run.json."""
    return {
        "status": status,
        "reason": "",
        "model": "body",
        "wall_s": {"mesh": 0.1, "solve": 2.5},
        "versions": {"fiberbend": "0.1.0"},
        "warnings": ["the body <b>passes</b> through itself"],
        **entries,
    }


def bent_folder(path: Path, given: Case, run: dict[str, Any], element: str = "hexahedron") -> Path:
    """The folder of a run of a body that bends in an arc.

    Args:
        path: where.
        given: the case.
        run: content of run.json.
        element: kind of the elements.
    """
    model_mesh = bending.model_mesh(element=element)
    folder = RunFolder(path)
    folder.write_case(given)
    folder.write(MESH, model_mesh.mesh.save)
    assert model_mesh.fibers is not None
    write_fibers(folder, model_mesh.fibers, smeared=False)
    for step, degrees in enumerate(ANGLES, start=1):
        shot = state(model_mesh, step, degrees)
        write_snapshot(folder, shot)
    folder.write_history(rows())
    folder.write_text("run.json", json.dumps(run))
    return path
