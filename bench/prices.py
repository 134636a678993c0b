"""What each effect adds in unknowns and seconds: runs/prices.json, a part of docs/accuracy.md.

Every scene is the baseline's body at one mesh and one load, with an effect and without it, each in
a process of its own, in turns; of each the least processor time counts. On an idle machine:
`make accuracy`, or `python -m bench.prices --rounds 1 --axial "16 mm"` for a quick look.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fiberbend.ladder.record import Record
from fiberbend.ladder.rungs import BARE, Family, Rung
from fiberbend.ladder.solve import solve
from fiberbend.models.choice import meshed
from fiberbend.reader.reader import read_case
from machine import origin

ROOT = Path(__file__).resolve().parent.parent
CASE = ROOT / "cases" / "free_bending.yaml"
TARGET = ROOT / "runs" / "prices.json"
PRESSURE = "50 kPa"
"""It bends the baseline to a right angle."""
BASE = (
    *("output={}", f"effects.0.pressure.to={PRESSURE}", "effects.1.winding.as=smeared"),
    *("model=body", *BARE),
)
"""A winding that is spread takes long elements."""


@dataclasses.dataclass(frozen=True)
class Scene:
    """An effect's price: the settings of a scene with it, beside one without.

    Attributes:
        effect: its name in the table.
        settings: changes to the base that add it.
        without: changes to the base of the scene beside it; none is the base itself.
    """

    effect: str
    settings: tuple[str, ...]
    without: tuple[str, ...] = ()


_BARE_BODY = ("actuator.sheath=null", "materials.sheath=null")
_WEIGHT = "materials.floor={name: combined-base, density: 1.2 g/cm^3}"
SCENES = (
    Scene("sheath of 1 mm", (), _BARE_BODY),
    Scene("caps of 15 mm, instead of 1 mm", (), ("actuator.cap=1 mm",)),
    Scene("gravity", ("effects.2={gravity: {direction: -y}}", _WEIGHT)),
    Scene("every turn of the winding", ("effects.1.winding.as=discrete",)),
    Scene("half of the body not enough: whole", ("mesh.symmetry=full",)),
    Scene("blocked tip", ("effects.2={blocked-tip: {}}",)),
    Scene(
        "contact with a cylinder",
        ("effects.2={contact: {cylinder: {center: [-45 mm, 60 mm], radius: 25 mm}}}",),
    ),
    Scene(
        "contact with roof and post",
        ("effects.2={contact: {roof: {gap: 0 mm, width: 4 mm}, post: {gap: 0 mm, length: 2 mm}}}",),
    ),
)


def rung(name: str, settings: Sequence[str], axial: str) -> Rung:
    """A scene as a rung, to be solved and measured as one."""
    changes = (*BASE, f"mesh.axial={axial}", *settings)
    case = read_case(CASE, changes)
    size = meshed(case).size(case)
    return Rung(Family("body", name), changes, case, {}, unknowns=size.unknowns)


def least(records: Sequence[Record]) -> dict[str, Any]:
    """A scene's record with its least times.

    Raises:
        RuntimeError: it has not converged.
    """
    for record in records:
        if record.status != "converged":
            raise RuntimeError(f"{record.name}: {record.status}, {record.reason}")
    names = ("wall_s", "cpu_s", "solve_wall_s", "solve_cpu_s")
    times = {name: min(getattr(record, name) for record in records) for name in names}
    first = records[0]
    return times | {
        "unknowns": first.unknowns,
        "load_steps": first.load_steps,
        "iterations": first.iterations,
        "peak_memory_MB": first.peak_memory_MB,
    }


def measure(axial: str, rounds: int) -> dict[str, Any]:
    """Every scene with and without its effect, `rounds` times in turns."""
    wanted: dict[tuple[str, ...], Rung] = {}
    for scene in SCENES:
        for settings in (scene.settings, scene.without):
            wanted.setdefault(settings, rung(scene.effect, settings, axial))
    found: dict[tuple[str, ...], list[Record]] = {settings: [] for settings in wanted}
    for number in range(rounds):
        for settings, each in wanted.items():
            record = solve(each)
            found[settings].append(record)
            print(
                f"{number + 1}/{rounds} {each.family.winding:40s} {record.unknowns:7d} unknowns "
                f"{record.solve_cpu_s:8.2f} s",
                flush=True,
            )
    return {
        "command": f'python -m bench.prices --rounds {rounds} --axial "{axial}"',
        "axial": axial,
        "pressure": PRESSURE,
        "rounds": rounds,
        "machine": origin.machine(),
        "commit": origin.commit(ROOT),
        "scenes": [
            {
                "effect": scene.effect,
                "with": least(found[scene.settings]),
                "without": least(found[scene.without]),
            }
            for scene in SCENES
        ],
    }


def table(prices: dict[str, Any]) -> list[str]:
    """The price list as Markdown."""
    lines = [
        "| effect | unknowns | steps | iterations | solve, CPU (s) | adds unknowns | adds time |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for scene in prices["scenes"]:
        own, other = scene["with"], scene["without"]
        more = own["solve_cpu_s"] - other["solve_cpu_s"]
        share = 100 * more / other["solve_cpu_s"]
        pairs = [
            f"{other[name]} → {own[name]}" for name in ("unknowns", "load_steps", "iterations")
        ]
        times = f"{other['solve_cpu_s']:.1f} → {own['solve_cpu_s']:.1f}"
        added = f"{own['unknowns'] - other['unknowns']:+d}"
        cells = [scene["effect"], *pairs, times, added, f"{more:+.1f} s ({share:+.0f} %)"]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def main() -> None:
    """Measure and write runs/prices.json."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--axial", default="4 mm", help="length of the elements")
    parser.add_argument("--rounds", type=int, default=3, help="times that each scene is solved")
    given = parser.parse_args()
    prices = measure(given.axial, given.rounds)
    TARGET.parent.mkdir(exist_ok=True)
    TARGET.write_text(json.dumps(prices, indent=2) + "\n", encoding="utf-8")
    print("\n".join(table(prices)))


if __name__ == "__main__":
    main()
