"""Hands for tests: files in a folder, and fingers of a law that is known at once."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from fiberbend.hand.assembled import Assembled
from fiberbend.hand.reading import Hand, read_hand
from fiberbend.slender import actuator
from fiberbend.slender.laws import SectionLaw
from rod.law import Law, Linear, Zones
from rod.layout import Layout
from tests.slender.rods import strains_without_shear

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "cases" / "hands" / "three_fingers.yaml"
STRETCHING, BENDING = 60.0, 3000.0
"""EA in N and EI in N mm² of a section as soft as the baseline's under pressure."""
THRUST = (90.0, 550.0)
"""Force and moment of a pressure of one, mm² and mm³."""


def content() -> dict[str, Any]:
    """The hand that comes with the program, its case where it is."""
    data: dict[str, Any] = yaml.safe_load(FILE.read_text(encoding="utf-8"))
    data["case"] = str(ROOT / "cases" / "free_bending_smeared.yaml")
    return data


def written(folder: Path, **changes: Any) -> Path:
    """That hand with other parts, as a file; None takes a part away."""
    data = copy.deepcopy(content()) | changes
    if data.get("gravity") is None and "set" not in changes:
        # a density that nothing weighs by is refused
        del data["set"]["materials.floor"]
    path = folder / "hand.yaml"
    kept = {key: value for key, value in data.items() if value is not None}
    path.write_text(yaml.safe_dump(kept, sort_keys=False), encoding="utf-8")
    return path


def hand(folder: Path, **changes: Any) -> Hand:
    """The same, checked."""
    return read_hand(written(folder, **changes))


def known_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sections have a linear law: what is tested is what a hand makes of any law."""

    def law(case: Any, *_: Any) -> SectionLaw:
        made = Linear(np.diag([STRETCHING, BENDING]), np.array([1.0, 0.0]), 100.0, np.array(THRUST))
        return SectionLaw(made, np.zeros((0, 3)), "section", 0, 0.0, 0.0, ())

    def along(_case: Any, made: SectionLaw, cap: Law, layout: Layout, chamber: slice) -> Law:
        inside = np.zeros(len(layout.lengths), dtype=int)
        inside[chamber] = 1
        return Zones((cap, made.law), inside.tolist())

    monkeypatch.setattr(actuator, "section_law", law)
    monkeypatch.setattr(actuator, "along", along)
    monkeypatch.setattr(actuator, "strains_of", strains_without_shear)


def assembled(folder: Path, **changes: Any) -> Assembled:
    """A hand that can be solved."""
    return Assembled(hand(folder, **changes))
