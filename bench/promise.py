"""Whether `accuracy: 1 %` keeps its word on actuators that its table was not made from.

Writes docs/evidence/promise.md; fine cells are kept in build/knowledge. `python bench/promise.py`
solves what takes less than `MOST_S` by its own plan; `python bench/promise.py bodies` all, and
`python bench/promise.py kept` only that whose fine cell is kept.
"""

from __future__ import annotations

import copy
import hashlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bench.knowledge import KEPT, LINES, UnsolvedError, only_kept, solved
from bench.tables import WINDING, table
from fiberbend import run
from fiberbend.accuracy.budget import estimate
from fiberbend.accuracy.words import way_named
from fiberbend.models.choice import meshed
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import parse_case

PAGE = Path(__file__).resolve().parent.parent / "docs" / "evidence" / "promise.md"
ASKED = 1.0
ANGLES = (45.0, 90.0, 180.0, 270.0)
FINE = (2, 8)
"""Refinement of the section and layers a half pitch of the cell that counts as true."""
MOST_S = 25.0
"""Seconds of a run, by its plan, above which it is planned only."""
HALF = {"radius": "8 mm", "wall": "2 mm", "floor": "2 mm", "sheath": "1 mm", "length": "160 mm"}
BASE = {"wall": "elastosil-m4601", "floor": "combined-base", "sheath": "ecoflex-0030"}
BOX = {"section": "rectangle", "width": "20 mm", "height": "10 mm", "wall": "2.5 mm"}
BOX |= {"floor": "2.5 mm", "sheath": "1 mm", "length": "160 mm"}
TUBE = {"section": "circle", "radius": "7 mm", "wall": "2.5 mm", "floor": "1.25 mm"}
TUBE |= {"sheath": "1 mm", "length": "160 mm"}
Actuator = tuple[dict[str, str], str, dict[str, str]]
"""Dimensions, pitch, and materials other than the baseline's."""
NEW: dict[str, Actuator] = {
    "radius 9, pitch 2.5": (HALF | {"radius": "9 mm"}, "2.5 mm", {}),
    "radius 7, wall 1.5, pitch 2": (HALF | {"radius": "7 mm", "wall": "1.5 mm"}, "2 mm", {}),
    "wall 2.5, pitch 4": (HALF | {"wall": "2.5 mm"}, "4 mm", {}),
    "wall 1.5, length 100": (HALF | {"wall": "1.5 mm", "length": "100 mm"}, "3 mm", {}),
    "wall 2.5, floor 3, length 250": (
        HALF | {"wall": "2.5 mm", "floor": "3 mm", "length": "250 mm"}, "3 mm", {},
    ),
    "Dragon Skin 30, radius 10": (HALF | {"radius": "10 mm"}, "3 mm", {"wall": "dragon-skin-30"}),
    "rectangle 20 × 12, pitch 3": (BOX | {"height": "12 mm"}, "3 mm", {}),
    "circle, radius 9, wall 2, pitch 3": (
        TUBE | {"radius": "9 mm", "wall": "2 mm", "floor": "1 mm"}, "3 mm", {},
    ),
}  # fmt: skip
"""Of these nothing was known when the margins were set."""
OLD: dict[str, Actuator] = {
    "radius 7, pitch 2": (HALF | {"radius": "7 mm"}, "2 mm", {}),
    "radius 10, pitch 4": (HALF | {"radius": "10 mm"}, "4 mm", {}),
    "pitch 5": (HALF, "5 mm", {}),
    "Dragon Skin 30": (HALF, "3 mm", {"wall": "dragon-skin-30"}),
    "rectangle 20 × 10, pitch 4": (BOX, "4 mm", {}),
    "circle, radius 7, wall 2.5, pitch 2": (TUBE, "2 mm", {}),
}
"""By these the margins were set."""
ACTUATORS = NEW | OLD
RESOLVED = ("radius 9, pitch 2.5",)
"""Those whose chosen body is put beside one with every turn."""
LAYERS = 4
"""Of that one, a half pitch: with one and two it is too stiff (docs/evidence/calibration.md)."""
MODELS = ("section", "cell", "auto")
HEAD = """# Does an accuracy keep its word?

`accuracy: 1 %` on fourteen actuators that its table ([Ask for an
accuracy](../models.md#ask-for-an-accuracy)) was not made from, at 45, 90, 180 and 270°, with
the model given or left open. "Found" is the greatest difference of the pressure from a cell of
{layers} layers a half pitch, {section} elements through each thickness and {lines} lines a
ribbon; of a body it is taken at the angle that L times the curvature of its middle half makes.
So it holds mesh and winding, and is to be compared with the estimate of these two. The ends,
which no cell has, are estimated beside. A run that its plan gives more than {seconds:g} s is
planned only. `python bench/promise.py` makes the page.
"""
TITLES = {
    "Eight of which nothing was known when the margins were set": NEW,
    "Six by which the margins were set": OLD,
}
WHOLE = """
## The chosen body beside one with every turn

The body that `accuracy: 1 %` chooses, beside a body with every turn and {layers} layers a half
pitch (`as: discrete`, `mesh.section: 1`): both have their ends, so that the pressures are compared
at the same angles of the tip. The last column is the difference of a cell of the resolved mesh from
the fine cell, to be added as far as the body shares it.

"""


def case_of(name: str, model: str) -> dict[str, Any]:
    """The case of an actuator that asks for an accuracy."""
    actuator, pitch, materials = ACTUATORS[name]
    return {
        "actuator": actuator,
        "materials": BASE | materials,
        "model": model,
        "accuracy": f"{ASKED} %",
        "effects": [
            {"pressure": {"angle": f"{ANGLES[-1]} deg"}},
            {"winding": WINDING | {"pitch": pitch}},
        ],
        "output": {"at_angles": [f"{angle} deg" for angle in ANGLES]},
    }


def true(case: dict[str, Any], angles: list[float]) -> list[float]:
    """P in kPa of the fine cell at angles in degrees."""
    fine = copy.deepcopy(case)
    del fine["accuracy"]
    pitch = float(ACTUATORS[_name(case)][1].split()[0])
    section, layers = FINE
    fine["model"] = "cell"
    fine["mesh"] = {"section": section, "axial": f"{pitch / 2 / layers} mm"}
    fine["effects"][0] = {"pressure": {"angle": f"{max(angles)!r} deg"}}
    fine["effects"][1]["winding"] |= {"as": "discrete", "lines": LINES}
    fine["output"] = {"at_angles": [f"{angle!r} deg" for angle in angles]}
    return [row["pressure_kPa"] for row in solved(fine)]


def _name(case: dict[str, Any]) -> str:
    return next(
        name
        for name, (actuator, pitch, materials) in ACTUATORS.items()
        if actuator == case["actuator"]
        and pitch == case["effects"][1]["winding"]["pitch"]
        and BASE | materials == case["materials"]
    )


def _kept(case: dict[str, Any]) -> bool:
    """Whether the fine cell at the asked angles is kept."""
    try:
        true(case, list(ANGLES))
    except UnsolvedError:
        return False
    return True


def rows(name: str, bodies: bool) -> Iterator[list[str]]:
    """A line for each model."""
    for model in MODELS:
        case = case_of(name, model)
        made = parse_case(case)
        way, plan = way_named(made), make_plan(made)
        dear = plan.seconds is None or plan.seconds > MOST_S
        if dear and not bodies:
            first = dict(plan.rows)["accuracy"][0]
            yield [name, model, way, first.split(" asked, ")[1], "", "planned only"]
            continue
        # of a body it is another one: it stops where the middle is, and is looked for after the run
        if only_kept() and not (meshed(made).ends or _kept(case)):
            first = dict(plan.rows)["accuracy"][0]
            yield [name, model, way, first.split(" asked, ")[1], "", "fine cell not solved yet"]
            continue
        kept = _row(case, dict(plan.rows)["accuracy"])
        if kept.exists():
            yield json.loads(kept.read_text(encoding="utf-8"))
            continue
        result = run(copy.deepcopy(case))
        block = result.run["accuracy"]
        parts = block["parts"]
        stops = [min(result.rows, key=lambda r: abs(r["angle_deg"] - a)) for a in ANGLES]
        middles = [row.get("uniform_angle_deg") for row in stops]
        angles = [m if m is not None else a for m, a in zip(middles, ANGLES, strict=True)]
        try:
            pressures = true(case, angles)
        except UnsolvedError:
            yield [name, model, way, "", "", "fine cell not solved yet"]
            continue
        found = max(
            abs(100 * (row["pressure_kPa"] / p - 1))
            for row, p in zip(stops, pressures, strict=True)
        )
        both = parts["mesh"] + parts["winding"]
        estimated = f"{both:.2f} (mesh {parts['mesh']:.2f}, winding {parts['winding']:.2f})"
        estimated += f", ends {parts['ends']:.2f}"
        word = "promised" if block["promised"] else "cannot promise"
        bound = "kept" if found <= both else f"EXCEEDED by {found - both:.2f}"
        if block["promised"] and found > ASKED:
            bound = "BROKEN"
        print(name, model, way, estimated, word, f"{found:.2f}", bound, flush=True)
        line = [name, model, way, f"{estimated}: {word}", f"{found:.2f}", bound]
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(line), encoding="utf-8")
        yield line


def _row(case: dict[str, Any], expected: object) -> Path:
    """Where the line of a run is kept, as long as the same is expected of its error."""
    text = json.dumps([case, expected], sort_keys=True)
    return KEPT / "promise" / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.json"


def whole(name: str) -> list[str]:
    """A line of the chosen body beside one with every turn."""
    case = case_of(name, "auto")
    made = parse_case(case)
    assert made.turns is not None
    way = "discrete" if made.turns.discrete else "calibrated" if made.turns.bulges else "smeared"
    spelled = _spelled(case, made.mesh.section, made.mesh.axial, way)
    half_pitch = float(ACTUATORS[name][1].split()[0]) / 2
    resolved = _spelled(case, 1, half_pitch / LAYERS, "discrete")
    try:
        pairs = list(zip(solved(spelled), solved(resolved), strict=True))
    except UnsolvedError as reason:
        return [name, way_named(made), "", str(reason), ""]
    off = [100 * (one["pressure_kPa"] / two["pressure_kPa"] - 1) for one, two in pairs]
    found = estimate(made, meshed(made))
    cells = zip(solved(resolved | {"model": "cell"}), true(case, list(ANGLES)), strict=True)
    rest = ", ".join(f"{100 * (one['pressure_kPa'] / p - 1):+.2f}" for one, p in cells)
    word = "promised" if found.meets(ASKED) else "cannot promise"
    print(name, way_named(made), off, found.short(), rest, flush=True)
    differences = ", ".join(f"{value:+.2f}" for value in off)
    estimated = f"{found.total:.2f}: {word}"
    return [name, way_named(made), estimated, differences, rest]


def _spelled(case: dict[str, Any], section: int, axial: float, way: str) -> dict[str, Any]:
    """The case as a body with a mesh and a winding instead of an accuracy."""
    body = copy.deepcopy(case)
    del body["accuracy"]
    body |= {"model": "body", "mesh": {"section": section, "axial": f"{axial!r} mm"}}
    body["effects"][1]["winding"] |= {"as": way}
    return body


def main() -> None:
    """Write the page; names of actuators on the command line are tried, and nothing is written."""
    bodies = "bodies" in sys.argv[1:]
    only_kept("kept" in sys.argv[1:])
    names = [name for name in sys.argv[1:] if name in ACTUATORS]
    for name in names:
        list(rows(name, bodies))
    if names:
        return
    head = ["actuator", "model", "chosen", "estimated, %", "found, %", "bound"]
    numbers = {"section": FINE[0], "layers": FINE[1], "lines": LINES, "seconds": MOST_S}
    text = HEAD.format(**numbers)
    for title, group in TITLES.items():
        found = [row for name in group for row in rows(name, bodies)]
        text += f"\n## {title}\n\n" + "\n".join(table(head, found)) + "\n"
    head = [
        "actuator",
        "chosen",
        "estimated, %",
        "off at 45, 90, 180, 270°, %",
        "its mesh in a cell, %",
    ]
    text += WHOLE.format(layers=LAYERS) + "\n".join(table(head, [whole(name) for name in RESOLVED]))
    PAGE.write_text(text.rstrip("\n") + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
