"""Tables of calibrated windings: section beside a fine cell, coarse body beside a resolved one.

Writes docs/evidence/calibration.md; names of parts on the command line (bent, straight, bodies)
renew only these. Minutes for sections and cells, half an hour for the bodies; every number in the
page comes from here. Times are those of whole processes: the machine should be idle.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fiberbend.calibration.store import FOLDER
from fiberbend.schema.units import parse, show
from machine.folders import cache_root

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
}
"""Radius 8, wall 2, pitch 3 mm but for what is named."""
BODIES = ("baseline", "radius 6 mm", "pitch 4.5 mm")
COARSE = "8 mm"
HEAD = """# A calibrated winding beside every turn by itself

P in kPa of the baseline of Polygerinos et al. 2015 (radius 8, length 160, wall 2, floor 2, sheath
1 mm; double helix of pitch 3 mm) and of seven geometries beside it, each calibrated by its own cell
(one element through each thickness, eight along half a pitch; `fiberbend/calibration/`). The fine
cell has two elements through each thickness and twelve along half a pitch. `python
bench/calibration.py` makes the page, in the order bent, straight, bodies; `make calibration` does
too. s are seconds of whole processes as they came, CPU in brackets.
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
    (cache_root().path / FOLDER / f"{mark}.json").unlink(missing_ok=True)
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


def bent() -> str:
    """Section, calibrated and smeared, beside a fine cell at the angles."""
    calibrated = {f"{WINDING}.as": "calibrated"}
    rows = []
    for name, change in GEOMETRIES.items():
        own = anew("section.yaml", change | calibrated)
        again = Run("section.yaml", change | calibrated)
        plain = Run("section.yaml", change)
        cell = Run("cell.yaml", change | FINE | layered(name, LAYERS))
        p, q, reference = (r.at("angle_deg", ANGLES, "pressure_kPa") for r in (own, plain, cell))
        entry = own.run["calibration"]
        numbers = " | ".join(
            f"{entry[key]:.3g}" for key in ("stiffness_MPa_per_mm", "linear", "quadratic")
        )
        rows.append(
            f"| {name} | {numbers} | {entry['bent_percent']:.2f} | {shown(reference)} | "
            f"{percent(p, reference)} | {percent(q, reference)} | {own.wall:.1f} ({own.cpu:.1f}) | "
            f"{again.wall:.1f} ({again.cpu:.1f}) |"
        )
        print(rows[-1], flush=True)
    head = (
        "| geometry | K0, MPa/mm | a1 | a2 | left, % | fine cell: P at 90 / 180 / 270 / 360° | "
        "calibrated section, % | smeared section, % | s, calibration and all | s, kept |"
    )
    return _table("Bent by pressure", head, rows)


def straight() -> str:
    """Moment of a section kept straight beside a fine cell, by numbers of either kind."""
    rows = []
    for name, change in GEOMETRIES.items():
        goals = ("pressure_kPa", PRESSURES, "blocked_moment_Nmm")
        most = {
            "effects.0.pressure.to": f"{PRESSURES[-1]} kPa",
            "output.at_pressures": f"[{', '.join(f'{p} kPa' for p in PRESSURES)}]",
        }
        free = Run("section.yaml", change | {f"{WINDING}.as": "calibrated"}).run["calibration"]
        section = change | most | {"model": "section"}
        own = Run("straight.yaml", section | {f"{WINDING}.as": "calibrated"})
        bending = Run("straight.yaml", section | as_found(free))
        plain = Run("straight.yaml", section | {f"{WINDING}.as": "smeared"})
        fine = change | most | {"model": "cell", "mesh.section": "2"} | layered(name, LAYERS)
        reference = Run("straight.yaml", fine).at(*goals)
        parts = (percent(r.at(*goals), reference) for r in (own, bending, plain))
        rows.append(f"| {name} | {shown(reference)} | {' | '.join(parts)} |")
        print(rows[-1], flush=True)
    head = (
        "| geometry | fine cell: M in N mm at 25 / 50 / 75 / 100 kPa | calibrated, for a case kept "
        "straight, % | with the numbers of free bending, % | smeared, % |"
    )
    return _table("Kept straight", head, rows)


def bodies() -> str:
    """A coarse body, calibrated, beside a resolved one: bent, and its tip blocked."""
    kinds: dict[str, tuple[str, str, tuple[float, ...], str]] = {
        "free_bending.yaml": ("P at 90 / 180 / 270 / 360°", "angle_deg", ANGLES, "pressure_kPa"),
        "blocked_tip.yaml": (
            "F at 25 / 50 / 75 / 100 kPa",
            "pressure_kPa",
            PRESSURES,
            "tip_force_N",
        ),
        "blocked_contact.yaml": (
            "F by contact at 25 / 50 / 75 / 100 kPa",
            "pressure_kPa",
            PRESSURES,
            "tip_force_N",
        ),
    }
    rows = []
    for name in BODIES:
        for case, (label, key, goals, value) in kinds.items():
            change = dict(GEOMETRIES[name])
            if case == "free_bending.yaml":
                angles = ", ".join(f"{angle} deg" for angle in ANGLES)
                change |= {
                    "effects.0.pressure.to": "260 kPa",
                    "output.at_angles": f"[{angles}]",
                    "output.stop_at_angle": f"{ANGLES[-1]} deg",
                }
            else:
                change |= {
                    "effects.0.pressure.to": f"{PRESSURES[-1]} kPa",
                    "output.at_pressures": f"[{', '.join(f'{p} kPa' for p in PRESSURES)}]",
                }
            coarse = {"mesh.axial": COARSE, f"{WINDING}.as": "calibrated"}
            own, fine = anew(case, change | coarse), Run(case, change | layered(name, 1))
            values, reference = (run.at(key, goals, value) for run in (own, fine))
            rows.append(
                f"| {name} | {label} | {shown(reference)} | {percent(values, reference)} | "
                f"{own.run['unknowns']} / {fine.run['unknowns']} | "
                f"{own.wall:.1f} ({own.cpu:.1f}) / {fine.wall:.1f} ({fine.cpu:.1f}) | "
                f"{fine.wall / own.wall:.1f} |"
            )
            print(rows[-1], flush=True)
    head = (
        "| geometry | what | resolved body | coarse body, calibrated, % | unknowns, coarse / "
        "resolved | s, coarse with its calibration / resolved | times faster |"
    )
    return _table(f"Body of elements {COARSE} long", head, rows)


def _table(title: str, head: str, rows: list[str]) -> str:
    line = "|---" * (head.count("|") - 1) + "|"
    return "\n".join([f"## {title}", "", head, line, *rows, ""])


PARTS: dict[str, Callable[[], str]] = {"bent": bent, "straight": straight, "bodies": bodies}


def main(names: list[str]) -> None:
    """Make the named parts, all by default, and put them in their places in the page."""
    unknown = [name for name in names if name not in PARTS]
    if unknown:
        sys.exit(f"{', '.join(unknown)}: expected {', '.join(PARTS)}")
    text = PAGE.read_text(encoding="utf-8") if PAGE.exists() else HEAD
    for name in names or PARTS:
        made = PARTS[name]()
        title = re.escape(made.splitlines()[0])
        old = re.search(rf"^{title}$.*?(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
        text = text.replace(old.group(), made + "\n") if old else f"{text.rstrip()}\n\n{made}"
        PAGE.write_text(text.rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
