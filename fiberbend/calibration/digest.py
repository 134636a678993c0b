"""What a calibration depends on: everything that enters, and nothing else."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
from pathlib import Path
from typing import Any

from fiberbend.calibration.reach import Reach
from fiberbend.case import convert
from fiberbend.case.case import Case

LAYERS = 8
"""Elements of the cell along half a pitch."""
CELL = 1
"""Elements of the cell through each thickness."""
SECTION = 2
"""The same of the section: as many as a section has by default, whose own error is absorbed."""
TOLERANCE = 1e-8
"""Of Newton's method."""
_NOT_OF_A_SECTION = {"length", "cap"}
_CODE = (
    *("fem/effects", "fem/kinematics", "fiberbend/calibration", "fiberbend/uniform"),
    *("geometry/sections", "geometry/winding", "materials", "materials/laws"),
)
"""Folders whose files say what a number means; of solver and march only round-off hangs on."""
_DIGITS = 16


def content(case: Case, reach: Reach) -> dict[str, Any]:
    """All that enters a calibration; length, caps, loads and densities do not.

    Args:
        case: a case with a winding.
        reach: how far its cell is bent.
    """
    return common(case) | {
        "winding": [
            effect.model_dump(exclude={"representation", "bulging", "bedding"})
            for effect in case.effects
            if effect.winds()
        ],
        "reach": dataclasses.asdict(reach),
        "straight": case.straight,
        "mesh": [CELL, LAYERS, SECTION, TOLERANCE],
    }


def common(case: Case) -> dict[str, Any]:
    """What enters the calibration of any winding."""
    given = convert.site(case)
    return {
        "section": {
            name: value
            for name, value in case.actuator.model_dump().items()
            if name not in _NOT_OF_A_SECTION
        },
        "materials": {
            part: {"law": item.law, "bulk": item.bulk, **dict(item.parameters)}
            for part, item in given.materials.items()
        },
        "code": _code(),
    }


def digest(content: dict[str, Any]) -> str:
    """A hash of it."""
    text = json.dumps(content, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


@functools.cache
def _code() -> str:
    """A hash of the source that a calibration depends on."""
    root, found = Path(__file__).resolve().parents[2], hashlib.sha256()
    for folder in _CODE:
        for file in sorted((root / folder).glob("*.py")):
            found.update(file.name.encode() + b"\0" + file.read_bytes())
    return found.hexdigest()[:_DIGITS]
