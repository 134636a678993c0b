"""Cases of the house with coarse sections, and their runs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import yaml

from fiberbend.case.case import Case
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from fiberbend.reader.shipped import FOLDER
from fiberbend.running.runner import run_case

Data = dict[str, Any]

TIGHT = 1e-11
"""Tolerance of the runs: their own error is no part of what is compared."""


def shipped(name: str, **changes: Any) -> Data:
    """A case of the house as a mapping."""
    data: Data = yaml.safe_load((FOLDER / f"{name}.yaml").read_text(encoding="utf-8"))
    del data["output"]
    data.pop("compare", None)
    return data | {"mesh": {"section": 1}} | changes


def under(data: Data, *more: Data, **pressure: str) -> Data:
    """The same under another pressure, its other effects kept, and more of them."""
    others = [effect for effect in data["effects"] if "pressure" not in effect]
    return data | {"effects": [{"pressure": pressure}, *others, *more]}


def wound(data: Data, **winding: Any) -> Data:
    """The same with another winding."""
    others = [effect for effect in data["effects"] if "winding" not in effect]
    return data | {"effects": [*others, {"winding": winding}]}


def checked(data: Data) -> Case:
    """The case of a mapping."""
    return parse_case(data)


def run(data: Data, states: Path | None = None, **output: Any) -> RunResult:
    """A run of a case that writes nothing, or its states alone."""
    silent = {"pictures": False, "fields": states is not None, "report": False}
    solver = {"tolerance": TIGHT}
    case = parse_case(data | {"solver": solver, "output": silent | output})
    return run_case(case, None, states=states)


def radians(*degrees: float) -> tuple[float, ...]:
    """Angles in rad."""
    return tuple(math.radians(angle) for angle in degrees)
