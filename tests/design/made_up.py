"""A model in closed form in place of the section, and designs that are searched with it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from fiberbend.case.case import Case
from fiberbend.design.quantities.seen import Reading, State
from fiberbend.design.reading import Design, read_design
from fiberbend.design.search.search import Search
from fiberbend.design.search.wishes import Correction
from fiberbend.design.solving.models import Slopes, States, UnsolvedError
from fiberbend.design.solving.tries import Tries

ROOT = Path(__file__).resolve().parents[2]
SECTION = str(ROOT / "cases" / "section.yaml")
_MODULUS = {"elastosil-m4601": 1.0, "dragon-skin-30": 0.8}


class MadeUp:
    """The angle is P r² / (E t), up to an angle at which it has no more states.

    Args:
        ends: rad.
    """

    def __init__(self, ends: float = math.inf) -> None:
        self._ends = ends
        self.solved = 0

    def states(self, case: Case, wanted: Sequence[State]) -> States:
        """As of `Model`."""
        self.solved += 1
        actuator = case.actuator
        assert actuator.radius is not None
        spec = case.materials.wall
        soft = actuator.radius**2 / (actuator.wall * _MODULUS[str(spec.name)])
        found: dict[State, Sequence[Reading]] = {}
        for state in wanted:
            bent = 0.0 if state.kind == "straight" else state.value * soft
            if bent > self._ends:
                raise UnsolvedError("it ends before")
            moment = state.value * actuator.radius**2 * (1 + actuator.wall)
            reading = Reading(state.value, bent, 1.0, moment, 0.1 * bent, 0.0, 0.0, bent**2)
            found[state] = (reading,)
        return found

    def slopes(self, case: Case, wanted: Sequence[State], fields: Sequence[str]) -> Slopes | None:
        """None: cases beside are solved."""
        return None


def design(folder: Path, **parts: Any) -> Design:
    """A design of the baseline's section whose file has these parts."""
    base = {"case": SECTION, "set": {"output": {}, "compare": []}}
    path = folder / "design.yaml"
    path.write_text(yaml.safe_dump({**base, **parts}), encoding="utf-8")
    return read_design(path)


def search(made: Design, model: MadeUp | None = None) -> Search:
    """A search of a design with the model in closed form."""
    return Search(made, Tries(made, model or MadeUp()))


def none(made: Design) -> list[Correction]:
    """No correction of any quantity."""
    return [Correction() for _ in made.quantities]
