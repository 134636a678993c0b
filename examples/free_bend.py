"""How much pressure bends the baseline to 360°: the section's answer beside the cell's.

    python examples/free_bend.py runs/examples/free_bend

The section spreads the winding over its surface and needs half a second. The cell has every turn by
itself: rubber bulges between them, and it needs a few per cent more pressure.
"""

from __future__ import annotations

import sys
from pathlib import Path

import fiberbend
from examples.actuator import WINDING, case, hemicircle

ANGLES = ("90 deg", "180 deg", "270 deg", "360 deg")
"""Load steps are made there, so that no pressure is interpolated."""


def main(out: Path) -> dict[str, list[float]]:
    """Solve both models; the pressures in kPa at 90, 180, 270 and 360° by model."""
    found = {}
    for model in ("section", "cell"):
        bend = {"pressure": {"angle": ANGLES[-1]}}
        output = {"at_angles": list(ANGLES), "fields": False}
        free = case("Free bending", hemicircle(160), bend, WINDING, model=model, output=output)
        result = fiberbend.run(free, out / model, overwrite=True)
        found[model] = [result.at(angle=angle)["pressure_kPa"] for angle in ANGLES]
        print(f"{model:8}", "  ".join(f"{kpa:6.1f} kPa" for kpa in found[model]))
    return found


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/examples/free_bend"))
