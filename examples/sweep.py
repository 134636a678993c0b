"""Which radius and wall need the least pressure: a sweep, its table and its map.

    python examples/sweep.py runs/examples/sweep

The sweep is resumable: started again it solves what is missing. `fiberbend sweep FILE -j 2` does
the same from the shell, two points at a time.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import yaml

from examples.actuator import SMEARED, case, hemicircle
from fiberbend.running import launch
from fiberbend.sweep.command import run_sweep


def main(out: Path) -> list[dict[str, str]]:
    """Run the sweep; the rows of its table."""
    out.mkdir(parents=True, exist_ok=True)
    bend = {"pressure": {"angle": "90 deg"}}
    silent = {"pictures": False, "fields": False}
    base = case("Base", hemicircle(160), bend, SMEARED, model="section", output=silent)
    vary = {
        "actuator.radius": ["6 mm", "8 mm", "10 mm"],
        "actuator.wall": ["1.5 mm", "2 mm", "2.5 mm"],
    }
    report = {"angles": ["90 deg"]}
    files = {
        "base.yaml": base,
        "sweep.yaml": {
            "title": "Radius and wall",
            "case": "base.yaml",
            "vary": vary,
            "report": report,
        },
    }
    for name, content in files.items():
        (out / name).write_text(yaml.safe_dump(content), encoding="utf-8")
    launch.start_mpi()
    run_sweep(out / "sweep.yaml", out / "points")
    with (out / "points" / "sweep.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    least = min(rows, key=lambda row: float(row["pressure_90deg_kPa"]))
    print(
        f"least pressure at 90°: {float(least['pressure_90deg_kPa']):.1f} kPa with a radius of "
        f"{least['radius_mm']} mm and a wall of {least['wall_mm']} mm"
    )
    return rows


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/examples/sweep"))
