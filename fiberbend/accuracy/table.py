"""What is known of errors: the table that `make knowledge` writes, and how far it carries."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from fiberbend.accuracy.numbers import PITCH, SOFT

FILE = Path(__file__).parent / "knowledge.json"
BEYOND = 2.0
"""Times a number may lie outside of those in the table: beyond, nothing is known."""
ABSENT = 1.5
"""A part that is not there counts as a number that lies outside so many times."""

_END = 1e-6
"""Rounding of the numbers."""

Curve = tuple[float, ...]
"""Percent at the curvatures of the table; ends early where an actuator does."""


@dataclasses.dataclass(frozen=True)
class Known:
    """What is known of an actuator; all in percent of P at a bending angle.

    Attributes:
        name: as the script calls it.
        section: shape of its section.
        numbers: what it is like, see `fiberbend.accuracy.numbers`.
        spread: error of a section by the elements through each thickness.
        turns: error of a cell by the same and by layers in half a turn; may be empty.
        winding: error of a winding that is spread; may be empty.
        ends: curvature of the middle, times the radius, and by how many radii longer than it is
            a body with caps seems; may be empty.
    """

    name: str
    section: str
    numbers: Mapping[str, float]
    spread: Mapping[int, Curve]
    turns: Mapping[tuple[int, float], Curve]
    winding: Curve
    ends: tuple[Curve, Curve]


@dataclasses.dataclass(frozen=True)
class Knowledge:
    """All of it.

    Attributes:
        origin: command, commit and machine that made it.
        curvatures: radius times curvature at which errors are known, rising.
        actuators: what is known of each.
        body_curvatures: the same of bodies.
        spread_body: error of a body beyond that of its section at these, by the length of its
            elements over the radius, winding spread.
        turns_body: the same of a body beyond its cell, by layers in half a turn: turns fill it
            otherwise than a slice that repeats.
        ends_of_turns: by how many radii more than one with a spread winding and long elements a
            body with turns seems longer.
        ends_of_short: by how many radii more a body of ten radii seems longer than one of twenty.
    """

    origin: Mapping[str, Any]
    curvatures: Curve
    actuators: tuple[Known, ...]
    body_curvatures: Curve
    spread_body: Mapping[float, Curve]
    turns_body: Mapping[float, float]
    ends_of_turns: float
    ends_of_short: float

    def of_section(self, section: str) -> tuple[Known, ...]:
        """Actuators with a shape; all of them where there is none."""
        found = tuple(known for known in self.actuators if known.section == section)
        return found or self.actuators


@functools.cache
def knowledge() -> Knowledge:
    """The table as it is shipped."""
    data = json.loads(FILE.read_text(encoding="utf-8"))
    return Knowledge(
        data["origin"],
        tuple(data["curvatures"]),
        tuple(_known(entry) for entry in data["actuators"]),
        tuple(data["body curvatures"]),
        {float(key): _curve(values) for key, values in data["spread body"].items()},
        {float(key): value for key, value in data["turns body"].items()},
        data["ends of turns"],
        data["ends of short"],
    )


def _known(entry: Mapping[str, Any]) -> Known:
    turns = {
        (int(section), float(layers)): _curve(values)
        for key, values in entry.get("turns", {}).items()
        for section, layers in [key.split()]
    }
    ends = entry.get("ends", {"curvature": [], "longer": []})
    return Known(
        entry["name"],
        entry["section"],
        entry["numbers"],
        {int(key): _curve(values) for key, values in entry["spread"].items()},
        turns,
        _curve(entry.get("winding", ())),
        (tuple(ends["curvature"]), tuple(ends["longer"])),
    )


def _curve(values: Sequence[float | None]) -> Curve:
    known = []
    for value in values:
        if value is None:
            break
        known.append(value)
    return tuple(known)


def up_to(known: Sequence[Known], name: str, value: float) -> list[Known]:
    """Actuators that have no more of a number than the next one to a value."""
    above = [k.numbers[name] for k in known if k.numbers[name] >= value * (1 - _END)]
    return [k for k in known if k.numbers[name] <= min(above, default=math.inf) * (1 + _END)]


def down_to(known: Sequence[Known], name: str, value: float) -> list[Known]:
    """Actuators that have no less of a number than the next one below a value."""
    below = [k.numbers[name] for k in known if k.numbers[name] <= value * (1 + _END)]
    return [k for k in known if k.numbers[name] >= max(below, default=0.0) * (1 - _END)]


def reaches(curvatures: Curve, values: Curve, curvature: float) -> bool:
    """Whether a curve is known as far as a curvature; the table's last one counts as the end."""
    last = min(len(curvatures), len(values)) - 1
    return last == len(curvatures) - 1 or curvature <= curvatures[last] * (1 + 1e-3)


def at(curvatures: Curve, values: Curve, curvature: float) -> float:
    """A curve at a curvature; held beyond its ends."""
    last = min(len(curvatures), len(values)) - 1
    if curvature <= curvatures[0]:
        return values[0]
    for index in range(last):
        low, high = curvatures[index], curvatures[index + 1]
        if curvature <= high:
            part = (curvature - low) / (high - low)
            return values[index] + part * (values[index + 1] - values[index])
    return values[last]


def outside(
    known: Sequence[Known], numbers: Mapping[str, float], turns: bool = False
) -> Iterator[tuple[str, float]]:
    """What lies outside of what is known.

    Args:
        known: the actuators of one shape.
        numbers: what the actuator at hand is like.
        turns: whether every turn counts: only pitches are known then of which there are cells.

    Yields:
        A number in words and how many times it lies outside, above one.
    """
    for name, value in numbers.items():
        with_it = [entry for entry in known if name in entry.numbers]
        if turns and name == PITCH:
            with_it = [entry for entry in with_it if entry.turns] or with_it
        there = [entry.numbers[name] for entry in with_it]
        low, high = min(there), max(there)
        if low * (1 - 1e-6) <= value <= high * (1 + 1e-6) or (name == SOFT and value > low):
            continue
        times = ABSENT
        if value and high:
            times = value / high if value > high else low / value
        elif value:
            times = math.inf
        span = f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
        yield f"{name} {value:.3g} (known: {span})", times
