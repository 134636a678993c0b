"""A small actuator whose runs take seconds, and runs that several tests look at."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend import run
from fiberbend.models.result import RunResult

SMALL: dict[str, Any] = {
    "title": "A short actuator",
    "actuator": {
        "section": "hemicircle",
        "radius": "8 mm",
        "length": "24 mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "sheath": "1 mm",
        "cap": "6 mm",
    },
    "materials": {"wall": "elastosil-m4601", "floor": "combined-base", "sheath": "ecoflex-0030"},
    "effects": [
        {"pressure": {"to": "60 kPa"}},
        {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}},
    ],
    "model": "body",
    "mesh": {"axial": "4 mm"},
    "output": {"at_angles": ["8 deg"], "fields": False, "pictures": False},
}


def small(**changes: Any) -> dict[str, Any]:
    """The small case with top-level entries changed."""
    return copy.deepcopy(SMALL) | changes


def write_case(folder: Path, case: dict[str, Any]) -> Path:
    """A case as a file."""
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(case), encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def small_run(tmp_path_factory: pytest.TempPathFactory) -> RunResult:
    """The small case, with everything that a run can leave."""
    folder = tmp_path_factory.mktemp("small") / "run"
    output = {"at_angles": ["8 deg"], "at_pressures": ["30 kPa"]}
    return run(small(output=output), folder)
