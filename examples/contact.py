"""An actuator that bends down onto a table and presses on it.

    python examples/contact.py runs/examples/contact

The march stops where the touch is foreseen, and starts anew from there. Until then the body bends
as if nothing were there.
"""

from __future__ import annotations

import sys
from pathlib import Path

import fiberbend
from examples.actuator import SMEARED, case, hemicircle

TABLE = {"plane": {"point": ["0 mm", "-8 mm", "0 mm"], "normal": [0, 1, 0]}}


def main(out: Path) -> tuple[float, float]:
    """Solve it; the pressure in kPa at the touch, and the table's force at the end in N."""
    table = case(
        "Onto a table",
        hemicircle(48, 6),
        {"pressure": {"to": "60 kPa"}},
        SMEARED,
        {"contact": TABLE},
        model="body",
        mesh={"axial": "6 mm"},
        output={"fields": False},
    )
    result = fiberbend.run(table, out, overwrite=True)
    (touched,) = result.run["contact"]["plane"]["touched_at_kPa"]
    force = result.at(pressure="60 kPa")["contact_plane_y_N"]
    body = result.mesh("last").warp_by_vector("displacement_mm")
    print(f"touches at {touched:.1f} kPa, presses with {force:.3f} N at 60 kPa")
    print(f"the body reaches down to y = {body.bounds[2]:.2f} mm, the table is at -8 mm")
    return touched, force


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/examples/contact"))
