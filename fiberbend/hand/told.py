"""What a hand answers, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from fiberbend.answer.answer import Answer, Entry
from fiberbend.answer.numbers import number
from fiberbend.hand.assembled import Assembled
from fiberbend.hand.reading import Hand
from fiberbend.hand.rows import MODES, PRESSURE, on_object
from fiberbend.hand.solved import Solved
from fiberbend.running.slender.touch import passes_itself

_FELT = 1e-9
"""Force in N that is none."""


def answer(made: Assembled, solved: Solved, rows: Sequence[dict[str, Any]]) -> Answer:
    """All of it.

    Args:
        made: the hand.
        solved: its states.
        rows: of history.csv.
    """
    hand = made.hand
    return Answer(
        title=hand.title,
        sentence=_sentence(hand, solved, rows),
        entries=(*_fingers(hand, rows), *_objects(hand, solved, rows), *_pairs(hand, solved, rows)),
        trust=(
            "fingers are rods, whose sections keep their outline; objects are rigid, fixed and "
            "without friction (docs/hand.md)"
        ),
        comparisons=(),
        warnings=tuple(_warnings(made, solved, rows)),
    )


def _warnings(made: Assembled, solved: Solved, rows: Sequence[dict[str, Any]]) -> Iterator[str]:
    """What is doubtful."""
    if rows[-1][MODES]:
        count = rows[-1][MODES]
        yield f"the last state is unstable: {count} mode{'s' if count > 1 else ''} would grow"
    for place, digit in enumerate(made.digits):
        shapes = [moment.state.shape.each[place] for moment in solved.moments]
        first = passes_itself(digit.slender, shapes)
        if first is not None:
            pressure = number(rows[first][f"finger_{place + 1}_pressure_kPa"])
            name = digit.finger.name
            yield f"{name} passes through itself at the latest at {pressure} kPa: not modelled"
    yield from sorted({line for digit in made.digits for line in digit.slender.section.remarks})


def _sentence(hand: Hand, solved: Solved, rows: Sequence[dict[str, Any]]) -> str:
    count = len(hand.fingers)
    last = solved.moments[-1]
    what = f"{count} finger{'s' if count > 1 else ''} as rod{'s' if count > 1 else ''}"
    text = f"{what}, {solved.steps} states up to {number(rows[-1][PRESSURE])} kPa"
    if hand.gravity is not None and last.weight < 1:
        return f"{text}, {number(100 * last.weight)} % of the weight: {solved.reason}."
    return f"{text}: {solved.reason}." if solved.reason else f"{text}."


def _fingers(hand: Hand, rows: Sequence[dict[str, Any]]) -> Iterator[Entry]:
    last = rows[-1]
    for place, finger in enumerate(hand.fingers, start=1):
        mine = f"finger_{place}"
        tip = ", ".join(number(last[f"{mine}_tip_{axis}_mm"]) for axis in "xyz")
        value = f"{number(last[f'{mine}_angle_deg'])}° at "
        value += f"{number(last[f'{mine}_pressure_kPa'])} kPa, tip at {tip} mm"
        forces = [
            f"{number(size)} N on the {name}"
            for name in hand.objects
            if (size := math.hypot(*on_object(last, place - 1, name))) > _FELT
        ]
        yield Entry(finger.name, value, ", ".join(forces))


def _objects(hand: Hand, solved: Solved, rows: Sequence[dict[str, Any]]) -> Iterator[Entry]:
    last = rows[-1]
    for name in hand.objects:
        begun = [touch for touch in solved.touches if touch.other == name]
        if not begun:
            yield Entry(name, f"not touched, {number(last[f'{name}_gap_mm'])} mm away")
            continue
        first = begun[0]
        greatest = max((finger.pressure for finger in hand.fingers), key=abs)
        when = f"touched from {number(1e3 * first.pressure * greatest)} kPa on"
        if not first.pressure:
            when = "touched under the weight"
        names = {hand.fingers[touch.finger].name for touch in begun}
        note = f"by {len(names)} of {len(hand.fingers)} fingers"
        yield Entry(name, when, note)
        force = ", ".join(number(last[f"{name}_{axis}_N"]) for axis in "xyz")
        turning = ", ".join(number(last[f"{name}_moment_{axis}_Nmm"]) for axis in "xyz")
        yield Entry("", f"force on it {force} N, moment {turning} N mm")


def _pairs(hand: Hand, solved: Solved, rows: Sequence[dict[str, Any]]) -> Iterator[Entry]:
    last, greatest = rows[-1], max((finger.pressure for finger in hand.fingers), key=abs)
    for touch in solved.touches:
        if isinstance(touch.other, int):
            a, b = touch.finger, touch.other
            size = _size(last, f"finger_{b + 1}_on_{a + 1}", "N")
            value = f"touch from {number(1e3 * touch.pressure * greatest)} kPa on"
            both = f"{hand.fingers[a].name} and {hand.fingers[b].name}"
            yield Entry(both, value, f"{number(size)} N at the end")
    rooms = {
        key: last[key] for key in last if key.startswith("fingers_") and key.endswith("_gap_mm")
    }
    if rooms and not any(isinstance(touch.other, int) for touch in solved.touches):
        yield Entry("fingers", f"{number(min(rooms.values()))} mm from each other at the end")


def _size(row: dict[str, Any], name: str, unit: str) -> float:
    return math.hypot(*(row[f"{name}_{axis}_{unit}"] for axis in "xyz"))
