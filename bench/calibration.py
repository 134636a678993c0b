"""Tables of calibrated windings: section beside a fine cell, coarse body beside a resolved one.

Writes docs/evidence/calibration.md, row by row. Names on the command line, of parts (bent,
straight, bodies, meshes, phases) and of geometries, renew only these rows, as in
`bodies "radius 6 mm"`.
Minutes for sections and cells, an hour for the bodies; every number in the tables comes from here.
Times are those of whole processes: the machine should be idle.
"""

from __future__ import annotations

import dataclasses
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from fiberbend.calibration.store import Store
from fiberbend.schema.units import parse, show

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "evidence" / "calibration.md"
ANGLES = (90.0, 180.0, 270.0, 360.0)
PRESSURES = (25.0, 50.0, 75.0, 100.0)
FINE = {"mesh.section": "2", "solver.max_turn": "90 deg"}
LAYERS = 12
"""Of the fine cell along half a pitch."""
WINDING = "effects.1.winding"
GEOMETRIES: dict[str, dict[str, str]] = {
    "baseline": {},
    "radius 6 mm": {"actuator.radius": "6 mm"},
    "radius 12 mm": {"actuator.radius": "12 mm"},
    "wall 1 mm": {"actuator.wall": "1 mm"},
    "wall 3 mm": {"actuator.wall": "3 mm"},
    "pitch 1.5 mm": {f"{WINDING}.pitch": "1.5 mm"},
    "pitch 4.5 mm": {f"{WINDING}.pitch": "4.5 mm"},
    "pitch 6 mm": {f"{WINDING}.pitch": "6 mm"},
    "radius 9, pitch 2.5 mm": {"actuator.radius": "9 mm", f"{WINDING}.pitch": "2.5 mm"},
}
"""Radius 8, wall 2, pitch 3 mm but for what is named."""
SECTIONS = tuple(GEOMETRIES)[:8]
"""Those whose sections are put beside fine cells."""
BLOCKED = ("baseline", "radius 6 mm", "pitch 4.5 mm")
"""Those whose tips are blocked too."""
COARSE = "8 mm"
LENGTH = 160.0
"""Of the bodies, mm."""
RESOLVED = 4
"""Layers along half a pitch of the body in turns: one is too stiff, see `meshes`."""
PHASES = ("48 mm", "49.5 mm")
"""Lengths of short bodies, half a pitch apart."""
HEAD = """# A calibrated winding beside every turn by itself

P in kPa of the baseline of Polygerinos et al. 2015 (radius 8, length 160, wall 2, floor 2, sheath
1 mm; double helix of pitch 3 mm) and of seven other geometries, for bodies of an eighth too, each
calibrated by its own cell (one element through each thickness, eight along half a pitch;
`fiberbend/calibration/`). The fine cell has two elements through each thickness and twelve along
half a pitch. `python bench/calibration.py` makes the tables, in the order bent, straight, bodies,
meshes, phases; `make calibration` does too. Rows are renewed by name: `python bench/calibration.py
bodies "wall 1 mm"`. s are seconds of whole processes as they came, CPU in brackets; a row without
them was filled while the machine had other work.
"""


class Run:
    """A case run in a process of its own.

    Args:
        case: file in cases/.
        settings: changes to it.

    Attributes:
        wall: seconds of the process.
        cpu: seconds of a core.
        run: content of run.json.
    """

    def __init__(self, case: str, settings: dict[str, str]) -> None:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "run"
            quiet = {f"output.{key}": "false" for key in ("pictures", "fields", "report")}
            pairs = [f"{key}={value}" for key, value in (settings | quiet).items()]
            arguments = [word for pair in pairs for word in ("--set", pair)]
            command = [sys.executable, "-m", "fiberbend", "run", str(ROOT / "cases" / case)]
            begin, used = time.perf_counter(), os.times()
            done = subprocess.run(
                [*command, "--out", str(out), *arguments], capture_output=True, text=True
            )
            now = os.times()
            self.wall = time.perf_counter() - begin
            self.cpu = now.children_user + now.children_system
            self.cpu -= used.children_user + used.children_system
            if done.returncode:
                print(done.stdout, done.stderr, file=sys.stderr, flush=True)
            self.run: dict[str, Any] = json.loads((out / "run.json").read_text())
            lines = (out / "history.csv").read_text().splitlines()
            names = lines[0].split(",")
            self.rows = [dict(zip(names, line.split(","), strict=True)) for line in lines[1:]]

    def at(self, key: str, goals: tuple[float, ...], value: str) -> list[float | None]:
        """A column where another one has given values; None where that is not reached."""
        found = {round(float(row[key]), 4): row.get(value) or None for row in self.rows}
        return [None if (v := found.get(round(g, 4))) is None else float(v) for g in goals]


def anew(case: str, settings: dict[str, str]) -> Run:
    """A run whose calibration is not kept from before; compiled kernels are."""
    mark = Run(case, settings).run["calibration"]["digest"]
    Store().forget(mark)
    return Run(case, settings)


def layered(name: str, layers: int) -> dict[str, str]:
    """Every turn by itself, with so many elements along half a pitch."""
    pitch = parse(GEOMETRIES[name].get(f"{WINDING}.pitch", "3 mm"), "length")
    return {f"{WINDING}.as": "discrete", "mesh.axial": show(pitch / 2 / layers, "length")}


def as_found(entry: dict[str, Any]) -> dict[str, str]:
    """Numbers of a calibration as settings of another case."""
    key = f"{WINDING}.bulging"
    return {
        f"{WINDING}.as": "calibrated",
        f"{key}.stiffness": f"{entry['stiffness_MPa_per_mm']} MPa/mm",
        f"{key}.linear": str(entry["linear"]),
        f"{key}.quadratic": str(entry["quadratic"]),
    }


def percent(values: list[float | None], reference: list[float | None]) -> str:
    """Differences from reference values, a column each."""
    pairs = zip(values, reference, strict=True)
    return " / ".join("–" if not a or not b else f"{100 * (a / b - 1):+.2f}" for a, b in pairs)


def shown(values: list[float | None]) -> str:
    """Values, a column each."""
    return " / ".join("–" if value is None else f"{value:.4g}" for value in values)


@dataclasses.dataclass(frozen=True)
class Part:
    """A table of the page.

    Attributes:
        title: above it.
        head: names of its columns, the first of them what is renewed by name.
        rows: of a geometry.
        names: geometries it has.
    """

    title: str
    head: str
    rows: Callable[[str], Iterator[str]]
    names: tuple[str, ...] = tuple(GEOMETRIES)


def bent(name: str) -> Iterator[str]:
    """Section, calibrated and smeared, beside a fine cell at the angles."""
    change, calibrated = GEOMETRIES[name], {f"{WINDING}.as": "calibrated"}
    own = anew("section.yaml", change | calibrated)
    again = Run("section.yaml", change | calibrated)
    plain = Run("section.yaml", change)
    cell = Run("cell.yaml", change | FINE | layered(name, LAYERS))
    p, q, reference = (r.at("angle_deg", ANGLES, "pressure_kPa") for r in (own, plain, cell))
    entry = own.run["calibration"]
    numbers = " | ".join(
        f"{entry[key]:.3g}" for key in ("stiffness_MPa_per_mm", "linear", "quadratic")
    )
    yield (
        f"| {name} | {numbers} | {entry['bent_percent']:.2f} | {shown(reference)} | "
        f"{percent(p, reference)} | {percent(q, reference)} | {own.wall:.1f} ({own.cpu:.1f}) | "
        f"{again.wall:.1f} ({again.cpu:.1f}) |"
    )


def straight(name: str) -> Iterator[str]:
    """Moment of a section kept straight beside a fine cell, by numbers of either kind."""
    change, goals = GEOMETRIES[name], ("pressure_kPa", PRESSURES, "blocked_moment_Nmm")
    most = _up_to_pressures()
    free = Run("section.yaml", change | {f"{WINDING}.as": "calibrated"}).run["calibration"]
    section = change | most | {"model": "section"}
    own = Run("straight.yaml", section | {f"{WINDING}.as": "calibrated"})
    bending = Run("straight.yaml", section | as_found(free))
    plain = Run("straight.yaml", section | {f"{WINDING}.as": "smeared"})
    fine = change | most | {"model": "cell", "mesh.section": "2"} | layered(name, LAYERS)
    reference = Run("straight.yaml", fine).at(*goals)
    parts = (percent(r.at(*goals), reference) for r in (own, bending, plain))
    yield f"| {name} | {shown(reference)} | {' | '.join(parts)} |"


def _up_to_pressures() -> dict[str, str]:
    return {
        "effects.0.pressure.to": f"{PRESSURES[-1]} kPa",
        "output.at_pressures": f"[{', '.join(f'{p} kPa' for p in PRESSURES)}]",
    }


def _up_to_angles() -> dict[str, str]:
    return {
        "effects.0.pressure.to": "300 kPa",
        "output.at_angles": f"[{', '.join(f'{angle} deg' for angle in ANGLES)}]",
        "output.stop_at_angle": f"{ANGLES[-1]} deg",
    }


@dataclasses.dataclass(frozen=True)
class Kind:
    """What a body is asked for.

    Attributes:
        case: file in cases/.
        label: in words.
        change: to that file.
        goals: column, its values, and the column read there.
    """

    case: str
    label: str
    change: dict[str, str]
    goals: tuple[str, tuple[float, ...], str]


FREE = Kind(
    "free_bending.yaml",
    "P at 90 / 180 / 270 / 360°",
    _up_to_angles(),
    ("angle_deg", ANGLES, "pressure_kPa"),
)
TIP = Kind(
    "blocked_tip.yaml",
    "F at 25 / 50 / 75 / 100 kPa",
    _up_to_pressures(),
    ("pressure_kPa", PRESSURES, "tip_force_N"),
)


def bodies(name: str) -> Iterator[str]:
    """A coarse body, calibrated, beside a resolved one: bent, and its tip blocked."""
    for kind in (FREE, TIP) if name in BLOCKED else (FREE,):
        change = GEOMETRIES[name] | kind.change
        own = anew(kind.case, change | {"mesh.axial": COARSE, f"{WINDING}.as": "calibrated"})
        fine = Run(kind.case, change | layered(name, RESOLVED))
        values, reference = (run.at(*kind.goals) for run in (own, fine))
        yield (
            f"| {name} | {kind.label} | {shown(reference)} | {percent(values, reference)} | "
            f"{own.run['unknowns']} / {fine.run['unknowns']} | "
            f"{own.wall:.1f} ({own.cpu:.1f}) / {fine.wall:.1f} ({fine.cpu:.1f}) | "
            f"{fine.wall / own.wall:.1f} |"
        )


def meshes(name: str) -> Iterator[str]:
    """Bodies of a winding and a length of elements, beside the resolved one."""
    for kind in (FREE, TIP):
        change = GEOMETRIES[name] | kind.change
        made = {f"{layers} a half pitch, in turns": layered(name, layers) for layers in (4, 2, 1)}
        for axial in (COARSE, "4 mm", "2 mm"):
            made[f"{axial}, calibrated"] = {"mesh.axial": axial, f"{WINDING}.as": "calibrated"}
        reference: list[float | None] = []
        for label, mesh in made.items():
            run = Run(kind.case, change | mesh)
            values = run.at(*kind.goals)
            reference = reference or values
            yield (
                f"| {name} | {kind.label} | {label} | {run.run['unknowns']} | "
                f"{percent(values, reference)} | {longer(name, run) if kind is FREE else '–'} |"
            )


def longer(name: str, run: Run) -> str:
    """By how many radii a body seems longer than one that bends like its middle, at the angles."""
    radii = LENGTH / parse(GEOMETRIES[name].get("actuator.radius", "8 mm"), "length")
    middle = run.at("angle_deg", ANGLES, "uniform_angle_deg")
    pairs = zip(ANGLES, middle, strict=True)
    return " / ".join("–" if m is None else f"{radii * (a / m - 1):.3f}" for a, m in pairs)


def phases(name: str) -> Iterator[str]:
    """Tip forces of short bodies on one mesh, by where in a pitch the last turn ends."""
    for length in PHASES:
        change = GEOMETRIES[name] | TIP.change | {"actuator.length": length}
        change |= layered(name, RESOLVED)
        fine = Run(TIP.case, change)
        own = Run(TIP.case, change | {f"{WINDING}.as": "calibrated"})
        values, reference = (run.at(*TIP.goals) for run in (own, fine))
        yield f"| {name} | {length} | {shown(reference)} | {percent(values, reference)} |"


PARTS: dict[str, Part] = {
    "bent": Part(
        "Bent by pressure",
        "| geometry | K0, MPa/mm | a1 | a2 | left, % | fine cell: P at 90 / 180 / 270 / 360° | "
        "calibrated section, % | smeared section, % | s, calibration and all | s, kept |",
        bent,
        SECTIONS,
    ),
    "straight": Part(
        "Kept straight",
        "| geometry | fine cell: M in N mm at 25 / 50 / 75 / 100 kPa | calibrated, for a case kept "
        "straight, % | with the numbers of free bending, % | smeared, % |",
        straight,
        SECTIONS,
    ),
    "bodies": Part(
        f"Body of elements {COARSE} long",
        f"| geometry | what | resolved body, {RESOLVED} layers a half pitch | coarse body, "
        "calibrated, % | unknowns, coarse / resolved | s, coarse with its calibration / resolved | "
        "times faster |",
        bodies,
    ),
    "meshes": Part(
        "What the elements of a body cost",
        f"| geometry | what | elements | unknowns | beside {RESOLVED} layers a half pitch, % | "
        "seems longer at 90 / 180 / 270 / 360°, radii |",
        meshes,
        ("baseline",),
    ),
    "phases": Part(
        "Where the last turn ends",
        "| geometry | length | in turns: F at 25 / 50 / 75 / 100 kPa | calibrated, same mesh, % |",
        phases,
        ("baseline",),
    ),
}


def renewed(text: str, part: Part, name: str, rows: list[str]) -> str:
    """The page with other rows of a geometry in a table, in the order of the geometries.

    Args:
        text: the page.
        part: whose table.
        name: of the geometry.
        rows: its rows.
    """
    title = re.escape(f"## {part.title}")
    old = re.search(rf"^{title}$.*?(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    lines = old.group().splitlines() if old else []
    kept = {each: [row for row in lines if row.startswith(f"| {each} |")] for each in part.names}
    line = "|---" * (part.head.count("|") - 1) + "|"
    kept[name] = rows
    table = [part.head, line, *(row for each in part.names for row in kept[each])]
    made = "\n".join([f"## {part.title}", "", *table, "", ""])
    return text.replace(old.group(), made) if old else f"{text.rstrip()}\n\n{made}"


def main(words: list[str]) -> None:
    """Make rows of the named parts and geometries, all by default, and put them in the page."""
    unknown = [word for word in words if word not in PARTS and word not in GEOMETRIES]
    if unknown:
        sys.exit(f"{', '.join(unknown)}: expected {', '.join((*PARTS, *GEOMETRIES))}")
    names = [word for word in words if word in GEOMETRIES] or list(GEOMETRIES)
    for part in [PARTS[word] for word in words if word in PARTS] or PARTS.values():
        for name in [each for each in names if each in part.names]:
            rows = list(part.rows(name))
            print("\n".join(rows), flush=True)
            text = PAGE.read_text(encoding="utf-8") if PAGE.exists() else HEAD
            PAGE.write_text(renewed(text, part, name, rows).rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
