"""What `make paper ASSUME=1` has solved, as a JSON file beside this one: the page is quick."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bench.paper.assumed import confirm
from bench.paper.assumed.confirm import Confirmed, Held
from bench.paper.assumed.flat import Directions, Profile, directions, profiles
from bench.paper.assumed.grid import Grid
from bench.paper.combination import Best, optimise, statements

FILE = Path(__file__).with_name("record.json")
COMMAND = "make paper ASSUME=1"


@dataclasses.dataclass(frozen=True)
class Record:
    """Everything that the part shows.

    Attributes:
        grid: sections that were solved.
        best: the best combination of every reading, the best of all first.
        profiles: of what is open between numbers.
        ends: the best combination if of the radius only 6 and 12 mm count.
        ends_profiles: likewise.
        directions: at the best combination.
        cells: the best combination by the cell.
        bodies: its force by bodies.
        held_out: parts by which the grid is off where it was not solved.
        seconds: of processor time, all in all.
    """

    grid: Grid
    best: tuple[Best, ...]
    profiles: tuple[Profile, ...]
    ends: Best
    ends_profiles: tuple[Profile, ...]
    directions: Directions
    cells: tuple[Confirmed, ...]
    bodies: tuple[Held, ...]
    held_out: tuple[float, ...]
    seconds: float

    def save(self, target: Path = FILE) -> None:
        """Write it."""
        entries: dict[str, Any] = {
            "command": COMMAND,
            "seconds": round(self.seconds),
            "best": [one.entries() for one in self.best],
            "profiles": [dataclasses.asdict(one) for one in self.profiles],
            "ends": self.ends.entries(),
            "ends_profiles": [dataclasses.asdict(one) for one in self.ends_profiles],
            "directions": dataclasses.asdict(self.directions),
            "cells": [dataclasses.asdict(one) for one in self.cells],
            "bodies": [dataclasses.asdict(one) for one in self.bodies],
            "held_out": self.held_out,
            "grid": self.grid.entries(),
        }
        lines = [f' "{key}": {json.dumps(value)}' for key, value in entries.items()]
        target.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")

    @classmethod
    def load(cls, source: Path = FILE) -> Record:
        """Read it."""
        entries = json.loads(source.read_text(encoding="utf-8"))
        return cls(
            Grid.read(entries["grid"]),
            tuple(Best.read(one) for one in entries["best"]),
            tuple(Profile.read(one) for one in entries["profiles"]),
            Best.read(entries["ends"]),
            tuple(Profile.read(one) for one in entries["ends_profiles"]),
            Directions.read(entries["directions"]),
            tuple(
                Confirmed(tuple(one["key"]), one["grid"], one["cell"]) for one in entries["cells"]
            ),
            tuple(Held(**one) for one in entries["bodies"]),
            tuple(entries["held_out"]),
            entries["seconds"],
        )


def made(grid: Grid, tell: Callable[[str], None]) -> Record:
    """Optimise on a grid, and solve anew what is found."""
    stated = statements()
    tell("optimiser")
    best = optimise(grid, stated)
    given = best[0].given
    tell(f"best: {given}, misfit {best[0].misfit:.3f}")
    cells, cell_seconds = confirm.cells(grid, given, tell)
    bodies, body_seconds = confirm.bodies(grid, given, tell)
    held_out, seconds = confirm.held_out(grid, tell)
    return Record(
        grid,
        tuple(best),
        tuple(profiles(grid, stated)),
        optimise(grid, statements(ends=True))[0],
        tuple(profiles(grid, statements(ends=True))),
        directions(grid, given, stated),
        tuple(cells),
        tuple(bodies),
        tuple(held_out),
        grid.seconds + cell_seconds + body_seconds + seconds,
    )
