"""Bending actuators beside the paper, an independent section and cell, and other programs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from analytic.bending import Hemicircle
from bench.outside.table import Row
from bench.peers.scene import CASE, ROOT, settings
from fiberbend import run
from fiberbend.reader.reader import read_case

ANGLES = (90.0, 180.0, 270.0, 360.0)
BASELINE = "Paper's actuator, free"
CLOSED_FORM = (78.197, 140.691, 192.815, 237.828)
SECTION = (45.1, 89.2, 134.3, 181.5)
CELL = (46.7, 92.9, 140.6, 190.8)
"""P in kPa at the angles, as others have them."""
BAND = {"section": 0.01, "cell": None}
PEERS = ROOT / "docs" / "evidence" / "peers.md"
PEER_GOALS = (90.0, 180.0)
MESH = (1, 8.0)
"""On which CalculiX and felupe came to their goals."""


def _pressures(changes: Sequence[str], angles: Sequence[float]) -> list[float]:
    """P in kPa at bending angles of a case of the paper, its winding smeared."""
    asked = ", ".join(f'"{angle:g} deg"' for angle in angles)
    result = run(
        read_case(
            CASE,
            [
                f'effects.0={{"pressure": {{"angle": "{angles[-1]:g} deg"}}}}',
                f'output={{"at_angles": [{asked}], "pictures": false, "fields": false}}',
                "compare=[]",
                *changes,
            ],
        )
    )
    if result.status != "converged":
        raise RuntimeError(f"{', '.join(changes)}: {result.reason}")
    return [
        float(min(result.rows, key=lambda row: abs(row["angle_deg"] - angle))["pressure_kPa"])
        for angle in angles
    ]


def _texts(values: Sequence[float], digits: int = 1) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values) + " kPa"


def _worst(ours: Sequence[float], theirs: Sequence[float]) -> float:
    return max((a / b - 1 for a, b in zip(ours, theirs, strict=True)), key=abs)


def bending() -> list[Row]:
    """The closed form, the section and the cell at quarters of a circle."""
    where = "at 90, 180, 270, 360°; off: the worst"
    closed = (1e3 * Hemicircle(8, 2, 2, 160).pressure(np.radians(ANGLES))).tolist()
    made = [
        Row(
            BASELINE,
            f"P of eq. (19) with μ̄ = 0.314 MPa {where}",
            _texts(closed, 3),
            _texts(CLOSED_FORM, 3),
            _worst(closed, CLOSED_FORM),
            1e-5,
            "Polygerinos 2015",
            "the printed formula has a factor L too many, left out in both",
        )
    ]
    turns = 'effects.1.winding={"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"'
    cases: dict[str, tuple[str, ...]] = {
        "section": ("model=section", "mesh={section: 2}"),
        "cell": ("model=cell", "mesh={section: 1, axial: 0.25 mm}", turns + ', "as": "discrete"}'),
    }
    for (model, changes), theirs in zip(cases.items(), (SECTION, CELL), strict=True):
        ours = _pressures([change for change in changes if change], ANGLES)
        what = {"section": "winding smeared", "cell": "every turn"}[model]
        made.append(
            Row(
                BASELINE,
                f"P of the {model}, {what}, {where}",
                _texts(ours),
                _texts(theirs),
                _worst(ours, theirs),
                BAND[model],
                "independent",
                "its mesh, of 40 to 120 elements" if model == "cell" else "its mesh",
            )
        )
    return made


def trends() -> list[Row]:
    """The paper's Table II: what a radius, a length and a wall do to the pressure at 360°."""
    made = []
    for name, key, low, high, paper in (
        ("radius", "actuator.radius", 6, 12, "falls"),
        ("length", "actuator.length", 100, 160, "falls"),
        ("wall", "actuator.wall", 1, 3, "rises"),
    ):
        for floor in (2, 3):
            ends = [
                _pressures(
                    [
                        *("model=section", "mesh={section: 1}"),
                        *(f"actuator.floor={floor} mm", f"{key}={value} mm"),
                    ],
                    [360.0],
                )[0]
                for value in (low, high)
            ]
            change = ends[1] / ends[0] - 1
            made.append(
                Row(
                    BASELINE,
                    f"P at 360°, {name} {low} to {high} mm, floor {floor} mm, section",
                    f"{'falls' if change < 0 else 'rises'}, {ends[0]:.1f} to {ends[1]:.1f} kPa",
                    paper,
                    None,
                    None,
                    "Polygerinos 2015",
                    "the floor's thickness, which decides the sign" if name == "radius" else "",
                )
            )
    return made


def peers_page(text: str) -> dict[str, tuple[float, ...]]:
    """P in kPa at the goals, by program, from the page of `make peers` on the mesh.

    Raises:
        ValueError: the page has no such row.
    """
    mesh = f"{MESH[0]} × {MESH[1]:g} mm"
    found: dict[str, tuple[float, ...]] = {}
    for name, program in (("CalculiX C3D20R", "CalculiX, C3D20R"), ("felupe", "felupe")):
        row = re.search(rf"(?m)^\| {program}[^|]*\| {mesh} \|.*$", text)
        if row is None:
            raise ValueError(f"docs/evidence/peers.md has no row of {program} on {mesh}")
        cells: list[Any] = [cell.strip() for cell in row[0].split("|")]
        found[name] = (float(cells[5]), float(cells[7]))
    return found


def programs() -> list[Row]:
    """CalculiX and felupe on the same mesh, as `make peers` has left them."""
    ours = _pressures([*settings(*MESH), 'output.at_angles=["90 deg", "180 deg"]'], PEER_GOALS)
    causes = {
        "CalculiX C3D20R": "its hexahedra have 20 nodes and no pressures as unknowns, its hoops "
        "are polygons; its finer mesh did not come to 90° in 300 s",
        "felupe": "its hoops are trusses between nodes",
    }
    return [
        Row(
            "Paper's actuator, hoops, half body",
            f"P at {goal:g}°, mesh of {MESH[0]} × {MESH[1]:g} mm in both",
            f"{mine:.2f} kPa",
            f"{value:.2f} kPa",
            mine / value - 1,
            None,
            name,
            causes[name],
        )
        for name, values in peers_page(PEERS.read_text(encoding="utf-8")).items()
        for goal, mine, value in zip(PEER_GOALS, ours, values, strict=True)
    ]


def rows() -> list[Row]:
    """All of them."""
    return [*bending(), *trends(), *programs()]
