"""A single helix makes the actuator twist while it bends, by its hand.

python examples/twist.py runs/examples/twist
"""

from __future__ import annotations

import sys
from pathlib import Path

import fiberbend
from examples.actuator import case, hemicircle


def main(out: Path) -> dict[str, tuple[float, float]]:
    """Solve both hands; bending and twist in degrees at 100 kPa by hand."""
    found = {}
    for hand in ("left", "right"):
        winding = {
            "winding": {
                "pattern": f"single-helix-{hand}",
                "pitch": "6 mm",
                "fiber": "kevlar",
                "as": "smeared",
            }
        }
        helix = case(
            f"One helix, {hand}-handed",
            hemicircle(160),
            {"pressure": {"to": "100 kPa"}},
            winding,
            model="section",
            output={"fields": False},
        )
        result = fiberbend.run(helix, out / hand, overwrite=True)
        found[hand] = result.last("angle_deg"), result.last("twist_deg")
        print(f"{hand:6} bends by {found[hand][0]:6.1f}°, twists by {found[hand][1]:+6.1f}°")
    return found


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/examples/twist"))
