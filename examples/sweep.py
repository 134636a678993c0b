"""Which radius and wall need the least pressure: a sweep, its table and its map.

    python examples/sweep.py runs/examples/sweep

The sweep is resumable: started again it solves what is missing. `fiberbend sweep FILE -j 2` does
the same from the shell, two points at a time.
"""

from __future__ import annotations

import sys
from pathlib import Path

import fiberbend
from examples.actuator import SMEARED, case, hemicircle


def main(out: Path) -> fiberbend.Sweep:
    """Run the sweep."""
    bend = {"pressure": {"angle": "90 deg"}}
    silent = {"pictures": False, "fields": False}
    base = case("Base", hemicircle(160), bend, SMEARED, model="section", output=silent)
    vary = {
        "actuator.radius": ["6 mm", "8 mm", "10 mm"],
        "actuator.wall": ["1.5 mm", "2 mm", "2.5 mm"],
    }
    report = {"angles": ["90 deg"]}
    file = {"title": "Radius and wall", "case": base, "vary": vary, "report": report}
    found = fiberbend.sweep(file, out)
    least = found.frame.sort_values("pressure_90deg_kPa").iloc[0]
    print(
        f"least pressure at 90°: {least['pressure_90deg_kPa']:.1f} kPa with a radius of "
        f"{least['radius_mm']:g} mm and a wall of {least['wall_mm']:g} mm"
    )
    return found


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/examples/sweep"))
