"""Accuracy tables of section and cell: meshes, ribbon, pitch, and the body beside them.

Writes docs/evidence/uniform.md; names of parts on the command line renew only these. Runs on any
number of ranks; every number in the file comes from here.
"""

from __future__ import annotations

import copy
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.tables import BASELINE, WINDING, table
from fiberbend import run
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import read_case
from fiberbend.running import launch

PAGE = Path(__file__).resolve().parent.parent / "docs" / "evidence" / "uniform.md"
CASES = PAGE.parent.parent / "cases"
ANGLES = (90.0, 180.0, 270.0, 360.0)
SECTION = (45.1, 89.2, 134.3, 181.5)
CELL = (46.7, 92.9, 140.6, 190.8)
SMEARED: dict[str, Any] = {"as": "smeared"}
DISCRETE: dict[str, Any] = {"as": "discrete"}
LINES = 9
"""Across a ribbon where it is to be resolved."""
HEAD = """# Accuracy of section and cell

P in kPa of the baseline of Polygerinos et al. 2015 (radius 8, length 160, wall 2, floor 2, sheath
1 mm; double helix of pitch 3 mm) at bending angles of 90, 180, 270 and 360° by default. s is the
time of the solution on one core of the machine that wrote this page, compilation and reading left
out, beside other work: an order of magnitude. `python bench/uniform.py` makes the page.
"""


def solve(
    model: str,
    mesh: dict[str, Any],
    angles: Sequence[float] = ANGLES,
    actuator: dict[str, str] | None = None,
    **winding: Any,
) -> RunResult:
    """Bend an actuator to the last of some angles, °.

    Args:
        model: "section", "cell" or "body".
        mesh: entry `mesh` of the case.
        angles: stops, °.
        actuator: dimensions other than the baseline's.
        winding: settings other than the baseline's.
    """
    case = copy.deepcopy(BASELINE)
    case["actuator"] |= actuator or {}
    case |= {"model": model, "mesh": mesh}
    case["effects"] = [
        {"pressure": {"angle": f"{angles[-1]!r} deg"}},
        {"winding": WINDING | winding},
    ]
    case["output"] = {"at_angles": [f"{angle!r} deg" for angle in angles]}
    result = run(case)
    if launch.rank() == 0:
        print(model, mesh, actuator, winding, result.status, result.run["wall_s"], flush=True)
    if result.status != "converged":
        raise RuntimeError(f"{model}, {mesh}: {result.reason}")
    return result


def rows_at(result: RunResult, angles: Sequence[float] = ANGLES) -> list[dict[str, Any]]:
    """Rows of the history at the stops."""
    return [min(result.rows, key=lambda row: abs(row["angle_deg"] - a)) for a in angles]


def pressures(result: RunResult, angles: Sequence[float] = ANGLES) -> list[float]:
    """P in kPa at the stops."""
    return [float(row["pressure_kPa"]) for row in rows_at(result, angles)]


def cost(result: RunResult) -> list[Any]:
    """Unknowns, steps with iterations, seconds."""
    data = result.run
    steps = f"{data['load_steps']}; {data['newton_iterations']}"
    return [data["unknowns"], steps, f"{data['wall_s']['solve']:.1f}"]


def worst(found: Sequence[float], true: Sequence[float]) -> float:
    """Difference of the largest size, %."""
    return max((100 * (a / b - 1) for a, b in zip(found, true, strict=True)), key=abs)


def fixed(values: Sequence[float], digits: int = 2) -> list[str]:
    """With the same number of decimals."""
    return [f"{value:.{digits}f}" for value in values]


def percent(found: Sequence[float], true: Sequence[float], digits: int = 2) -> list[str]:
    """Differences, %."""
    return [f"{100 * (a / b - 1):+.{digits}f} %" for a, b in zip(found, true, strict=True)]


COST = ["unknowns", "steps; iterations", "s"]
DEGREES = [f"{angle:g}°" for angle in ANGLES]


def section_mesh() -> list[str]:
    """Refinement of the section."""
    refinements = (1, 2, 3, 4, 5, 6, 8, 12, 16)
    results = {n: solve("section", {"section": n}, **SMEARED) for n in refinements}
    found = {n: np.array(pressures(result)) for n, result in results.items()}
    orders = np.log2((found[4] - found[8]) / (found[8] - found[16]))
    # the last two and their own order
    limit = found[16] - (found[8] - found[16]) / (2**orders - 1)
    rows = [
        [n, *cost(results[n]), *fixed(list(p), 3), f"{worst(list(p), list(limit)):.4f} %"]
        for n, p in found.items()
    ]
    return [
        "## Section: refinement",
        "",
        "Refinement n has n elements through wall, floor and sheath and 4 n along a quarter arc. "
        "The order is that between n = 4, 8 and 16; the last row but one is Richardson's value by "
        "it. Corners of the chamber and of the winding, where stiff floor, rubber and fibers meet, "
        "keep the order near 2, where smooth solutions would give 4.",
        "",
        *table(
            ["n", *COST, *DEGREES, "off by at most"],
            [
                *rows,
                ["order", "", "", "", *fixed(list(orders)), ""],
                ["∞", "", "", "", *fixed(list(limit), 3), ""],
                ["independent section", "", "", "", *map(str, SECTION), "1 % band"],
            ],
        ),
    ]


def section_shapes() -> list[str]:
    """Refinement of every shipped section, from small angles on."""
    angles = (2.0, 5.0, 20.0, 45.0, 90.0, 180.0)
    cases = ("section", "single_helix", "rectangle", "circle")
    rows = []
    for name in cases:

        def bent(n: int, name: str = name) -> list[float]:
            settings = [
                "model=section",
                f"effects.0={{pressure: {{angle: {angles[-1]:g} deg}}}}",
                f"mesh.section={n}",
                f"output={{at_angles: [{', '.join(f'{angle:g} deg' for angle in angles)}]}}",
            ]
            return pressures(run(read_case(CASES / f"{name}.yaml", settings)), angles)

        fine = bent(8)
        for n in (1, 2, 3, 4):
            found = bent(n)
            off = [*percent(found, fine), f"{abs(worst(found, fine)):.2f} %"]
            rows.append([f"{name}.yaml", n, *off])
    return [
        "## Section: refinement by shape",
        "",
        "P of the shipped cases with n elements through each thickness against n = 8. Small angles "
        "need the most where a stiff floor meets soft walls, and sharp corners more than arcs; the "
        "flat walls of a rectangle bulge near 45°.",
        "",
        *table(["case", "n", *(f"{angle:g}°" for angle in angles), "off by at most"], rows),
    ]


def _cell(n: int, layers: int, pitch: float = 3.0, **winding: Any) -> RunResult:
    """A cell with so many layers over half a pitch."""
    mesh = {"section": n, "axial": f"{pitch / 2 / layers!r} mm"}
    return solve("cell", mesh, pitch=f"{pitch!r} mm", **(DISCRETE | winding))


def cell_mesh() -> list[str]:
    """Section, layers and lines."""
    meshes = {
        5: ((1, 1), (1, 2), (1, 4), (1, 8), (2, 2), (2, 4), (2, 6), (3, 4), (3, 6), (4, 4)),
        LINES: (
            *((1, 1), (1, 2), (1, 4), (1, 8), (2, 2), (2, 4), (2, 6), (2, 8), (2, 12)),
            *((2, 16), (3, 8), (3, 12)),
        ),
    }
    results = {
        (lines, n, layers): _cell(n, layers, lines=lines)
        for lines, group in meshes.items()
        for n, layers in group
    }
    limit = pressures(results[LINES, 3, 12])
    rows = []
    for (lines, n, layers), result in results.items():
        found = pressures(result)
        size = result.run["elements"]
        off = percent(found, limit)
        rows.append([lines, n, layers, size, *cost(result), *fixed(found), off[0], off[-1]])
    independent = ["independent cell", "", "", "40–120", "", "", "", *map(str, CELL)]
    return [
        "## Cell: section, layers, and lines of the ribbon",
        "",
        "Half a pitch of 3 mm in layers of elements; the ribbon, 0.38 mm wide, as 5 or 9 lines. "
        "The last columns are differences from the finest mesh at 90 and 360°. Layers matter most, "
        "and the more the actuator bends: at 360° the crown is stretched by half, and the rubber "
        "that bulges between the turns asks for four layers and more a half pitch. With fewer, as "
        "in the independent cell, P is 1 to 2 % too high there. With nine lines all meshes of six "
        "layers and more are within 0.1 % of the finest at every angle.",
        "",
        *table(
            ["lines", "n", "layers", "hexahedra", *COST, *DEGREES, "at 90°", "at 360°"],
            [*rows, [*independent, *percent(CELL, limit)[::3]]],
        ),
    ]


def ribbon() -> list[str]:
    """Number of lines, and width zero."""
    rows = []
    for lines in (1, 3, 5, 9, 15, 25):
        result = _cell(1, 8, lines=lines)
        rows.append([lines, *cost(result), *fixed(pressures(result))])
    drift = []
    for layers in (2, 4, 8, 12):
        line, wide = (pressures(_cell(2, layers, width=w)) for w in ("0 mm", "0.38 mm"))
        drift.append([layers, *fixed([line[0], line[-1], wide[0], wide[-1]])])
    return [
        "## Cell: the ribbon",
        "",
        "Lines across a ribbon 0.38 mm wide, n = 1, eight layers. A single line in its middle has "
        "no limit; nine lines are as good as many.",
        "",
        *table(["lines", *COST, *DEGREES], rows),
        "Width zero against the ribbon of five lines, n = 2: under a line the displacement is "
        "log-singular, and what it gives wanders with the mesh instead of settling.",
        "",
        *table(
            ["layers", "line: 90°", "line: 360°", "ribbon: 90°", "ribbon: 360°"],
            drift,
        ),
    ]


def pitches() -> list[str]:
    """Cell against the section of the same pitch."""
    rows = []
    for pitch in (3.0, 1.5, 0.75):
        text = f"{pitch:g} mm"
        flat = solve("section", {"section": 2}, pitch=text, **SMEARED)
        smeared = _cell(2, 1, pitch, **SMEARED)
        off = worst(pressures(smeared), pressures(flat))
        rows.append([text, "section", *fixed(pressures(flat)), "", "", "", ""])
        rows.append([text, "cell, smeared", *fixed(pressures(smeared)), f"{off:.0e} %", "", "", ""])
        for n, layers in ((1, 8), (2, 8)):
            coarse = solve("section", {"section": n}, pitch=text, **SMEARED)
            found = pressures(_cell(n, layers, pitch, lines=LINES))
            name = f"cell, n = {n}, {layers} layers, {LINES} lines"
            rows.append([text, name, *fixed(found), *percent(found, pressures(coarse))])
    return [
        "## Cell and section as the pitch goes to zero",
        "",
        "The section's winding has the same pitch: smeared, a closer winding is stiffer too. "
        "Smeared in the cell it gives the section's numbers; discrete it differs by the rubber "
        "that bulges between fibers (last columns, against the section of the same n).",
        "",
        *table(["pitch", "model", *DEGREES, *(f"off at {d}" for d in DEGREES)], rows),
    ]


def _beside(body: RunResult, model: str, mesh: dict[str, Any], **how: Any) -> list[list[str]]:
    """A body's stops and another model at the angle that the body's middle has there."""
    rows = rows_at(body, [a for a in ANGLES if a <= body.rows[-1]["angle_deg"] + 1e-6])
    middle = [float(row["uniform_angle_deg"]) for row in rows]
    mine = [float(row["pressure_kPa"]) for row in rows]
    other = pressures(solve(model, mesh, middle, **how), middle)
    return [fixed(middle), fixed(mine), fixed(other), percent(mine, other)]


def bodies() -> list[str]:
    """Section and cell against the middle of the body."""
    cases: list[tuple[str, dict[str, str] | None, int]] = [
        ("baseline", None, 1),
        ("baseline", None, 2),
        ("radius 6", {"radius": "6 mm"}, 1),
        ("radius 10", {"radius": "10 mm"}, 1),
        ("wall 3", {"wall": "3 mm"}, 1),
    ]
    names = ("angle of the middle, °", "body, kPa", "section, kPa", "body off by")
    rows = []
    for name, actuator, n in cases:
        mesh = {"axial": "4 mm", "section": n}
        body = solve("body", mesh, actuator=actuator, **SMEARED)
        found = _beside(body, "section", {"section": n}, actuator=actuator, **SMEARED)
        for what, values in zip(names, found, strict=True):
            rows.append([f"{name}, n = {n}", body.run["unknowns"], what, *values])
    mesh = {"axial": "1.5 mm", "section": 1}
    body = solve("body", mesh, **DISCRETE)
    discrete = [
        ["baseline, n = 1, 1.5 mm", body.run["unknowns"], what.replace("section", "cell"), *values]
        for what, values in zip(names, _beside(body, "cell", mesh, **DISCRETE), strict=True)
    ]
    head = ["case", "unknowns", "", *(f"body at {d}" for d in DEGREES)]
    return [
        "## Section and cell against the body",
        "",
        "Near the caps the sections warp, and the whole body bends 0.6 to 1.4 % further than its "
        "middle half, on which the comparison is: the body's own states at four angles, and the "
        "pressure of section or cell at the angle that L times the curvature of the body's middle "
        "half makes. All with the same section mesh n; smeared bodies have elements 4 mm long.",
        "",
        *table(head, rows),
        "Discrete winding: body and cell with elements 1.5 mm long and ribbons of five lines. 107 "
        "elements fill the body's 160 mm, so that its layers meet the turns a little differently "
        "from turn to turn, while those of the cell begin and end where the fibers cross: meshes "
        "this coarse feel that.",
        "",
        *table(head, discrete),
    ]


PARTS = {
    "section": section_mesh,
    "shapes": section_shapes,
    "cell": cell_mesh,
    "ribbon": ribbon,
    "pitches": pitches,
    "bodies": bodies,
}


def _renew(page: str, part: str) -> str:
    """A page with one of its parts, which begins with its heading, put in place or appended."""
    title = part.split("\n", 1)[0]
    parts = re.split(r"(?m)^(?=## )", page)
    found = [i for i, old in enumerate(parts) if old.startswith(title + "\n")]
    if found:
        parts[found[0]] = part
    else:
        parts.append(part)
    return "".join(parts)


def main() -> None:
    """Write the parts named on the command line, or all."""
    wanted = sys.argv[1:] or list(PARTS)
    for name in wanted:
        part = "\n".join(PARTS[name]()) + "\n"
        if launch.rank() == 0:
            page = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
            rest = page.split("\n## ", 1)
            old = "## " + rest[1] if len(rest) == 2 else ""
            PAGE.write_text(HEAD + "\n" + _renew(old, part), encoding="utf-8")


if __name__ == "__main__":
    main()
