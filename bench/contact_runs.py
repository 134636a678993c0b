"""Runs behind docs/contact.md, kept in runs/contact and taken again while their cases stay."""

from __future__ import annotations

import copy
import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from mpi4py import MPI

from bench.tables import ROOT
from fem.results.centre_line import CentreLine
from fiberbend import run
from fiberbend.models.choice import meshed
from fiberbend.reader.reader import as_case
from fiberbend.running.assembly import assemble

RUNS = ROOT / "runs" / "contact"
PRESSURES = (50, 100, 150, 200, 250)
"""Of Fig. 11, kPa."""


@dataclasses.dataclass(frozen=True)
class Solved:
    """A finished run.

    Attributes:
        case: the case.
        rows: of its history.
        run: its run.json.
        folder: where its states are.
    """

    case: dict[str, Any]
    rows: list[dict[str, Any]]
    run: dict[str, Any]
    folder: Path

    def at(self, kpa: float) -> dict[str, Any]:
        """The row at a pressure that was asked for, kPa."""
        return min(self.rows, key=lambda row: abs(row["pressure_kPa"] - kpa))

    def column(self, name: str) -> list[float]:
        """Values at all pressures of Fig. 11."""
        return [float(self.at(kpa)[name]) for kpa in PRESSURES]


def solve(name: str, case: dict[str, Any], states: bool = False) -> Solved:
    """Run a case, or take the run of the same case again.

    Args:
        name: of its folder.
        case: the case.
        states: keep the states for pictures.
    """
    output = case.get("output", {}) | {"pictures": False, "fields": states}
    case = copy.deepcopy(case) | {"output": output}
    folder = RUNS / name
    note = folder / "bench.json"
    if note.exists():
        kept = json.loads(note.read_text(encoding="utf-8"))
        if kept["case"] == case:
            return Solved(case, kept["rows"], kept["run"], folder)
    result = run(case, folder, overwrite=True)
    print(name, result.status, result.run["wall_s"]["solve"], result.run["cutbacks"], flush=True)
    if result.status != "converged":
        raise RuntimeError(f"{name}: {result.reason}")
    kept = {"case": case, "rows": result.rows, "run": result.run}
    note.write_text(json.dumps(kept), encoding="utf-8")
    return Solved(case, result.rows, result.run, folder)


def read(path: str) -> dict[str, Any]:
    """A case file."""
    case: dict[str, Any] = yaml.safe_load((ROOT / "cases" / path).read_text(encoding="utf-8"))
    return case


def fixed(values: Sequence[float], digits: int = 2) -> list[str]:
    """With the same number of decimals."""
    return [f"{value:.{digits}f}" for value in values]


def percent(found: Sequence[float], true: Sequence[float]) -> list[str]:
    """Differences, %."""
    return [f"{100 * (a / b - 1):+.2f}" for a, b in zip(found, true, strict=True)]


def carried(name: str, support: str, kpa: int) -> dict[str, float]:
    """What the roof does to an actuator of Fig. 11.

    Args:
        name: its dimensions, as in the name of its case.
        support: "guided" or "contact".
        kpa: the pressure, kPa.

    Returns:
        The upward force of the roof, on all, on the rims of its strip and on the middle half of
        the length, N; the moment in the body at half its length, of roof and post beyond, N mm;
        the angle to which the curvature of the middle half adds up along the length, °.
    """
    note = RUNS / f"carried_{name}_{support}_{kpa}.json"
    case = read(f"fig11/{name}_{support}.yaml")
    case["effects"][0] = {"pressure": {"to": f"{kpa} kPa"}}
    case["output"] = {}
    if note.exists():
        kept = json.loads(note.read_text(encoding="utf-8"))
        if kept["case"] == case:
            return dict(kept["found"])
    checked = as_case(case)
    mesh = meshed(checked).mesh(checked)
    built = assemble(checked, mesh, MPI.COMM_SELF)
    report = built.march.run(built.ramps)
    if report.status != "converged":
        raise RuntimeError(report.reason)
    scene, body = built.scene, built.scene.body
    up = body.node_dofs[:, 1]

    def push(name: str) -> Any:
        """Upward forces of roof or post on the nodes."""
        if support == "contact":
            return body.symmetry_factor * scene.force(f"Contact[{name}]")[up]
        reaction = np.zeros(body.local)
        reaction[scene.fixed(name)] = scene.residual()[0][scene.fixed(name)]
        return body.symmetry_factor * reaction[up]

    frames, shape = built.observables.frames, built.march.states[-1].shape
    assert frames is not None
    assert shape is not None
    roof, both = push("roof"), push("roof") + push("post")
    x, _, z = mesh.nodes.T
    length = checked.actuator.length
    half = z[np.argmin(np.abs(z - length / 2))]
    here = z + body.w.x.array[body.node_dofs[:, 2]]
    lever = here - here[np.abs(z - half) < 1e-6].mean()
    beyond = z > half
    found = {
        "all": roof.sum(),
        "rims": roof[x > x[np.abs(roof) > 0].max() - 1e-6].sum(),
        "middle": roof[np.abs(z - length / 2) < length / 4].sum(),
        "moment": both[beyond] @ lever[beyond],
        "angle": np.degrees(CentreLine(body).middle()[0]),
    }
    found = {name: float(value) for name, value in found.items()}
    note.write_text(json.dumps({"case": case, "found": found}), encoding="utf-8")
    return found
