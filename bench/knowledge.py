"""What is known of errors: ladders of section, cell and body meshes of many actuators.

Writes fiberbend/accuracy/knowledge.json, from which `accuracy: 1 %` in a case chooses model and
mesh. Every solution is kept in build/knowledge, so that a run that was stopped goes on;
`python bench/knowledge.py`, or `make knowledge`; an hour on two cores that are otherwise idle.
"""

from __future__ import annotations

import contextlib
import copy
import hashlib
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bench.tables import WINDING
from fiberbend import run
from fiberbend.accuracy.numbers import numbers
from fiberbend.accuracy.table import FILE
from fiberbend.reader.reader import parse_case
from machine import origin

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "build" / "knowledge"
ANGLES = (10.0, 45.0, 90.0, 180.0, 270.0, 360.0, 480.0)
"""Degrees of an actuator twenty radii long."""
BODY_ANGLES = (45.0, 90.0, 180.0, 270.0, 360.0)
LINES = 9
"""Across a ribbon where it is to be resolved."""
SECTIONS = (1, 2, 3, 4)
FINE_SECTION = 6
CELLS = ((1, 1), (1, 2), (1, 4), (1, 8), (2, 4))
"""Refinement of the section, and layers a half pitch."""
FINE_CELL = (2, 8)
SPREAD: dict[str, Any] = {"as": "smeared"}
TURNS: dict[str, Any] = {"as": "discrete"}
LONG = (1.0, 0.5)
"""Length of the elements of a body over the radius, winding spread."""
IN_TURNS = (1, 2)
"""Layers a half pitch of a body in turns."""

HALF: dict[str, Any] = {"radius": 8.0, "wall": 2.0, "floor": 2.0, "sheath": 1.0}
BOX: dict[str, Any] = {"section": "rectangle", "width": 16.0, "height": 8.0, "wall": 2.0}
ROUND: dict[str, Any] = {"section": "circle", "radius": 8.0, "wall": 2.0, "sheath": 1.0}
BOX |= {"floor": 2.0, "sheath": 1.0}
GEOMETRIES: dict[str, tuple[dict[str, Any], float, dict[str, str]]] = {
    "baseline": (HALF, 3.0, {}),
    "radius 6": (HALF | {"radius": 6.0}, 3.0, {}),
    "radius 12": (HALF | {"radius": 12.0}, 3.0, {}),
    "pitch 1.5": (HALF, 1.5, {}),
    "pitch 6": (HALF, 6.0, {}),
    "wall 1": (HALF | {"wall": 1.0}, 3.0, {}),
    "wall 3": (HALF | {"wall": 3.0}, 3.0, {}),
    "floor 1": (HALF | {"floor": 1.0}, 3.0, {}),
    "floor 4": (HALF | {"floor": 4.0}, 3.0, {}),
    "no sheath": ({k: v for k, v in HALF.items() if k != "sheath"}, 3.0, {}),
    "soft floor": (HALF, 3.0, {"floor": "elastosil-m4601", "wall": "ecoflex-0030"}),
    "rectangle": (BOX, 3.0, {}),
    "rectangle, wide": (BOX | {"height": 5.0}, 3.0, {}),
    "rectangle, square, pitch 6": (BOX | {"height": 16.0}, 6.0, {}),
    "rectangle, wall 3": (BOX | {"wall": 3.0}, 1.5, {}),
    "circle": (ROUND | {"floor": 1.0}, 3.0, {}),
    "circle, wall 3, pitch 6": (ROUND | {"wall": 3.0, "floor": 1.5}, 6.0, {}),
    "circle, wall 1, pitch 1.5": (ROUND | {"wall": 1.0, "floor": 0.5}, 1.5, {}),
}
"""Dimensions in mm, pitch in mm, materials other than the baseline's."""
CELLED = (
    "baseline", "pitch 6", "rectangle", "circle", "radius 6", "radius 12", "pitch 1.5",
    "wall 1", "wall 3", "circle, wall 3, pitch 6",
)  # fmt: skip
"""Those whose cells are solved too. The square box has none: its fine cells squeeze the wall out of
the corners, where the ribbon turns, at 30° with a pitch of 6 mm and at 63° with 4.5 mm."""
UP_TO = {"pitch 6": 360.0, "circle, wall 3, pitch 6": 270.0}
"""Degrees up to which one is solved: at 468° and 313° cells squeeze the wall beside a turn out."""
SLACK = ("floor 1",)
"""Those whose thread goes slack: where it carries compression, it wrinkles a floor as thin in its
plane at 27°, as soon as the mesh has four elements through it (with three it cannot, and six step
over it)."""
BODIED = ("baseline", "radius 6", "wall 1", "wall 3", "rectangle", "circle", "radius 12")
"""Those whose bodies are solved too, for the ends."""


def case_of(
    name: str,
    model: str,
    mesh: dict[str, Any],
    radii: int = 20,
    winding: dict[str, Any] | None = None,
) -> dict[str, Any]:
    """The case of an actuator so many radii long; its cap is 15 mm long."""
    sizes, pitch, materials = GEOMETRIES[name]
    given = {k: v if isinstance(v, str) else f"{v} mm" for k, v in sizes.items()}
    base = {"wall": "elastosil-m4601", "floor": "combined-base", "sheath": "ecoflex-0030"}
    base |= materials
    used = {part: stuff for part, stuff in base.items() if part == "wall" or part in sizes}
    known = BODY_ANGLES if model == "body" else ANGLES
    angles = [radii / 20 * angle for angle in known if angle <= UP_TO.get(name, np.inf)]
    wound = WINDING | {"pitch": f"{pitch} mm"} | (winding or {})
    if name in SLACK:
        wound |= {"tension_only": True}
    return {
        "actuator": given | {"length": f"{radii * _radius(name)} mm"},
        "materials": used,
        "model": model,
        "mesh": mesh,
        "effects": [
            {"pressure": {"angle": f"{angles[-1]} deg"}},
            {"winding": wound},
        ],
        "output": {"at_angles": [f"{angle} deg" for angle in angles]},
    }


_only = {"kept": False}
_missing: dict[str, str] = {}


class UnsolvedError(LookupError):
    """A case whose solution is not kept, or was not reached: none of its numbers is used."""


def only_kept(wish: bool | None = None) -> bool:
    """Whether solutions that are not kept are missing instead of being solved.

    Args:
        wish: from now on.
    """
    if wish is not None:
        _only["kept"] = wish
    return _only["kept"]


@contextlib.contextmanager
def _unless_missing(what: str) -> Iterator[None]:
    """A part of the table that is left out, and named with the reason, where one is unsolved."""
    try:
        yield
    except UnsolvedError as reason:
        _missing[what] = str(reason)


def solved(case: dict[str, Any]) -> list[dict[str, float]]:
    """Rows at all the stops of a case; kept from an earlier run where there is one.

    A run that ends early is kept with its reason and gives no row, not even where it has been:
    take its file away to try it again.

    Raises:
        UnsolvedError: it has not reached all its stops, or it is not kept and must be.
    """
    text = json.dumps(case, sort_keys=True)
    path = KEPT / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.json"
    if not path.exists():
        if only_kept():
            raise UnsolvedError("not solved yet")
        _solve(case, path)
    kept = json.loads(path.read_text(encoding="utf-8"))
    rows: list[dict[str, float]] = kept["rows"]
    asked = len(case["output"]["at_angles"])
    if kept.get("status", "converged") != "converged" or len(rows) < asked:
        raise UnsolvedError(f"{case['model']} {case['mesh']}: {kept.get('reason', 'ended early')}")
    return rows


def _solve(case: dict[str, Any], path: Path) -> None:
    """Solve a case and keep it."""
    result = run(copy.deepcopy(case))
    angles = [float(text.split()[0]) for text in case["output"]["at_angles"]]
    keys = ("angle_deg", "pressure_kPa", "uniform_angle_deg")
    rows = []
    for angle in angles:
        row = min(result.rows, key=lambda row: abs(row["angle_deg"] - angle))
        if abs(row["angle_deg"] - angle) < 1e-3:
            rows.append({key: float(row[key]) for key in keys if row.get(key) is not None})
    seconds = result.run["wall_s"]["solve"]
    print(case["model"], case["mesh"], case["actuator"], result.status, seconds, flush=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    kept = {"case": case, "status": result.status, "reason": result.run["reason"], "rows": rows}
    kept |= {"unknowns": result.run["unknowns"], "solve_s": seconds}
    path.write_text(json.dumps(kept), encoding="utf-8")


def pressures(case: dict[str, Any]) -> np.ndarray:
    """P at the stops, kPa."""
    return np.array([row["pressure_kPa"] for row in solved(case)])


def percent(found: np.ndarray, true: np.ndarray) -> list[float]:
    """Signed differences in percent."""
    return [round(float(v), 4) for v in 100 * (found / true - 1)]


def section(name: str, n: int) -> np.ndarray:
    """P of a section, winding spread."""
    return pressures(case_of(name, "section", {"section": n}, winding=SPREAD))


def cell(name: str, n: int, layers: int, **more: Any) -> np.ndarray:
    """P of a cell with every turn."""
    axial = f"{GEOMETRIES[name][1] / 2 / layers} mm"
    mesh = {"section": n, "axial": axial}
    return pressures(case_of(name, "cell", mesh, winding=TURNS | more))


def fine_section(name: str) -> np.ndarray:
    """Richardson's value of the two finest, order two."""
    coarse, fine = section(name, SECTIONS[-1]), section(name, FINE_SECTION)
    return fine + (fine - coarse) / ((FINE_SECTION / SECTIONS[-1]) ** 2 - 1)


def body(
    name: str, n: int, axial: float, winding: dict[str, Any], radii: int = 20
) -> dict[str, Any]:
    """The case of a body with elements so many mm long."""
    return case_of(name, "body", {"section": n, "axial": f"{axial} mm"}, radii, winding)


def ends(case: dict[str, Any], radii: int = 20) -> dict[str, list[float]]:
    """How much longer than it is a body seems that bends like its middle, over the radius.

    (θ − θ_middle) / θ_middle · L / r at the curvature r κ of the middle.
    """
    rows = solved(case)
    whole = np.array([row["angle_deg"] for row in rows])
    middle = np.array([row["uniform_angle_deg"] for row in rows])
    return {
        "curvature": [round(float(v), 4) for v in np.radians(middle) / radii],
        "longer": [round(float(v), 4) for v in (whole - middle) / middle * radii],
    }


def long_elements() -> dict[str, list[float]]:
    """Percent of P that long elements cost a body, by their length over the radius.

    Against elements a quarter of the radius long, winding spread; at the curvatures of
    `BODY_ANGLES`.
    """
    fine = pressures(body("baseline", 1, 2.0, winding=SPREAD))
    found = {}
    for part in LONG:
        coarse = pressures(body("baseline", 1, 8.0 * part, winding=SPREAD))
        found[f"{part}"] = percent(coarse, fine)
    return found


def bodies_in_turns() -> tuple[dict[str, float], float]:
    """Percent of P by which turns in a body differ from those in a cell, by layers a half turn.

    And by how many radii more it seems longer than a body whose winding is spread. On a baseline
    ten radii long, whose layers begin and end elsewhere between the turns than a cell's: the
    pressure of the body beside that of the cell at the angle of the body's middle.
    """
    apart, more, radii = {}, [], 10
    spread = ends(body("baseline", 1, 4.0, radii=radii, winding=SPREAD), radii)
    for layers in IN_TURNS:
        case = body("baseline", 1, 1.5 / layers, radii=radii, winding=TURNS)
        rows = solved(case)
        middle = [row["uniform_angle_deg"] for row in rows]
        beside = copy.deepcopy(case)
        beside["model"] = "cell"
        beside["effects"][0] = {"pressure": {"angle": f"{middle[-1]!r} deg"}}
        beside["output"] = {"at_angles": [f"{angle!r} deg" for angle in middle]}
        found = np.array([row["pressure_kPa"] for row in rows])
        off = float(np.max(np.abs(100 * (found / pressures(beside) - 1))))
        apart[f"{layers}"] = round(off, 3)
        longer = np.array(ends(case, radii)["longer"]) - np.array(spread["longer"])
        more.append(float(np.max(np.abs(longer))))
    # and as much as the long elements hide with which the ends of all actuators are measured
    long, short = (ends(body("baseline", 1, axial, SPREAD))["longer"] for axial in (8.0, 4.0))
    hidden = float(np.max(np.abs(np.array(long) - np.array(short))))
    return apart, round(max(more) + hidden, 4)


def short_ends() -> float:
    """By how many radii more a body of ten radii seems longer than one of twenty, of long elements.

    The baseline at the same curvatures of its tip; that of thirty radii is 0.003 off at most.
    """
    short, usual = (ends(body("baseline", 1, 8.0, SPREAD, n), n)["longer"] for n in (10, 20))
    return round(float(np.max(np.array(short) - np.array(usual))), 4)


def _radius(name: str) -> float:
    sizes = GEOMETRIES[name][0]
    return float(sizes.get("width", 2 * sizes.get("radius", 0.0)) / 2)


def entry(name: str) -> dict[str, Any]:
    """What is known of an actuator; without cells or bodies where these are not kept."""
    true = fine_section(name)
    made = parse_case(case_of(name, "section", {}, winding=SPREAD))
    known: dict[str, Any] = {
        "name": name,
        "section": made.actuator.section,
        "numbers": numbers(made),
        "spread": {str(n): percent(section(name, n), true) for n in SECTIONS},
    }
    if name in CELLED:
        with _unless_missing(f"{name}: cells"):
            fine = cell(name, *FINE_CELL, lines=LINES)
            turns = {f"{n} {k}": percent(cell(name, n, k), fine) for n, k in CELLS}
            known |= {"turns": turns, "winding": percent(true, fine)}
    if name in BODIED:
        with _unless_missing(f"{name}: ends"):
            known["ends"] = ends(body(name, 1, _radius(name), winding=SPREAD))
    return known


PARTS: dict[str, Callable[[], object]] = {
    "sections": lambda: [
        section(name, n) for name in GEOMETRIES for n in (*SECTIONS, FINE_SECTION)
    ],
    "cells": lambda: [entry(name) for name in CELLED],
    "ends": lambda: [ends(body(name, 1, _radius(name), winding=SPREAD)) for name in BODIED],
    "bodies": lambda: (long_elements(), bodies_in_turns(), short_ends()),
}


def main() -> None:
    """Write the table, or solve what is named on the command line: sections, cells, ends, bodies.

    `kept` writes it from what is kept, and names what it lacks.
    """
    wanted = sys.argv[1:]
    if wanted and wanted != ["kept"]:
        for part in wanted:
            PARTS[part]()
        return
    only_kept(bool(wanted))
    entries = []
    for name in GEOMETRIES:
        with _unless_missing(name):
            entries.append(entry(name))
    apart, more = bodies_in_turns()
    content = {
        "origin": {
            "command": "python bench/knowledge.py",
            "missing": _missing,
            "commit": origin.commit(ROOT),
            "machine": origin.machine(),
        },
        "curvatures": [round(float(np.radians(angle) / 20), 6) for angle in ANGLES],
        "body curvatures": [round(float(np.radians(angle) / 20), 6) for angle in BODY_ANGLES],
        "spread body": long_elements(),
        "turns body": apart,
        "ends of turns": more,
        "ends of short": short_ends(),
        "actuators": entries,
    }
    FILE.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
