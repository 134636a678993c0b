"""How hard the tip pushes when it may not move: a body under a roof and on a post.

    python examples/blocked_tip.py runs/examples/blocked_tip

Beside it the blocked state of uniform bending, a section that is kept straight: its moment over the
length of the cap. A real tip turns a little and its sheath yields, so that it pushes less.
"""

from __future__ import annotations

import sys
from pathlib import Path

import fiberbend
from examples.actuator import SMEARED, case, hemicircle

PRESSURE = {"pressure": {"to": "100 kPa"}}


def main(out: Path) -> tuple[float, float]:
    """Solve body and section; the tip force in N of both."""
    output = {"fields": False}
    tip = case(
        "Blocked tip",
        hemicircle(40, 8),
        PRESSURE,
        SMEARED,
        {"blocked-tip": {}},
        model="body",
        mesh={"axial": "4 mm"},
        output=output,
    )
    straight = case(
        "Kept straight", hemicircle(40, 8), PRESSURE, SMEARED, {"straight": {}}, output=output
    )
    forces = []
    for name, blocked in (("body", tip), ("section", straight)):
        result = fiberbend.run(blocked, out / name, overwrite=True)
        forces.append(result.last("tip_force_N"))
        print(f"{name:8} {forces[-1]:6.2f} N at {result.last('pressure_kPa'):g} kPa")
    return forces[0], forces[1]


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/examples/blocked_tip"))
