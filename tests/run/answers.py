"""Cases, rows and entries of an answer by which the tests of answers are written."""

from __future__ import annotations

from typing import Any

import yaml

from fiberbend.answer.answer import Answer, Entry
from fiberbend.case.case import Case
from fiberbend.reader.reader import parse_case
from tests.conftest import ROOT

CONVERGED: dict[str, Any] = {"status": "converged", "reason": "", "warnings": []}


def case_of(name: str = "section", **sections: Any) -> Case:
    """A shipped case with changes to it."""
    data = yaml.safe_load((ROOT / "cases" / f"{name}.yaml").read_text(encoding="utf-8"))
    for key, change in sections.items():
        data[key] = {**data[key], **change} if isinstance(change, dict) else change
    return parse_case(data)


def row(step: int, kpa: float, degrees: float, **more: Any) -> dict[str, Any]:
    place = {"tip_x_mm": 0.0, "tip_y_mm": 5.0 - degrees, "tip_z_mm": 175.0 - step}
    return {"step": step, "pressure_kPa": kpa, "angle_deg": degrees, **place, **more}


def found(said: Answer, label: str) -> Entry:
    (entry,) = [entry for entry in said.entries if entry.label == label]
    return entry


def labels(said: Answer) -> list[str]:
    return [entry.label for entry in said.entries]
